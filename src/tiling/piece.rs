//! Placed pieces: where a role's body is at every tick, and the boxes that it leaves lying.

use glam::Vec2;

use super::bridge::{NO_INSTANCE, Port};
use super::domain::Domain;
use super::footprint::{DISCS, Footprint, Lifts};
use super::library::{Library, Role};
use crate::geom::{Ground, Turn};
use crate::motion::MotionPath;

/// In place of a source frame: a box that lies there before (+ 0) or after (+ 1) the piece.
const LYING: u32 = u32::MAX - 1;

/// Ticks after leaving a patch of several people, and before entering one, over which its people may be as near as they
/// are inside: whoever parts from an embrace is still in it for a moment. Final bodies are tested exactly.
const PARTING: i32 = 8;

/// The patches of several people that somebody leaves to begin a piece, and enters at its end; `NO_INSTANCE` if none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Company {
    pub from: u32,
    pub to: u32,
}

impl Company {
    /// Nobody before and after.
    pub const NONE: Self = Self { from: NO_INSTANCE, to: NO_INSTANCE };
}

/// Which instances somebody is with, and when: the own one over the whole time, those before and after for a moment.
#[derive(Clone, Copy)]
pub(super) struct Ties {
    pub instance: u32,
    pub company: Company,
    pub begin: i32,
    pub end: i32,
}

impl Ties {
    fn at(self, tick: i32) -> [u32; 3] {
        let only = |is_there: bool, instance: u32| if is_there { instance } else { NO_INSTANCE };
        let from = only(tick < self.begin + PARTING, self.company.from);
        [self.instance, from, only(tick >= self.end - PARTING, self.company.to)]
    }

    /// True if two people are in one patch at a moment, or as good as; each counts ticks in laps of their own.
    pub fn join(self, tick: i32, other: Self, their_tick: i32) -> bool {
        let theirs = other.at(their_tick);
        self.at(tick).into_iter().any(|i| i != NO_INSTANCE && theirs.contains(&i))
    }
}

/// From one person's way of counting places and ticks to another's: whole periods and laps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shift {
    /// Metres.
    pub place: Vec2,
    /// Ticks.
    pub ticks: i32,
}

impl Shift {
    /// The same place and heading.
    pub fn ground(self, at: Ground) -> Ground {
        Ground::new(at.position + self.place, at.heading)
    }

    /// The same port.
    pub fn port(self, port: Port) -> Port {
        Port { at: self.ground(port.at), tick: port.tick + self.ticks, ..port }
    }
}

/// A body at one tick, or the box that lies there in its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Body {
    pub position: Vec2,
    turn: Turn,
    pub reach: f32,
    frame: u32,
}

impl Body {
    /// The same body somewhere else.
    #[inline]
    pub fn moved(self, by: Vec2) -> Self {
        Self { position: self.position + by, ..self }
    }
}

/// One role of an instance, placed: from tick `begin` to tick `end`, along `path` (world, one sample per source frame).
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Index of the role in the library.
    pub role: u32,
    /// Index of the instance.
    pub instance: u32,
    /// The patches of several people that it leads from and to.
    pub company: Company,
    /// Tick of the entry.
    pub begin: i32,
    /// Tick of the exit.
    pub end: i32,
    /// The deformed path.
    pub path: MotionPath,
    /// First tick of `bodies`.
    pub shown_from: i32,
    /// The bodies on the ticks it occupies: [begin, end) cut to [0, horizon); before and after them the box that lies
    /// there until the piece takes it up, or from when it puts it down.
    pub bodies: Vec<Body>,
}

impl Piece {
    /// A role placed rigidly with its entry at `from`.
    pub fn rigid(library: &Library, domain: &Domain, role: u32, instance: u32, from: Ground, begin: i32) -> Self {
        let rigid = Rigid::new(library, role, from, begin);
        let (source, end) = (rigid.source, begin + rigid.source.ticks);
        let path = MotionPath {
            points: source.path.points.iter().map(|&p| rigid.place(p)).collect(),
            headings: source.path.headings.iter().map(|h| h + from.heading).collect(),
        };
        let ticks = rigid.ticks(domain);
        let (shown_from, company) = (ticks.start, Company::NONE);
        let bodies = ticks.map(|tick| rigid.body(tick)).collect();
        let mut piece = Self { role, instance, company, begin, end, path, shown_from, bodies };
        piece.lay_boxes(source, domain.horizon);
        piece
    }

