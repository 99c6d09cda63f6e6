//! Enriching: a patch of two or more people is put where people pass near each other. The windows of their tracks
//! around it are ripped up and bridged again, and so are those of the few who stand in the way; if one bridge fails
//! everything is as before.

use std::ops::Range;

use glam::Vec2;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::bridge::{Goal, NO_INSTANCE, Port, Taste, easy_closings};
use super::domain::Spot;
use super::draft::Draft;
use super::library::Role;
use super::occupancy::PieceId;
use super::piece::{Company, Piece, Shift};
use super::team::{may_meet, team_of};
use super::tracks::{TrackId, Tracks, Window};
use super::tryout::is_clean;
use crate::geom::Ground;
use crate::motion::FPS;

/// Kinds, places and times tried until one has all its players.
const CASTS: usize = 60;
/// How far from an entry its future player may be, metres.
const CAST_RADIUS: f32 = 2.6;
/// How long before an entry players are looked for, ticks.
const CAST_LEAD: i32 = 40;
/// How far from where somebody would be anyway a patch is put, metres and radians.
const JITTER: f32 = 0.5;
const JITTER_TURN: f32 = 0.8;
/// Patches drawn to begin before this tick may as well have begun before the first.
const EARLY_TICKS: i32 = 60;
/// Longer windows than this are not ripped up, ticks.
const LONGEST_BRIDGE: i32 = 110;
/// Most people who are asked to step aside for a patch.
const MAX_BYSTANDERS: usize = 4;
/// Ticks before and after their collision that they may use to do so.
const BYSTANDER_TICKS: i32 = 15;
/// As long as no way there is, metres.
const NO_WAY: f32 = 1e3;
/// Room that the ends of a patch must have to walls, metres.
const WALL_ROOM: f32 = 0.4;

/// One role of the new patch and who is to play it.
struct Part {
    track: TrackId,
    role: u32,
    entry: Port,
    exit: Port,
    /// Pieces `keep_before..keep_after` of the track are ripped up.
    keep_before: usize,
    keep_after: usize,
}

/// Puts an instance of some kind into the tiling, somebody's entry being in `ticks`.
pub(super) fn enrich(draft: &mut Draft, ticks: Range<i32>, taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    let kinds = &draft.base.library.multi;
    let mut draw = || cast(draft.base, kinds[rng.random_range(0..kinds.len())], ticks.clone(), rng);
    let parts = (0..CASTS).find_map(|_| draw())?;
    perform(draft, &parts, taste, rng)
}

/// Chooses place, time and players: somebody's way leads through one of the entries, others are near the rest.
fn cast(tracks: &Tracks, kind: u32, ticks: Range<i32>, rng: &mut ChaCha8Rng) -> Option<Vec<Part>> {
    let library = tracks.library;
    let roles = library.roles_of(kind);
    let lead_role = rng.random_range(roles.clone());
    let lead_track = rng.random_range(0..tracks.tracks.len());
    let lead = &library.roles[lead_role as usize];
    let (at, tick, joint) = meeting_point(tracks, lead_track, lead, ticks, rng)?;
    if !fits_hands(tracks, lead_track, lead.entry_group, tick) {
        return None;
    }
    if !library.preference.is_wanted(kind, tracks.domain.stay(at, tick), rng) {
        return None;
    }
    let world_from_patch = at.then(lead.entry.inverse());
    let clock = tick - lead.begin;

    let mut parts: Vec<Part> = Vec::with_capacity(roles.len());
    let mut near = Vec::new();
    for role in roles {
        let (mut entry, exit) = library.ports(role, world_from_patch, clock);
        let room = |p: &Port| {
            tracks.domain.is_unseen(p.tick) || tracks.domain.holds(Spot::ground(p.tick), p.at.position, WALL_ROOM)
        };
        if !room(&entry) || !room(&exit) {
            return None;
        }
        let part = |track, keep_before, keep_after| Part { track, role, entry, exit, keep_before, keep_after };
        let part = if role != lead_role {
            let barred = |t: TrackId, other: TrackId| t == other || !may_meet(tracks, kind, t, other);
            let taken = |t: TrackId| barred(t, lead_track) || parts.iter().any(|p| barred(t, p.track));
            let heir = heir(tracks, role, exit, world_from_patch, clock);
            let (track, shift, from, to) = player(tracks, &entry, &exit, &heir, taken, &mut near, rng)?;
            Part { entry: shift.port(entry), exit: shift.port(exit), ..part(track, from, to) }
        } else if !tracks.spans(lead_track, entry.tick, exit.tick) {
            return None;
        } else if let Some(joint) = joint {
            // The very numbers of the joint, not ones that differ by rounding.
            entry.at = at;
            let to = rip_to(tracks, lead_track, &entry, &heir(tracks, role, exit, world_from_patch, clock))?;
            Part { track: lead_track, role, entry, exit, keep_before: joint, keep_after: to }
        } else {
            let from = rip_from(tracks, lead_track, &entry)?;
            let heir = heir(tracks, role, exit, world_from_patch, clock);
            part(lead_track, from, rip_to(tracks, lead_track, &entry, &heir)?)
        };
        parts.push(part);
    }
    Some(parts)
}

