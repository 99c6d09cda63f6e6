//! Which pose groups serve as boundaries: the fewest that keep patches small (paper section 4.2).
//!
//! The paper weighs the number of groups against the frames of all patches. Here every stretch of somebody's motion
//! between two boundaries, events in it or not, costs more than its two halves would; and an event without a boundary
//! towards the capture's begin or end is lost, at [`LOST`]. Both only fall when groups are added, which makes the bound of
//! [`Search::choose`] safe.

/// What an event costs that nothing bounds towards the capture's begin or end, frames: as much as ten seconds.
pub(super) const LOST: f32 = 300.0;
/// A stretch of this many frames costs its length,
const ONE: f32 = 30.0;
/// and beyond this many every further frame costs the same.
const LONG: f32 = 60.0;

/// One person's motion and where it may be cut.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Line {
    /// Number of frames.
    pub length: usize,
    /// Frame and group of each possible boundary, sorted.
    pub marks: Vec<(usize, usize)>,
    /// First frame of the first and last frame of the last event, if there are any.
    pub events: Option<(usize, usize)>,
}

impl Line {
    fn cost(&self, subset: u32) -> f32 {
        let mut before = 0;
        let mut sum = 0.0;
        let mut bounded = [false; 2];
        for frame in self.marks.iter().filter(|m| subset >> m.1 & 1 == 1).map(|m| m.0) {
            sum += stretch((frame - before) as f32);
            before = frame;
            if let Some((begin, end)) = self.events {
                bounded[0] |= frame < begin;
                bounded[1] |= frame > end;
            }
        }
        let lost = if self.events.is_some() { bounded.iter().filter(|b| !**b).count() } else { 0 };
        sum + stretch((self.length - before) as f32) + lost as f32 * LOST
    }
}

/// The cost of so many frames without a boundary: convex, so that to divide them is never dearer.
fn stretch(frames: f32) -> f32 {
    frames.min(LONG).powi(2) / ONE + (frames - LONG).max(0.0) * 2.0 * LONG / ONE
}

/// A choice of groups.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    /// The groups, in order.
    pub groups: Vec<usize>,
    /// What they cost in all.
    pub cost: f32,
    /// Number of subsets that were looked at.
    pub tried: usize,
}

/// What subsets are chosen from and by.
pub(super) struct Search<'a> {
    pub lines: &'a [Line],
    /// Of every group its image in a mirror: both or none are chosen. At most 20.
    pub twins: &'a [usize],
    /// What a group costs, frames.
    pub weight: f32,
    /// Most groups.
    pub most: usize,
}

impl Search<'_> {
    /// The subset with the least cost; of equals the smallest, then the first.
    ///
    /// Subsets are looked at by size. None costs less than its size and the frames that all groups together leave, so
    /// once that is no less than the best found, neither this size nor any larger one can be better.
    pub fn choose(&self) -> Choice {
        let count = self.twins.len();
        assert!(count <= 20, "subsets of {count} groups are too many");
        let least = self.frames((1u32 << count) - 1);
        let mut best = (f32::INFINITY, 0u32);
        let mut tried = 0;
        for size in 0..=count.min(self.most) {
            if size as f32 * self.weight + least >= best.0 {
                break;
            }
            for subset in (0..1u32 << count).filter(|&s| s.count_ones() as usize == size && self.symmetric(s)) {
                tried += 1;
                let cost = size as f32 * self.weight + self.frames(subset);
                if cost < best.0 {
                    best = (cost, subset);
                }
            }
        }
        Choice { groups: of(best.1, count).collect(), cost: best.0, tried }
    }

    fn symmetric(&self, subset: u32) -> bool {
        of(subset, self.twins.len()).all(|g| subset >> self.twins[g] & 1 == 1)
    }

    fn frames(&self, subset: u32) -> f32 {
        self.lines.iter().map(|line| line.cost(subset)).sum()
    }
}

fn of(subset: u32, count: usize) -> impl Iterator<Item = usize> {
    (0..count).filter(move |g| subset >> g & 1 == 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(groups: usize) -> impl Strategy<Value = Line> {
        let marks = proptest::collection::vec((0usize..90, 0..groups), 0..12);
        (marks, proptest::option::of((20usize..40, 40usize..70))).prop_map(|(mut marks, events)| {
            marks.retain(|m| events.is_none_or(|(b, e)| m.0 < b || m.0 > e));
            marks.sort_unstable();
            Line { length: 90, marks, events }
        })
    }

    type Case = (Vec<Line>, Vec<usize>, f32, usize);

    fn case() -> impl Strategy<Value = Case> {
        (1usize..7).prop_flat_map(|n| {
            let twins = (0..n).map(|g| if g ^ 1 < n { g ^ 1 } else { g }).collect::<Vec<_>>();
            (proptest::collection::vec(line(n), 0..6), Just(twins), 0f32..200.0, 0..=n)
        })
    }

    /// The least by trying every subset, written out anew.
    fn oracle((lines, twins, weight, most): &Case) -> f32 {
        let subsets =
            (0..1u32 << twins.len()).map(|s| (0..twins.len()).filter(|g| s >> g & 1 == 1).collect::<Vec<_>>());
        let costs = subsets.filter(|s| s.len() <= *most && s.iter().all(|g| s.contains(&twins[*g]))).map(|s| {
            let mut cost = s.len() as f32 * weight;
            for line in lines {
                let own: Vec<usize> = line.marks.iter().filter(|m| s.contains(&m.1)).map(|m| m.0).collect();
                let cuts: Vec<usize> = [0].into_iter().chain(own.iter().copied()).chain([line.length]).collect();
                cost += cuts.windows(2).map(|w| stretch(w[1] as f32 - w[0] as f32)).sum::<f32>();
                if let Some((begin, end)) = line.events {
                    let sides = [own.iter().any(|&f| f < begin), own.iter().any(|&f| f > end)];
                    cost += sides.iter().filter(|s| !**s).count() as f32 * LOST;
                }
            }
            cost
        });
        costs.fold(f32::INFINITY, f32::min)
    }

    proptest! {
        #[test]
        fn the_choice_is_the_best_of_all_subsets(case in case()) {
            let (lines, twins, weight, most) = &case;
            let search = Search { lines, twins, weight: *weight, most: *most };
            let chosen = search.choose();
            prop_assert!((chosen.cost - oracle(&case)).abs() < 1e-2, "{chosen:?} {}", oracle(&case));
            prop_assert!(chosen.groups.len() <= *most);
            prop_assert!(chosen.groups.iter().all(|&g| chosen.groups.contains(&twins[g])));
        }

        #[test]
        fn more_groups_never_cost_more_frames(line in line(6), a in 0u32..64, b in 0u32..64) {
            prop_assert!(line.cost(a | b) <= line.cost(a) + 1e-3);
        }
    }

    #[test]
    fn a_dear_group_is_left_out_and_nothing_larger_is_tried() {
        let lines = [Line { length: 60, marks: vec![(30, 0), (45, 1)], events: Some((20, 25)) }];
        let search = |weight| Search { lines: &lines, twins: &[0, 1], weight, most: 9 }.choose();
        // Nothing bounds the event's begin; its end is bounded by either.
        let cheap = search(1.0);
        assert_eq!((cheap.groups, cheap.cost), (vec![0, 1], LOST + 30.0 + 7.5 + 7.5 + 2.0));
        let dear = search(50.0);
        assert_eq!((dear.groups, dear.cost, dear.tried), (vec![0], LOST + 60.0 + 50.0, 3));
    }
}