    /// A role placed along a deformed path.
    pub fn along(
        library: &Library,
        domain: &Domain,
        role: u32,
        instance: u32,
        path: MotionPath,
        begin: i32,
        end: i32,
    ) -> Self {
        let source = &library.roles[role as usize];
        let last = path.len() - 1;
        let step = last as f32 / (end - begin) as f32;
        let ticks = domain.seen(begin, end);
        let (shown_from, company) = (ticks.start, Company::NONE);
        let bodies = ticks.map(|tick| {
            let at = (tick - begin) as f32 * step;
            let i = (at as usize).min(last - 1);
            let t = at - i as f32;
            let frame = (at + 0.5) as usize;
            Body {
                position: path.points[i].lerp(path.points[i + 1], t),
                turn: Turn::from_angle(path.headings[i] * (1.0 - t) + path.headings[i + 1] * t),
                reach: source.reach[frame],
                frame: frame as u32,
            }
        });
        let bodies = bodies.collect();
        let mut piece = Self { role, instance, company, begin, end, path, shown_from, bodies };
        piece.lay_boxes(source, domain.horizon);
        piece
    }

    /// The same piece somewhere else and at another time, if it leaves no boxes: `by` and then as much later.
    pub fn moved(&self, domain: &Domain, by: Ground, ticks: i32) -> Self {
        let (turn, seen) = (by.turn(), domain.seen(self.begin + ticks, self.end + ticks));
        let bodies = self.bodies.iter().zip(self.shown_from + ticks..).filter(|(_, tick)| seen.contains(tick));
        let bodies = bodies.map(|(b, _)| Body { position: by.apply(b.position), turn: turn.then(b.turn), ..*b });
        Self {
            begin: self.begin + ticks,
            end: self.end + ticks,
            path: MotionPath {
                points: self.path.points.iter().map(|&p| by.apply(p)).collect(),
                headings: self.path.headings.iter().map(|h| h + by.heading).collect(),
            },
            shown_from: seen.start,
            bodies: bodies.collect(),
            ..*self
        }
    }

    /// Puts boxes where they lie before the piece begins and after it ends.
    fn lay_boxes(&mut self, source: &Role, horizon: i32) {
        let lying = |k: usize, ticks: i32| {
            let rest = source.rests[k].as_ref().filter(|_| ticks > 0)?;
            let at = self.path.at(rest.frame).then(rest.from_path);
            let body = Body { position: at.position, turn: at.turn(), reach: rest.reach, frame: LYING + k as u32 };
            Some(std::iter::repeat_n(body, ticks as usize))
        };
        let (before, after) = (lying(0, self.begin.min(horizon)), lying(1, horizon - self.end.max(0)));
        self.bodies.extend(after.into_iter().flatten());
        if let Some(before) = before {
            self.bodies.splice(..0, before);
            self.shown_from = 0;
        }
    }

    /// The same piece some laps later or earlier, a whole number of periods away.
    pub fn shifted(mut self, by: Shift) -> Self {
        self.begin += by.ticks;
        self.end += by.ticks;
        self.shown_from += by.ticks;
        self.path.points.iter_mut().for_each(|p| *p += by.place);
        self.bodies.iter_mut().for_each(|b| b.position += by.place);
        self
    }

    /// True if it is to the bit what [`Self::rigid`] makes.
    pub fn is_rigid(&self, library: &Library) -> bool {
        let rigid = Rigid::new(library, self.role, self.entry(), self.begin);
        let source = &rigid.source.path;
        let turned = |(now, then): (&f32, &f32)| *now == then + self.path.headings[0];
        self.end - self.begin == rigid.source.ticks
            && self.path.points.iter().zip(&source.points).all(|(&now, &then)| now == rigid.place(then))
            && self.path.headings.iter().zip(&source.headings).all(turned)
    }

    /// State at the entry.
    pub fn entry(&self) -> Ground {
        self.path.at(0)
    }