/// Where and when `track` is to enter as `lead`: at a joint of its pieces if one fits (then which), or near its way.
fn meeting_point(
    tracks: &Tracks,
    track: TrackId,
    lead: &Role,
    ticks: Range<i32>,
    rng: &mut ChaCha8Rng,
) -> Option<(Ground, i32, Option<usize>)> {
    let tick = rng.random_range(ticks);
    let loops = tracks.domain.cycle.loops();
    // Some patches are met half-way through at the first frame.
    let tick = if loops {
        tracks.fold(track, tick)
    } else if tick < EARLY_TICKS {
        tick - rng.random_range(0..lead.ticks)
    } else {
        tick
    };
    if !loops && !tracks.is_there(track, tick.max(0)) {
        return None;
    }
    if (tick > 0 || loops) && rng.random_range(0..2) == 0 {
        let joint = tracks.index_at(track, tick);
        let port = tracks.port(track, joint);
        let inside = loops || (port.tick > 0 && port.tick < tracks.domain.horizon - 15);
        if port.group == lead.entry_group && inside {
            return Some((port.at, port.tick, Some(joint)));
        }
    }
    let on_the_way = tracks.state_at(track, if loops { tick } else { tick.max(0) });
    let aside = Vec2::new(rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0)) * JITTER;
    let at = on_the_way.then(Ground::new(aside, rng.random_range(-JITTER_TURN..JITTER_TURN)));
    Some((at, tick, None))
}

/// From where a role's future is taken over: from its own exit, but where a box is handed on the one who comes with it
/// leaves their future to the one who goes with it.
fn heir(tracks: &Tracks, role: u32, exit: Port, world_from_patch: Ground, clock: i32) -> Port {
    let library = tracks.library;
    let laden = |group: u32| library.laden[group as usize];
    let entry = laden(library.roles[role as usize].entry_group);
    if entry == laden(exit.group) {
        return exit;
    }
    let mut others = library.roles_of(library.roles[role as usize].kind);
    let swaps = |&r: &u32| {
        let other = &library.roles[r as usize];
        laden(other.entry_group) != entry && laden(other.exit_group) == entry
    };
    others.find(swaps).map_or(exit, |r| library.ports(r, world_from_patch, clock).1)
}

/// One of those who can be at `entry` in time and go on from `heir` after `exit`: person, how that person counts places
/// and ticks, first and one past the last piece to rip.
fn player(
    tracks: &Tracks,
    entry: &Port,
    exit: &Port,
    heir: &Port,
    taken: impl Fn(TrackId) -> bool,
    near: &mut Vec<PieceId>,
    rng: &mut ChaCha8Rng,
) -> Option<(TrackId, Shift, usize, usize)> {
    let tick = lead_tick(tracks, entry.tick - CAST_LEAD);
    tracks.occupancy.near(tick, entry.at.position, CAST_RADIUS, near);
    let fits = |&t: &TrackId| !taken(t) && fits_hands(tracks, t, entry.group, tick);
    let mut candidates: Vec<TrackId> = near.iter().map(|&id| tracks.owner(id)).filter(fits).collect();
    candidates.sort_unstable();
    while !candidates.is_empty() {
        let track = candidates.swap_remove(rng.random_range(0..candidates.len()));
        // Before the first tick nobody is anywhere.
        let seen = if tracks.domain.cycle.loops() { entry.tick } else { tick };
        let shift = tracks.shift_to(track, entry, seen);
        let (entry, heir) = (shift.port(*entry), shift.port(*heir));
        if !tracks.spans(track, entry.tick, shift.port(*exit).tick) {
            continue;
        }
        let from = rip_from(tracks, track, &entry);
        if let Some((from, to)) = from.and_then(|f| Some((f, rip_to(tracks, track, &entry, &heir)?))) {
            return Some((track, shift, from, to));
        }
    }
    None
}

