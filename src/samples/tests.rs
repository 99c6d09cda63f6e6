use super::*;

#[test]
#[ignore]
fn dump() {
    let dir = std::env::var("SAMPLES_OUT").unwrap();
    write(Path::new(&dir), 1).unwrap();
}
