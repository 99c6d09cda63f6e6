//! The C interface: what it says is what the stage says, mistakes are messages, and a C compiler agrees with the header.

use std::ffi::{CStr, CString};
use std::mem::{offset_of, size_of};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::ptr;

use crowdquilt::patch::PatchSet;
use crowdquilt::stage::World;
use crowdquilt::world::{Layout, Plan, WorldScene, gait_table, scenes, with_gait};
use crowdquilt_capi::people::{CqPerson, CqQuat};
use crowdquilt_capi::*;
use glam::DVec2;

fn world() -> World {
    let plan = Plan { versions: 2, ..scenes::city(8, true, 1).unwrap() };
    WorldScene { name: "test".into(), layout: Layout::Map(plan) }.build(&|_, _| true).unwrap().world
}

fn open(bytes: &[u8]) -> *mut CqWorld {
    // SAFETY: a slice's own pointer and length.
    unsafe { cq_world_from_memory(bytes.as_ptr(), bytes.len()) }
}

fn message() -> String {
    // SAFETY: always a text.
    unsafe { CStr::from_ptr(cq_last_error()) }.to_str().unwrap().to_owned()
}

fn people(world: *const CqWorld, secs: f64, at: DVec2, radius: f64) -> Vec<CqPerson> {
    let mut out = vec![CqPerson::default(); 4000];
    // SAFETY: as much room as is said.
    let count = unsafe { cq_world_people(world, secs, at.x, at.y, radius, out.as_mut_ptr(), out.len()) };
    assert!(count >= 0, "{}", message());
    out.truncate(count as usize);
    out
}

#[test]
fn people_are_those_of_the_stage_in_any_copy_and_keep_their_id() {
    let world = world();
    let opened = open(&world.to_bytes());
    for (secs, at) in [(3.3, DVec2::new(30.0, 30.0)), (3603.3, DVec2::new(64.0 * 9.0 + 30.0, 30.0))] {
        let found = people(opened, secs, at, 12.0);
        let moment = world.moment(secs);
        let copy = [((at.x - 30.0) / 64.0).round() as i64, 0];
        let shift = DVec2::new(64.0 * copy[0] as f64, 0.0);
        let mut roots = crowdquilt::stage::world::Roots::default();
        world.roots(&moment, DVec2::ZERO, &mut roots);
        let all = world.order().flat_map(|i| world.people_of(i, copy, &moment));
        let near = all
            .enumerate()
            .filter(|(i, _)| (DVec2::new(roots.x()[*i].into(), roots.z()[*i].into()) + shift).distance(at) < 12.0);
        let mut expected: Vec<u64> = near.map(|(_, person)| person.hash(0)).collect();
        let mut ids: Vec<u64> = found.iter().filter(|p| p.activity < 0).map(|p| p.id).collect();
        expected.sort_unstable();
        ids.sort_unstable();
        assert!(ids.len() > 20);
        assert_eq!(ids, expected);
        // Soon after, most of them are still there, and have not jumped.
        let later = people(opened, secs + 0.01, at, 12.0);
        let same = found.iter().filter_map(|a| Some((a, later.iter().find(|b| b.id == a.id)?)));
        let steps: Vec<f64> = same.map(|(a, b)| (a.x - b.x).hypot(a.z - b.z)).collect();
        assert!(steps.len() * 10 > found.len() * 9 && steps.iter().all(|&step| step < 0.03));
    }
    // SAFETY: opened above, used no more.
    unsafe { cq_world_free(opened) };
}

