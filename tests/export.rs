//! What is exported says what the crowd says: joints, times, presence. Other people's readers are asked in
//! `tests/clients`.

mod fixture;
mod glb_file;

use crowdquilt::export::{clip, glb, look};
use crowdquilt::motion::{Build, FPS, JOINT_COUNT};
use crowdquilt::stage::Crowd;
use glam::{Quat, Vec3};
use glb_file::Glb;
use serde_json::Value;

/// The fixture, with a person who comes late and one who leaves early.
fn crowd() -> Crowd {
    let mut crowd = fixture::crowd();
    let late = &mut crowd.characters[fixture::WALKER];
    late.begin = 20;
    late.root.drain(..20);
    late.rotations.drain(..20 * JOINT_COUNT);
    let early = &mut crowd.characters[fixture::SHAKER];
    early.root.truncate(80);
    early.rotations.truncate(80 * JOINT_COUNT);
    for (character, build) in crowd.characters.iter_mut().zip(Build::catalogue().iter().skip(1)) {
        character.build = build[0].clone();
    }
    crowd
}

fn sample(times: &[f32], at: f32) -> (usize, usize, f32) {
    let after = times.partition_point(|&t| t <= at).clamp(1, times.len().max(2) - 1).min(times.len() - 1);
    let before = after.saturating_sub(1);
    let t = if after == before { 0.0 } else { ((at - times[before]) / (times[after] - times[before])).clamp(0.0, 1.0) };
    (before, after, t)
}

#[test]
fn joints_are_where_the_crowd_has_them() {
    let crowd = crowd();
    let glb = Glb::open(&glb(&crowd));
    let (mut expected, mut found) = (Vec::new(), Vec::new());
    for (p, person) in crowd.characters.iter().enumerate() {
        let skeleton = person.skeleton();
        for frame in [person.begin, person.begin + 17, person.end()] {
            let secs = frame as f32 / FPS;
            let (times, values, _) = glb.channel(&format!("person_{p}_hips"), "translation").unwrap();
            let (i, j, t) = sample(&times, secs);
            let root = Vec3::from_slice(&values[i * 3..]).lerp(Vec3::from_slice(&values[j * 3..]), t);
            let pose: Vec<Quat> = skeleton
                .joints
                .iter()
                .map(|joint| {
                    let (times, values, _) = glb.channel(&format!("person_{p}_{}", joint.name), "rotation").unwrap();
                    let (i, j, t) = sample(&times, secs);
                    Quat::from_slice(&values[i * 4..])
                        .normalize()
                        .slerp(Quat::from_slice(&values[j * 4..]).normalize(), t)
                })
                .collect();
            skeleton.globals(root, &pose, &mut found);
            person.globals((frame - person.begin) as usize, &mut expected);
            for ((e, f), joint) in expected.iter().zip(&found).zip(&skeleton.joints) {
                assert!(e.0.distance(f.0) < 5e-4, "person {p}, frame {frame}, {}: {} against {}", joint.name, f.0, e.0);
            }
        }
    }
}

#[test]
fn neighbouring_rotations_take_the_short_way() {
    let glb = Glb::open(&glb(&crowd()));
    for joint in &crowdquilt::motion::canonical().joints {
        let (_, values, _) = glb.channel(&format!("person_1_{}", joint.name), "rotation").unwrap();
        let keys: Vec<Quat> = values.chunks_exact(4).map(Quat::from_slice).collect();
        assert!(keys.windows(2).all(|w| w[0].dot(w[1]) > 0.0), "{}", joint.name);
    }
}

