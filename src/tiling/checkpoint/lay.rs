//! Pieces as a checkpoint keeps them: a placed role is one placement unless its path is deformed.

use std::collections::BTreeMap;

use super::super::bridge::NO_INSTANCE;
use super::super::domain::Domain;
use super::super::library::Library;
use super::super::piece::{Company, Piece};
use super::super::tracks::Tracks;
use crate::geom::Ground;
use crate::motion::MotionPath;

/// A piece, told by the kind instead of by what a library makes of it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Laid {
    /// Index in the checkpoint's list of kinds.
    pub kind: u32,
    /// Index of the fragment in the kind.
    pub role: u32,
    /// Pieces of one instance are played together.
    pub instance: u32,
    /// The patches of several people that it leads from and to.
    pub company: Company,
    /// Tick of the entry.
    pub begin: i32,
    /// Tick of the exit.
    pub end: i32,
    /// Where it goes.
    pub way: Way,
}

/// Where a piece goes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Way {
    /// As captured, its entry here.
    Rigid(Ground),
    /// Along this path.
    Along(MotionPath),
}

/// The kinds in use and everybody's pieces.
pub(super) fn lay(tracks: &Tracks) -> (Vec<String>, Vec<Vec<Laid>>) {
    let library = tracks.library;
    let kind = |piece: &Piece| library.roles[piece.role as usize].kind;
    let mut numbers: BTreeMap<u32, u32> =
        tracks.tracks.iter().flatten().map(|&id| (kind(tracks.piece(id)), 0)).collect();
    let names = numbers.keys().map(|&k| library.set.kinds[k as usize].name.clone()).collect();
    numbers.values_mut().enumerate().for_each(|(i, number)| *number = i as u32);
    let laid = |&id: &u32| {
        let piece = tracks.piece(id);
        of(library, piece, numbers[&kind(piece)])
    };
    (names, tracks.tracks.iter().map(|track| track.iter().map(laid).collect()).collect())
}

fn of(library: &Library, piece: &Piece, kind: u32) -> Laid {
    Laid {
        kind,
        role: library.roles[piece.role as usize].role,
        instance: piece.instance,
        company: piece.company,
        begin: piece.begin,
        end: piece.end,
        way: if piece.is_rigid(library) { Way::Rigid(piece.entry()) } else { Way::Along(piece.path.clone()) },
    }
}

impl Laid {
    /// The piece of a role of the library.
    pub fn piece(&self, library: &Library, domain: &Domain, role: u32) -> Piece {
        let piece = match &self.way {
            Way::Rigid(from) => Piece::rigid(library, domain, role, self.instance, *from, self.begin),
            Way::Along(path) => Piece::along(library, domain, role, self.instance, path.clone(), self.begin, self.end),
        };
        Piece { company: self.company, ..piece }
    }

    /// The instances that it names.
    pub fn instances(&self) -> impl Iterator<Item = u32> {
        let company = [self.company.from, self.company.to].into_iter().filter(|&i| i != NO_INSTANCE);
        company.chain([self.instance])
    }

    /// All numbers of its way.
    pub fn numbers(&self) -> impl Iterator<Item = f32> + '_ {
        let (points, headings, one) = match &self.way {
            Way::Rigid(at) => (&[][..], &[][..], Some([at.position.x, at.position.y, at.heading])),
            Way::Along(path) => (&path.points[..], &path.headings[..], None),
        };
        points.iter().flat_map(|p| [p.x, p.y]).chain(headings.iter().copied()).chain(one.into_iter().flatten())
    }
}
