//! The rigid nodes of a web: frames that are bonded together are one.

use super::band::Complex;
use super::web::{AGREEMENT, Bond, Thread};

/// Where a frame of a thread hangs: its node (P, S), and p = P + S offset, s = S turn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub node: usize,
    pub offset: Complex,
    pub turn: Complex,
}

impl Spot {
    /// The spot that a bond hangs on this one; `offset` and `turn` are those of the second frame seen from the first.
    fn then(self, offset: Complex, turn: Complex) -> Self {
        Self { node: self.node, offset: self.offset + self.turn * offset, turn: self.turn * turn }
    }

    fn agrees(self, other: Self) -> bool {
        (self.offset - other.offset).abs() < AGREEMENT && (self.turn - other.turn).abs() < AGREEMENT
    }
}

/// The node of every frame of every thread, the number of nodes, and the component of every thread; or the index of a
/// bond that contradicts others or names a frame that does not exist. Nodes are numbered in order of time.
pub(super) fn nodes(threads: &[Thread], bonds: &[Bond]) -> Result<(Vec<Vec<Spot>>, usize, Vec<usize>), usize> {
    let exists = |&(role, frame): &(usize, usize)| threads.get(role).is_some_and(|t| frame < t.path.len());
    if let Some(bad) = bonds.iter().position(|b| !exists(&b.a) || !exists(&b.b)) {
        return Err(bad);
    }
    let mut at: Vec<Vec<Vec<usize>>> = threads.iter().map(|t| vec![Vec::new(); t.path.len()]).collect();
    let mut components: Vec<usize> = (0..threads.len()).collect();
    for (i, bond) in bonds.iter().enumerate() {
        at[bond.a.0][bond.a.1].push(i);
        at[bond.b.0][bond.b.1].push(i);
        join(&mut components, bond.a.0, bond.b.0);
    }
    let mut order: Vec<(usize, usize, usize)> = Vec::new();
    for (role, thread) in threads.iter().enumerate() {
        order.extend((0..thread.path.len()).map(|frame| (thread.begin + frame, role, frame)));
    }
    order.sort_unstable();
    let mut spots: Vec<Vec<Option<Spot>>> = threads.iter().map(|t| vec![None; t.path.len()]).collect();
    let mut count = 0;
    for (_, role, frame) in order {
        if spots[role][frame].is_none() {
            let root = Spot { node: count, offset: Complex::default(), turn: Complex::ONE };
            spread(threads, bonds, &at, (role, frame), root, &mut spots)?;
            count += 1;
        }
    }
    let spots = spots.into_iter().map(|s| s.into_iter().map(|s| s.expect("all frames were visited")).collect());
    Ok((spots.collect(), count, components))
}

/// Hangs a frame and all that is bonded to it on one node.
fn spread(
    threads: &[Thread],
    bonds: &[Bond],
    at: &[Vec<Vec<usize>>],
    first: (usize, usize),
    root: Spot,
    spots: &mut [Vec<Option<Spot>>],
) -> Result<(), usize> {
    spots[first.0][first.1] = Some(root);
    let mut open = vec![(first, root)];
    while let Some((here, spot)) = open.pop() {
        for &i in &at[here.0][here.1] {
            let (offset, turn) = seen(threads, &bonds[i]);
            let (other, found) = if bonds[i].a == here {
                (bonds[i].b, spot.then(offset, turn))
            } else {
                (bonds[i].a, spot.then(-(turn.conj() * offset), turn.conj()))
            };
            match spots[other.0][other.1] {
                Some(known) if !known.agrees(found) => return Err(i),
                Some(_) => {}
                None => {
                    spots[other.0][other.1] = Some(found);
                    open.push((other, found));
                }
            }
        }
    }
    Ok(())
}

/// Offset and turn of a bond's second frame, in terms of the first one's similarity.
fn seen(threads: &[Thread], bond: &Bond) -> (Complex, Complex) {
    let heading = |(role, frame): (usize, usize)| threads[role].path.headings[frame] as f64;
    let offset = Complex::unit(heading(bond.a)) * Complex::from(bond.a_from_b.position);
    (offset, Complex::unit(heading(bond.a) + bond.a_from_b.heading as f64 - heading(bond.b)))
}

/// Gives the set of `b` the smaller of both leaders, and that of `a` too.
fn join(leaders: &mut [usize], a: usize, b: usize) {
    let (low, high) = (leaders[a].min(leaders[b]), leaders[a].max(leaders[b]));
    leaders.iter_mut().filter(|l| **l == high).for_each(|l| *l = low);
}
