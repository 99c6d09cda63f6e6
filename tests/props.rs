//! Boxes: taken up, carried, passed and put down in a crowd made by hand of the sample patches; one fault per test.

use std::path::Path;
use std::sync::LazyLock;

use crowdquilt::check::{check, summary};
use crowdquilt::geom::{Cuboid, Ground, Polygon, Upright};
use crowdquilt::motion::{Build, FPS, joint};
use crowdquilt::patch::{PatchKind, PatchSet, cut_folder};
use crowdquilt::refine::refine_crowd;
use crowdquilt::samples;
use crowdquilt::stage::{Character, Crowd, DomainInfo, FragmentUse, Holding, Instance};
use glam::{Vec2, Vec3};

static SET: LazyLock<PatchSet> = LazyLock::new(|| {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("prop-takes");
    samples::write(&folder, 1).unwrap();
    cut_folder(&folder, None).unwrap()
});

/// One comes with a box from where it lay and hands it on, the other puts it down.
static CROWD: LazyLock<Crowd> = LazyLock::new(|| hand_over(0));

const GIVER: usize = 0;
const TAKER: usize = 1;
const STANDER: usize = 2;

fn kind(name: &str) -> (u32, &'static PatchKind) {
    let index = SET.kinds.iter().position(|k| k.name == name).unwrap_or_else(|| panic!("no kind {name}"));
    (index as u32, &SET.kinds[index])
}

struct Builder {
    instances: Vec<Instance>,
}

impl Builder {
    fn instance(&mut self, kind: u32) -> u32 {
        self.instances.push(Instance { kind });
        self.instances.len() as u32 - 1
    }

    /// A role placed so that the patch's frame is at `world_from_patch`.
    fn place(&self, kind: &PatchKind, instance: u32, role: u32, world_from_patch: Ground, begin: i32) -> FragmentUse {
        let path = &kind.fragments[role as usize].motion.path;
        FragmentUse {
            instance,
            role,
            begin,
            end: begin + path.len() as i32 - 1,
            points: path.points.iter().map(|&p| world_from_patch.apply(p)).collect(),
            headings: path.headings.iter().map(|h| h + world_from_patch.heading).collect(),
        }
    }

    /// People alone before and after a fragment.
    fn chain(&mut self, before: &[&str], middle: FragmentUse, after: &[&str]) -> Vec<FragmentUse> {
        let ends = |f: &FragmentUse| {
            let at = |i: usize| Ground::new(f.points[i], f.headings[i]);
            [at(0), at(f.points.len() - 1)]
        };
        let mut chain = vec![middle];
        for name in before.iter().rev() {
            let (index, kind) = kind(name);
            let path = &kind.fragments[0].motion.path;
            let world = ends(&chain[0])[0].then(path.at(path.len() - 1).inverse());
            let (begin, instance) = (chain[0].begin - path.len() as i32 + 1, self.instance(index));
            chain.insert(0, self.place(kind, instance, 0, world, begin));
        }
        for name in after {
            let (index, kind) = kind(name);
            let last = chain.last().unwrap();
            let world = ends(last)[1].then(kind.fragments[0].motion.path.at(0).inverse());
            let (begin, instance) = (last.end, self.instance(index));
            chain.push(self.place(kind, instance, 0, world, begin));
        }
        chain
    }
}

