//! Writes small seeds for every fuzz target: `cargo run --release --example fuzz_seeds [folder]`.

#[path = "seeds/avatar.rs"]
mod avatar;
#[path = "seeds/fbx.rs"]
mod fbx;
#[path = "../tests/fixture/mod.rs"]
mod fixture;
#[path = "../tests/glb_file/mod.rs"]
#[allow(dead_code)]
mod glb_file;

use std::path::Path;

use crowdquilt::export::clip_glb;
use crowdquilt::geom::Polygon;
use crowdquilt::motion::{Clip, bvh, canonical};
use crowdquilt::samples;
use crowdquilt::tiling::{Keep, Options, Scene, Session, tile_in};
use crowdquilt::world::scenes;
use glam::{Quat, Vec2, Vec3};

/// Two joints, and two people of them who move.
const ASF: &str = ":version 1.10\n:units\n mass 1.0\n length 0.45\n angle deg\n:root\n order TX TY TZ RX RY RZ\n axis XYZ\n \
    position 0 0 0\n orientation 0 0 0\n:bonedata\n begin\n id 1\n name leg\n direction 0 -1 0\n length 7.5\n \
    axis 0 0 20 XYZ\n dof rx ry rz\n limits (-160.0 20.0)\n (-70.0 70.0)\n (-70.0 60.0)\n end\n begin\n id 2\n name foot\n \
    direction 0 0 1\n length 2\n axis -90 0 20 ZYX\n dof rx l\n end\n:hierarchy\n begin\n root leg\n leg foot\n end\n";
const AMC: &str = "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n1\nroot 1 17 -30 -2.5 -9.8 -3e0\nleg -28 -1 -20\nfoot 22 0\n2\n\
    root 1 16 -29 -2 -10 -2\nleg -27 -1 -21\nfoot 21 0.5\n";

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).unwrap_or_else(|| "fuzz/corpus".into());
    let write = |target: &str, name: &str, bytes: &[u8]| {
        let folder = Path::new(&folder).join(target);
        std::fs::create_dir_all(&folder)?;
        std::fs::write(folder.join(name), bytes)
    };
    let clip = clip();
    write("asf", "small.asf", ASF.as_bytes())?;
    write("amc", "small.amc", format!("{ASF}\n=====\n{AMC}").as_bytes())?;
    write("bvh", "small.bvh", bvh::write(&clip).as_bytes())?;
    let glb = clip_glb(&clip);
    write("gltf", "small.glb", &glb)?;
    write("gltf", "text.gltf", &text_of(&glb))?;
    write("gltf", "curves.gltf", include_bytes!("seeds/curves.gltf"))?;
    write("fbx", "small_text.fbx", fbx::text().as_bytes())?;
    write("fbx", "small_binary.fbx", &fbx::binary())?;
    write("crowd", "small.crowd", &fixture::lattice(1, 1).to_bytes())?;
    write("patches", "small.patches", &small_set().to_bytes())?;
    write("tiling", "small.tiling", &checkpoint()?)?;
    write("scene", "plaza.toml", include_bytes!("../examples/plaza.toml"))?;
    write("compose", "meet.toml", include_bytes!("../examples/compose/meet-and-bow.compose.toml"))?;
    write("compose", "rows.toml", include_bytes!("../examples/compose/rows-bow.compose.toml"))?;
    write("compose", "push.toml", include_bytes!("../examples/compose/push-and-stumble.compose.toml"))?;
    write("compose", "carry.toml", include_bytes!("../examples/compose/carry-and-pass.compose.toml"))?;
    write("compose", "rest.toml", include_bytes!("../examples/compose/put-and-take.compose.toml"))?;
    write("compose", "sit.toml", include_bytes!("../examples/compose/sit-on-box.compose.toml"))?;
    let street = scenes::city(2, true, 1).and_then(|plan| plan.bake("small", &plan.build()?));
    write("world", "small.world", &street.map_err(std::io::Error::other)?.to_bytes())?;
    write("geojson", "square.geojson", include_bytes!("../examples/worlds/square.geojson"))?;
    write("svg", "plan.svg", include_bytes!("../examples/worlds/plan.svg"))?;
    write("floor", "level.glb", include_bytes!("../examples/worlds/level.glb"))?;
    write("rig", "small.toml", b"hips = \"Root_M\"\nleft_up_leg = \"Hip_L\"\n")?;
    write("avatar", "small.glb", &avatar::character(&glb))?;
    for take in samples::generate(1).iter().take(3) {
        write("take", &format!("{}.json", take.file.name), &serde_json::to_vec(&take.file)?)?;
    }
    Ok(())
}

/// Two frames of the canonical skeleton.
fn clip() -> Clip {
    let skeleton = canonical().clone();
    let turns = |by: f32| skeleton.joints.iter().map(move |_| Quat::from_rotation_y(by));
    let rotations = turns(0.1).chain(turns(0.2)).collect();
    Clip { name: "small".into(), fps: 30.0, root: vec![Vec3::Y, Vec3::ONE], rotations, skeleton }
}

/// The JSON of a GLB.
fn text_of(glb: &[u8]) -> Vec<u8> {
    let length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    glb[20..20 + length].to_vec()
}

/// What is kept of two people tiled.
fn checkpoint() -> std::io::Result<Vec<u8>> {
    let path = std::env::temp_dir().join(format!("crowdquilt-seed-{}.tiling", std::process::id()));
    let scene = Scene { interaction: 0.0, ..Scene::new(Polygon::rectangle(Vec2::ZERO, Vec2::splat(6.0)), 3.0, 2) };
    let keep = Keep { path: &path, every_secs: 60.0, patches: Some("small") };
    let session = Session { keep: Some(keep), ..Session::default() };
    tile_in(session, &scene, &fixture::patch_set(), &Options::default(), &mut |_| true)
        .map_err(std::io::Error::other)?;
    let bytes = std::fs::read(&path)?;
    std::fs::remove_file(&path)?;
    Ok(bytes)
}

/// The kind that is shortest.
fn small_set() -> crowdquilt::patch::PatchSet {
    let mut set = fixture::patch_set();
    set.kinds.truncate(1);
    set
}
