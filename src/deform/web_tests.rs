use glam::Vec2;
use proptest::prelude::*;

use super::super::Strand;
use super::*;
use crate::geom::wrap_angle;
use crate::motion::{BodyPart, Motion};
use crate::patch::{Contact, Fragment, PatchKind, Touch};

const WALK: usize = 40;
const STAND: usize = 25;

/// Walks, stands, walks on: `at` is where one stands.
fn visit(at: Ground, turn: f32) -> MotionPath {
    let speed = |i: usize| match i {
        _ if i < WALK => 1.2 * (((WALK - i) as f32 / 15.0).min(1.0)),
        _ if i < WALK + STAND => 0.0,
        _ => 1.2 * (((i - WALK - STAND) as f32 / 15.0).min(1.0)),
    };
    let mut path = MotionPath::default();
    let mut now = Ground::IDENTITY;
    for i in 0..2 * WALK + STAND {
        path.points.push(now.position);
        path.headings.push(now.heading);
        let turning = if i < WALK { turn / WALK as f32 } else { 0.0 };
        now = now.then(Ground::new(Vec2::new(0.0, speed(i) / 30.0), turning));
    }
    let move_there = at.then(path.at(WALK).inverse());
    MotionPath {
        points: path.points.iter().map(|&p| move_there.apply(p)).collect(),
        headings: path.headings.iter().map(|h| h + move_there.heading).collect(),
    }
}

/// Three people: two who shake hands, and a third who comes late, is with them for the end of it, and leaves alone.
fn gathering(core: bool) -> PatchKind {
    let fragment = |at: Ground, turn: f32, begin: u32| Fragment {
        motion: Motion { path: visit(at, turn), ..Motion::default() },
        begin,
        entry_group: 0,
        exit_group: 0,
    };
    let touch = |role| Touch { role, part: BodyPart::RightHand };
    let (begin, end) = (WALK as u32, (WALK + STAND) as u32);
    let contacts = vec![
        Contact { a: touch(0), b: touch(1), begin: begin + 4, end: end - 3 },
        Contact { a: touch(2), b: touch(1), begin: begin + 14, end },
    ];
    PatchKind {
        name: "gathering".into(),
        labels: vec![],
        fragments: vec![
            fragment(Ground::new(Vec2::new(0.0, -0.4), 0.0), 0.6, 0),
            fragment(Ground::new(Vec2::new(0.1, 0.4), 3.1), -0.4, 2),
            fragment(Ground::new(Vec2::new(0.9, 0.0), -1.5), 0.2, 10),
        ],
        contacts,
        core: core.then_some((begin + 8, end - 6)),
        ..PatchKind::default()
    }
}

/// The bonds of a kind: people in contact, and everyone during the core, stay as captured.
fn web_of(kind: &PatchKind) -> Web {
    let path = |r: usize| kind.fragments[r].motion.path.clone();
    let begin = |r: usize| kind.fragments[r].begin as usize;
    let threads = (0..kind.people()).map(|r| Thread { path: path(r), begin: begin(r) }).collect();
    let mut all = Vec::new();
    for tick in 0..200 {
        for (a, b) in bonds(kind, tick) {
            let (i, j) = (tick - begin(a), tick - begin(b));
            let a_from_b = path(a).at(i).inverse().then(path(b).at(j));
            all.push(Bond { a: (a, i), b: (b, j), a_from_b });
        }
    }
    Web::new(threads, &all).unwrap()
}

/// The pairs of roles, both present, whose relative placement must not change at a tick.
fn bonds(kind: &PatchKind, tick: usize) -> Vec<(usize, usize)> {
    let within = |begin: u32, end: u32| begin as usize <= tick && tick <= end as usize;
    let contacts = kind.contacts.iter().filter(|c| within(c.begin, c.end));
    let mut pairs: Vec<(usize, usize)> = contacts.map(|c| (c.a.role as usize, c.b.role as usize)).collect();
    let present = |&r: &usize| {
        let f = &kind.fragments[r];
        f.begin as usize <= tick && tick < f.begin as usize + f.motion.len()
    };
    if kind.core.is_some_and(|(begin, end)| within(begin, end)) {
        let present: Vec<usize> = (0..kind.people()).filter(present).collect();
        pairs.extend(present.windows(2).map(|w| (w[0], w[1])));
    }
    pairs.retain(|(a, b)| present(a) && present(b));
    pairs
}