/// The crowd, everybody of a build `tone` steps from the canonical one.
fn hand_over(tone: usize) -> Crowd {
    let mut b = Builder { instances: vec![] };
    let (index, pass) = kind("pass-box-stand");
    let instance = b.instance(index);
    let begin = kind("take-up").1.fragments[0].motion.len() as i32 + 35;
    let role = |b: &Builder, r: u32| {
        b.place(pass, instance, r, Ground::IDENTITY, begin + pass.fragments[r as usize].begin as i32)
    };
    let (giver, taker) = (role(&b, 0), role(&b, 1));
    let idle = ["idle-1.5"; 4];
    let chains =
        [b.chain(&["take-up", "carry-idle"], giver, &idle), b.chain(&idle, taker, &["carry-pivot-90", "put-down"])];
    let last = chains.iter().map(|c| c.last().unwrap().end).min().unwrap();
    let (stand, idle) = kind("idle-2.5");
    let instance = b.instance(stand);
    let far = b.place(idle, instance, 0, Ground::new(Vec2::new(3.0, 0.0), 0.0), -1);
    let alone = b.chain(&[], far, &["idle-2.5"; 4]);
    let builds = Build::catalogue();
    let person = |(i, fragments): (usize, Vec<FragmentUse>)| Character {
        begin: 0,
        build: if tone == 0 { Build::canonical() } else { builds[(i + tone) % builds.len()][1].clone() },
        team: None,
        fragments,
        root: vec![],
        rotations: vec![],
    };
    let domain = DomainInfo {
        region: Polygon::rectangle(Vec2::splat(-6.0), Vec2::splat(6.0)),
        obstacles: vec![],
        sources: vec![],
        sinks: vec![],
        last_frame: last as u32,
        periodic: Default::default(),
        teams: vec![],
    };
    let chains = chains.into_iter().chain([alone]).enumerate();
    let characters = chains.map(person).collect();
    let crowd = Crowd { seed: 1, domain, set: SET.clone(), instances: b.instances, characters, props: vec![] };
    refine_crowd(&crowd)
}

#[test]
fn a_box_is_taken_up_carried_passed_and_put_down() {
    let crowd = &*CROWD;
    let [prop] = &crowd.props[..] else { panic!("one box, found {}", crowd.props.len()) };
    let holders: Vec<u32> = prop.holds.iter().map(|h| h.character).collect();
    assert_eq!(holders, [GIVER as u32, TAKER as u32]);
    assert_eq!((prop.begin, prop.end()), (0, crowd.domain.last_frame));
    let (first, second) = (prop.holds[0], prop.holds[1]);
    assert!(first.begin > 20 && second.begin < first.end && second.end < prop.end() - 20, "{:?}", prop.holds);
    // It lies on the ground, is carried before the belly, and lies on the ground again, elsewhere.
    let height = |frame: u32| prop.at_frame(frame).unwrap().at.middle.y;
    assert_eq!((height(0), height(prop.end())), (0.5 * prop.size[1], 0.5 * prop.size[1]));
    assert!((0.9..1.25).contains(&height(first.begin + 60)), "{}", height(first.begin + 60));
    assert!(prop.places[0].middle.distance(prop.places.last().unwrap().middle) > 0.5);
    let speeds = prop.places.windows(2).map(|w| w[0].middle.distance(w[1].middle) * FPS);
    assert!(speeds.fold(0.0, f32::max) < 2.0);
    let report = check(crowd);
    assert!(report.ok(), "{report}");
    assert_eq!(report.rows.iter().filter(|r| r.row.contains("box")).count(), 8, "{report}");
    assert_eq!(summary(crowd).props, 1);
}

#[test]
fn hands_stay_on_the_box_whatever_the_build() {
    for tone in 0..Build::catalogue().len() {
        let crowd = hand_over(tone);
        let report = check(&crowd);
        let palms = report.rows.iter().find(|r| r.row.contains("palm")).unwrap();
        assert!(palms.value < 0.016, "builds from {tone}: {report}");
        assert_eq!(crowd.props, CROWD.props, "boxes do not depend on builds");
    }
}

#[test]
fn a_crowd_of_boxes_comes_back_from_its_file_and_from_its_fragments() {
    let bytes = CROWD.to_bytes();
    let read = Crowd::from_bytes(&bytes).unwrap();
    assert_eq!(read, *CROWD);
    assert_eq!(read.to_bytes(), bytes);
    assert_eq!(refine_crowd(&read), *CROWD);
    let (i, place) = CROWD.props_at(2.0).next().unwrap();
    assert_eq!((i, place), (0, CROWD.props[0].places[60]));
}

