//! Bodies for tests.

use super::Body;
use crate::motion::Motion;

/// Somebody of the canonical build who moves as captured.
pub(crate) fn body(motion: &Motion) -> Body {
    let mut body = Body::default();
    let mut globals = Vec::new();
    for f in 0..motion.len() {
        motion.globals(f, &mut globals);
        body.root.push(globals[0].0);
        body.rotations.push(globals[0].1);
        body.rotations.extend_from_slice(&motion.pose(f)[1..]);
    }
    body
}