fn join(leaders: &mut [usize], a: usize, b: usize) {
    let (low, high) = (leaders[a].min(leaders[b]), leaders[a].max(leaders[b]));
    leaders.iter_mut().filter(|l| **l == high).for_each(|l| *l = low);
}

/// All ports held where they were captured.
fn ports(kind: &PatchKind) -> Vec<Handle> {
    let of = |(role, f): (usize, &Fragment)| {
        let last = f.motion.len() - 1;
        [0, last].map(|frame| Handle {
            role,
            frame,
            at: Some(f.motion.path.at(frame)),
            tick: Some((f.begin as usize + frame) as f32),
        })
    };
    kind.fragments.iter().enumerate().flat_map(of).collect()
}

fn dragged(kind: &PatchKind, port: usize, by: Ground, ticks: f32) -> Vec<Handle> {
    let mut handles = ports(kind);
    handles[port].at = handles[port].at.map(|at| at.then(by));
    handles[port].tick = handles[port].tick.map(|t| t + ticks);
    handles
}

fn hold<'a>(web: &'a Web, handles: &[Handle]) -> Hold<'a> {
    web.hold(handles).unwrap()
}

/// Gaussian elimination with pivoting.
fn solve_dense(mut a: Vec<Vec<Complex>>, mut b: Vec<Complex>) -> Vec<Complex> {
    let inverse = |c: Complex| c.conj().scale(1.0 / (c.abs() * c.abs()));
    let n = b.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs())).unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] * inverse(a[k][k]);
            if factor.abs() > 0.0 {
                let (above, below) = a.split_at_mut(i);
                above[k][k..].iter().zip(&mut below[0][k..]).for_each(|(&a, b)| *b -= factor * a);
                let below = factor * b[k];
                b[i] -= below;
            }
        }
    }
    for k in (0..n).rev() {
        let sum = (k + 1..n).fold(b[k], |sum, j| sum - a[k][j] * b[j]);
        b[k] = sum * inverse(a[k][k]);
    }
    b
}