/// Breaks the valid crowd with `fault` and expects exactly the rows whose names contain `expected` to fail.
fn fails(fault: impl FnOnce(&mut Crowd), expected: &[&str]) {
    let mut broken = CROWD.clone();
    fault(&mut broken);
    let report = check(&broken);
    let failed: Vec<&str> = report.failures().map(|r| r.row.as_str()).collect();
    let as_expected = failed.len() == expected.len() && failed.iter().zip(expected).all(|(f, e)| f.contains(e));
    assert!(as_expected, "expected {expected:?} to fail\n{report}");
    assert!(report.failures().all(|r| !r.place.is_empty()), "{report}");
}

/// A frame in the middle of the first hold.
fn carried() -> usize {
    CROWD.props[0].holds[0].begin as usize + 40
}

#[test]
fn a_box_that_slips_out_of_the_hands() {
    let slip = |c: &mut Crowd| {
        let at = carried();
        for (i, p) in c.props[0].places[at - 20..at + 20].iter_mut().enumerate() {
            p.middle.y -= 0.25 * (i as f32 / 20.0).min(2.0 - i as f32 / 20.0);
        }
    };
    fails(slip, &["palm off"]);
}

#[test]
fn a_box_that_jumps() {
    fails(|c| c.props[0].places[carried()].middle.x += 0.5, &["moves faster", "palm off"]);
}

#[test]
fn a_box_let_go_in_the_air() {
    let let_go = |c: &mut Crowd| {
        let hold = c.props[0].holds[0];
        let at = carried() as u32;
        let later = Holding { begin: at + 5, ..hold };
        c.props[0].holds[0].end = at - 5;
        c.props[0].holds.insert(1, later);
    };
    fails(let_go, &["held by nobody"]);
}

#[test]
fn a_box_in_the_hands_of_a_stranger() {
    let steal = |c: &mut Crowd| {
        let at = c.props[0].holds[1].end;
        c.props[0].holds.push(Holding { character: STANDER as u32, begin: at + 2, end: at + 10 });
    };
    fails(steal, &["palm off", "held by nobody"]);
}

#[test]
fn a_box_that_is_gone() {
    fails(|c| c.props.clear(), &["held by nobody"]);
    let vanish = |c: &mut Crowd| {
        let end = c.props[0].holds[1].end as usize + 5;
        c.props[0].places.truncate(end);
    };
    fails(vanish, &["held by nobody"]);
}

#[test]
fn a_box_of_another_size() {
    fails(|c| c.props[0].size[0] += 0.012, &["held by nobody"]);
}

#[test]
fn a_box_in_a_stranger() {
    let walk_in = |c: &mut Crowd| {
        // Somebody stands where the box lies at the end.
        let to = c.props[0].places.last().unwrap().middle - c.characters[STANDER].root[0];
        let by = Vec3::new(to.x, 0.0, to.z);
        c.characters[STANDER].root.iter_mut().for_each(|p| *p += by);
        let points = c.characters[STANDER].fragments.iter_mut().flat_map(|f| &mut f.points);
        points.for_each(|p| *p += Vec2::new(by.x, by.z));
    };
    let mut broken = CROWD.clone();
    walk_in(&mut broken);
    let report = check(&broken);
    assert!(report.failures().any(|r| r.row.contains("box inside a body")), "{report}");
}

#[test]
fn boxes_in_each_other() {
    let twin = |c: &mut Crowd| {
        let mut other = c.props[0].clone();
        let at = Upright { middle: other.places[0].middle + Vec3::new(0.1, 0.0, 0.1), heading: 0.3 };
        other.places.iter_mut().for_each(|p| *p = at);
        other.holds.clear();
        c.props.push(other);
    };
    // Whoever takes up the one takes it out of the other.
    let mut broken = CROWD.clone();
    twin(&mut broken);
    let report = check(&broken);
    assert!(report.failures().any(|r| r.row == "boxes overlap"), "{report}");
}

