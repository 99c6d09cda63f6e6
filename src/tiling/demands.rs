//! What a scene demands of a patch set and of a method, before anything is tiled.

use std::borrow::Cow;

use super::{Method, Scene, repeat, wang};
use crate::patch::{PatchKind, PatchSet};
use crate::{Error, Result};

/// Label of kinds that are for jumping over something.
const JUMP: &str = "jump";

/// Label of what is done on one leg: for scenes that ask for it.
const HOP: &str = "hop";

/// Label of kinds that are only used where a scene has placed them.
const STAGED: &str = "staged";

/// The kinds of `set` that the scene uses.
///
/// # Errors
/// The scene speaks of labels or kinds that the set does not have, leaves no kind over, or asks for what the method
/// cannot do.
pub(super) fn admitted<'a>(scene: &Scene, set: &'a PatchSet, method: Method) -> Result<Cow<'a, PatchSet>> {
    possible(scene, method)?;
    known(scene, set)?;
    let used = |kind: &PatchKind| {
        let placed = scene.placed.iter().any(|p| p.kind == kind.name);
        let jumps = !has(kind, JUMP) || may_jump(scene);
        let hops = !has(kind, HOP) || is_asked_for(scene, HOP);
        let wanted = scene.kinds.lets_pass(&kind.labels) && jumps && hops && !has(kind, STAGED);
        (placed || wanted) && (scene.periodic.none() || repeat::can_repeat(kind))
    };
    if set.kinds.iter().all(used) {
        return Ok(Cow::Borrowed(set));
    }
    let some = set.only(used);
    if some.kinds.is_empty() {
        let problem = format!("expected to leave some of {} kinds over, found none left", set.kinds.len());
        return Err(Error::invalid("scene", "kinds", problem));
    }
    Ok(Cow::Owned(some))
}

/// Refuses a set with which no tiling can be perfect: it is not sound or empty, or some pose group can be entered but never
/// left by people alone, or the other way round.
pub(super) fn check_set(set: &PatchSet) -> Result<()> {
    if let Some(problem) = set.validate().into_iter().next() {
        return Err(problem);
    }
    if set.kinds.is_empty() {
        return Err(Error::invalid("patch set", "kinds", "expected at least one kind, found none"));
    }
    let single = |k: &&crate::patch::PatchKind| k.people() == 1;
    let singles = || set.kinds.iter().filter(single).flat_map(|k| &k.fragments);
    for kind in &set.kinds {
        for (role, f) in kind.fragments.iter().enumerate() {
            let name = |group: u32| &set.groups[group as usize].name;
            let place = || format!("kind {}, role {role}", kind.name);
            if !singles().any(|s| s.entry_group == f.exit_group) {
                let problem =
                    format!("no single-person kind can follow its exit in pose group {:?}", name(f.exit_group));
                return Err(Error::invalid("patch set", place(), problem));
            }
            if !singles().any(|s| s.exit_group == f.entry_group) {
                let problem =
                    format!("no single-person kind can lead to its entry in pose group {:?}", name(f.entry_group));
                return Err(Error::invalid("patch set", place(), problem));
            }
        }
    }
    Ok(())
}

fn has(kind: &PatchKind, label: &str) -> bool {
    kind.labels.iter().any(|l| l == label)
}

/// People jump where there is something to jump over, or where they are told to.
fn may_jump(scene: &Scene) -> bool {
    let over = scene.obstacles.iter().any(|o| o.height.is_some());
    over || is_asked_for(scene, JUMP)
}

/// True if a scene names a label as one that it uses or prefers.
fn is_asked_for(scene: &Scene, label: &str) -> bool {
    scene.kinds.only.iter().map(String::as_str).chain(scene.preference.labels()).any(|l| l == label)
}

/// Refuses what the method cannot do.
fn possible(scene: &Scene, method: Method) -> Result<()> {
    let asked = [
        ("source", method == Method::Paper && !scene.sources.is_empty()),
        ("sink", method == Method::Paper && !scene.sinks.is_empty()),
        ("place", method == Method::Paper && !scene.placed.is_empty()),
        ("team", method == Method::Paper && !scene.teams.is_empty()),
        ("rivals", method == Method::Paper && !scene.rivals.is_empty()),
        ("periodic", method == Method::Paper && scene.periodic.any()),
        ("wang", method == Method::Paper && scene.wang.is_some()),
    ];
    let name = match method {
        Method::Engine => "the engine",
        Method::Paper => "the method \"paper\"",
    };
    match asked.iter().find(|a| a.1) {
        Some((key, _)) => Err(Error::invalid("scene", *key, format!("{name} cannot do this yet; leave it out"))),
        None => repeat::possible(scene).and_then(|()| wang::possible(scene)),
    }
}

