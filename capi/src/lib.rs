//! C interface to the stage: baked worlds, played by random access. `include/crowdquilt.h` documents every function.
//!
//! All unsafe code of the project is in this file: pointers from C are turned into references and slices at the top of each
//! function, what they must be stands in the header. No panic crosses the border: it becomes an error. A world never
//! changes, so any number of threads may read it at once; the message of the last error belongs to the thread.

pub mod people;

use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::ptr;

use crowdquilt::motion::{JOINT_COUNT, canonical};
use crowdquilt::stage::World;
use crowdquilt::{Error, Result};
use glam::DVec2;
use people::{CqPerson, CqQuat};

/// A baked world; `cq_world` in C.
pub struct CqWorld {
    world: World,
    /// Names of what people do, for C.
    names: Vec<CString>,
}

thread_local! {
    static MESSAGE: RefCell<CString> = RefCell::default();
}

/// C has no zero bytes in texts.
fn text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// What `work` gives, or `failed` and a message.
fn guard<T>(failed: T, work: impl FnOnce() -> Result<T>) -> T {
    let tell = |message: &str| MESSAGE.with(|last| *last.borrow_mut() = text(message));
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(value)) => value,
        Ok(Err(error)) => {
            tell(&error.to_string());
            failed
        }
        Err(panic) => {
            let found = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
            tell(&format!("internal error, please report it: {}", found.unwrap_or("no message")));
            failed
        }
    }
}

fn missing(what: &str) -> Error {
    Error::invalid("arguments", what, "expected a pointer, found NULL")
}

/// # Safety
/// `world` is NULL or came from one of the functions that open worlds, and was not freed.
unsafe fn world<'a>(world: *const CqWorld) -> Result<&'a CqWorld> {
    // SAFETY: as the caller promises.
    unsafe { world.as_ref() }.ok_or_else(|| missing("world"))
}

fn boxed(world: World) -> *mut CqWorld {
    let names = world.info().names.iter().map(|name| text(name)).collect();
    Box::into_raw(Box::new(CqWorld { world, names }))
}

/// Message of the last error of this thread.
#[unsafe(no_mangle)]
pub extern "C" fn cq_last_error() -> *const c_char {
    MESSAGE.with(|last| last.borrow().as_ptr())
}

/// Reads a world file.
///
/// # Safety
/// `path` is NULL or a text that ends with a zero.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_open(path: *const c_char) -> *mut CqWorld {
    guard(ptr::null_mut(), || {
        if path.is_null() {
            return Err(missing("path"));
        }
        // SAFETY: not NULL, and as the caller promises.
        let path = unsafe { CStr::from_ptr(path) };
        let path = path.to_str().map_err(|e| Error::invalid("arguments", "path", format!("expected UTF-8: {e}")))?;
        World::load(&PathBuf::from(path)).map(boxed)
    })
}

/// A world from the bytes of a world file.
///
/// # Safety
/// `bytes` is NULL or points to `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_from_memory(bytes: *const u8, size: usize) -> *mut CqWorld {
    guard(ptr::null_mut(), || {
        if bytes.is_null() {
            return Err(missing("bytes"));
        }
        // SAFETY: not NULL, and as the caller promises.
        World::from_bytes(unsafe { std::slice::from_raw_parts(bytes, size) }).map(boxed)
    })
}

/// Frees a world; NULL is nothing.
///
/// # Safety
/// As all functions of a world; nobody uses it any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_free(world: *mut CqWorld) {
    if !world.is_null() {
        // SAFETY: not NULL, made by `boxed`, and as the caller promises.
        drop(unsafe { Box::from_raw(world) });
    }
}

/// Seconds after which everything repeats; 0 on error.
///
/// # Safety
/// `world` is NULL or a world that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_period(of: *const CqWorld) -> f64 {
    // SAFETY: as the caller promises.
    guard(0.0, || Ok(unsafe { world(of) }?.world.info().period_secs.into()))
}

/// Radius of a body in metres; 0 on error.
///
/// # Safety
/// `world` is NULL or a world that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_radius(of: *const CqWorld) -> f64 {
    // SAFETY: as the caller promises.
    guard(0.0, || Ok(unsafe { world(of) }?.world.info().limits.radius.into()))
}

/// Least x, least z, greatest x, greatest z of the ground.
///
/// # Safety
/// `world` is NULL or a world that is not freed, `out` NULL or room for 4 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_bounds(of: *const CqWorld, out: *mut f64) -> i32 {
    guard(-1, || {
        // SAFETY: as the caller promises.
        let bounds = people::bounds(&unsafe { world(of) }?.world);
        // SAFETY: as the caller promises.
        unsafe { write(out, 4, &bounds, "out") }.map(|()| 0)
    })
}

