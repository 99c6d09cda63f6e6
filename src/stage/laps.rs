//! Crowds whose time repeats, unrolled: lap after lap of the same life, each beginning where the one before has led.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::{Character, Crowd, FragmentUse, Instance};
use crate::geom::{Ground, Obstacle, Waypoint};
use crate::motion::{FPS, JOINT_COUNT};

/// Images of one patch are this near to being whole periods apart, metres.
const SAME_PLACE: f32 = 0.05;

/// Where an instance is: what its clock shows at frame 0 (negated), and `world_from_patch`.
pub(super) struct Site {
    kind: u32,
    clock: i32,
    pub place: Vec2,
}

impl Crowd {
    /// Where each instance is, as seen by who meets it first; `None` for those that nobody plays.
    pub(super) fn sites(&self) -> Vec<Option<Site>> {
        let mut sites: Vec<Option<Site>> = self.instances.iter().map(|_| None).collect();
        for f in self.characters.iter().flat_map(|c| &c.fragments) {
            let site = &mut sites[f.instance as usize];
            if site.is_none() {
                *site = Some(self.site_of(f));
            }
        }
        sites
    }

    /// Where the instance of a fragment is, as its player counts places.
    pub(super) fn site_of(&self, f: &FragmentUse) -> Site {
        let kind = self.instances[f.instance as usize].kind;
        let source = &self.set.kinds[kind as usize].fragments[f.role as usize];
        let entry = Ground::new(f.points[0], f.headings[0]);
        let world_from_patch = entry.then(source.motion.path.at(0).inverse());
        Site { kind, clock: f.begin - source.begin as i32, place: world_from_patch.position }
    }

    /// The same crowd over so many laps, its time cropped at both ends; as it is if its time does not repeat.
    ///
    /// Boxes are left out. O(laps x size).
    pub fn laps(&self, laps: u32) -> Self {
        if !self.domain.periodic.t {
            return self.clone();
        }
        let mut out = self.without_people();
        out.domain.periodic.t = false;
        out.domain.last_frame = laps.saturating_mul(self.domain.last_frame);
        out.domain.obstacles = self.domain.obstacles.iter().map(|o| self.rounds(o, laps)).collect();
        let count = self.instances.len() as u32;
        let twins = self.twins();
        let number = |lap: u32, instance: u32| match twins.get(&instance) {
            Some(&twin) if lap > 0 => (lap - 1) * count + twin,
            _ => lap * count + instance,
        };
        out.instances = (0..laps).flat_map(|_| self.instances.clone()).collect();
        out.characters = self.characters.iter().map(|c| self.life(c, laps, &number)).collect();
        out.renumbered()
    }

    /// Everything but people, boxes and instances.
    pub(super) fn without_people(&self) -> Self {
        Self {
            seed: self.seed,
            domain: self.domain.clone(),
            set: self.set.clone(),
            instances: vec![],
            characters: vec![],
            props: vec![],
        }
    }

    /// The instances that are under way when a lap begins, and the same ones at its end.
    fn twins(&self) -> BTreeMap<u32, u32> {
        let (torus, sites) = (self.domain.torus(), self.sites());
        let mut at_clock: BTreeMap<(u32, i32), Vec<(u32, Vec2)>> = BTreeMap::new();
        for (i, site) in sites.iter().enumerate() {
            if let Some(site) = site {
                at_clock.entry((site.kind, site.clock)).or_default().push((i as u32, site.place));
            }
        }
        let twin = |site: &Site| {
            let late = at_clock.get(&(site.kind, site.clock + self.domain.last_frame as i32))?;
            let away = |place: Vec2| torus.nearest(place - site.place).length();
            late.iter().find(|(_, place)| away(*place) < SAME_PLACE).map(|&(i, _)| i)
        };
        let early = sites.iter().enumerate().filter_map(|(i, s)| s.as_ref().map(|s| (i as u32, s)));
        early.filter(|(_, s)| s.clock < 0).filter_map(|(i, s)| Some((i, twin(s)?))).collect()
    }

    fn life(&self, c: &Character, laps: u32, number: &impl Fn(u32, u32) -> u32) -> Character {
        let lap = self.domain.last_frame as usize;
        let ground = |p: Vec3| Vec2::new(p.x, p.z);
        let way = c.root.last().map_or(Vec2::ZERO, |&last| self.domain.torus().whole(ground(last) - ground(c.root[0])));
        let mut out = Character { fragments: vec![], root: vec![], rotations: vec![], ..c.clone() };
        for k in 0..laps {
            let by = way * k as f32;
            let frames = if k + 1 < laps { lap.min(c.frames()) } else { c.frames() };
            out.root.extend(c.root[..frames].iter().map(|&p| p + Vec3::new(by.x, 0.0, by.y)));
            out.rotations.extend_from_slice(&c.rotations[..frames * JOINT_COUNT]);
            // What is under way when a lap begins is in the one before.
            for f in c.fragments.iter().filter(|f| k == 0 || f.begin >= 0) {
                let ticks = (k as usize * lap) as i32;
                out.fragments.push(FragmentUse {
                    instance: number(k, f.instance),
                    begin: f.begin + ticks,
                    end: f.end + ticks,
                    points: f.points.iter().map(|&p| p + by).collect(),
                    ..f.clone()
                });
            }
        }
        out
    }

