//! Agglomerative clustering with complete linkage: no two members of a group are farther apart than the threshold.

use rayon::prelude::*;

/// Distances of all pairs of `count` things, symmetric.
#[derive(Clone)]
pub(super) struct Distances {
    count: usize,
    values: Vec<f32>,
}

impl Distances {
    /// Measures every pair once, in parallel. O(count squared) of memory.
    pub fn measure(count: usize, between: impl Fn(usize, usize) -> f32 + Sync) -> Self {
        let row = |i: usize| (0..count).map(|j| if j > i { between(i, j) } else { 0.0 }).collect();
        let rows: Vec<Vec<f32>> = (0..count).into_par_iter().map(row).collect();
        let mut values = rows.concat();
        for i in 0..count {
            for j in 0..i {
                values[i * count + j] = values[j * count + i];
            }
        }
        Self { count, values }
    }

    /// Of things and their images in a mirror, which come after them all in the same order: an image is from another as
    /// its thing is from that one's, and from a thing as its own thing is from that one's image.
    pub fn with_images(
        count: usize,
        own: impl Fn(usize, usize) -> f32 + Sync,
        to_image: impl Fn(usize, usize) -> f32 + Sync,
    ) -> Self {
        let (own, across) = (Self::measure(count, own), Self::measure(count, &to_image));
        let at = |i: usize, j: usize| match (i < count) == (j < count) {
            true => own.at(i % count, j % count),
            false if i % count == j % count => to_image(i % count, i % count),
            false => across.at(i % count, j % count),
        };
        let all = 2 * count;
        Self { count: all, values: (0..all * all).map(|k| at(k / all, k % all)).collect() }
    }

    pub fn at(&self, i: usize, j: usize) -> f32 {
        self.values[i * self.count + j]
    }

    /// All nearer to one than `radius`, itself among them.
    pub fn within(&self, of: usize, radius: f32) -> Vec<usize> {
        (0..self.count).filter(|&i| self.at(of, i) < radius).collect()
    }

    /// Complete linkage: the merged group, kept at `into`, is as far from others as its farther half.
    fn merge(&mut self, into: usize, from: usize) {
        for k in 0..self.count {
            let farther = self.at(into, k).max(self.at(from, k));
            self.values[into * self.count + k] = farther;
            self.values[k * self.count + into] = farther;
        }
        self.values[into * self.count + into] = 0.0;
    }
}

/// The groups, each sorted, the largest first (of equals the one with the first member). Merging goes from the nearest
/// to farther groups and stops where a merged group would hold two members at `threshold` or more.
///
/// By chains of nearest neighbours, which gives the same groups in O(count squared): merging two groups never brings the
/// result nearer to a third than both were, so groups that are each other's nearest stay so until they are merged.
pub(super) fn groups(mut distances: Distances, threshold: f32) -> Vec<Vec<usize>> {
    let count = distances.count;
    let mut members: Vec<Vec<usize>> = (0..count).map(|i| vec![i]).collect();
    let mut open: Vec<bool> = vec![true; count];
    let mut chain: Vec<usize> = Vec::new();
    loop {
        if chain.is_empty() {
            match open.iter().position(|&o| o) {
                Some(first) => chain.push(first),
                None => break,
            }
        }
        let last = chain[chain.len() - 1];
        let before = chain.len().checked_sub(2).map(|i| chain[i]);
        match nearest(&distances, &open, last, before) {
            Some((other, distance)) if distance < threshold => {
                if before == Some(other) {
                    chain.truncate(chain.len() - 2);
                    distances.merge(last.min(other), last.max(other));
                    let moved = std::mem::take(&mut members[last.max(other)]);
                    members[last.min(other)].extend(moved);
                    open[last.max(other)] = false;
                } else {
                    chain.push(other);
                }
            }
            // Nothing is near enough, nor will be: distances only grow.
            _ => {
                open[last] = false;
                chain.clear();
            }
        }
    }
    members.retain(|m| !m.is_empty());
    members.iter_mut().for_each(|m| m.sort_unstable());
    members.sort_by_key(|m| (std::cmp::Reverse(m.len()), m[0]));
    members
}

/// The nearest open group; of equals the one before in the chain, so that chains end, else the first.
fn nearest(distances: &Distances, open: &[bool], of: usize, before: Option<usize>) -> Option<(usize, f32)> {
    let others = (0..open.len()).filter(|&i| open[i] && i != of);
    let first = others.map(|i| (i, distances.at(of, i))).min_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(match before {
        Some(b) if distances.at(of, b) <= first.1 => (b, distances.at(of, b)),
        _ => first,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Merging as it is defined: always the two nearest groups.
    fn greedy(points: &[f32], threshold: f32) -> Vec<Vec<usize>> {
        let mut all: Vec<Vec<usize>> = (0..points.len()).map(|i| vec![i]).collect();
        let far = |a: &[usize], b: &[usize]| {
            a.iter().flat_map(|&i| b.iter().map(move |&j| (points[i] - points[j]).abs())).fold(0.0, f32::max)
        };
        loop {
            let pairs = (0..all.len()).flat_map(|i| (i + 1..all.len()).map(move |j| (i, j)));
            let best = pairs.map(|(i, j)| (far(&all[i], &all[j]), i, j)).min_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some((distance, i, j)) if distance < threshold => {
                    let moved = all.remove(j);
                    all[i].extend(moved);
                }
                _ => break,
            }
        }
        all.iter_mut().for_each(|m| m.sort_unstable());
        all.sort_by_key(|m| (std::cmp::Reverse(m.len()), m[0]));
        all
    }

    proptest! {
        #[test]
        fn chains_give_what_merging_the_nearest_gives(
            points in proptest::collection::vec(0f32..1.0, 0..24), threshold in 0.02f32..0.6,
        ) {
            let distances = Distances::measure(points.len(), |i, j| (points[i] - points[j]).abs());
            let found = groups(distances, threshold);
            prop_assert_eq!(&found, &greedy(&points, threshold));
            for group in &found {
                for (&i, &j) in group.iter().zip(&group[1..]).chain(group.first().zip(group.last())) {
                    prop_assert!(i == j || (points[i] - points[j]).abs() < threshold);
                }
            }
        }
    }

    #[test]
    fn equal_points_and_no_points() {
        let same = Distances::measure(6, |_, _| 0.0);
        assert_eq!(groups(same, 0.1), [[0, 1, 2, 3, 4, 5]]);
        assert!(groups(Distances::measure(0, |_, _| 0.0), 0.1).is_empty());
    }
}
