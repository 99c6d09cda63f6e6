//! The folder of real captures and its index: `../shared/mocap`, or what `CROWDQUILT_MOCAP` says.
#![allow(dead_code)]

use std::path::{Path, PathBuf};

use crowdquilt::motion::take::ImportOptions;

/// The folder of captures, if it is there.
pub fn folder() -> Option<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = std::env::var_os("CROWDQUILT_MOCAP").map_or_else(|| root.join("../shared/mocap"), PathBuf::from);
    if folder.join("index.csv").is_file() {
        return Some(folder);
    }
    eprintln!("skipped: no captures at {} (set CROWDQUILT_MOCAP to a folder with index.csv)", folder.display());
    None
}

/// One row of the index.
pub struct Row {
    pub take: String,
    pub file: PathBuf,
    pub frames: usize,
    pub import: ImportOptions,
    /// The preset for files of its family.
    pub preset: &'static str,
}

pub fn rows(folder: &Path) -> Vec<Row> {
    let text = std::fs::read_to_string(folder.join("index.csv")).unwrap();
    let mut lines = text.lines().map(cells);
    let header = lines.next().unwrap();
    let column = |name: &str| header.iter().position(|h| h == name).unwrap();
    let rows = lines.map(|row| Row {
        take: row[column("take")].clone(),
        file: folder.join(&row[column("file")]),
        frames: row[column("frames")].parse().unwrap(),
        import: ImportOptions {
            metres_per_unit: row[column("metres_per_unit")].parse().ok(),
            fps: row[column("fps_true")].parse().ok(),
            drop_first_frames: row[column("drop_first_frames")].parse().ok(),
            restore_thorax: Some(["cmu-mb", "cmu-max"].iter().any(|f| row[column("skeleton")].starts_with(f))),
            ..Default::default()
        },
        preset: preset(&row[column("skeleton")]),
    });
    rows.collect()
}

fn cells(line: &str) -> Vec<String> {
    let (mut cells, mut quoted) = (vec![String::new()], false);
    for c in line.chars() {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted => cells.push(String::new()),
            c => cells.last_mut().unwrap().push(c),
        }
    }
    cells
}

fn preset(skeleton: &str) -> &'static str {
    let known = ["cmu-daz/128", "cmu-daz", "cmu-max", "cmu-mb"];
    match known.into_iter().find(|name| skeleton.starts_with(name)) {
        Some("cmu-daz/128") => "cmu-daz-128",
        Some(name) => name,
        None => panic!("a family without a preset: {skeleton}"),
    }
}
