//! Writes the take files of `examples/cmu` from a small table of what happens when in some captures of CMU's database:
//! rough times by hand, exact boundaries by [`crowdquilt::patch::boundary`], contacts by detection.
//!
//! `cargo run --release --example annotate_cmu -- MOCAP_FOLDER [OUT_FOLDER]`; the mocap folder holds `index.csv`
//! (one row per capture: file, take, repairs) and the files it names. No motion data is written.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crowdquilt::motion::gait::Phase;
use crowdquilt::motion::take::{ImportOptions, TakeFile, TakePatch, TakePerson, TakePort, TakeRole};
use crowdquilt::motion::{FPS, Motion, contacts, import, retarget};
use crowdquilt::patch::boundary::{self, Boundary, Exemplar};
use crowdquilt::{Error, Result};

/// One patch: label, rough first and last frame (30 fps, after the dropped frames) of every person.
type Row = (&'static str, &'static [(usize, usize)]);

/// What is cut from which captures. Labels become names, numbered within the take.
const TAKES: &[(&[&str], &[Row])] = &[
    (&["02_01"], &[("walk", &[(11, 44)]), ("walk", &[(44, 61)])]),
    (&["02_04"], &[("jump", &[(0, 74)]), ("idle", &[(87, 120)])]),
    (&["07_01"], &[("walk", &[(25, 57)])]),
    (&["07_04"], &[("walk", &[(4, 49)])]),
    (
        &["09_12"],
        &[
            ("turn", &[(28, 62)]),
            ("turn", &[(62, 95)]),
            ("turn", &[(78, 111)]),
            ("turn", &[(111, 129)]),
            ("turn", &[(111, 146)]),
            ("turn", &[(129, 164)]),
        ],
    ),
    (&["10_04"], &[("idle", &[(0, 20)]), ("start", &[(20, 49)]), ("walk", &[(86, 102)]), ("walk", &[(102, 135)])]),
    (&["12_02"], &[("walk", &[(18, 58)]), ("walk", &[(38, 58)])]),
    (&["13_11"], &[("idle", &[(0, 27)]), ("jump", &[(27, 101)])]),
    (&["16_11"], &[("turn", &[(40, 74)]), ("turn", &[(55, 74)])]),
    (&["16_15"], &[("walk", &[(9, 27)]), ("walk", &[(27, 61)])]),
    (&["16_47"], &[("walk", &[(8, 42)])]),
    (
        &["26_01"],
        &[
            ("start", &[(0, 31)]),
            ("stop", &[(51, 72)]),
            ("turn-around", &[(72, 129)]),
            ("start", &[(129, 155)]),
            ("walk", &[(155, 175)]),
            ("stop", &[(194, 208)]),
        ],
    ),
    (
        &["29_01"],
        &[
            ("idle", &[(0, 28)]),
            ("start", &[(28, 54)]),
            ("stop", &[(99, 178)]),
            ("turn", &[(178, 202)]),
            ("start", &[(202, 235)]),
            ("walk", &[(235, 260)]),
        ],
    ),
    (&["32_02"], &[("start", &[(0, 32)]), ("turn", &[(49, 84)])]),
    (&["35_09"], &[("walk", &[(25, 58)])]),
    (&["35_29"], &[("walk", &[(19, 59)])]),
    (&["49_02"], &[("idle", &[(0, 29)])]),
    (&["49_06"], &[("cartwheel", &[(22, 115)])]),
    (&["131_03"], &[("idle", &[(0, 30)])]),
    (&["18_01", "19_01"], &[("handshake", &[(8, 67), (12, 60)])]),
    (&["60_03", "61_03"], &[("salsa", &[(73, 257), (61, 256)]), ("salsa", &[(73, 149), (61, 106)])]),
    (&["60_05", "61_05"], &[("salsa", &[(67, 216), (78, 219)]), ("salsa", &[(107, 216), (108, 219)])]),
];

/// Frames around a rough one among which the nearest pose is looked for.
const SEARCH: usize = 4;

/// Seconds of a patch of two or more that may bend at either end: the core is what lies between.
const LEG: f32 = 0.5;

fn main() -> Result<()> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let mocap = arguments.next().unwrap_or_else(|| "../shared/mocap".into());
    let out = arguments.next().unwrap_or_else(|| "examples/cmu".into());
    let index = Index::read(&mocap.join("index.csv"))?;
    let mut loaded = Vec::new();
    for (takes, _) in TAKES {
        loaded.push(index.motions(&mocap, takes)?);
    }
    let alone: Vec<Motion> = loaded.iter().filter(|m| m.len() == 1).flatten().cloned().collect();
    let exemplars = boundary::exemplars(&alone);
    for ((takes, rows), motions) in TAKES.iter().zip(&loaded) {
        let take = annotate(takes, rows, motions, &exemplars, &index);
        let path = out.join(format!("{}.take.json", take.name));
        let json = serde_json::to_string_pretty(&take).expect("plain data");
        std::fs::write(&path, json + "\n").map_err(|e| Error::io(&path, e))?;
        let kinds: Vec<&str> = take.patches.iter().map(|p| p.name.as_str()).collect();
        println!("{}: {}", path.display(), kinds.join(", "));
    }
    Ok(())
}