    /// State at the exit.
    pub fn exit(&self) -> Ground {
        self.path.at(self.path.len() - 1)
    }

    /// Whom it is with.
    pub fn ties(&self) -> Ties {
        Ties { instance: self.instance, company: self.company, begin: self.begin, end: self.end }
    }

    /// What is there at a tick.
    pub fn body(&self, tick: i32) -> Option<&Body> {
        self.bodies.get(usize::try_from(tick - self.shown_from).ok()?)
    }

    /// Place and heading at a tick the piece occupies.
    pub fn state(&self, tick: i32) -> Ground {
        let body = self.body(tick).expect("a tick the piece occupies");
        Ground::new(body.position, body.turn.angle())
    }

    /// True if the person is in the piece at a tick.
    pub fn is_played(&self, tick: i32) -> bool {
        self.begin <= tick && tick < self.end
    }

    /// Ticks inside the domain's time.
    pub fn ticks_inside(&self) -> usize {
        self.bodies.iter().filter(|b| b.frame < LYING).count()
    }

    /// True if a box lies there before or after the piece.
    pub fn leaves_box(&self) -> bool {
        [self.bodies.first(), self.bodies.last()].into_iter().flatten().any(|b| b.frame >= LYING)
    }

    /// The places of the boxes that lie there before or after the piece.
    pub fn lying<'a>(&'a self, library: &'a Library) -> impl Iterator<Item = Vec2> + 'a {
        let rests = library.roles[self.role as usize].rests.iter().flatten();
        rests.map(|rest| self.path.at(rest.frame).then(rest.from_path).position)
    }

    /// True if this piece and another are ever in each other's way.
    pub fn meets(&self, other: &Self, library: &Library) -> bool {
        let until = |p: &Self| p.shown_from + p.bodies.len() as i32;
        let ticks = self.shown_from.max(other.shown_from)..until(self).min(until(other));
        ticks.into_iter().any(|tick| depth(library, self, other, tick).is_some())
    }
}

/// A role placed rigidly whose bodies are worked out one by one: mostly one of the first is found in the way.
#[derive(Clone, Copy)]
pub(super) struct Rigid<'a> {
    source: &'a Role,
    from: Ground,
    turn: Turn,
    begin: i32,
}

impl<'a> Rigid<'a> {
    /// With its entry at `from` at tick `begin`.
    pub fn new(library: &'a Library, role: u32, from: Ground, begin: i32) -> Self {
        Self { source: &library.roles[role as usize], from, turn: from.turn(), begin }
    }

    /// Whom it is with.
    pub fn ties(&self, company: Company) -> Ties {
        Ties { instance: NO_INSTANCE, company, begin: self.begin, end: self.begin + self.source.ticks }
    }

    /// The ticks that it occupies.
    pub fn ticks(&self, domain: &Domain) -> std::ops::Range<i32> {
        domain.seen(self.begin, self.begin + self.source.ticks)
    }

    /// The body at a tick that it occupies.
    #[inline]
    pub fn body(&self, tick: i32) -> Body {
        let frame = (tick - self.begin) as usize;
        let (position, turn) = (self.place(self.source.path.points[frame]), self.turn.then(self.source.turns[frame]));
        Body { position, turn, reach: self.source.reach[frame], frame: frame as u32 }
    }

    fn place(&self, point: Vec2) -> Vec2 {
        self.from.position + self.turn.apply(point)
    }
}

/// How deep the footprints of two pieces overlap at a tick, metres; `None` if either is not there, or they are apart.
pub(super) fn depth(library: &Library, a: &Piece, b: &Piece, tick: i32) -> Option<f32> {
    let body = |p: &Piece| {
        let body = p.body(tick)?;
        Some((body.position, body.reach, world_discs(body, footprint(library, p.role, body))))
    };
    let ((at, reach, own), (other_at, other_reach, others)) = (body(a)?, body(b)?);
    if at.distance(other_at) >= reach + other_reach {
        return None;
    }
    let pairs = own.iter().flat_map(|p| others.iter().map(move |q| p.z + q.z - p.truncate().distance(q.truncate())));
    pairs.reduce(f32::max).filter(|&d| d > 0.0)
}