    /// An obstacle that goes its way lap after lap.
    fn rounds(&self, obstacle: &Obstacle, laps: u32) -> Obstacle {
        if obstacle.path.is_empty() {
            return obstacle.clone();
        }
        let lap = self.domain.last_frame as f32 / FPS;
        let at = |secs: f32| {
            let place = obstacle.place(secs);
            Waypoint { secs, position: place.position, heading: place.heading }
        };
        let (first, last) = (at(0.0), at(lap));
        let inner = obstacle.path.iter().filter(|w| 0.0 < w.secs && w.secs < lap);
        let points: Vec<Waypoint> = inner.copied().chain([last]).collect();
        let (way, turn) = (last.position - first.position, last.heading - first.heading);
        let mut path = vec![first];
        for k in 0..laps {
            let k = k as f32;
            let moved = |w: &Waypoint| Waypoint {
                secs: w.secs + k * lap,
                position: w.position + way * k,
                heading: w.heading + turn * k,
            };
            path.extend(points.iter().map(moved));
        }
        Obstacle { path, ..obstacle.clone() }
    }

    /// What is seen from one frame to another, both included. Boxes are left out.
    pub(crate) fn cut(&self, from: u32, to: u32) -> Self {
        let mut out = self.without_people();
        out.domain.last_frame = to - from;
        for waypoint in out.domain.obstacles.iter_mut().flat_map(|o| &mut o.path) {
            waypoint.secs -= from as f32 / FPS;
        }
        out.instances = self.instances.clone();
        out.characters = self.characters.iter().filter_map(|c| cut(c, from, to)).collect();
        out.renumbered()
    }

    /// The same crowd, begun so many frames later and placed somewhere else: what repeats has no beginning. Frames count
    /// only where time repeats. Boxes are left out.
    pub fn shifted(&self, by: Vec2, frames: u32) -> Self {
        let lap = self.domain.last_frame;
        let mut out = match self.domain.periodic.t {
            true => self.laps(2).cut(frames % lap.max(1), frames % lap.max(1) + lap),
            false => self.without_boxes(),
        };
        out.domain.periodic = self.domain.periodic;
        out.domain.region.points.iter_mut().for_each(|p| *p += by);
        for obstacle in &mut out.domain.obstacles {
            match obstacle.path.is_empty() {
                true => obstacle.outline.points.iter_mut().for_each(|p| *p += by),
                false => obstacle.path.iter_mut().for_each(|w| w.position += by),
            }
        }
        out.characters.iter_mut().for_each(|c| c.move_by(by));
        out
    }

    pub(super) fn without_boxes(&self) -> Self {
        Self { props: vec![], ..self.clone() }
    }

    /// Without the instances that nobody plays any more.
    fn renumbered(mut self) -> Self {
        let mut numbers: BTreeMap<u32, u32> = BTreeMap::new();
        let mut instances: Vec<Instance> = Vec::new();
        for f in self.characters.iter_mut().flat_map(|c| &mut c.fragments) {
            f.instance = *numbers.entry(f.instance).or_insert_with(|| {
                instances.push(self.instances[f.instance as usize].clone());
                instances.len() as u32 - 1
            });
        }
        self.instances = instances;
        self
    }
}

impl Character {
    /// Puts somebody somewhere else, metres.
    pub(crate) fn move_by(&mut self, by: Vec2) {
        self.root.iter_mut().for_each(|p| *p += Vec3::new(by.x, 0.0, by.y));
        self.fragments.iter_mut().flat_map(|f| &mut f.points).for_each(|p| *p += by);
    }
}

fn cut(c: &Character, from: u32, to: u32) -> Option<Character> {
    let (first, last) = (from.max(c.begin), to.min(c.end()));
    if c.frames() == 0 || first > last {
        return None;
    }
    let frames = (first - c.begin) as usize..(last - c.begin) as usize + 1;
    let seen = c.fragments.iter().filter(|f| f.end > from as i32 && f.begin < to as i32);
    let moved = |f: &FragmentUse| FragmentUse { begin: f.begin - from as i32, end: f.end - from as i32, ..f.clone() };
    Some(Character {
        begin: first - from,
        build: c.build.clone(),
        team: c.team,
        fragments: seen.map(moved).collect(),
        root: c.root[frames.clone()].to_vec(),
        rotations: c.rotations[frames.start * JOINT_COUNT..frames.end * JOINT_COUNT].to_vec(),
    })
}
