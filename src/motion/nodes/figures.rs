//! Which nodes make a character.

use std::collections::{BTreeMap, BTreeSet};

use super::{Figure, Tree};

/// A tree with fewer joints is a prop or a camera, where there is a larger one.
const PERSON: usize = 8;

/// The characters that an animation moves: every tree of joints, where the file marks joints; else every tree of
/// animated nodes. Trees of fewer than eight joints count only where there is no larger one.
pub(super) fn find(tree: &Tree) -> Vec<Figure> {
    let marked: Vec<bool> = tree.nodes.iter().map(|n| n.joint).collect();
    let moving = subtree_counts(tree, |i| tree.nodes[i].animated);
    let mut groups = forest(tree, &marked);
    groups.retain(|group| moves(tree, group, &moving));
    if groups.is_empty() {
        groups = unmarked(tree, &moving);
    }
    let largest = groups.iter().map(Vec::len).max().unwrap_or(0);
    groups.retain(|group| group.len() >= PERSON.min(largest) && group.len() > 1);
    named(tree, groups.into_iter().map(|joints| figure(tree, joints)).collect())
}

/// By node, how many nodes at or below it are `counted`.
fn subtree_counts(tree: &Tree, counted: impl Fn(usize) -> bool) -> Vec<usize> {
    let mut count: Vec<usize> = (0..tree.nodes.len()).map(|i| usize::from(counted(i))).collect();
    for &i in tree.order.iter().rev() {
        if let Some(parent) = tree.nodes[i].parent {
            count[parent] += count[i];
        }
    }
    count
}

/// The trees that the chosen nodes form, each parents first; chosen nodes may be far below each other.
fn forest(tree: &Tree, chosen: &[bool]) -> Vec<Vec<usize>> {
    let mut group_of: Vec<Option<usize>> = vec![None; tree.nodes.len()];
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for &i in &tree.order {
        group_of[i] = tree.nodes[i].parent.and_then(|p| group_of[p]);
        if chosen[i] {
            let group = *group_of[i].get_or_insert_with(|| {
                groups.push(Vec::new());
                groups.len() - 1
            });
            groups[group].push(i);
        }
    }
    // In the order of the file.
    groups.sort_by_key(|group| group.iter().min().copied());
    groups
}

/// Whether something moves a joint of the group, or carries all of it.
fn moves(tree: &Tree, group: &[usize], moving: &[usize]) -> bool {
    let mut above = tree.nodes[group[0]].parent;
    while let Some(i) = above {
        if tree.nodes[i].animated {
            return true;
        }
        above = tree.nodes[i].parent;
    }
    moving[group[0]] > 0
}

/// The characters of a file that marks no joints.
fn unmarked(tree: &Tree, moving: &[usize]) -> Vec<Vec<usize>> {
    let mut children = vec![Vec::new(); tree.nodes.len()];
    let mut open: Vec<usize> = Vec::new();
    for &i in &tree.order {
        match tree.nodes[i].parent {
            Some(parent) if moving[i] > 0 => children[parent].push(i),
            None if moving[i] > 0 => open.push(i),
            _ => {}
        }
    }
    let size = subtree_counts(tree, |_| true);
    let mut roots = BTreeSet::new();
    while let Some(i) = open.pop() {
        // A still node above one tree, or above several large enough for people, is no joint but what holds them.
        let one = |c: usize| size[c] + 1 == size[i];
        let holder = !tree.nodes[i].animated && children[i].iter().all(|&c| size[c] >= PERSON || one(c));
        if holder {
            open.extend(&children[i]);
        } else {
            roots.insert(i);
        }
    }
    let mut chosen: Vec<bool> = vec![false; tree.nodes.len()];
    for &i in &tree.order {
        let node = &tree.nodes[i];
        let inside = roots.contains(&i) || node.parent.is_some_and(|p| chosen[p]);
        chosen[i] = inside && (!node.shows || moving[i] > 0);
    }
    forest(tree, &chosen)
}

fn figure(tree: &Tree, joints: Vec<usize>) -> Figure {
    let place: BTreeMap<usize, usize> = joints.iter().enumerate().map(|(at, &i)| (i, at)).collect();
    let above = |i: usize| std::iter::successors(tree.nodes[i].parent, |&p| tree.nodes[p].parent);
    let parents = joints.iter().map(|&i| above(i).find_map(|p| place.get(&p).copied())).collect();
    let mut chain: Vec<usize> = above(joints[0]).collect();
    chain.reverse();
    let mut known: BTreeSet<usize> = chain.iter().copied().collect();
    for &joint in &joints {
        let first = chain.len();
        chain.extend(std::iter::once(joint).chain(above(joint)).take_while(|i| known.insert(*i)));
        chain[first..].reverse();
    }
    let root = &tree.nodes[joints[0]];
    let holder = root.parent.map(|p| tree.nodes[p].name.clone()).filter(|name| !name.is_empty());
    let name = root.label.clone().or(holder).unwrap_or_else(|| root.name.clone());
    Figure { name, joints, parents, chain }
}

/// Names that differ: a figure whose name is taken is called by its root, or gets a number.
fn named(tree: &Tree, mut figures: Vec<Figure>) -> Vec<Figure> {
    let mut used: BTreeMap<String, usize> = BTreeMap::new();
    for figure in &mut figures {
        let root = &tree.nodes[figure.joints[0]].name;
        if used.contains_key(&figure.name) && !used.contains_key(root) && !root.is_empty() {
            figure.name.clone_from(root);
        }
        let plain = figure.name.clone();
        loop {
            let count = used.entry(plain.clone()).or_insert(0);
            *count += 1;
            if *count > 1 {
                figure.name = format!("{plain}.{count}");
            }
            if figure.name == plain || used.insert(figure.name.clone(), 1).is_none() {
                break;
            }
        }
    }
    figures
}