#[test]
fn bodies_stand_on_the_ground_where_people_are() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("gait");
    std::fs::create_dir_all(&folder).unwrap();
    crowdquilt::samples::write(&folder, 1).unwrap();
    let table = gait_table(&PatchSet::from_folder(&folder).unwrap()).unwrap();
    let opened = open(&with_gait(&world(), table).unwrap().to_bytes());
    let walking = |p: &&CqPerson| p.activity < 0;
    let count = cq_joint_count();
    for person in people(opened, 7.7, DVec2::new(30.0, 30.0), 10.0).iter().filter(walking) {
        let (mut hips, mut turns, mut joints) =
            ([0.0_f32; 3], vec![CqQuat::default(); count], vec![0.0_f32; 3 * count]);
        // SAFETY: as much room as the header says.
        unsafe {
            assert_eq!(cq_world_has_bodies(opened), 1);
            assert_eq!(cq_world_pose(opened, 7.7, person, hips.as_mut_ptr(), turns.as_mut_ptr()), 0, "{}", message());
            assert_eq!(cq_world_joints(opened, 7.7, person, joints.as_mut_ptr()), 0);
        }
        assert!(turns.iter().all(|q| (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0).abs() < 1e-3));
        assert_eq!(hips, joints[..3]);
        assert!((0.7..1.2).contains(&hips[1]) && hips[0].hypot(hips[2]) < 0.4, "{hips:?}");
        let heights = || joints.chunks_exact(3).map(|p| p[1]);
        assert!((-0.05..0.2).contains(&heights().fold(f32::MAX, f32::min)));
        assert!((1.3..2.0).contains(&heights().fold(f32::MIN, f32::max)));
    }
    let parents: Vec<i32> = (0..count).map(|joint| cq_joint_parent(joint)).collect();
    assert!(parents[0] == -1 && parents.iter().enumerate().skip(1).all(|(i, &p)| p >= 0 && (p as usize) < i));
    // SAFETY: opened above, used no more.
    unsafe { cq_world_free(opened) };
}

#[test]
fn threads_may_read_at_once() {
    let opened = open(&world().to_bytes()) as usize;
    let read = move |secs: f64| people(opened as *const CqWorld, secs, DVec2::new(20.0, 20.0), 15.0);
    let expected: Vec<_> = (0..8).map(|i| read(f64::from(i))).collect();
    let threads: Vec<_> = (0..8).map(|i| std::thread::spawn(move || read(f64::from(i)))).collect();
    let found: Vec<_> = threads.into_iter().map(|t| t.join().unwrap()).collect();
    assert_eq!(found, expected);
    // SAFETY: opened above, used no more.
    unsafe { cq_world_free(opened as *mut CqWorld) };
}