/// Whether the world repeats for ever: the size in x and z of what repeats.
///
/// # Safety
/// `world` is NULL or a world that is not freed, `out` NULL or room for 2 numbers.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_repeat(of: *const CqWorld, out: *mut f64) -> i32 {
    guard(-1, || {
        // SAFETY: as the caller promises.
        let Some(size) = people::repeat(&unsafe { world(of) }?.world) else { return Ok(0) };
        // SAFETY: as the caller promises.
        unsafe { write(out, 2, &size.to_array(), "out") }.map(|()| 1)
    })
}

/// Whether people who walk have full bodies.
///
/// # Safety
/// `world` is NULL or a world that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_has_bodies(of: *const CqWorld) -> i32 {
    // SAFETY: as the caller promises.
    guard(-1, || Ok(unsafe { world(of) }?.world.tables().gait.is_some().into()))
}

/// Name of what people do, or NULL.
///
/// # Safety
/// `world` is NULL or a world that is not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_activity(of: *const CqWorld, activity: i32) -> *const c_char {
    guard(ptr::null(), || {
        // SAFETY: as the caller promises.
        let names = &unsafe { world(of) }?.names;
        let found = usize::try_from(activity).ok().and_then(|index| names.get(index));
        let problem = || format!("expected a number below {}, found {activity}", names.len());
        found.map(|name| name.as_ptr()).ok_or_else(|| Error::invalid("arguments", "activity", problem()))
    })
}

/// Everybody near a camera: how many there are.
///
/// # Safety
/// `world` is NULL or a world that is not freed, `out` NULL or room for `capacity` people.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_people(
    of: *const CqWorld,
    secs: f64,
    x: f64,
    z: f64,
    radius: f64,
    out: *mut CqPerson,
    capacity: usize,
) -> isize {
    guard(-1, || {
        // SAFETY: as the caller promises.
        let world = unsafe { world(of) }?;
        if out.is_null() && capacity > 0 {
            return Err(missing("out"));
        }
        let mut count = 0;
        people::near(&world.world, secs, DVec2::new(x, z), radius, |person| {
            if count < capacity {
                // SAFETY: not NULL, and there is room for `capacity` people.
                unsafe { out.add(count).write(person) };
            }
            count += 1;
        })?;
        Ok(count as isize)
    })
}

/// The body of somebody who was found at the same time: hips, and rotations of all joints.
///
/// # Safety
/// `world` is NULL or a world that is not freed, `person` NULL or a person, `hips` NULL or room for 3 numbers, `rotations` NULL or
/// room for `cq_joint_count()` of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_pose(
    of: *const CqWorld,
    secs: f64,
    person: *const CqPerson,
    hips: *mut f32,
    rotations: *mut CqQuat,
) -> i32 {
    guard(-1, || {
        // SAFETY: as the caller promises.
        let (world, person) = (unsafe { world(of) }?, unsafe { person.as_ref() }.ok_or_else(|| missing("person"))?);
        let (root, joints) = people::pose(&world.world, secs, person)?;
        let joints = joints.map(|q| CqQuat { x: q.x, y: q.y, z: q.z, w: q.w });
        // SAFETY: as the caller promises.
        unsafe { write(hips, 3, &root.to_array(), "hips") }?;
        // SAFETY: as the caller promises.
        unsafe { write(rotations, JOINT_COUNT, &joints, "rotations") }.map(|()| 0)
    })
}

/// All joints of such a body, relative to the person's place.
///
/// # Safety
/// As [`cq_world_pose`]; `out` is NULL or room for 3 numbers for each joint.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn cq_world_joints(of: *const CqWorld, secs: f64, person: *const CqPerson, out: *mut f32) -> i32 {
    guard(-1, || {
        // SAFETY: as the caller promises.
        let (world, person) = (unsafe { world(of) }?, unsafe { person.as_ref() }.ok_or_else(|| missing("person"))?);
        let joints = people::joints(&people::pose(&world.world, secs, person)?);
        let numbers: Vec<f32> = joints.iter().flat_map(|p| p.to_array()).collect();
        // SAFETY: as the caller promises.
        unsafe { write(out, 3 * JOINT_COUNT, &numbers, "out") }.map(|()| 0)
    })
}

/// How many joints a body has.
#[unsafe(no_mangle)]
pub extern "C" fn cq_joint_count() -> usize {
    JOINT_COUNT
}

/// The joint that a joint hangs on; -1 for the hips, and if there is no such joint.
#[unsafe(no_mangle)]
pub extern "C" fn cq_joint_parent(joint: usize) -> i32 {
    guard(-1, || Ok(canonical().joints.get(joint).and_then(|j| j.parent).map_or(-1, |parent| parent as i32)))
}

/// Copies `count` numbers to C.
///
/// # Safety
/// `out` is NULL or room for `count` of them.
unsafe fn write<T: Copy>(out: *mut T, count: usize, values: &[T], name: &str) -> Result<()> {
    if out.is_null() {
        return Err(missing(name));
    }
    let count = count.min(values.len());
    // SAFETY: not NULL, room for `count`, and what Rust has just made does not overlap what C owns.
    unsafe { ptr::copy_nonoverlapping(values.as_ptr(), out, count) };
    Ok(())
}