#[test]
fn absent_people_are_scaled_away() {
    let glb = Glb::open(&glb(&crowd()));
    let (times, scales, how) = glb.channel("person_0", "scale").unwrap();
    assert_eq!(how, "STEP");
    assert_eq!(times, [0.0, 20.0 / FPS]);
    assert_eq!(scales, [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let (times, scales, _) = glb.channel("person_2", "scale").unwrap();
    assert_eq!(times, [0.0, 80.0 / FPS]);
    assert_eq!(scales[..3], [1.0; 3]);
    assert_eq!(scales[3..], [0.0; 3]);
    assert!(glb.channel("person_1", "scale").is_none(), "always there");
    let extras = &glb.json["nodes"][glb.node("person_0")]["extras"];
    assert_eq!(extras["person"], 0);
    assert!((extras["begin_secs"].as_f64().unwrap() - 20.0 / 30.0).abs() < 1e-6);
    assert!((extras["end_secs"].as_f64().unwrap() - 119.0 / 30.0).abs() < 1e-6);
}

#[test]
fn people_share_vertices_by_build_and_not_their_looks() {
    let mut crowd = crowd();
    crowd.characters.iter_mut().for_each(|c| c.build = Build::canonical());
    let tall = Build::catalogue()[1][0].clone();
    crowd.characters[1].build = tall.clone();
    crowd.characters[3].build = tall;
    let glb = Glb::open(&glb(&crowd));
    let meshes = glb.json["meshes"].as_array().unwrap();
    let mesh_of =
        |p: usize| &meshes[glb.json["nodes"][glb.node(&format!("person_{p}_body"))]["mesh"].as_u64().unwrap() as usize];
    let attributes = |p: usize| mesh_of(p)["primitives"][0]["attributes"].clone();
    assert_eq!(attributes(0), attributes(2));
    assert_eq!(attributes(1), attributes(3));
    assert_ne!(attributes(0)["POSITION"], attributes(1)["POSITION"]);
    assert_eq!(attributes(0)["WEIGHTS_0"], attributes(1)["WEIGHTS_0"]);
    let materials = |p: usize| -> Vec<Value> {
        mesh_of(p)["primitives"].as_array().unwrap().iter().map(|p| p["material"].clone()).collect()
    };
    assert_ne!(materials(0), materials(1));
    assert_ne!(look(0), look(1));
    assert_eq!(
        glb.json["scenes"][0]["nodes"].as_array().unwrap().len(),
        9,
        "a joint root and a mesh for each of four, and an obstacle"
    );
    let knee = &glb.json["nodes"][glb.node("person_1_left_leg")]["translation"][1];
    assert!((knee.as_f64().unwrap() + 0.42 * 1.085).abs() < 1e-4, "{knee}");
}

#[test]
fn the_same_crowd_makes_the_same_bytes_and_an_empty_one_is_a_file_too() {
    let mut crowd = crowd();
    assert_eq!(glb(&crowd), glb(&crowd));
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/fixture.glb"), glb(&crowd)).unwrap();
    crowd.save(concat!(env!("CARGO_TARGET_TMPDIR"), "/fixture.crowd").as_ref()).unwrap();
    crowd.characters.clear();
    let empty = glb(&crowd);
    let json: Value = serde_json::from_slice(&empty[20..]).unwrap();
    assert!(json.get("meshes").is_none() && json["asset"]["version"] == "2.0");
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/empty.glb"), empty).unwrap();
}

#[test]
fn a_clip_is_the_persons_motion() {
    let crowd = crowd();
    let clip = clip(&crowd, fixture::SHAKER).unwrap();
    assert_eq!((clip.frames(), clip.fps), (80, FPS));
    let (mut a, mut b) = (Vec::new(), Vec::new());
    clip.globals(40, &mut a);
    crowd.characters[fixture::SHAKER].globals(40, &mut b);
    assert_eq!(a, b);
    let error = crowdquilt::export::clip(&crowd, 9).unwrap_err().to_string();
    assert!(error.contains("character 9") && error.contains("0..4"), "{error}");
}

#[test]
fn a_crowd_of_seventy_stays_small() {
    let crowd = fixture::lattice(70, 600);
    let begin = std::time::Instant::now();
    let bytes = glb(&crowd);
    println!("70 people, 601 frames: {:.1} MB in {:?}", bytes.len() as f64 / 1e6, begin.elapsed());
    // 16-bit rotations of 22 joints and a position for every person and frame, and little else.
    assert!(bytes.len() < 70 * 601 * (22 * 8 + 12) + 1_500_000, "{}", bytes.len());
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/seventy.glb"), bytes).unwrap();
}

#[test]
fn a_bvh_file_read_back_has_the_joints_where_the_crowd_has_them() {
    let crowd = crowd();
    let text = crowdquilt::export::bvh(&crowd, fixture::SHAKER).unwrap();
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/person_2.bvh"), &text).unwrap();
    let read = crowdquilt::motion::bvh::read(text.as_bytes()).unwrap();
    let person = &crowd.characters[fixture::SHAKER];
    assert_eq!(read.frames(), person.frames());
    assert!((read.fps - FPS).abs() < 1e-3);
    let (mut found, mut expected) = (Vec::new(), Vec::new());
    for frame in [0, 33, 79] {
        read.globals(frame, &mut found);
        person.globals(frame, &mut expected);
        for (joint, e) in crowdquilt::motion::canonical().joints.iter().zip(&expected) {
            let f = found[read.skeleton.find(&joint.name).unwrap()].0;
            assert!(e.0.distance(f) < 1e-3, "frame {frame}, {}: {f} against {}", joint.name, e.0);
        }
    }
    assert!(crowdquilt::export::bvh(&crowd, 9).is_err());
}

/// The crowd file with its header changed.
fn with_header(bytes: &[u8], change: impl FnOnce(&mut Value)) -> Vec<u8> {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let mut header: Value = serde_json::from_slice(&bytes[24..24 + length]).unwrap();
    change(&mut header);
    let mut json = serde_json::to_vec(&header).unwrap();
    json.resize(json.len().next_multiple_of(8), b' ');
    let mut out = bytes[..24].to_vec();
    out[12..16].copy_from_slice(&(json.len() as u32).to_le_bytes());
    out.extend_from_slice(&json);
    out.extend_from_slice(&bytes[24 + length..]);
    out
}

#[test]
fn builds_are_kept_in_the_crowd_file_and_files_without_them_are_of_canonical_people() {
    let mut crowd = crowd();
    for (character, build) in crowd.characters.iter_mut().zip(Build::catalogue()) {
        character.build = build[0].clone();
    }
    let bytes = crowd.to_bytes();
    let read = Crowd::from_bytes(&bytes).unwrap();
    assert_eq!(read.builds().0.len(), 4);
    assert!(read.characters.iter().zip(&crowd.characters).all(|(a, b)| a.build == b.build));
    let old = with_header(&bytes, |h| {
        h.as_object_mut().unwrap().remove("builds");
        h["characters"]
            .as_array_mut()
            .unwrap()
            .iter_mut()
            .for_each(|c| drop(c.as_object_mut().unwrap().remove("build")));
    });
    assert!(Crowd::from_bytes(&old).unwrap().characters.iter().all(|c| c.build == Build::canonical()));
    let told = |change: &dyn Fn(&mut Value)| Crowd::from_bytes(&with_header(&bytes, change)).unwrap_err().to_string();
    let missing = told(&|h| h["characters"][1]["build"] = 9.into());
    assert!(missing.contains("character 1") && missing.contains("below 4, found 9"), "{missing}");
    let bent = told(&|h| h["builds"][2]["offsets"][2][1] = (-9.0).into());
    assert!(bent.contains("left_leg") && bent.contains("slight"), "{bent}");
}

#[test]
fn obstacles_are_where_they_are() {
    use crowdquilt::geom::{Obstacle, Polygon, Waypoint};
    use glam::Vec2;
    let mut crowd = crowd();
    let at = |secs: f32, x: f32, heading: f32| Waypoint { secs, position: Vec2::new(x, 1.0), heading };
    let outline = Polygon::rectangle(Vec2::new(-0.5, -0.2), Vec2::new(0.5, 0.2));
    let path = vec![at(0.5, -2.0, 0.0), at(2.0, 3.0, 1.5)];
    crowd.domain.obstacles.push(Obstacle { outline, height: Some(0.25), path });
    let cart = &crowd.domain.obstacles[1];
    let glb = Glb::open(&glb(&crowd));
    let (times, places, _) = glb.channel("obstacle_1", "translation").unwrap();
    let (_, turns, _) = glb.channel("obstacle_1", "rotation").unwrap();
    for secs in [0.0, 0.9, 1.4, 1.9] {
        let (i, j, t) = sample(&times, secs);
        let place = Vec3::from_slice(&places[i * 3..]).lerp(Vec3::from_slice(&places[j * 3..]), t);
        let turn =
            Quat::from_slice(&turns[i * 4..]).normalize().slerp(Quat::from_slice(&turns[j * 4..]).normalize(), t);
        let expected = cart.place(secs);
        assert!(place.distance(Vec3::new(expected.position.x, 0.0, expected.position.y)) < 1e-3, "{secs}: {place}");
        assert!(turn.angle_between(expected.rotation()) < 1e-3, "{secs}: {turn}");
    }
    // One that stands has its two keys at most.
    assert!(glb.channel("obstacle_0", "translation").is_none_or(|(times, ..)| times.len() <= 2));
}