/// The positions and similarities of every frame by the published formulation: one dense system with Lagrange
/// multipliers for every contact and handle, nothing eliminated, nothing banded.
fn oracle(kind: &PatchKind, handles: &[Handle]) -> Vec<Vec<(Complex, Complex)>> {
    let lengths: Vec<usize> = kind.fragments.iter().map(|f| f.motion.len()).collect();
    let first: Vec<usize> = (0..lengths.len()).map(|r| lengths[..r].iter().sum::<usize>() * 2).collect();
    let (p, s) = (|r: usize, i: usize| first[r] + 2 * i, |r: usize, i: usize| first[r] + 2 * i + 1);
    let point = |r: usize, i: usize| Complex::from(kind.fragments[r].motion.path.points[i]);
    let minus = Complex::real(-1.0);
    let mut energy: Vec<(Vec<(usize, Complex)>, f64)> = Vec::new();
    for (r, &n) in lengths.iter().enumerate() {
        for i in 0..n - 1 {
            let edge = point(r, i + 1) - point(r, i);
            let half = -edge.scale(0.5);
            let stiffness = 1.0 / compliance(edge.abs() as f32) as f64;
            let terms = vec![(p(r, i + 1), Complex::ONE), (p(r, i), minus), (s(r, i), half), (s(r, i + 1), half)];
            energy.push((terms, EDGE_WEIGHT * stiffness));
            energy.push((vec![(s(r, i + 1), Complex::ONE), (s(r, i), minus)], stiffness));
        }
    }
    let mut constraints: Vec<(Vec<(usize, Complex)>, Complex)> = Vec::new();
    for h in handles {
        let at = h.at.unwrap();
        let turn = at.heading - kind.fragments[h.role].motion.path.headings[h.frame];
        constraints.push((vec![(p(h.role, h.frame), Complex::ONE)], at.position.into()));
        constraints.push((vec![(s(h.role, h.frame), Complex::ONE)], Complex::unit(turn as f64)));
    }
    for tick in 0..200 {
        // A spanning tree of those in contact, so that no constraint follows from others.
        let mut leaders: Vec<usize> = (0..lengths.len()).collect();
        for (a, b) in bonds(kind, tick) {
            let frame = |r: usize| tick.checked_sub(kind.fragments[r].begin as usize).filter(|&i| i < lengths[r]);
            let (Some(i), Some(j)) = (frame(a), frame(b)) else { continue };
            if leaders[a] != leaders[b] {
                join(&mut leaders, a, b);
                let d = point(b, j) - point(a, i);
                constraints.push((vec![(p(b, j), Complex::ONE), (p(a, i), minus), (s(a, i), -d)], Complex::default()));
                constraints.push((vec![(s(b, j), Complex::ONE), (s(a, i), minus)], Complex::default()));
            }
        }
    }
    let unknowns = 2 * lengths.iter().sum::<usize>();
    let n = unknowns + constraints.len();
    let (mut a, mut b) = (vec![vec![Complex::default(); n]; n], vec![Complex::default(); n]);
    for (terms, weight) in &energy {
        for &(i, c) in terms {
            terms.iter().for_each(|&(j, d)| a[i][j] += (c.conj() * d).scale(*weight));
        }
    }
    for (k, (terms, right)) in constraints.iter().enumerate() {
        for &(i, c) in terms {
            a[unknowns + k][i] = c;
            a[i][unknowns + k] = c.conj();
        }
        b[unknowns + k] = *right;
    }
    let x = solve_dense(a, b);
    (0..lengths.len()).map(|r| (0..lengths[r]).map(|i| (x[p(r, i)], x[s(r, i)])).collect()).collect()
}

#[test]
fn banded_elimination_agrees_with_a_dense_system_of_all_constraints() {
    for core in [false, true] {
        let kind = gathering(core);
        let handles = dragged(&kind, 1, Ground::new(Vec2::new(0.25, -0.1), 0.3), 0.0);
        let web = web_of(&kind);
        let x = hold(&web, &handles).similar(&handles).unwrap();
        for (role, frames) in oracle(&kind, &handles).into_iter().enumerate() {
            for (i, (p, s)) in frames.into_iter().enumerate() {
                let spot = web.spots[role][i];
                let (node, turn) = (x[2 * spot.node], x[2 * spot.node + 1]);
                // Bonds are given in single precision.
                assert!((node + turn * spot.offset - p).abs() < 1e-5, "role {role} frame {i}");
                assert!((turn * spot.turn - s).abs() < 1e-5, "role {role} frame {i}");
            }
        }
    }
}

