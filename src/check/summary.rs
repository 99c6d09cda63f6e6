//! What a crowd consists of.

use super::{chain, part};
use crate::stage::Crowd;

/// The figures one quotes of a tiling.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Summary {
    /// People present at any time.
    pub characters: usize,
    /// Placed patches.
    pub instances: usize,
    /// Patch kinds that at least one instance is of.
    pub kinds_used: usize,
    /// Share of all people's time in the domain that is spent inside patches of two or more, in [0, 1].
    pub multi_person_share: f64,
    /// Boxes that people carry, or that lie there.
    pub props: usize,
    /// Entries after the first frame but at a source, and exits before the last but at a sink.
    pub danglings: usize,
}

/// Counts what `crowd` consists of. O(fragments). References that do not exist are left out: [`super::check`] names
/// them.
pub fn summary(crowd: &Crowd) -> Summary {
    let kinds = crowd.set.kinds.len();
    let mut used = vec![false; kinds];
    for instance in crowd.instances.iter().filter(|i| (i.kind as usize) < kinds) {
        used[instance.kind as usize] = true;
    }
    let (mut all, mut together) = (0, 0);
    if chain::references(crowd).ok {
        for part in part::parts(crowd) {
            // Half-open, so that the frame of a stitch counts once.
            let ticks = part.visible(crowd.domain.last_frame).count().saturating_sub(1);
            all += ticks;
            together += if part.kind.people() >= 2 { ticks } else { 0 };
        }
    }
    Summary {
        characters: crowd.characters.iter().filter(|c| c.frames() > 0).count(),
        instances: crowd.instances.len(),
        kinds_used: used.iter().filter(|&&u| u).count(),
        multi_person_share: if all == 0 { 0.0 } else { together as f64 / all as f64 },
        props: crowd.props.len(),
        danglings: chain::danglings(crowd).count(),
    }
}