fn annotate(takes: &[&str], rows: &[Row], motions: &[Motion], exemplars: &[Exemplar], index: &Index) -> TakeFile {
    let name = takes.join("-");
    let mut ports: BTreeMap<(usize, usize), Boundary> = BTreeMap::new();
    let mut patches: Vec<TakePatch> = Vec::new();
    for (label, people) in rows {
        // Dancers' steps in hold are no walk, however near to mid-stance: dances begin and end standing.
        let standing: Vec<Exemplar> = exemplars.iter().filter(|e| e.phase == Phase::Stand).cloned().collect();
        let groups = if *label == "salsa" { &standing } else { exemplars };
        let mut roles = Vec::new();
        for (person, &(begin, end)) in people.iter().enumerate() {
            let mut port = |near: usize| {
                let frames = near.saturating_sub(SEARCH)..=near + SEARCH;
                let found = boundary::nearest(&motions[person], frames, groups).expect("captures have frames");
                ports.insert((person, found.frame), found);
                seconds(found.frame)
            };
            roles.push(TakeRole { person, begin: port(begin), end: port(end) });
        }
        let number = patches.iter().filter(|p| p.labels[0] == *label).count() + 1;
        patches.push(TakePatch {
            name: format!("{label}-{name}-{number}"),
            labels: vec![label.to_string()],
            core: (roles.len() > 1).then(|| core(&roles)),
            roles,
        });
    }
    for ((person, _), port) in &ports {
        println!("  {name} person {person}: {:?} at {}, {:.3} m", port.phase, port.frame, port.distance);
    }
    let port = |(&(person, frame), b): (&(usize, usize), &Boundary)| TakePort {
        person,
        time: seconds(frame),
        pose: b.phase.group().into(),
    };
    let mut touches = contacts::detect(motions, &contacts::ContactOptions::default());
    for contact in &mut touches {
        (contact.begin, contact.end) = (millis(contact.begin), millis(contact.end));
    }
    TakeFile {
        format: "crowdquilt-take".into(),
        version: 1,
        description: String::new(),
        people: takes.iter().map(|take| index.rows[*take].clone()).collect(),
        name,
        plants: Vec::new(),
        contacts: touches,
        ports: ports.iter().map(port).collect(),
        patches,
        props: Vec::new(),
    }
}

/// The time all people share, less the legs.
fn core(roles: &[TakeRole]) -> [f32; 2] {
    let begin = roles.iter().map(|r| r.begin).fold(0.0, f32::max);
    let end = roles.iter().map(|r| r.end).fold(f32::INFINITY, f32::min);
    let leg = LEG.min((end - begin) / 4.0);
    [millis(begin + leg), millis(end - leg)]
}

fn seconds(frame: usize) -> f32 {
    millis(frame as f32 / FPS)
}

fn millis(seconds: f32) -> f32 {
    (seconds * 1000.0).round() / 1000.0
}

/// The captures by their take's name.
struct Index {
    rows: BTreeMap<String, TakePerson>,
}

impl Index {
    fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        let mut lines = text.lines().map(cells);
        let header = lines.next().unwrap_or_default();
        let mut rows = BTreeMap::new();
        for row in lines {
            let cell = |name: &str| header.iter().position(|h| h == name).and_then(|i| row.get(i)).cloned();
            let text = |name: &str| cell(name).unwrap_or_default();
            let import = ImportOptions {
                metres_per_unit: text("metres_per_unit").parse().ok(),
                fps: text("fps_true").parse().ok(),
                drop_first_frames: text("drop_first_frames").parse().ok(),
                restore_thorax: Some(["cmu-mb", "cmu-max"].iter().any(|family| text("skeleton").starts_with(family))),
                ..Default::default()
            };
            rows.insert(text("take"), TakePerson { file: text("file"), import, ..Default::default() });
        }
        Ok(Self { rows })
    }

    fn motions(&self, mocap: &Path, takes: &[&str]) -> Result<Vec<Motion>> {
        let clip = |take: &&str| {
            let person = self.rows.get(*take).ok_or_else(|| Error::invalid("index.csv", *take, "expected a row"))?;
            import::load(&mocap.join(&person.file), &person.import)
        };
        retarget::take(&takes.iter().map(clip).collect::<Result<Vec<_>>>()?)
    }
}

/// The cells of a line of comma-separated values with optional double quotes.
fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().expect("never empty").push(c),
        }
    }
    cells
}