/// A tick at which somebody can be looked for.
fn lead_tick(tracks: &Tracks, tick: i32) -> i32 {
    if tracks.domain.cycle.loops() { tick } else { tick.clamp(0, tracks.domain.horizon - 1) }
}

/// True if a person has as much in the hands at a tick as people of a pose group have: a box or nothing.
fn fits_hands(tracks: &Tracks, track: TrackId, group: u32, tick: i32) -> bool {
    let library = tracks.library;
    let piece = tracks.piece(tracks.tracks[track][tracks.index_at(track, lead_tick(tracks, tick))]);
    library.laden[library.roles[piece.role as usize].entry_group as usize] == library.laden[group as usize]
}

/// First piece to rip up so that the person can walk to `entry`: where that is easiest; 0 if the person may begin there.
fn rip_from(tracks: &Tracks, track: TrackId, entry: &Port) -> Option<usize> {
    let (mut best, open) = ((0, None), tracks.begins_open(track));
    let loops = tracks.domain.cycle.loops();
    for index in (0..tracks.index_before(track, entry.tick)).rev() {
        let from = tracks.port(track, index);
        if entry.tick - from.tick > LONGEST_BRIDGE || !tracks.is_loose(tracks.tracks[track][index]) {
            return best.1;
        }
        let ease = easy_closings(tracks.library, from, *entry);
        if ease > best.0 && (from.tick > 0 || loops || index == 0 && !open) {
            best = (ease, Some(index));
        }
    }
    best.1.or((open || loops).then_some(0))
}

/// First piece to keep after the patch; the number of pieces if the rest of the time is planned anew.
fn rip_to(tracks: &Tracks, track: TrackId, entry: &Port, exit: &Port) -> Option<usize> {
    let (count, open) = (tracks.tracks[track].len(), tracks.ends_open(track));
    let mut best = (0, None);
    for index in tracks.index_before(track, exit.tick)..count + usize::from(!open) {
        let to = tracks.port(track, index);
        if to.tick - exit.tick > LONGEST_BRIDGE {
            break;
        }
        let ease = easy_closings(tracks.library, *exit, to);
        if ease > best.0 {
            best = (ease, Some(index));
        }
        if tracks.tracks[track].get(index).is_some_and(|&id| !tracks.is_loose(id)) {
            break;
        }
    }
    let index = best.1.or((open || tracks.domain.cycle.loops()).then_some(count))?;
    no_patch_between(tracks, track, entry.tick, tracks.port(track, index).tick).then_some(index)
}

/// True if the person is in no patch of several people at any time between the two ticks.
fn no_patch_between(tracks: &Tracks, track: TrackId, begin: i32, end: i32) -> bool {
    tracks.tracks[track].iter().all(|&id| {
        let p = tracks.piece(id);
        p.end <= begin || p.begin >= end || tracks.is_loose(id)
    })
}

fn perform(draft: &mut Draft, parts: &[Part], taste: Taste, rng: &mut ChaCha8Rng) -> Option<()> {
    for part in parts {
        draft.hide(Window { track: part.track, from: part.keep_before, to: part.keep_after });
    }
    let tracks = draft.base;
    let bystanders = step_aside(draft, parts)?;
    let placed = draft.add_patch(parts.iter().map(|p| (p.role, p.entry)))?;
    let futures = futures(tracks, parts);
    for (i, part) in parts.iter().enumerate() {
        let future = &parts[futures[i]];
        let mut way = tracks.tracks[part.track][..part.keep_before].to_vec();
        let here = draft.piece(placed[i]).instance;
        let from = tracks.company_before(part.track, part.keep_before);
        way.extend(lead_in(draft, part, Company { from, to: here }, taste, rng)?);
        way.push(placed[i]);
        let to = tracks.company_after(future.track, future.keep_after);
        way.extend(lead_out(draft, part, future, Company { from: here, to }, taste, rng)?);
        way.extend(&tracks.tracks[future.track][future.keep_after..]);
        draft.set_track(part.track, way);
    }
    bystanders.into_iter().try_for_each(|window| draft.bridge_window(window, taste, rng))?;
    is_clean(draft).then_some(())
}