#[test]
fn mistakes_are_messages() {
    let bytes = world().to_bytes();
    let path = CString::new("no/such.world").unwrap();
    // SAFETY: pointers are NULL or valid.
    unsafe {
        assert!(cq_world_open(path.as_ptr()).is_null() && message().contains("no/such.world"));
        assert!(cq_world_open(ptr::null()).is_null() && message().contains("NULL"));
        assert!(open(&bytes[..bytes.len() - 1]).is_null() && message().contains("bytes in all"));
        assert_eq!(cq_world_period(ptr::null()), 0.0);
        assert_eq!(cq_world_bounds(ptr::null(), ptr::null_mut()), -1);
        cq_world_free(ptr::null_mut());
        let world = open(&bytes);
        assert_eq!(cq_world_people(world, f64::NAN, 0.0, 0.0, 5.0, ptr::null_mut(), 0), -1);
        assert!(message().contains("time"), "{}", message());
        assert_eq!(cq_world_people(world, 0.0, f64::INFINITY, 0.0, 5.0, ptr::null_mut(), 0), -1);
        assert_eq!(cq_world_people(world, 0.0, 0.0, 0.0, 5.0, ptr::null_mut(), 5), -1);
        let count = cq_world_people(world, 0.0, 20.0, 20.0, 15.0, ptr::null_mut(), 0);
        let mut one = [CqPerson::default(); 2];
        assert_eq!(cq_world_people(world, 0.0, 20.0, 20.0, 15.0, one.as_mut_ptr(), 1), count);
        assert!(count > 1 && one[0].id != 0 && one[1] == CqPerson::default());
        assert_eq!(cq_world_joints(world, 0.0, &one[0], ptr::null_mut()), -1);
        assert!(message().contains("without"), "{}", message());
        assert!(cq_world_activity(world, -1).is_null() && cq_world_activity(world, 999).is_null());
        cq_world_free(world);
    }
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// Names of functions in a text: what stands before a bracket and begins with `cq_`.
fn functions(text: &str, mark: &str) -> Vec<String> {
    let mut found: Vec<String> = text
        .lines()
        .filter(|line| line.contains(mark))
        .filter_map(|line| {
            let before = &line[..line.find('(')?];
            let name = before.rsplit(|c: char| !(c.is_alphanumeric() || c == '_')).next()?;
            name.starts_with("cq_").then(|| name.to_owned())
        })
        .collect();
    found.sort_unstable();
    found
}

#[test]
fn the_header_declares_what_is_exported() {
    let header = std::fs::read_to_string(root().join("include/crowdquilt.h")).unwrap();
    let header: String = header.split("/*").map(|part| part.rsplit("*/").next().unwrap_or_default()).collect();
    let source = std::fs::read_to_string(root().join("src/lib.rs")).unwrap();
    assert_eq!(functions(&header, "("), functions(&source, "extern \"C\" fn"));
    assert_eq!(functions(&header, "(").len(), source.matches("no_mangle").count());
}

/// What the C compiler says, or nothing if there is none.
fn cc(arguments: &[&std::ffi::OsStr]) -> Option<std::process::Output> {
    let found = Command::new("cc").args(["-std=c11", "-Wall", "-Wextra", "-Werror"]).args(arguments).output();
    if found.is_err() {
        eprintln!("skipped: there is no C compiler (cc)");
    }
    found.ok()
}

#[test]
fn a_c_compiler_lays_structures_out_alike() {
    let fields = [
        ("id", offset_of!(CqPerson, id)),
        ("look", offset_of!(CqPerson, look)),
        ("x", offset_of!(CqPerson, x)),
        ("z", offset_of!(CqPerson, z)),
        ("vx", offset_of!(CqPerson, vx)),
        ("vz", offset_of!(CqPerson, vz)),
        ("heading", offset_of!(CqPerson, heading)),
        ("speed", offset_of!(CqPerson, speed)),
        ("activity", offset_of!(CqPerson, activity)),
        ("patch", offset_of!(CqPerson, patch)),
        ("number", offset_of!(CqPerson, number)),
        ("copy_x", offset_of!(CqPerson, copy_x)),
        ("copy_z", offset_of!(CqPerson, copy_z)),
    ];
    let mut text = String::from("#include \"crowdquilt.h\"\n");
    for (name, at) in fields {
        text += &format!("_Static_assert(offsetof(cq_person, {name}) == {at}, \"{name}\");\n");
    }
    text += &format!("_Static_assert(sizeof(cq_person) == {}, \"person\");\n", size_of::<CqPerson>());
    text += &format!("_Static_assert(sizeof(cq_quat) == {}, \"quat\");\n", size_of::<CqQuat>());
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("layout.c");
    std::fs::write(&file, text).unwrap();
    let include = root().join("include");
    if let Some(found) = cc(&["-fsyntax-only".as_ref(), "-I".as_ref(), include.as_ref(), file.as_ref()]) {
        assert!(found.status.success(), "{}", String::from_utf8_lossy(&found.stderr));
    }
}

#[test]
fn the_example_compiles_and_walks() {
    let out = Path::new(env!("CARGO_TARGET_TMPDIR"));
    // The library lies beside this test.
    let libraries = std::env::current_exe().unwrap().parent().unwrap().to_owned();
    let (program, file) = (out.join("walk"), out.join("walk.world"));
    let (include, source) = (root().join("include"), root().join("examples/walk.c"));
    let path = CString::new(format!("-Wl,-rpath,{}", libraries.display())).unwrap();
    let compiled = cc(&[
        source.as_ref(),
        "-I".as_ref(),
        include.as_ref(),
        "-L".as_ref(),
        libraries.as_ref(),
        "-lcrowdquilt_capi".as_ref(),
        "-lm".as_ref(),
        path.to_str().unwrap().as_ref(),
        "-o".as_ref(),
        program.as_ref(),
    ]);
    let Some(compiled) = compiled else { return };
    assert!(compiled.status.success(), "{}", String::from_utf8_lossy(&compiled.stderr));
    world().save(&file).unwrap();
    let walked = Command::new(&program).arg(&file).output().unwrap();
    let told = String::from_utf8_lossy(&walked.stdout);
    assert!(walked.status.success(), "{}", String::from_utf8_lossy(&walked.stderr));
    assert_eq!(told.lines().count(), 11, "{told}");
    assert!(told.starts_with("period 10.0 s") && told.contains(" walk") && told.contains("stay"), "{told}");
    let failed = Command::new(&program).arg(out.join("none.world")).output().unwrap();
    assert!(!failed.status.success() && String::from_utf8_lossy(&failed.stderr).contains("none.world"));
}
