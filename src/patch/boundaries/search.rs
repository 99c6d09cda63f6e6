//! Which pose groups serve as boundaries: the fewest that keep patches small (paper section 4.2).

/// How far one person's nearest boundary frames of each group are from an event, in frames: `before` its begin and
/// `after` its end; `None` where there is none before the next event or the capture's end.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Reach {
    pub before: Vec<Option<usize>>,
    pub after: Vec<Option<usize>>,
}

/// A choice of groups.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Choice {
    /// The groups, in order.
    pub groups: Vec<usize>,
    /// Frames by which all patches together exceed their events.
    pub frames: usize,
    /// Number of subsets that were looked at.
    pub tried: usize,
}

/// Of all subsets of `count` groups (at most 20) that bound everybody on both sides, the one with the smallest sum of
/// its size times `weight` and all frames; of equals the smallest, then the first. `None` if no subset bounds all.
///
/// Subsets are looked at by size. No subset needs fewer frames than all groups together do, so once `size x weight`
/// with those is no less than the best found, neither this size nor any larger one can be better.
pub(super) fn choose(reaches: &[Reach], count: usize, weight: f32) -> Option<Choice> {
    assert!(count <= 20, "subsets of {count} groups are too many");
    let least = total(reaches, (1 << count) - 1)?;
    let cost = |size: usize, frames: usize| size as f32 * weight + frames as f32;
    let mut best: Option<(f32, u32, usize)> = None;
    let mut tried = 0;
    for size in 0..=count {
        if best.is_some_and(|b| cost(size, least) >= b.0) {
            break;
        }
        for subset in (0..1u32 << count).filter(|s| s.count_ones() as usize == size) {
            tried += 1;
            let Some(frames) = total(reaches, subset) else { continue };
            if best.is_none_or(|b| cost(size, frames) < b.0) {
                best = Some((cost(size, frames), subset, frames));
            }
        }
    }
    let (_, subset, frames) = best?;
    Some(Choice { groups: (0..count).filter(|g| subset >> g & 1 == 1).collect(), frames, tried })
}

/// All frames that patches have beyond their events with the boundaries of a subset.
fn total(reaches: &[Reach], subset: u32) -> Option<usize> {
    let nearest = |side: &[Option<usize>]| {
        side.iter().enumerate().filter(|(g, _)| subset >> g & 1 == 1).filter_map(|(_, frames)| *frames).min()
    };
    reaches.iter().map(|r| Some(nearest(&r.before)? + nearest(&r.after)?)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn reach(count: usize) -> impl Strategy<Value = Reach> {
        let side = || proptest::collection::vec(proptest::option::weighted(0.8, 0usize..60), count);
        (side(), side()).prop_map(|(before, after)| Reach { before, after })
    }

    /// The cheapest cost by trying everything, without any bound.
    fn oracle(reaches: &[Reach], count: usize, weight: f32) -> Option<f32> {
        let all = (0..1u32 << count).filter_map(|subset| {
            let mut frames = 0;
            for r in reaches {
                for side in [&r.before, &r.after] {
                    frames += (0..count).filter(|g| subset >> g & 1 == 1).filter_map(|g| side[g]).min()?;
                }
            }
            Some(subset.count_ones() as f32 * weight + frames as f32)
        });
        all.min_by(f32::total_cmp)
    }

    proptest! {
        #[test]
        fn the_choice_is_the_best_of_all_subsets(
            (reaches, weight) in (1usize..7).prop_flat_map(|n| (proptest::collection::vec(reach(n), 1..6), 0f32..80.0)),
        ) {
            let count = reaches[0].before.len();
            let chosen = choose(&reaches, count, weight);
            let cost = chosen.as_ref().map(|c| c.groups.len() as f32 * weight + c.frames as f32);
            prop_assert_eq!(cost, oracle(&reaches, count, weight));
        }
    }

    #[test]
    fn a_dear_group_is_left_out_and_nothing_larger_is_tried() {
        let near = |group: usize| vec![Some(if group == 0 { 2 } else { 9 }), Some(if group == 1 { 2 } else { 9 })];
        let reaches = [0, 1].map(|g| Reach { before: near(g), after: near(g) });
        let cheap = choose(&reaches, 2, 1.0).unwrap();
        assert_eq!((cheap.groups, cheap.frames), (vec![0, 1], 8));
        let dear = choose(&reaches, 2, 50.0).unwrap();
        assert_eq!((dear.groups, dear.frames, dear.tried), (vec![0], 22, 3));
        assert!(choose(&[Reach { before: vec![None], after: vec![Some(1)] }], 1, 1.0).is_none());
    }
}
