//! The takes: what the people do.

mod actions;
mod carry;
mod greet;
mod hop;
mod jump;
mod lift;
mod meet;
mod place;
mod push;
mod rows;
mod sit;
mod talk;
mod trio;
mod walks;

use super::actor::Actor;
use super::scene::Scene;

/// All scenes, in order.
pub(super) fn scenes() -> Vec<Scene> {
    let all = [
        walks::scenes(),
        place::scenes(),
        actions::scenes(),
        jump::scenes(),
        carry::scenes(),
        lift::scenes(),
        sit::scenes(),
        greet::scenes(),
        push::scenes(),
        talk::scenes(),
        trio::scenes(),
        rows::scenes(),
        hop::scenes(),
    ];
    all.into_iter().flatten().collect()
}

/// A scene of one actor, with patches (name, labels, first frame, last frame).
fn solo(name: &str, actor: Actor, patches: &[(&str, &[&str], i32, i32)]) -> Scene {
    let mut scene = Scene::new(name, vec![actor]);
    for &(name, labels, begin, end) in patches {
        scene.patch(name, labels, &[(0, begin, end)], None);
    }
    scene
}