#[test]
fn the_energys_gradient_is_zero_at_the_solution() {
    let kind = gathering(true);
    let handles = dragged(&kind, 3, Ground::new(Vec2::new(-0.2, 0.15), -0.2), 0.0);
    let web = web_of(&kind);
    let held = hold(&web, &handles);
    let mut x = held.similar(&handles).unwrap();
    let right = vec![Complex::default(); web.space.rows.len()];
    let pinned: Vec<usize> = handles.iter().map(|h| web.spots[h.role][h.frame].node).collect();
    let h = 1e-4;
    let mut slope = |i: usize, by: Complex| {
        let mut at = |by: Complex| {
            x[i] += by;
            let energy = web.space.energy(&x, &right);
            x[i] -= by;
            energy
        };
        // Central differences of a quadratic are exact.
        (at(by) - at(-by)) / (2.0 * h)
    };
    let (mut free, mut held_back) = (0.0_f64, 0.0_f64);
    for i in 0..web.space.size {
        let largest = slope(i, Complex::real(h)).abs().max(slope(i, Complex { re: 0.0, im: h }).abs());
        let side = if pinned.contains(&(i / 2)) { &mut held_back } else { &mut free };
        *side = side.max(largest);
    }
    assert!(free < 1e-6, "{free}");
    assert!(held_back > 1e-2, "the handles hold against a force: {held_back}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn handles_are_met_contacts_kept_and_limits_hold(
        port in 0usize..6, dx in -0.25f32..0.25, dz in -0.25f32..0.25, turn in -0.3f32..0.3, ticks in -5.0f32..5.0,
    ) {
        let kind = gathering(true);
        let web = web_of(&kind);
        let handles = dragged(&kind, port, Ground::new(Vec2::new(dx, dz), turn), ticks);
        let limits = Limits::PUBLISHED;
        let out = web.deform(&handles, &limits);
        prop_assert!(out.is_some());
        let out = out.unwrap();
        for h in &handles {
            let now = out.paths[h.role].at(h.frame);
            prop_assert!(now.position.distance(h.at.unwrap().position) < 1e-5);
            prop_assert!(wrap_angle(now.heading - h.at.unwrap().heading).abs() < 1e-5);
            prop_assert!((out.ticks[h.role][h.frame] - h.tick.unwrap()).abs() < 1e-3);
        }
        for tick in 0..200 {
            for (a, b) in bonds(&kind, tick) {
                let frame = |r: usize| tick - kind.fragments[r].begin as usize;
                let between = |p: &MotionPath, q: &MotionPath| p.at(frame(a)).inverse().then(q.at(frame(b)));
                let captured = between(&kind.fragments[a].motion.path, &kind.fragments[b].motion.path);
                let now = between(&out.paths[a], &out.paths[b]);
                prop_assert!(now.position.distance(captured.position) < 1e-4);
                prop_assert!(wrap_angle(now.heading - captured.heading).abs() < 1e-4);
                prop_assert!((out.ticks[a][frame(a)] - out.ticks[b][frame(b)]).abs() < 1e-3);
            }
        }
        for (f, path) in kind.fragments.iter().zip(&out.paths) {
            let own = &f.motion.path;
            for i in 1..path.len() {
                let length = |p: &MotionPath| p.points[i].distance(p.points[i - 1]);
                prop_assert!((length(path) - length(own)).abs() <= limits.stretch + 1e-5);
                let turned = |p: &MotionPath| p.headings[i] - p.headings[i - 1];
                prop_assert!((turned(path) - turned(own)).abs() <= limits.bend + 1e-5);
            }
        }
    }

    #[test]
    fn moving_all_handles_rigidly_moves_everything_rigidly(
        x in -9.0f32..9.0, z in -9.0f32..9.0, turn in -3.0f32..3.0, dx in -0.2f32..0.2, dz in -0.2f32..0.2,
    ) {
        let kind = gathering(true);
        let web = web_of(&kind);
        let handles = dragged(&kind, 5, Ground::new(Vec2::new(dx, dz), 0.1), 2.0);
        let there = Ground::new(Vec2::new(x, z), turn);
        let moved: Vec<Handle> = handles.iter().map(|h| Handle { at: h.at.map(|at| there.then(at)), ..*h }).collect();
        let (a, b) = (web.deform(&handles, &Limits::PUBLISHED), web.deform(&moved, &Limits::PUBLISHED));
        let (a, b) = (a.unwrap(), b.unwrap());
        for (p, q) in a.paths.iter().zip(&b.paths) {
            for i in 0..p.len() {
                let expected = there.then(p.at(i));
                prop_assert!(q.points[i].distance(expected.position) < 2e-5);
                prop_assert!(wrap_angle(q.headings[i] - expected.heading).abs() < 2e-5);
            }
        }
        prop_assert_eq!(a.ticks, b.ticks);
    }
}

#[test]
fn handles_as_captured_leave_the_web_as_it_is() {
    let kind = gathering(true);
    let out = web_of(&kind).deform(&ports(&kind), &Limits::TIGHT).unwrap();
    for (f, (path, ticks)) in kind.fragments.iter().zip(out.paths.iter().zip(&out.ticks)) {
        for (i, tick) in ticks.iter().enumerate() {
            assert!(path.points[i].distance(f.motion.path.points[i]) < 1e-5);
            assert!((path.headings[i] - f.motion.path.headings[i]).abs() < 1e-5);
            assert!((tick - (f.begin as usize + i) as f32).abs() < 1e-4);
        }
    }
}

