//! Foot plants as detected on the generated sample captures, against what their generator knows.

use crowdquilt::motion::{Foot, Motion, joint, plants, take::TakeFile};
use crowdquilt::patch::{CutOptions, load_take};
use crowdquilt::samples;

/// The samples in a folder of their own, which goes when dropped.
struct Samples(std::path::PathBuf);

impl Drop for Samples {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Every person's motion with the true plants.
fn motions(name: &str) -> Vec<(String, Motion)> {
    let folder = Samples(std::env::temp_dir().join(format!("crowdquilt-plants-{}-{name}", std::process::id())));
    std::fs::create_dir_all(&folder.0).unwrap();
    let files = samples::write(&folder.0, 1).unwrap();
    let takes = files.iter().filter(|f| f.to_string_lossy().ends_with(".take.json"));
    let loaded = takes.flat_map(|file| {
        let take = TakeFile::load(file).unwrap();
        assert!(!take.plants.is_empty(), "{}", take.name);
        let people = load_take(file, &take, &CutOptions::default()).unwrap();
        people.into_iter().map(move |m| (take.name.clone(), m))
    });
    loaded.collect()
}

#[test]
fn detected_plants_are_the_true_ones_in_more_than_nine_frames_of_ten() {
    let (mut both, mut detected, mut truly) = (0, 0, 0);
    for (name, truth) in motions("truth") {
        let bare = Motion { plants: Vec::new(), ..truth.clone() };
        let found = Motion { plants: plants::detect(&bare, &plants::PlantOptions::default()), ..bare };
        let (mut hits, mut said, mut meant) = (0, 0, 0);
        for (frame, foot) in (0..truth.len()).flat_map(|f| [(f, Foot::Left), (f, Foot::Right)]) {
            let (is, says) = (plants::is_planted(&truth, foot, frame), plants::is_planted(&found, foot, frame));
            (hits, said, meant) = (hits + u32::from(is && says), said + u32::from(says), meant + u32::from(is));
        }
        // A hop's stance lasts ten frames: one more or less at its ends is a tenth.
        let least = if name.starts_with("hop") || name.starts_with("bump") { 17 } else { 18 };
        assert!(hits * 20 > said * least, "{name}: precision {hits} of {said}");
        assert!(hits * 20 > meant * least, "{name}: recall {hits} of {meant}");
        (both, detected, truly) = (both + hits, detected + said, truly + meant);
    }
    assert!(both > 10_000, "only {both} frames");
    assert!(both * 100 > detected * 95 && both * 100 > truly * 95, "{both} of {detected} found and {truly} true");
}

#[test]
fn importing_the_samples_leaves_planted_feet_where_they_are() {
    for (name, motion) in motions("stay") {
        for plant in &motion.plants {
            let ball = if plant.foot == Foot::Left { joint::LEFT_TOE } else { joint::RIGHT_TOE };
            let points = plants::trajectory(&motion, ball);
            let stay = &points[plant.begin as usize..=plant.end as usize];
            assert!(stay.iter().all(|p| p.distance(stay[0]) < 0.005), "{name}: {plant:?}");
        }
    }
}
