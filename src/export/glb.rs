//! A crowd as one binary glTF file.
//!
//! Every person is one skin and one skinned mesh. The person's top node `person_N`, at the root of the scene, is the
//! parent of the joints and carries `extras: { person, begin_secs, end_secs, build }`; while the person is absent its
//! scale is keyed to 0, which hides the mesh, since a skinned mesh follows its joints alone. The mesh node
//! `person_N_body` is at the root of the scene too, as viewers want it. Vertices and inverse bind matrices are shared by
//! people of one build, triangles and key times by all. Boxes are nodes `box_N` at the root of the scene, with
//! `extras: { box, size }`, hidden in the same way while they are not there; obstacles are nodes `obstacle_N` with
//! `extras: { obstacle, height }`.

use gltf_json::{Asset, Index, Root, Scene};

use super::actor::{Keys, Writer};
use super::avatar::{Avatar, Graft};
use super::body::{Number, Wardrobe};
use super::boxes;
use super::buffer::assemble;
use super::look::dealt;
use super::obstacles;
use crate::motion::JOINT_COUNT;
use crate::stage::{Character, Crowd};

/// The crowd as the bytes of a `.glb` file: all people with a final motion, one animation, keys at 30 frames a second.
pub fn glb(crowd: &Crowd) -> Vec<u8> {
    glb_with(crowd, &[])
}

/// As [`glb`], with `avatars` dealt out in place of the mannequin; without any it is the mannequin.
///
/// Every avatar is scaled so that its legs are as long as those of the person it plays, and posed so that its bones
/// point where theirs do and its feet stand where theirs stand.
pub fn glb_with(crowd: &Crowd, avatars: &[Avatar]) -> Vec<u8> {
    let people: Vec<(usize, &Character)> =
        crowd.characters.iter().enumerate().filter(|(_, c)| c.frames() > 0).collect();
    let mut root = Root { asset: asset(), ..Default::default() };
    if people.is_empty() {
        return nobody(root);
    }
    let mut binary = Vec::new();
    if avatars.is_empty() {
        mannequins(crowd, &people, root, binary)
    } else {
        let grafts: Vec<Graft> = avatars.iter().map(|a| a.graft(&mut root, &mut binary)).collect();
        let meshes = boxes::meshes(&mut root, &mut binary, crowd);
        let blocks = obstacles::meshes(&mut root, &mut binary, crowd);
        let mut writer = Writer::new(root, crowd.domain.last_frame);
        for (person, character) in people {
            let number = dealt(person, AVATAR_SALT, avatars.len());
            let (bones, keys) = avatars[number].play(character, &grafts[number]);
            writer.person(person, character, &bones, &grafts[number].dresses, &keys);
        }
        boxes::write(&mut writer, crowd, &meshes);
        obstacles::write(&mut writer, crowd, &blocks);
        writer.finish(binary)
    }
}

/// Who plays whom is dealt like clothes; see [`super::look`].
const AVATAR_SALT: u32 = 20;

fn mannequins(crowd: &Crowd, people: &[(usize, &Character)], mut root: Root, mut binary: Vec<u8>) -> Vec<u8> {
    let (builds, own) = crowd.builds();
    let number = |&(person, c): &(usize, &Character)| Number { person, build: own[person], team: c.team };
    let numbers: Vec<Number> = people.iter().map(number).collect();
    let wardrobe = Wardrobe::new(&mut root, &mut binary, &builds, &numbers);
    let meshes = boxes::meshes(&mut root, &mut binary, crowd);
    let blocks = obstacles::meshes(&mut root, &mut binary, crowd);
    let mut writer = Writer::new(root, crowd.domain.last_frame);
    for (&(person, character), number) in people.iter().zip(&numbers) {
        let (bones, dress) = (wardrobe.bones(number.build), wardrobe.dress(number));
        writer.person(person, character, bones, &[dress], &keys(character));
    }
    boxes::write(&mut writer, crowd, &meshes);
    obstacles::write(&mut writer, crowd, &blocks);
    writer.finish(binary)
}

/// The person's motion as it is: on the canonical joints.
fn keys(character: &Character) -> Keys {
    let track = |j: usize| (0..character.frames()).map(|i| character.pose(i)[j]).collect();
    Keys { root: 0, places: character.root.clone(), turns: (0..JOINT_COUNT).map(|j| (j, track(j))).collect() }
}

fn asset() -> Asset {
    Asset { generator: Some(concat!("Crowdquilt ", env!("CARGO_PKG_VERSION")).into()), ..Default::default() }
}

/// A file with an empty scene.
fn nobody(mut root: Root) -> Vec<u8> {
    root.push(Scene { nodes: Vec::new(), name: Some("crowd".into()), extensions: None, extras: Default::default() });
    root.scene = Some(Index::new(0));
    assemble(&root, Vec::new())
}
