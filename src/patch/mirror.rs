//! Mirrored copies of patch kinds.

use super::{Contact, PatchKind, PatchProp, PatchSet, PoseGroup, Touch, prop};
use crate::motion::mirror;

/// The label of kinds that are their own mirror image, of which no copy is made.
pub(super) const SYMMETRIC: &str = "symmetric";

/// What the names of mirrored copies end with.
pub(super) const MIRRORED: &str = "-mirror";

/// The kind seen in a mirror, called `NAME-mirror`; its ports' pose groups swap sides (`walk_left`, `walk_right`)
/// and are added to `groups` where they are new.
pub fn mirrored(kind: &PatchKind, groups: &mut Vec<PoseGroup>) -> PatchKind {
    let touch = |t: Touch| Touch { role: t.role, part: mirror::part(t.part) };
    let fragments = kind.fragments.iter().map(|f| {
        let mut twin = |group: u32| find_or_add(groups, &mirror::group(&groups[group as usize].name));
        super::Fragment {
            entry_group: twin(f.entry_group),
            exit_group: twin(f.exit_group),
            motion: mirror::motion(&f.motion),
            begin: f.begin,
        }
    });
    let seen = |p: &PatchProp| PatchProp {
        before: p.before.map(prop::mirrored),
        after: p.after.map(prop::mirrored),
        ..p.clone()
    };
    PatchKind {
        name: format!("{}{MIRRORED}", kind.name),
        fragments: fragments.collect(),
        labels: kind.labels.clone(),
        contacts: kind.contacts.iter().map(|c| Contact { a: touch(c.a), b: touch(c.b), ..*c }).collect(),
        core: kind.core,
        props: kind.props.iter().map(seen).collect(),
        mirrored: true,
    }
}

/// Adds the mirrored copy of every kind from number `first` on that is not labelled `symmetric`, after the kinds
/// themselves.
pub(super) fn add_mirrored(set: &mut PatchSet, first: usize) {
    let originals = set.kinds[first..].iter().filter(|k| !k.labels.iter().any(|l| l == SYMMETRIC));
    let copies: Vec<PatchKind> = originals.map(|kind| mirrored(kind, &mut set.groups)).collect();
    set.kinds.extend(copies);
}

/// Index of the group called `name`, added if there is none.
pub(super) fn find_or_add(groups: &mut Vec<PoseGroup>, name: &str) -> u32 {
    let found = groups.iter().position(|g| g.name == name).unwrap_or_else(|| {
        groups.push(PoseGroup { name: name.into() });
        groups.len() - 1
    });
    found as u32
}
