//! Crowds whose ground repeats, unrolled: a block of tiles side by side.

use std::collections::{BTreeMap, BTreeSet};

use glam::Vec2;

use super::{Crowd, Instance};
use crate::geom::{Obstacle, Periodic, Polygon};
use crate::motion::FPS;
use crate::patch::{Contact, PatchKind, Touch};

/// Nobody reaches further from the hips than this, metres.
const REACH: f32 = 1.2;

/// An image of a tile: how many periods along x and z.
type Tile = (i32, i32);

fn tile(laps: Vec2) -> Tile {
    (laps.x as i32, laps.y as i32)
}

fn add(a: Tile, b: Tile) -> Tile {
    (a.0.wrapping_add(b.0), a.1.wrapping_add(b.1))
}

/// An image of an instance and who plays it: (character, fragment) of the block.
struct Image {
    instance: u32,
    players: Vec<(usize, usize)>,
}

impl Crowd {
    /// The crowd of `x` times `z` tiles, and of `t` laps, open where it repeated: everybody of the endless crowd who is ever
    /// in the block, over all of the time. A direction that does not repeat is left as it is.
    ///
    /// Who walks out of the block goes on outside, and is there alone; of patches at its rim whose people are not all in
    /// the block, those who are play kinds made of their roles only. The first tile is where the crowd's region is. Boxes
    /// are left out. O(tiles x laps x size).
    pub fn unrolled(&self, x: u32, z: u32, t: u32) -> Self {
        if self.domain.periodic.none() {
            return self.clone();
        }
        self.laps(t).block(x, z)
    }

    fn block(&self, x: u32, z: u32) -> Self {
        if !self.domain.periodic.in_space() {
            return self.without_boxes();
        }
        let repeats = self.domain.periodic;
        let (columns, rows) = (if repeats.x { x } else { 1 }, if repeats.z { z } else { 1 });
        let block: BTreeSet<Tile> = (0..rows as i32).flat_map(|z| (0..columns as i32).map(move |x| (x, z))).collect();
        let mut out = self.without_people();
        let mut images: BTreeMap<(u32, Tile), Image> = BTreeMap::new();
        let sites = self.sites();
        for c in &self.characters {
            let own: Vec<Tile> = c.fragments.iter().map(|f| self.beside(f, &sites)).collect();
            for image in self.images(c.root.iter().map(|p| Vec2::new(p.x, p.z)), &block) {
                for (k, f) in c.fragments.iter().enumerate() {
                    let entry = images.entry((f.instance, add(own[k], image)));
                    let new = || Image { instance: f.instance, players: vec![] };
                    entry.or_insert_with(new).players.push((out.characters.len(), k));
                }
                let mut c = c.clone();
                c.move_by(self.domain.torus().period() * Vec2::new(image.0 as f32, image.1 as f32));
                out.characters.push(c);
            }
        }
        self.cast(&mut out, images.into_values());
        self.open(&mut out, &block);
        out
    }

    /// In which tile the instance of a fragment is, seen from the one that whoever meets it first counts it to be in.
    fn beside(&self, f: &super::FragmentUse, sites: &[Option<super::laps::Site>]) -> Tile {
        let first = sites[f.instance as usize].as_ref().map_or(Vec2::ZERO, |s| s.place);
        tile(self.domain.torus().laps(self.site_of(f).place - first))
    }

    /// The tile in which a place is; tile 0 along a direction that does not repeat.
    fn tile_of(&self, place: Vec2) -> Tile {
        let (torus, low) = (self.domain.torus(), self.domain.region.bounds().0);
        let repeats = torus.period().cmpgt(Vec2::ZERO);
        tile(Vec2::select(repeats, (place - low) / torus.period(), Vec2::ZERO).floor())
    }

    /// By how many tiles some places are shifted to be in one of the tiles of a block at some time.
    fn images(&self, places: impl Iterator<Item = Vec2>, block: &BTreeSet<Tile>) -> BTreeSet<Tile> {
        let own: BTreeSet<Tile> = places.map(|p| self.tile_of(p)).collect();
        let shift = |a: Tile, b: Tile| (a.0.wrapping_sub(b.0), a.1.wrapping_sub(b.1));
        own.iter().flat_map(|&o| block.iter().map(move |&b| shift(b, o))).collect()
    }

