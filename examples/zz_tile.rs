//! scratch
use crowdquilt::{
    check,
    patch::PatchSet,
    tiling::{Options, Scene, tile},
};
use std::path::Path;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let set = PatchSet::load(Path::new(&a[1])).unwrap();
    let scene = if a[2] == "demo" { Scene::demo() } else { Scene::load(Path::new(&a[2])).unwrap() };
    for seed in a[3].parse::<u64>().unwrap()..=a[4].parse().unwrap() {
        let o = tile(&scene, &set, &Options { seed, ..Options::default() }, &mut |_| true).unwrap();
        let r = check::check(&o.crowd);
        let s = check::summary(&o.crowd);
        println!(
            "seed {seed}: {:?} {} people {} patches {:.1}% in {:.2} s",
            o.status,
            o.crowd.characters.len(),
            o.crowd.instances.len(),
            s.multi_person_share * 100.0,
            o.solve_secs
        );
        for row in r.rows.iter().filter(|r| !r.ok) {
            println!("   {row:?}");
        }
        for row in r.rows.iter().filter(|r| r.row.contains("limits")) {
            println!("   {} {:?} {:?}", row.row, row.value, row.place);
        }
    }
}
