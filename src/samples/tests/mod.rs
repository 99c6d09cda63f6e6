//! What the samples promise, measured on the finished takes.

mod annotation;
mod bodies;
mod contacts;
mod hops;
mod jumps;

use std::sync::LazyLock;

use glam::{Quat, Vec3};

use super::*;

/// Global joint transforms by frame.
type Globals = Vec<Vec<(Vec3, Quat)>>;

const SEED: u64 = 1;

/// The takes of one seed, and everybody's joints.
static TAKES: LazyLock<Vec<(Take, Vec<Globals>)>> = LazyLock::new(|| {
    let globals = |clip: &Clip| {
        let mut out = Vec::new();
        (0..clip.frames())
            .map(|f| {
                clip.globals(f, &mut out);
                out.clone()
            })
            .collect()
    };
    generate(SEED).into_iter().map(|take| (take.clone(), take.clips.iter().map(globals).collect())).collect()
});

fn frame(seconds: f32) -> usize {
    (seconds * 60.0).round() as usize
}

#[test]
fn the_same_seed_writes_the_same_bytes() {
    assert!(generate(7) == generate(7));
    assert!(generate(7)[0].clips != generate(8)[0].clips);
    let take = &generate(7)[0];
    assert_eq!(bvh::write(&take.clips[0]), bvh::write(&generate(7)[0].clips[0]));
}

#[test]
fn written_files_are_what_the_take_names() {
    let dir = std::env::temp_dir().join(format!("crowdquilt-samples-{}", std::process::id()));
    let files = write(&dir, 1).unwrap();
    for file in files.iter().filter(|f| f.extension().is_some_and(|e| e == "json")) {
        let take: TakeFile = serde_json::from_slice(&std::fs::read(file).unwrap()).unwrap();
        for person in &take.people {
            let text = std::fs::read_to_string(dir.join(&person.file)).unwrap();
            assert!(text.starts_with("HIERARCHY\nROOT hips\n"));
            let frames: usize = text.lines().find_map(|l| l.strip_prefix("Frames: ")).unwrap().parse().unwrap();
            assert_eq!(text.lines().skip_while(|l| !l.starts_with("Frame Time")).count() - 1, frames);
        }
    }
    std::fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn positions_survive_writing_and_reading_to_a_tenth_of_a_millimetre() {
    for (take, globals) in TAKES.iter().filter(|(t, _)| ["sit", "stretch", "hug-stand"].contains(&t.file.name.as_str()))
    {
        for (clip, joints) in take.clips.iter().zip(globals) {
            let read = bvh::read(bvh::write(clip).as_bytes()).unwrap();
            assert_eq!(read.frames(), clip.frames());
            let mut out = Vec::new();
            for (f, want) in joints.iter().enumerate() {
                read.globals(f, &mut out);
                let far = out.iter().zip(want).map(|(a, b)| (a.0 - b.0).length()).fold(0.0, f32::max);
                assert!(far < 1e-4, "{} frame {f}: {far}", clip.name);
            }
        }
    }
}