#[test]
fn standing_people_neither_turn_nor_glide_when_a_partners_port_is_dragged() {
    let kind = gathering(false);
    let web = web_of(&kind);
    for port in 0..6 {
        let handles = dragged(&kind, port, Ground::new(Vec2::new(0.2, 0.1), 0.2), 0.0);
        let out = web.deform(&handles, &Limits::PUBLISHED).unwrap();
        for path in &out.paths {
            let (from, to) = (WALK + 1, WALK + STAND - 1);
            let glide = path.points[from].distance(path.points[to]);
            let turn = (path.headings[from] - path.headings[to]).abs();
            assert!(glide < 0.01 && turn < 0.03, "port {port}: {glide} m, {turn} rad");
        }
    }
}

#[test]
fn one_person_bends_as_a_strand_does() {
    let mut kind = gathering(false);
    kind.fragments.truncate(1);
    kind.contacts.clear();
    let handles = dragged(&kind, 1, Ground::new(Vec2::new(0.2, 0.15), 0.2), 0.0);
    let web = web_of(&kind).deform(&handles, &Limits::PUBLISHED).unwrap();
    let mut strand = MotionPath::default();
    let own = Strand::new(&kind.fragments[0].motion.path);
    assert!(own.deform(handles[0].at.unwrap(), handles[1].at.unwrap(), &Limits::PUBLISHED, &mut strand));
    for i in 0..strand.len() {
        assert!(web.paths[0].points[i].distance(strand.points[i]) < 0.03, "frame {i}");
        assert!((web.paths[0].headings[i] - strand.headings[i]).abs() < 0.08, "frame {i}");
    }
}

#[test]
fn limits_are_kept_or_nothing_is_answered() {
    let kind = gathering(true);
    let web = web_of(&kind);
    assert!(web.deform(&dragged(&kind, 1, Ground::new(Vec2::new(0.0, 1.6), 0.0), 0.0), &Limits::PUBLISHED).is_none());
    assert!(web.deform(&dragged(&kind, 1, Ground::new(Vec2::ZERO, 3.0), 0.0), &Limits::TIGHT).is_none());
    assert!(web.deform(&dragged(&kind, 1, Ground::IDENTITY, 60.0), &Limits::PUBLISHED).is_none());
}

#[test]
fn handles_that_make_no_sense_are_refused() {
    let kind = gathering(false);
    let web = web_of(&kind);
    assert!(web.deform(&[], &Limits::TIGHT).is_none(), "nobody is held");
    let nowhere = |role, frame| Handle { role, frame, at: Some(Ground::IDENTITY), tick: None };
    assert!(web.hold(&[nowhere(0, 10_000)]).is_none() && web.hold(&[nowhere(9, 0)]).is_none());
    // Two people in contact, held apart.
    let at = |role: usize, by: f32| {
        let frame = WALK + 10 - kind.fragments[role].begin as usize;
        let mut at = kind.fragments[role].motion.path.at(frame);
        at.position.x += by;
        Handle { role, frame, at: Some(at), tick: None }
    };
    assert!(web.deform(&[at(0, 0.0), at(1, 0.0)], &Limits::TIGHT).is_some());
    assert!(web.deform(&[at(0, 0.0), at(1, 0.1)], &Limits::TIGHT).is_none());
    let handles = ports(&kind);
    assert!(hold(&web, &handles).deform(&handles[1..], &Limits::TIGHT).is_none(), "not the frames that are held");
    // People who share no contact and are not held.
    let mut apart = kind;
    apart.contacts.clear();
    let handles = ports(&apart);
    assert!(web_of(&apart).deform(&handles[..2], &Limits::TIGHT).is_none());
}

