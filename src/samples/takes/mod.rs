//! The takes: what the people do.

mod walks;

use super::scene::Scene;

/// All scenes, in order.
pub(super) fn scenes() -> Vec<Scene> {
    let mut scenes = Vec::new();
    scenes.extend(walks::scenes());
    scenes
}
