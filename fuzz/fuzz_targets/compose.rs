//! Compose files of any content: an error or a patch, never a panic.
#![no_main]

use std::sync::LazyLock;

use crowdquilt::motion::retarget;
use crowdquilt::patch::{Source, compose::compose};
use crowdquilt::samples;
use crowdquilt_fuzz as _;
use libfuzzer_sys::fuzz_target;

static SOURCES: LazyLock<Vec<Source>> = LazyLock::new(|| {
    let people = ["start-stop", "start-stop-90", "bow-stand", "push-stand", "idle", "walk-normal"];
    let boxes = ["take-up", "put-down", "carry-start-stop", "carry-pivot-90", "pass-box-stand", "sit-look"];
    let wanted = [people, boxes].concat();
    let takes = samples::generate(1).into_iter().filter(|t| wanted.contains(&t.file.name.as_str()));
    let motions = |take: &samples::Take| retarget::take(&take.clips).expect("samples are sound");
    takes.map(|t| Source { origin: "sample".into(), motions: motions(&t), take: t.file }).collect()
});

fuzz_target!(|text: &str| {
    let _ = compose(text, &SOURCES, &mut Vec::new());
});