/// Takes out the windows of the tracks that are in the way of the parts; `None` if that are too many, or patches of
/// several people, or walls.
fn step_aside(draft: &mut Draft, parts: &[Part]) -> Option<Vec<Window>> {
    let tracks = draft.base;
    let mut windows: Vec<Window> = Vec::new();
    for part in parts {
        let piece = Piece::rigid(tracks.library, tracks.domain, part.role, NO_INSTANCE, part.entry.at, part.entry.tick);
        for id in draft.view().blockers(&piece)? {
            let track = tracks.owner(id);
            let index = tracks.index_at(track, tracks.piece(id).begin);
            if !tracks.is_loose(id) || parts.iter().any(|p| p.track == track) {
                return None;
            }
            match windows.iter_mut().find(|w| w.track == track) {
                Some(window) => {
                    window.from = window.from.min(index);
                    window.to = window.to.max(index + 1);
                }
                None => windows.push(Window { track, from: index, to: index + 1 }),
            }
        }
    }
    if windows.len() > MAX_BYSTANDERS {
        return None;
    }
    for window in &mut windows {
        if (window.from..window.to).any(|i| !tracks.is_loose(tracks.tracks[window.track][i])) {
            return None;
        }
        *window = tracks.widen(*window, BYSTANDER_TICKS);
        draft.hide(*window);
    }
    Some(windows)
}

/// True if a part leads to the end of time wherever that is.
fn is_open(tracks: &Tracks, part: &Part) -> bool {
    part.keep_after == tracks.tracks[part.track].len() && tracks.ends_open(part.track)
}

/// Whose future each part takes over: the pairing with the least way to go (parts are few). Nobody lives on with a box
/// who has none.
fn futures(tracks: &Tracks, parts: &[Part]) -> Vec<usize> {
    let way = |i: usize, j: usize| {
        let to = tracks.port(parts[j].track, parts[j].keep_after);
        let left = (to.tick - parts[i].exit.tick) as f32 / FPS;
        if i != j && team_of(tracks, parts[i].track) != team_of(tracks, parts[j].track) {
            return NO_WAY;
        }
        let open = is_open(tracks, &parts[j]);
        let laden = |group: u32| tracks.library.laden[group as usize];
        if !open && laden(to.group) != laden(parts[i].exit.group) {
            return NO_WAY;
        }
        if open { 0.0 } else { (parts[i].exit.at.position.distance(to.at.position) - 0.8 * left).abs() }
    };
    let mut order: Vec<usize> = (0..parts.len()).collect();
    if tracks.domain.cycle.loops() {
        // Everybody's future leads to where they began.
        return order;
    }
    for i in 0..order.len() {
        for j in i + 1..order.len() {
            if way(i, order[j]) + way(j, order[i]) < way(i, order[i]) + way(j, order[j]) {
                order.swap(i, j);
            }
        }
    }
    order
}

fn lead_in(
    draft: &mut Draft,
    part: &Part,
    company: Company,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<PieceId>> {
    let from = draft.base.port(part.track, part.keep_before);
    let loops = draft.base.domain.cycle.loops();
    if (part.entry.tick <= 0 && !loops) || from == part.entry {
        return Some(vec![]);
    }
    match part.keep_before {
        0 if draft.base.begins_open(part.track) => draft.search(part.entry, Goal::Since(0), company, taste, rng),
        _ => draft.search(from, Goal::Port(part.entry), company, taste, rng),
    }
}

fn lead_out(
    draft: &mut Draft,
    part: &Part,
    future: &Part,
    company: Company,
    taste: Taste,
    rng: &mut ChaCha8Rng,
) -> Option<Vec<PieceId>> {
    let (tracks, horizon) = (draft.base, draft.base.domain.horizon);
    let open = is_open(tracks, future);
    if open && part.exit.tick >= horizon {
        return Some(vec![]);
    }
    let goal = if open { Goal::Until(horizon) } else { Goal::Port(tracks.port(future.track, future.keep_after)) };
    draft.search(part.exit, goal, company, taste, rng)
}