/// Two walkers who never met, bonded at a moment of either: frame 25 of the one and 30 of the other.
fn strangers(begin: usize) -> (Vec<Thread>, Bond) {
    let thread = |at: Ground, turn: f32, begin: usize| Thread { path: visit(at, turn), begin };
    let threads = vec![thread(Ground::IDENTITY, 0.4, 0), thread(Ground::new(Vec2::new(5.0, 1.0), 1.0), -0.3, begin)];
    let a_from_b = Ground::new(Vec2::new(0.1, 1.2), std::f32::consts::PI);
    (threads, Bond { a: (0, 25), b: (1, 30), a_from_b })
}

#[test]
fn a_bond_places_strangers_and_turns_nobody_out_of_shape() {
    let (threads, bond) = strangers(0);
    let web = Web::new(threads.clone(), &[bond]).unwrap();
    let handles = [Handle { role: 0, frame: 0, at: Some(threads[0].path.at(0)), tick: Some(7.0) }];
    let out = web.deform(&handles, &Limits { stretch: 1e-4, bend: 1e-3, time: 1e-5, slip: 1e-2 }).unwrap();
    let between = out.paths[0].at(25).inverse().then(out.paths[1].at(30));
    assert!(between.position.distance(bond.a_from_b.position) < 1e-5, "{between:?}");
    assert!(wrap_angle(between.heading - bond.a_from_b.heading).abs() < 1e-5, "{between:?}");
    assert!((out.ticks[0][25] - 32.0).abs() < 1e-4 && (out.ticks[1][30] - 32.0).abs() < 1e-4);
}

#[test]
fn bonds_at_two_moments_bend_the_way_between_and_its_time() {
    let (threads, first) = strangers(0);
    let handles = [Handle { role: 0, frame: 0, at: Some(threads[0].path.at(0)), tick: None }];
    let rigid = Web::new(threads.clone(), &[first]).unwrap().deform(&handles, &Limits::TIGHT).unwrap();
    let a_from_b = rigid.paths[0].at(90).inverse().then(rigid.paths[1].at(99));
    let a_from_b = a_from_b.then(Ground::new(Vec2::new(0.2, 0.15), 0.2));
    let second = Bond { a: (0, 90), b: (1, 99), a_from_b };
    let web = Web::new(threads.clone(), &[first, second]).unwrap();
    let out = web.hold(&handles).unwrap().solve(&handles).unwrap();
    for bond in [first, second] {
        let between = out.paths[0].at(bond.a.1).inverse().then(out.paths[1].at(bond.b.1));
        assert!(between.position.distance(bond.a_from_b.position) < 1e-5, "{between:?}");
        assert!(wrap_angle(between.heading - bond.a_from_b.heading).abs() < 1e-5, "{between:?}");
        assert!((out.ticks[0][bond.a.1] - out.ticks[1][bond.b.1]).abs() < 1e-4);
    }
    let strain = web.strain(&out);
    assert!(strain.stretch.value > 1e-3 && strain.time.value > 5e-4, "{strain:?}");
    let tight = Limits { time: 0.5 * strain.time.value, ..Limits::PUBLISHED };
    let wide = Limits { stretch: 9.0, bend: 9.0, slip: 9.0, ..tight };
    let broken = strain.broken(&wide).unwrap();
    assert!(broken.measure == "change time" && (broken.found - strain.time.value).abs() < 1e-6, "{broken:?}");
}

#[test]
fn bonds_that_contradict_each_other_are_named() {
    let (mut threads, bond) = strangers(3);
    threads.push(Thread { path: visit(Ground::IDENTITY, 0.0), begin: 1 });
    let ring = |x: f32| {
        let on = Bond { a: (1, 30), b: (2, 8), a_from_b: Ground::new(Vec2::new(0.5, 0.0), 0.0) };
        let back = bond.a_from_b.then(on.a_from_b).inverse();
        [bond, on, Bond { a: (2, 8), b: (0, 25), a_from_b: Ground { position: back.position + Vec2::X * x, ..back } }]
    };
    assert!(Web::new(threads.clone(), &ring(0.0)).is_ok());
    assert!(Web::new(threads.clone(), &ring(0.01)).is_err());
    let nobody = Bond { b: (7, 0), ..bond };
    assert_eq!(Web::new(threads, &[bond, nobody]).unwrap_err(), 1);
}