/// The discs of a body, seen from its place.
pub(super) fn footprint<'a>(library: &'a Library, role: u32, body: &Body) -> &'a Footprint {
    let role = &library.roles[role as usize];
    match body.frame.checked_sub(LYING) {
        None => &role.footprints[body.frame as usize],
        Some(k) => &role.rests[k as usize].as_ref().expect("a box lies there").footprint,
    }
}

/// How high what each disc of a body covers is above the ground.
pub(super) fn lifts(library: &Library, role: u32, body: &Body) -> Lifts {
    library.roles[role as usize].lifts.get(body.frame as usize).copied().unwrap_or([0.0; DISCS])
}

/// The discs of a body in the world.
pub(super) fn world_discs(body: &Body, footprint: &Footprint) -> Footprint {
    footprint.map(|d| (body.position + body.turn.apply(d.truncate())).extend(d.z))
}

/// True if two sets of discs meet.
pub(super) fn overlap(a: &Footprint, b: &Footprint) -> bool {
    for p in a {
        for q in b {
            let apart = p.z + q.z;
            if p.truncate().distance_squared(q.truncate()) < apart * apart {
                return true;
            }
        }
    }
    debug_assert_eq!(a.len(), DISCS);
    false
}

#[cfg(test)]
mod tests {
    use super::super::common::plain_set;
    use super::super::occupancy::Occupancy;
    use super::super::scene::Scene;
    use super::super::view::View;
    use super::*;
    use crate::deform::Limits;
    use crate::geom::Upright;
    use crate::patch::{PatchProp, PropHold};
    use glam::Vec3;

    #[test]
    fn a_box_is_in_the_way_before_it_is_taken_up_and_after_it_was_put_down() {
        let mut set = plain_set();
        let role_of = |set: &crate::patch::PatchSet, name: &str| {
            let kinds = set.kinds.iter().take_while(|k| k.name != name);
            kinds.map(|k| k.people()).sum::<usize>() as u32
        };
        let lies = Upright { middle: Vec3::new(0.0, 0.15, 0.6), heading: 0.4 };
        set.kinds.iter_mut().find(|k| k.name == "idle-20").unwrap().props.push(PatchProp {
            name: "box".into(),
            size: [0.4, 0.3, 0.3],
            grip: [0.0; 2],
            holds: vec![PropHold { role: 0, begin: 5, end: 15 }],
            sat: vec![],
            before: Some(lies),
            after: Some(lies),
        });
        let library = Library::new(&set, Limits::default());
        let domain = Domain::new(&Scene::demo()).unwrap();
        let mut occupancy = Occupancy::new(&domain, &library);
        let at = |x: f32, z: f32| Ground::new(Vec2::new(x, z), 0.0);
        let lifting = Piece::rigid(&library, &domain, role_of(&set, "idle-20"), 0, at(6.0, 6.0), 100);
        assert!(lifting.leaves_box() && lifting.is_played(100) && !lifting.is_played(99));
        assert_eq!((lifting.ticks_inside(), lifting.state(105).position), (19, Vec2::new(6.0, 6.0)));
        let walker =
            |x: f32, begin: i32| Piece::rigid(&library, &domain, role_of(&set, "cycle-1"), 1, at(x, 6.2), begin);
        let id = occupancy.insert(lifting);
        for begin in [-10, 20, 200, domain.horizon - 20] {
            let (through, past) = (walker(6.0, begin), walker(7.2, begin));
            assert!(!View::new(&library, &domain, &occupancy).is_free(&through), "at tick {begin}");
            assert_eq!(View::new(&library, &domain, &occupancy).blockers(&through), Some(vec![id]));
            assert!(through.meets(occupancy.piece(id), &library) && !past.meets(occupancy.piece(id), &library));
            assert!(View::new(&library, &domain, &occupancy).is_free(&past), "at tick {begin}");
        }
        // Nobody is there who could be cast.
        let mut near = vec![];
        occupancy.near(50, Vec2::new(6.0, 6.6), 2.0, &mut near);
        assert!(near.is_empty());
        occupancy.hide(id);
        assert!(View::new(&library, &domain, &occupancy).is_free(&walker(6.0, 20)));
    }
}