    /// Numbers the images of instances; those without all their people become instances of smaller kinds.
    fn cast(&self, out: &mut Self, images: impl Iterator<Item = Image>) {
        let mut seen: Vec<usize> = vec![0; self.instances.len()];
        for f in self.characters.iter().flat_map(|c| &c.fragments) {
            seen[f.instance as usize] += 1;
        }
        let mut smaller: BTreeMap<(u32, Vec<u32>), u32> = BTreeMap::new();
        for Image { instance, players } in images {
            let (mut kind, number) = (self.instances[instance as usize].kind, out.instances.len() as u32);
            let role = |&(c, k): &(usize, usize)| role_of(out, c, k);
            let mut roles: Vec<u32> = players.iter().map(role).collect();
            roles.sort_unstable();
            roles.dedup();
            let whole = players.len() == seen[instance as usize];
            if !whole {
                let set = &mut out.set;
                kind = *smaller.entry((kind, roles.clone())).or_insert_with(|| {
                    set.kinds.push(only(&self.set.kinds[kind as usize], &roles));
                    set.kinds.len() as u32 - 1
                });
            }
            for (c, k) in players {
                let f = &mut out.characters[c].fragments[k];
                f.instance = number;
                if !whole {
                    f.role = roles.binary_search(&f.role).expect("one of those who play") as u32;
                }
            }
            out.instances.push(Instance { kind });
        }
    }

    /// Opens the sides that repeat so far that nobody meets them, and puts obstacles wherever somebody is.
    fn open(&self, out: &mut Self, block: &BTreeSet<Tile>) {
        let (low, high) = self.domain.region.bounds();
        let period = self.domain.torus().period();
        let repeats = period.cmpgt(Vec2::ZERO);
        let corner = |t: &Tile| low + period * Vec2::new(t.0 as f32, t.1 as f32);
        let ends = block.iter().fold((low, high), |(a, b), t| (a.min(corner(t)), b.max(corner(t) + (high - low))));
        let places = || out.characters.iter().flat_map(|c| &c.root).map(|p| Vec2::new(p.x, p.z));
        let (from, to) = places().fold(ends, |(a, b), p| (a.min(p - REACH), b.max(p + REACH)));
        let region = Polygon::rectangle(Vec2::select(repeats, from, low), Vec2::select(repeats, to, high));
        let beside = |(x, z): Tile| {
            let all = (-1..2).flat_map(move |i| (-1..2).map(move |k| (x.wrapping_add(i), z.wrapping_add(k))));
            all.filter(|&t| (repeats.x || t.0 == 0) && (repeats.y || t.1 == 0))
        };
        let walked: BTreeSet<Tile> = places().map(|p| self.tile_of(p)).chain(block.iter().copied()).collect();
        let walked: BTreeSet<Tile> = walked.into_iter().flat_map(beside).collect();
        let images = |o: &Obstacle| -> Vec<Obstacle> {
            let shifts = self.images(self.stations(o).into_iter(), &walked);
            shifts.into_iter().map(|t| moved(o, period * Vec2::new(t.0 as f32, t.1 as f32))).collect()
        };
        out.domain.obstacles = self.domain.obstacles.iter().flat_map(images).collect();
        out.domain.region = region;
        out.domain.periodic = Periodic { x: false, z: false, ..self.domain.periodic };
    }

    /// Where an obstacle is, second by second.
    fn stations(&self, obstacle: &Obstacle) -> Vec<Vec2> {
        let (low, high) = obstacle.outline.bounds();
        let secs = if obstacle.path.is_empty() { 0 } else { self.domain.last_frame / FPS as u32 };
        (0..=secs).map(|s| obstacle.place(s as f32).apply((low + high) * 0.5)).collect()
    }
}

fn role_of(out: &Crowd, c: usize, k: usize) -> u32 {
    out.characters[c].fragments[k].role
}

fn moved(obstacle: &Obstacle, by: Vec2) -> Obstacle {
    let mut out = obstacle.clone();
    match out.path.is_empty() {
        true => out.outline.points.iter_mut().for_each(|p| *p += by),
        false => out.path.iter_mut().for_each(|w| w.position += by),
    }
    out
}

/// A kind of some of a kind's roles.
fn only(kind: &PatchKind, roles: &[u32]) -> PatchKind {
    let now = |t: Touch| Some(Touch { role: roles.binary_search(&t.role).ok()? as u32, ..t });
    let contact = |c: &Contact| Some(Contact { a: now(c.a)?, b: now(c.b)?, ..*c });
    let names: Vec<String> = roles.iter().map(u32::to_string).collect();
    PatchKind {
        name: format!("{} (role {} only)", kind.name, names.join(", ")),
        fragments: roles.iter().map(|&r| kind.fragments[r as usize].clone()).collect(),
        contacts: kind.contacts.iter().filter_map(contact).collect(),
        core: kind.core.filter(|_| roles.len() > 1),
        props: vec![],
        ..kind.clone()
    }
}
