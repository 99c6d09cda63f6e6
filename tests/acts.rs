//! Acts composed of real captures by `examples/cmu/acts` (CMU's database; not part of the project): people who carry boxes,
//! sit, bow and hop, in a set found automatically.
//!
//! The folder is `../shared/mocap`, or what `CROWDQUILT_MOCAP` says. Without it these tests say so and pass.

mod mocap;

use std::path::Path;

use crowdquilt::check::check;
use crowdquilt::motion::contacts::palm;
use crowdquilt::motion::joint::{LEFT_HAND, RIGHT_HAND};
use crowdquilt::patch::connectivity::connectivity;
use crowdquilt::patch::{CutOptions, MakeOptions, PatchSet, make};
use crowdquilt::tiling::{Options, Scene, Status, tile};
use glam::Vec3;

/// The set of what is found in the captures and of the acts.
fn set(captures: &Path) -> PatchSet {
    let acts = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/cmu/acts");
    let cut = CutOptions { captures: Some(captures.to_owned()), ..CutOptions::default() };
    let made = make(&[captures.join("index.csv"), acts], &MakeOptions { cut, ..MakeOptions::default() }).unwrap();
    assert_eq!(made.left_out, [], "every kind leads on");
    made.set
}

#[test]
fn people_of_captures_carry_sit_bow_and_hop() {
    let Some(captures) = mocap::folder() else { return };
    let set = set(&captures);
    let acts = set.kinds.iter().filter(|k| k.labels.iter().any(|l| l == "carry" || l == "sit"));
    assert!(acts.clone().filter(|k| !k.mirrored).count() >= 16, "{}", acts.count());
    assert!(connectivity(&set).closed, "everybody can go on");

    // Whoever carries nothing begins and ends as people found in the captures do.
    for group in &set.groups {
        let name = group.name.trim_start_matches("carry_");
        assert!(["stand", "stand2", "walk_left", "walk_right", "hop_left", "hop_right"].contains(&name), "{name}");
    }
    for kind in &set.kinds {
        for prop in &kind.props {
            for hold in &prop.holds {
                let fragment = &kind.fragments[hold.role as usize];
                for clock in hold.begin..=hold.end {
                    let mut globals = Vec::new();
                    fragment.motion.globals((clock - fragment.begin) as usize, &mut globals);
                    let palms = [LEFT_HAND, RIGHT_HAND].map(|hand| palm(&globals, hand));
                    let place = prop.between(palms[0], palms[1]);
                    for (palm, side) in palms.into_iter().zip([1.0, -1.0]) {
                        let face = Vec3::new(side * (0.5 * prop.size[0] + 0.012), -prop.grip[0], -prop.grip[1]);
                        let off = place.seen_from(palm).distance(face);
                        assert!(off < 0.02, "{} frame {clock}: a palm is {off} m off", kind.name);
                    }
                }
            }
        }
    }

    for (scene, label, least) in [("boxes", "carry", 100), ("keyframing", "staged", 3), ("hopping", "bump", 2)] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("examples/scenes/{scene}.toml"));
        let outcome = tile(&Scene::load(&path).unwrap(), &set, &Options::default(), &mut |_| true).unwrap();
        assert_eq!(outcome.status, Status::Perfect, "{scene}");
        let report = check(&outcome.crowd);
        assert!(report.ok(), "{scene}\n{report}");
        let kinds = outcome.crowd.instances.iter().map(|i| &outcome.crowd.set.kinds[i.kind as usize]);
        assert!(kinds.filter(|k| k.labels.iter().any(|l| l == label)).count() >= least, "{scene}");
    }
}
