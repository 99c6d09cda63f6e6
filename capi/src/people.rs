//! What the stage knows about people, in the shape that C gets. Nothing unsafe here.

use crowdquilt::motion::{JOINT_COUNT, canonical};
use crowdquilt::stage::World;
use crowdquilt::stage::world::{Moment, Roots, Spot, Walking};
use crowdquilt::{Error, Result};
use glam::{DVec2, Quat, Vec2, Vec3};

/// Somebody near a place; `cq_person` in C.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CqPerson {
    /// The same for the same person at any time.
    pub id: u64,
    /// A well-mixed number that goes with the person: picks its looks.
    pub look: u64,
    /// Where it is, metres.
    pub x: f64,
    /// Where it is, metres.
    pub z: f64,
    /// Velocity, m/s.
    pub vx: f32,
    /// Velocity, m/s.
    pub vz: f32,
    /// Where it looks, radians about the vertical: 0 along +z, positive towards +x.
    pub heading: f32,
    /// Length of the velocity, m/s.
    pub speed: f32,
    /// What somebody who stays does, an index of a name; -1 for those who walk.
    pub activity: i32,
    /// The patch it is in.
    pub patch: u32,
    /// Which of those who walk in the patch.
    pub number: u32,
    /// Which copy of the world it is in, where the world repeats.
    pub copy_x: i32,
    /// Which copy of the world it is in, where the world repeats.
    pub copy_z: i32,
}

/// A joint's rotation relative to its parent's: a unit quaternion; `cq_quat` in C.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CqQuat {
    /// Imaginary part along x.
    pub x: f32,
    /// Imaginary part along y.
    pub y: f32,
    /// Imaginary part along z.
    pub z: f32,
    /// Real part.
    pub w: f32,
}

/// A body: where the hips are relative to the person's place, and how joints are turned.
pub type Pose = (Vec3, [Quat; JOINT_COUNT]);

/// A time that can be.
fn moment(world: &World, secs: f64) -> Result<Moment> {
    if secs.is_finite() && secs.abs() < 1e12 {
        return Ok(world.moment(secs));
    }
    Err(Error::invalid("world", "time", format!("expected seconds within 1e12, found {secs}")))
}

/// Calls `tell` for everybody within `radius` of `centre` at a time, patch by patch.
pub fn near(world: &World, secs: f64, centre: DVec2, radius: f64, mut tell: impl FnMut(CqPerson)) -> Result<()> {
    let moment = moment(world, secs)?;
    if !centre.is_finite() || radius.is_nan() {
        let problem = format!("expected a place and a radius, found {centre} and {radius}");
        return Err(Error::invalid("world", "camera", problem));
    }
    let mut roots = Roots::default();
    for spot in world.nearby().within(centre, radius) {
        let within = |person: &CqPerson| DVec2::new(person.x, person.z).distance(centre) <= radius;
        world.roots_of(&moment, std::iter::once(spot), centre, &mut roots);
        walkers(world, spot, secs, &moment, centre, &roots).filter(within).for_each(&mut tell);
        stayers(world, spot).filter(within).for_each(&mut tell);
    }
    Ok(())
}

fn walkers<'a>(
    world: &'a World,
    spot: Spot,
    secs: f64,
    moment: &'a Moment,
    centre: DVec2,
    roots: &'a Roots,
) -> impl Iterator<Item = CqPerson> + 'a {
    let copy = copy(world, spot);
    let mut bodies = world.bodies(spot, secs).into_iter();
    let people = world.people_of(spot.instance as usize, copy, moment);
    people.enumerate().map(move |(i, person)| {
        let (vx, vz) = (roots.vx()[i], roots.vz()[i]);
        let heading = bodies.next().map_or(vx.atan2(vz), |body| body.heading);
        CqPerson {
            id: person.hash(0),
            look: person.hash(1),
            x: centre.x + f64::from(roots.x()[i]),
            z: centre.y + f64::from(roots.z()[i]),
            vx,
            vz,
            heading,
            speed: vx.hypot(vz),
            activity: -1,
            patch: spot.instance,
            number: i as u32,
            copy_x: copy[0] as i32,
            copy_z: copy[1] as i32,
        }
    })
}

fn stayers(world: &World, spot: Spot) -> impl Iterator<Item = CqPerson> + '_ {
    let (instance, copy) = (spot.instance as usize, copy(world, spot));
    let turn = world.turn(instance);
    let origin = world.place(instance) + spot.shift;
    world.kind(world.kind_of(instance)).stayers().enumerate().map(move |(i, stayer)| {
        let at = origin + Vec2::from_angle(turn).rotate(stayer.place).as_dvec2();
        let person = world.stayer(instance, i, copy);
        CqPerson {
            id: person.hash(0),
            look: person.hash(1),
            x: at.x,
            z: at.y,
            heading: stayer.heading - turn,
            activity: stayer.name as i32,
            patch: spot.instance,
            number: i as u32,
            copy_x: copy[0] as i32,
            copy_z: copy[1] as i32,
            ..CqPerson::default()
        }
    })
}

/// Which copy of the world a patch is in.
fn copy(world: &World, spot: Spot) -> [i64; 2] {
    let count = |shift: f64, size: f64| (shift / size).round() as i64;
    repeat(world).map_or([0, 0], |size| [count(spot.shift.x, size.x), count(spot.shift.y, size.y)])
}

/// Size of what repeats for ever, metres.
pub fn repeat(world: &World) -> Option<DVec2> {
    let units = crowdquilt::stage::world::UNITS_PER_METRE;
    world.info().repeat.map(|[x, z]| DVec2::new(f64::from(x), f64::from(z)) / units)
}

/// Least and greatest x and z of the patches' corners, metres.
pub fn bounds(world: &World) -> [f64; 4] {
    let mut bounds = [f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY];
    for instance in 0..world.instances() {
        let turn = Vec2::from_angle(world.turn(instance));
        for corner in world.kind(world.kind_of(instance)).outline() {
            let at = world.place(instance) + turn.rotate(corner).as_dvec2();
            bounds = [bounds[0].min(at.x), bounds[1].min(at.y), bounds[2].max(at.x), bounds[3].max(at.y)];
        }
    }
    if world.instances() == 0 { [0.0; 4] } else { bounds }
}

/// The body of somebody who was found at the same time.
pub fn pose(world: &World, secs: f64, person: &CqPerson) -> Result<Pose> {
    moment(world, secs)?;
    let problem = |text: &str| Error::invalid("world", "pose", text);
    let gait =
        world.tables().gait.as_ref().ok_or_else(|| problem("expected a world with bodies, found one without"))?;
    if person.activity >= 0 || person.patch as usize >= world.instances() {
        return Err(problem("expected somebody who walks in this world, found another"));
    }
    let spot = Spot { instance: person.patch, shift: DVec2::ZERO };
    let body: Option<Walking> = world.bodies(spot, secs).get(person.number as usize).copied();
    let body = body.ok_or_else(|| problem("expected the time at which the person was found, found another"))?;
    let mut rotations = [Quat::IDENTITY; JOINT_COUNT];
    let root = body.pose(&gait.table, &mut rotations);
    Ok((root - Vec3::new(body.place.x, 0.0, body.place.y), rotations))
}

/// All joints of a body relative to the person's place, metres.
pub fn joints((root, rotations): &Pose) -> Vec<Vec3> {
    let mut globals = Vec::new();
    canonical().globals(*root, rotations, &mut globals);
    globals.into_iter().map(|(position, _)| position).collect()
}