#[test]
fn a_box_in_a_wall_and_one_in_the_floor() {
    let wall = |c: &mut Crowd| {
        let at = c.props[0].places.last().unwrap().middle;
        let corner = Vec2::new(at.x + 0.12, at.z - 0.01);
        c.domain.obstacles.push(Polygon::rectangle(corner, corner + Vec2::new(0.02, 0.02)).into());
    };
    let mut broken = CROWD.clone();
    wall(&mut broken);
    let report = check(&broken);
    // Who puts it down leans over the wall, too.
    assert!(report.failures().any(|r| r.row == "boxes outside the region or in obstacles"), "{report}");
    fails(
        |c| c.props[0].places[0..5].iter_mut().for_each(|p| p.middle.y -= 0.02),
        &["held by nobody", "below the floor"],
    );
}

#[test]
fn references_to_nothing_are_a_failed_row_and_no_panic() {
    fails(|c| c.props[0].holds[0].character = 9, &["references"]);
    fails(|c| c.props[0].holds[0].end = 9999, &["references"]);
    fails(|c| c.props[0].places.clear(), &["references"]);
    fails(|c| c.props[0].places[3].heading = f32::NAN, &["references"]);
    fails(|c| c.props[0].size[1] = 0.0, &["references"]);
    fails(|c| c.set.kinds.iter_mut().for_each(|k| k.props.iter_mut().for_each(|p| p.holds.clear())), &["references"]);
}

fn problems(fault: impl FnOnce(&mut PatchSet)) -> String {
    let mut set = SET.clone();
    fault(&mut set);
    set.validate().iter().map(|e| format!("{e}\n")).collect()
}

fn of<'a>(set: &'a mut PatchSet, name: &str) -> &'a mut PatchKind {
    set.kinds.iter_mut().find(|k| k.name == name).unwrap()
}

#[test]
fn sets_whose_boxes_make_no_sense_are_refused() {
    assert_eq!(problems(|_| ()), "");
    let said = |fault: fn(&mut PatchSet), words: &[&str]| {
        let found = problems(fault);
        assert!(words.iter().all(|w| found.contains(w)), "expected {words:?}, found {found}");
    };
    said(|s| of(s, "carry-stop").props.clear(), &["kind carry-stop", "pose group carry_stand", "found empty hands"]);
    said(|s| of(s, "carry-stop").props[0].size[0] += 0.1, &["carry-stop", "pose group carry_stand", "0.46"]);
    said(|s| of(s, "take-up").props[0].before = None, &["take-up", "role 0 neither brings it along nor takes it up"]);
    said(|s| of(s, "put-down").props[0].holds[0].end = 9999, &["put-down", "outside its fragment"]);
    said(|s| of(s, "put-down").props[0].size[2] = f32::NAN, &["put-down", "expected extents above 0"]);
    said(|s| of(s, "pass-box-stand").props[0].holds.reverse(), &["pass-box-stand", "does not take it over"]);
    let twice = |s: &mut PatchSet| {
        let kind = of(s, "carry-idle");
        let again = kind.props[0].clone();
        kind.props.push(again);
    };
    said(twice, &["carry-idle", "box and box in the same hands"]);
}

#[test]
fn mirrored_boxes_are_the_mirrored_places() {
    let (original, twin) = (kind("pass-box-walk").1, kind("pass-box-walk-mirror").1);
    let last = original.props[0].holds.last().unwrap().end;
    for clock in (original.props[0].holds[0].begin..=last).step_by(7) {
        let (a, b) = (original.props[0].place(original, clock).unwrap(), twin.props[0].place(twin, clock).unwrap());
        assert!((a.middle * Vec3::new(-1.0, 1.0, 1.0)).distance(b.middle) < 1e-3, "{clock}: {a:?} {b:?}");
        let corners = |at: Upright| Cuboid::new(at, original.props[0].size).plan();
        let far = |p: Vec2| corners(b).iter().map(|q| q.distance(Vec2::new(-p.x, p.y))).fold(f32::MAX, f32::min);
        assert!(corners(a).into_iter().all(|p| far(p) < 1e-3));
    }
}

