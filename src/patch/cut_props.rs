//! The boxes of a patch: which of a take's holds fall into it, and where a box rests before and after.

use super::cut::frame;
use super::prop::settled;
use super::{Fragment, PatchKind, PatchProp, PropHold};
use crate::geom::Upright;
use crate::motion::take::{TakeFile, TakePatch, TakeProp};

/// Shortest time over which both hold a box that is passed, frames.
const PASS_FRAMES: u32 = 8;

/// The boxes that somebody holds in a patch whose clock begins at frame `start` of the take.
///
/// # Errors
/// Somebody takes a box from or hands it to a person who is not there, or puts it down and it is taken up again.
pub(super) fn of_patch(
    take: &TakeFile,
    patch: &TakePatch,
    start: usize,
    fragments: &[Fragment],
) -> Result<Vec<PatchProp>, String> {
    let cutter = Cutter { patch, start: start as u32, fragments };
    let props = take.props.iter().map(|prop| cutter.prop(prop).map_err(|e| format!("prop {}: {e}", prop.name)));
    props.filter_map(Result::transpose).collect()
}

struct Cutter<'a> {
    patch: &'a TakePatch,
    start: u32,
    fragments: &'a [Fragment],
}

/// A hold of a take that falls into a patch.
struct Held {
    /// Its index in the take.
    index: usize,
    /// Cut to the fragment.
    hold: PropHold,
    /// Whether the patch shows its beginning, and its end.
    whole: [bool; 2],
}

impl Cutter<'_> {
    fn prop(&self, prop: &TakeProp) -> Result<Option<PatchProp>, String> {
        let held: Vec<Held> = (0..prop.held.len()).filter_map(|k| self.held(prop, k)).collect();
        let (Some(first), Some(last)) = (held.first(), held.last()) else { return Ok(None) };
        for pair in held.windows(2) {
            self.check_pass(prop, &pair[0], &pair[1])?;
        }
        let passed = |k: usize| prop.held[k + 1].begin <= prop.held[k].end;
        if first.whole[0] && first.index > 0 && passed(first.index - 1) {
            return Err(stranger(prop, first.index, first.index - 1, "takes it over from"));
        }
        if last.whole[1] && last.index + 1 < prop.held.len() && passed(last.index) {
            return Err(stranger(prop, last.index, last.index + 1, "hands it to"));
        }
        let mut holds: Vec<PropHold> = held.iter().map(|h| h.hold).collect();
        self.lengthen_passes(&mut holds);
        let mut cut =
            PatchProp { name: prop.name.clone(), size: prop.size, grip: prop.grip, holds, before: None, after: None };
        (cut.before, cut.after) = (
            first.whole[0].then(|| self.rest(&cut, cut.holds[0].begin)),
            last.whole[1].then(|| self.rest(&cut, cut.holds[cut.holds.len() - 1].end)),
        );
        Ok(Some(cut))
    }

    /// The part of a hold in the patch; `None` if it has none.
    fn held(&self, prop: &TakeProp, index: usize) -> Option<Held> {
        let hold = &prop.held[index];
        let role = self.patch.roles.iter().position(|r| r.person == hold.person)?;
        let (first, last) = self.span(role as u32);
        let (begin, end) = (frame(hold.begin) as u32, frame(hold.end) as u32);
        let (begin, end) = (begin.saturating_sub(self.start), end.checked_sub(self.start)?);
        let starts_here = frame(hold.begin) as u32 > self.start + first;
        let cut = PropHold { role: role as u32, begin: begin.max(first), end: end.min(last) };
        (cut.begin < cut.end).then_some(Held { index, hold: cut, whole: [starts_here, end < last] })
    }

    fn span(&self, role: u32) -> (u32, u32) {
        let f = &self.fragments[role as usize];
        (f.begin, f.begin + f.motion.len() as u32 - 1)
    }

    fn check_pass(&self, prop: &TakeProp, a: &Held, b: &Held) -> Result<(), String> {
        if b.index != a.index + 1 {
            return Err(stranger(prop, a.index, a.index + 1, "hands it to"));
        }
        let (giver, taker) = (prop.held[a.index].person, prop.held[b.index].person);
        if prop.held[b.index].begin > prop.held[a.index].end {
            let advice = "cut one patch for putting it down and another for taking it up";
            return Err(format!("person {giver} puts it down before person {taker} takes it up: {advice}"));
        }
        if !(a.whole[1] && b.whole[0]) {
            let expected = "expected both to be in the patch while it is passed";
            return Err(format!("person {giver} hands it to person {taker}: {expected}"));
        }
        Ok(())
    }

    /// Gives passes that are annotated as a moment the time that hands need.
    fn lengthen_passes(&self, holds: &mut [PropHold]) {
        for k in 1..holds.len() {
            let (from, to) = (holds[k].begin, holds[k - 1].end);
            let short = PASS_FRAMES.saturating_sub(to.saturating_sub(from));
            let (giver, taker) = (self.span(holds[k - 1].role), self.span(holds[k].role));
            holds[k].begin = from.saturating_sub(short.div_ceil(2)).max(taker.0).max(holds[k - 1].begin + 1);
            holds[k - 1].end = (to + short.div_ceil(2)).min(giver.1).min(holds[k].end - 1);
        }
    }

    /// Where the box is at a frame of the clock at which it is taken up or put down.
    fn rest(&self, prop: &PatchProp, clock: u32) -> Upright {
        let kind = PatchKind { fragments: self.fragments.to_vec(), ..PatchKind::default() };
        settled(prop.place(&kind, clock).expect("held at that frame"), prop.size[1])
    }
}

fn stranger(prop: &TakeProp, index: usize, other: usize, what: &str) -> String {
    let (person, stranger) = (prop.held[index].person, prop.held[other].person);
    format!("person {person} {what} person {stranger}: expected both in the patch while it is passed")
}
