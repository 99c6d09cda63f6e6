//! One person jumping over something low: from standing with both feet, and out of a walk.

use super::solo;
use crate::motion::Foot;
use crate::samples::actor::Actor;
use crate::samples::gait::NORMAL;
use crate::samples::scene::Scene;

/// Label of what is only done where there is something to jump over.
const LABEL: &str = "jump";

pub(super) fn scenes() -> Vec<Scene> {
    vec![jump(), leap()]
}

fn jump() -> Scene {
    let mut a = Actor::standing();
    a.stand(20);
    let from = a.now;
    a.jump(1.8);
    let to = a.now;
    a.stand(20);
    solo("jump", a, &[("jump", &[LABEL], from, to)])
}

fn leap() -> Scene {
    let mut a = Actor::standing();
    a.stand(10);
    a.start(Foot::Left, NORMAL, 0.0);
    a.walk(NORMAL, 2);
    let from = a.now;
    a.leap(NORMAL, 1.9);
    let to = a.now;
    a.walk(NORMAL, 2);
    a.stop(0.0);
    solo("leap", a, &[("leap", &["walk", LABEL], from, to)])
}
