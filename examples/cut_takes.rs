//! Cuts a folder of take files into a patch set and prints it: kinds, durations, who can follow whom.
//!
//! `cargo run --release --example cut_takes -- [TAKES_FOLDER [CAPTURES_FOLDER]]`; by default the takes of
//! `examples/cmu` on the captures in `../shared/mocap`.

use std::path::PathBuf;

use crowdquilt::Result;
use crowdquilt::motion::FPS;
use crowdquilt::patch::{PatchKind, PatchSet, cut_folder};

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let takes = arguments.next().unwrap_or_else(|| "examples/cmu".into());
    let captures = arguments.next().unwrap_or_else(|| "../shared/mocap".into());
    let set = cut_folder(&takes, Some(&captures))?;
    set.kinds.iter().for_each(|kind| println!("{}", line(&set, kind)));
    println!("{} kinds, {} of them for two or more", set.kinds.len(), shared(&set));
    for (from, group) in set.groups.iter().enumerate() {
        let exits = single(&set).filter(|(_, exit)| *exit == from).count();
        let entries = single(&set).filter(|(entry, _)| *entry == from).count();
        println!("{}: {exits} single kinds lead to it, {entries} lead on", group.name);
    }
    Ok(())
}

fn line(set: &PatchSet, kind: &PatchKind) -> String {
    let people = kind.fragments.iter().map(|f| {
        let (path, last) = (&f.motion.path, f.motion.len() - 1);
        let name = |group: u32| set.groups[group as usize].name.as_str();
        let seconds = last as f32 / FPS;
        let metres = path.points[0].distance(path.points[last]);
        let turn = (path.headings[last] - path.headings[0]).to_degrees();
        format!("{} -> {} {seconds:.2} s {metres:.2} m {turn:+.0} deg", name(f.entry_group), name(f.exit_group))
    });
    format!("{}: {}; {} contacts", kind.name, people.collect::<Vec<_>>().join(" | "), kind.contacts.len())
}

fn shared(set: &PatchSet) -> usize {
    set.kinds.iter().filter(|k| k.people() > 1).count()
}

/// Entry and exit group of every single-person kind.
fn single(set: &PatchSet) -> impl Iterator<Item = (usize, usize)> + '_ {
    let alone = set.kinds.iter().filter(|k| k.people() == 1);
    alone.map(|k| (k.fragments[0].entry_group as usize, k.fragments[0].exit_group as usize))
}