#[test]
fn files_of_every_version_are_read() {
    let folder = Path::new("tests/files");
    let set = PatchSet::load(&folder.join("v1.patches")).unwrap();
    assert_eq!((set.kinds.len(), set.kinds[0].props.len()), (2, 0));
    let crowd = Crowd::load(&folder.join("v1.crowd")).unwrap();
    assert_eq!((crowd.characters.len(), crowd.props.len()), (1, 0));
    assert!(check(&crowd).ok(), "{}", check(&crowd));
    for (bytes, magic, newest) in [(set.to_bytes(), "CQPATCH", 2), (crowd.to_bytes(), "CQCROWD", 4)] {
        let mut newer = bytes.clone();
        newer[8] = 9;
        let error = match magic {
            "CQPATCH" => PatchSet::from_bytes(&newer).unwrap_err().to_string(),
            _ => Crowd::from_bytes(&newer).unwrap_err().to_string(),
        };
        assert!(error.contains(&format!("expected version 1 to {newest}, found 9")), "{error}");
    }
}

#[test]
fn the_head_of_who_carries_is_clear_of_the_box() {
    let prop = &CROWD.props[0];
    let giver = &CROWD.characters[GIVER];
    let mut globals = Vec::new();
    for frame in prop.holds[0].begin..prop.holds[0].end {
        giver.globals((frame - giver.begin) as usize, &mut globals);
        let from_box = prop.at_frame(frame).unwrap().at.seen_from(globals[joint::HEAD].0);
        assert!(from_box.y > 0.2 || from_box.z.abs() > 0.3, "frame {frame}: {from_box}");
    }
}

#[test]
fn boxes_are_in_the_glb() {
    let bytes = crowdquilt::export::glb(&CROWD);
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("boxes.glb"), &bytes).unwrap();
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).unwrap();
    let nodes = json["nodes"].as_array().unwrap();
    let node = nodes.iter().position(|n| n["name"] == "box_0").expect("a node of the box");
    assert!(nodes[node]["mesh"].is_number() && nodes[node]["extras"]["box"] == 0);
    assert!(json["scenes"][0]["nodes"].as_array().unwrap().contains(&node.into()));
    let channels = json["animations"][0]["channels"].as_array().unwrap();
    let moved: Vec<&str> = channels
        .iter()
        .filter(|c| c["target"]["node"] == node)
        .map(|c| c["target"]["path"].as_str().unwrap())
        .collect();
    assert_eq!(moved, ["translation", "rotation"]);
    // While it lies still it needs no keys.
    let sampler = channels.iter().find(|c| c["target"]["node"] == node).unwrap()["sampler"].as_u64().unwrap() as usize;
    let input = json["animations"][0]["samplers"][sampler]["input"].as_u64().unwrap() as usize;
    let keys = json["accessors"][input]["count"].as_u64().unwrap() as usize;
    let still = CROWD.props[0].places.windows(2).filter(|w| w[0] == w[1]).count();
    assert!(still > 20 && keys <= CROWD.props[0].places.len() - still + 4, "{keys} keys, {still} still frames");
}

#[test]
fn crowd_files_with_broken_boxes_are_refused() {
    let bytes = CROWD.to_bytes();
    let refused = |from: &str, to: &str, says: &str| {
        assert_eq!(from.len(), to.len());
        let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).unwrap_or_else(|| panic!("no {from}"));
        let mut broken = bytes.clone();
        broken[at..at + to.len()].copy_from_slice(to.as_bytes());
        let error = Crowd::from_bytes(&broken).unwrap_err().to_string();
        assert!(error.contains(says), "{error}");
    };
    refused("\"prop_places\"", "\"prop_placez\"", "array prop_places: expected, not found");
    refused("\"character\":1", "\"character\":7", "prop 0: expected a holder below 3, found 7");
    let frames = format!("\"frames\":{},\"holds\"", CROWD.props[0].places.len());
    refused(&frames, &frames.replace(":3", ":9"), "prop 0: its frames reach beyond the arrays");
    refused("\"size\":[", "\"size\":\"", "expected");
}
