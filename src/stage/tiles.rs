//! Crowds whose ground repeats, unrolled: a block of tiles side by side.

use std::collections::BTreeMap;

use glam::Vec2;

use super::{Character, Crowd, Instance};
use crate::geom::{Obstacle, Polygon};
use crate::patch::{Contact, PatchKind, Touch};

/// Nobody reaches further from the hips than this, metres.
const REACH: f32 = 1.2;

/// An image of a tile: how many periods along x and z.
type Tile = (i32, i32);

fn tile(laps: Vec2) -> Tile {
    (laps.x as i32, laps.y as i32)
}

fn add(a: Tile, b: Tile) -> Tile {
    (a.0 + b.0, a.1 + b.1)
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
        let (low, high) = self.domain.region.bounds();
        let block = (low, low + self.domain.torus().period() * Vec2::new(x as f32, z as f32));
        let block = (block.0, Vec2::new(block.1.x.max(high.x), block.1.y.max(high.y)));
        let mut out = self.without_people();
        let mut images: BTreeMap<(u32, Tile), Image> = BTreeMap::new();
        let sites = self.sites();
        for c in &self.characters {
            let own: Vec<Tile> = c.fragments.iter().map(|f| self.beside(f, &sites)).collect();
            for image in self.images_of(c, block) {
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
        self.open(&mut out, block);
        out
    }

    /// In which tile the instance of a fragment is, seen from the one that whoever meets it first counts it to be in.
    fn beside(&self, f: &super::FragmentUse, sites: &[Option<super::laps::Site>]) -> Tile {
        let first = sites[f.instance as usize].as_ref().map_or(Vec2::ZERO, |s| s.place);
        tile(self.domain.torus().laps(self.site_of(f).place - first))
    }

    /// The tiles an image in which of a person is ever in a block.
    fn images_of(&self, c: &Character, (low, high): (Vec2, Vec2)) -> Vec<Tile> {
        let ends = c.root.iter().map(|p| Vec2::new(p.x, p.z));
        let (from, to) = ends.fold((Vec2::INFINITY, Vec2::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
        if c.root.is_empty() {
            return vec![];
        }
        let period = self.domain.torus().period();
        let span = |low: f32, high: f32, from: f32, to: f32, period: f32| match period > 0.0 {
            true => ((low - to) / period).ceil() as i32..=((high - from) / period).floor() as i32,
            false => 0..=0,
        };
        let (columns, rows) = (span(low.x, high.x, from.x, to.x, period.x), span(low.y, high.y, from.y, to.y, period.y));
        let inside = |image: &Tile| {
            let by = period * Vec2::new(image.0 as f32, image.1 as f32);
            c.root.iter().map(|p| Vec2::new(p.x, p.z) + by).any(|p| p.cmpge(low).all() && p.cmple(high).all())
        };
        rows.flat_map(|z| columns.clone().map(move |x| (x, z))).filter(inside).collect()
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
            let role = |&(c, k): &(usize, usize)| self_role(out, c, k);
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

    /// Opens the sides that repeat so far that nobody meets them, and puts the obstacles of all tiles there.
    fn open(&self, out: &mut Self, block: (Vec2, Vec2)) {
        let torus = self.domain.torus();
        let repeats = torus.period().cmpgt(Vec2::ZERO);
        let places = out.characters.iter().flat_map(|c| &c.root).map(|p| Vec2::new(p.x, p.z));
        let (from, to) = places.fold(block, |(a, b), p| (a.min(p - REACH), b.max(p + REACH)));
        let (low, high) = (Vec2::select(repeats, from, block.0), Vec2::select(repeats, to, block.1));
        out.domain.region = Polygon::rectangle(low, high);
        out.domain.periodic = crate::geom::Periodic { x: false, z: false, ..self.domain.periodic };
        let first = torus.laps(low - block.0).floor() - Vec2::splat(1.0);
        let last = torus.laps(high - block.0).ceil() + Vec2::splat(1.0);
        let ((x0, z0), (x1, z1)) = (tile(first), tile(last));
        let span = |repeats: bool, a: i32, b: i32| if repeats { a..=b } else { 0..=0 };
        let tiles = span(repeats.y, z0, z1).flat_map(|z| span(repeats.x, x0, x1).map(move |x| Vec2::new(x as f32, z as f32)));
        let images = |by: Vec2| self.domain.obstacles.iter().map(move |o| moved(o, by));
        out.domain.obstacles = tiles.flat_map(|t| images(t * torus.period())).collect();
    }
}

fn self_role(out: &Crowd, c: usize, k: usize) -> u32 {
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
