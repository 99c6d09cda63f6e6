//! Somebody's own character plays the people of a crowd: our mannequin, disguised as a character from elsewhere.

mod disguise;
mod fixture;
mod glb_file;

use crowdquilt::export::glb_with;
use crowdquilt::motion::{Build, FPS, joint};
use crowdquilt::stage::{Character, Crowd};
use disguise::{CENTIMETRES, Disguise, MIXAMO, avatar, character};
use glam::{Affine3A, Quat, Vec3};
use glb_file::Glb;

/// Places of a person's joints in the exported file at a frame, by Mixamo's names.
fn joints(file: &Glb, person: usize, frame: u32) -> Vec<Vec3> {
    let nodes = file.json["nodes"].as_array().unwrap();
    let mut parent = vec![None; nodes.len()];
    for (n, node) in nodes.iter().enumerate() {
        node["children"].as_array().into_iter().flatten().for_each(|c| parent[c.as_u64().unwrap() as usize] = Some(n));
    }
    let local = |n: usize| {
        let name = nodes[n]["name"].as_str().unwrap();
        let key = |path: &str, width: usize| -> Option<Vec<f32>> {
            let (times, values, _) = file.channel(name, path)?;
            let after = times.partition_point(|&t| t < frame as f32 / FPS - 1e-4).min(times.len() - 1);
            Some(values[after * width..(after + 1) * width].to_vec())
        };
        let fixed = |path: &str| -> Option<Vec<f32>> {
            Some(nodes[n][path].as_array()?.iter().map(|v| v.as_f64().unwrap() as f32).collect())
        };
        let place = key("translation", 3).or_else(|| fixed("translation")).map_or(Vec3::ZERO, |v| Vec3::from_slice(&v));
        let turn = key("rotation", 4).or_else(|| fixed("rotation")).map_or(Quat::IDENTITY, |v| Quat::from_slice(&v));
        let scale = fixed("scale").map_or(Vec3::ONE, |v| Vec3::from_slice(&v));
        Affine3A::from_scale_rotation_translation(scale, turn.normalize(), place)
    };
    MIXAMO
        .iter()
        .map(|name| {
            let mut n = file.node(&format!("person_{person}_mixamorig:{name}"));
            let mut frame = local(n);
            while let Some(p) = parent[n] {
                frame = local(p) * frame;
                n = p;
            }
            frame.translation.into()
        })
        .collect()
}

fn person(character: &Character, frame: u32) -> Vec<Vec3> {
    let mut globals = Vec::new();
    character.globals((frame - character.begin) as usize, &mut globals);
    globals.into_iter().map(|g| g.0).collect()
}

/// Bones by their two joints.
const BONES: [[usize; 2]; 10] = [
    [joint::LEFT_UP_LEG, joint::LEFT_LEG],
    [joint::LEFT_LEG, joint::LEFT_FOOT],
    [joint::RIGHT_UP_LEG, joint::RIGHT_LEG],
    [joint::RIGHT_LEG, joint::RIGHT_FOOT],
    [joint::SPINE, joint::NECK],
    [joint::NECK, joint::HEAD],
    [joint::LEFT_ARM, joint::LEFT_FORE_ARM],
    [joint::LEFT_FORE_ARM, joint::LEFT_HAND],
    [joint::RIGHT_ARM, joint::RIGHT_FORE_ARM],
    [joint::RIGHT_FORE_ARM, joint::RIGHT_HAND],
];

fn crowd() -> Crowd {
    let mut crowd = fixture::crowd();
    crowd.characters[1].build = Build::catalogue()[1][0].clone();
    crowd
}

#[test]
fn bones_point_where_the_persons_do_and_feet_stand_where_theirs_do() {
    let crowd = crowd();
    let z_up = Quat::from_rotation_x(-std::f32::consts::FRAC_PI_2);
    for disguise in [
        CENTIMETRES,
        Disguise { size: 0.6, arms: 0.0, twist: 0.0, armature: (1.0, Quat::IDENTITY) },
        Disguise { size: 1.3, arms: 1.3, twist: -0.7, armature: (1.0, z_up) },
    ] {
        let file = Glb::open(&glb_with(&crowd, &[avatar(&disguise)]));
        for (p, character) in crowd.characters.iter().enumerate() {
            for frame in [character.begin, character.begin + 40, character.end()] {
                let (is, wanted) = (joints(&file, p, frame), person(character, frame));
                for [a, b] in BONES {
                    let angle = (is[b] - is[a]).angle_between(wanted[b] - wanted[a]).to_degrees();
                    assert!(
                        angle < 2.0,
                        "size {}, person {p}, frame {frame}, bone {a}: {angle} degrees",
                        disguise.size
                    );
                }
                for foot in [joint::LEFT_FOOT, joint::RIGHT_FOOT] {
                    let off = is[foot].distance(wanted[foot]);
                    assert!(off < 0.01, "size {}, person {p}, frame {frame}, joint {foot}: {off} m", disguise.size);
                }
                if character.build == Build::canonical() {
                    let off = is.iter().zip(&wanted).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
                    assert!(off < 0.01, "size {}, person {p}, frame {frame}: {off} m", disguise.size);
                }
            }
        }
    }
}

#[test]
fn meshes_are_shared_and_characters_are_dealt_out() {
    let crowd = fixture::lattice(12, 30);
    let own = [avatar(&CENTIMETRES), avatar(&Disguise { size: 1.0, arms: 0.4, ..CENTIMETRES })];
    let bytes = glb_with(&crowd, &own);
    std::fs::write(concat!(env!("CARGO_TARGET_TMPDIR"), "/avatars.glb"), &bytes).unwrap();
    let file = Glb::open(&bytes);
    assert_eq!(file.json["meshes"].as_array().unwrap().len(), 2);
    assert_eq!(file.json["skins"].as_array().unwrap().len(), 12);
    let mesh = |p: usize| file.json["nodes"][file.node(&format!("person_{p}_body"))]["mesh"].as_u64().unwrap();
    assert_eq!((0..12).filter(|&p| mesh(p) == 0).count(), 6);
    let (json, binary) = character(&CENTIMETRES);
    let (one, rest) = (glb_file::write(&json, &binary).len(), 12 * 31 * (22 * 8 + 12));
    assert!(bytes.len() < 2 * one + rest + 12 * 20_000, "{} bytes", bytes.len());
    assert_eq!(bytes, glb_with(&crowd, &own));
}