/// Every label and kind that the scene names must be there: a misspelt one would do nothing, silently.
fn known(scene: &Scene, set: &PatchSet) -> Result<()> {
    let mut labels: Vec<&str> = set.kinds.iter().flat_map(|k| &k.labels).map(String::as_str).collect();
    labels.sort_unstable();
    labels.dedup();
    let of_kinds = scene.kinds.only.iter().chain(&scene.kinds.without).map(|l| ("kinds", l.as_str()));
    let of_wishes = scene.preference.labels().map(|l| ("prefer", l));
    let of_rivals = scene.rivals.iter().map(|l| ("rivals", l.as_str()));
    if let Some((place, label)) = of_kinds.chain(of_wishes).chain(of_rivals).find(|(_, l)| !labels.contains(l)) {
        let problem = format!("expected a label of the patch set ({}), found {label:?}", labels.join(", "));
        return Err(Error::invalid("scene", place, problem));
    }
    let gates = scene.sources.iter().map(|s| ("source", &s.gate)).chain(scene.sinks.iter().map(|s| ("sink", &s.gate)));
    let unknown = |g: &str| set.groups.iter().all(|known| known.name != g);
    if let Some((place, group)) = gates.filter_map(|(k, g)| Some((k, g.group.as_ref()?))).find(|(_, g)| unknown(g)) {
        let names: Vec<&str> = set.groups.iter().map(|g| g.name.as_str()).collect();
        let problem = format!("expected a pose group of the patch set ({}), found {group:?}", names.join(", "));
        return Err(Error::invalid("scene", place, problem));
    }
    let people = |name: &str| set.kinds.iter().find(|k| k.name == name).map(PatchKind::people);
    if let Some(alone) = scene.placed.iter().find(|p| people(&p.kind) == Some(1)) {
        let problem = format!("expected a kind of two people or more, found {:?} of one", alone.kind);
        return Err(Error::invalid("scene", "place", problem));
    }
    match scene.placed.iter().find(|p| people(&p.kind).is_none()) {
        Some(placed) => {
            let problem = format!("expected the name of a kind of the patch set, found {:?}", placed.kind);
            Err(Error::invalid("scene", "place", problem))
        }
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geom::Gate;
    use crate::tiling::{Form, Periodic, Preference, Sink, Term};
    use glam::Vec2;

    fn set() -> PatchSet {
        let kind = |name: &str, label: &str| PatchKind {
            name: name.into(),
            labels: vec![label.into(), "any".into()],
            ..PatchKind::default()
        };
        PatchSet { kinds: vec![kind("a", "walk"), kind("b", "greet")], ..PatchSet::default() }
    }

    fn problem(scene: &Scene) -> String {
        admitted(scene, &set(), Method::Engine).unwrap_err().to_string()
    }

    #[test]
    fn kinds_are_filtered_by_label() {
        let mut scene = Scene::demo();
        assert!(matches!(admitted(&scene, &set(), Method::Paper), Ok(Cow::Borrowed(_))));
        scene.kinds.without = vec!["greet".into()];
        let left = admitted(&scene, &set(), Method::Engine).unwrap().into_owned();
        assert_eq!(left.kinds.iter().map(|k| k.name.as_str()).collect::<Vec<_>>(), ["a"]);
        scene.kinds.without = vec!["any".into()];
        assert!(problem(&scene).contains("none left"));
    }

    #[test]
    fn what_is_not_there_or_cannot_be_done_is_named() {
        let mut scene = Scene::demo();
        scene.kinds.only = vec!["wallk".into()];
        assert!(problem(&scene).contains("any, greet, walk") && problem(&scene).contains("wallk"));
        let form = Form::Ratios(vec![("hug".into(), 2.0)]);
        let preference = Preference { terms: vec![Term { form, strength: 1.0, labels: vec![], during: None }] };
        assert!(problem(&Scene { preference, ..Scene::demo() }).contains("\"hug\""));
        let gate = Gate { from: Vec2::ZERO, to: Vec2::ZERO, heading: None, spread: 0.1, group: Some("sit".into()) };
        let sinks = vec![Sink { gate }];
        let scene = Scene { sinks, ..Scene::demo() };
        assert!(problem(&scene).contains("pose group") && problem(&scene).contains("\"sit\""));
        let paper = admitted(&scene, &set(), Method::Paper).unwrap_err().to_string();
        assert!(paper.contains("sink") && paper.contains("paper"), "{paper}");
        let periodic = Periodic { x: true, ..Periodic::default() };
        let repeating = Scene { periodic, ..Scene::demo() };
        assert!(admitted(&repeating, &set(), Method::Paper).unwrap_err().to_string().contains("periodic"));
        assert!(admitted(&repeating, &set(), Method::Engine).is_ok());
    }
}
