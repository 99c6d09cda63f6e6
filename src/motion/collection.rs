//! A collection of captures: which files there are, which belong together, and how to import each. Read from an index
//! (`*.csv`, one row for each capture), from a folder, or from a single file.
//!
//! | column of an index | says |
//! |---|---|
//! | `file` | the capture, relative to the index; needed |
//! | `partner_file` | another row's capture, on the same clock and ground: both are one take |
//! | `take` | name; else the file's |
//! | `description` | what it shows, in words: they become labels |
//! | `preset`, `metres_per_unit`, `fps` or `fps_true`, `drop_first_frames`, `restore_thorax`, `rig` | repairs, as in take files; empty cells say nothing |
//! | `skeleton` | where it begins with the name of a preset (`cmu-daz/128 ...`), that preset |
//!
//! Other columns are left alone.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use super::presets::PRESETS;
use super::take::{ImportOptions, TakeFile, TakePerson};
use crate::{Error, Result};

/// Endings of files that are captures.
const CAPTURES: [&str; 5] = ["bvh", "amc", "fbx", "glb", "gltf"];

/// A take of a collection, with the file that speaks of it; captures are relative to that.
#[derive(Clone, Debug, PartialEq)]
pub struct Collected {
    /// The take file, the index, or the capture itself.
    pub origin: PathBuf,
    /// Its people. Where nobody annotated it, ports and patches are empty.
    pub take: TakeFile,
}

/// The takes of a take file, an index, a capture or a folder. A folder's take files come first if it has any; else its
/// `index.csv`; else every capture in it is a take. Sorted by name, but in an index's own order.
///
/// # Errors
/// A file cannot be read or is malformed (names it, and the line); nothing that is a capture.
pub fn collect(path: &Path) -> Result<Vec<Collected>> {
    if !path.is_dir() {
        return collect_file(path);
    }
    let entries = std::fs::read_dir(path).map_err(|e| Error::io(path, e))?;
    let entries = entries.map(|entry| entry.map(|e| e.path()).map_err(|e| Error::io(path, e)));
    let mut files = entries.collect::<Result<Vec<PathBuf>>>()?;
    files.sort();
    let takes: Vec<&PathBuf> = files.iter().filter(|f| is_take(f)).collect();
    let index = files.iter().filter(|f| f.file_name().is_some_and(|n| n == "index.csv"));
    let captures = files.iter().filter(|f| is_capture(f));
    let chosen: Vec<&PathBuf> = match (takes.is_empty(), index.clone().next()) {
        (false, _) => takes,
        (true, Some(_)) => index.collect(),
        (true, None) => captures.collect(),
    };
    if chosen.is_empty() {
        let expected = format!("take files (*.take.json), index.csv or captures (.{})", CAPTURES.join(", ."));
        let problem = format!("expected {expected}, found none");
        return Err(Error::invalid(path.display().to_string(), "folder", problem));
    }
    Ok(chosen.into_iter().map(|f| collect_file(f)).collect::<Result<Vec<_>>>()?.concat())
}

fn is_take(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(".take.json"))
}

fn is_capture(path: &Path) -> bool {
    path.extension().is_some_and(|e| CAPTURES.iter().any(|c| e.eq_ignore_ascii_case(c)))
}

fn collect_file(path: &Path) -> Result<Vec<Collected>> {
    std::fs::metadata(path).map_err(|e| Error::io(path, e))?;
    if is_take(path) {
        return Ok(vec![Collected { origin: path.to_owned(), take: TakeFile::load(path)? }]);
    }
    if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv")) {
        let text = std::fs::read_to_string(path).map_err(|e| Error::io(path, e))?;
        let takes = read_index(&text).map_err(|e| e.in_file(path))?;
        return Ok(takes.into_iter().map(|take| Collected { origin: path.to_owned(), take }).collect());
    }
    if !is_capture(path) {
        let expected = format!("a take file (.take.json), an index (.csv) or a capture (.{})", CAPTURES.join(", ."));
        return Err(Error::invalid(path.display().to_string(), "name", format!("expected {expected}, found another")));
    }
    let file = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    let person = TakePerson { file: file.clone(), ..Default::default() };
    Ok(vec![Collected { origin: path.to_owned(), take: bare(&stem(&file), "", vec![person]) }])
}

/// A take that nobody annotated.
fn bare(name: &str, description: &str, people: Vec<TakePerson>) -> TakeFile {
    TakeFile {
        format: "crowdquilt-take".into(),
        version: 1,
        name: name.into(),
        description: description.into(),
        people,
        plants: Vec::new(),
        contacts: Vec::new(),
        ports: Vec::new(),
        patches: Vec::new(),
        props: Vec::new(),
    }
}

fn stem(file: &str) -> String {
    Path::new(file).file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// One row of an index.
struct Row {
    line: u64,
    person: TakePerson,
    partner: String,
    name: String,
    description: String,
}

/// The takes of the text of an index, without its file's name.
///
/// # Errors
/// No `file` column; a row of another length; a cell that is not what its column says; a partner that no row or
/// another's partner is; a name twice. All name the line.
pub fn read_index(text: &str) -> Result<Vec<TakeFile>> {
    let rows = rows(text)?;
    let mut by_file: BTreeMap<&str, usize> = BTreeMap::new();
    for (i, row) in rows.iter().enumerate() {
        if let Some(before) = by_file.insert(&row.person.file, i) {
            let problem =
                format!("expected every file once, found {} on line {} as well", row.person.file, rows[before].line);
            return Err(bad(row.line, problem));
        }
    }
    let mut takes: Vec<TakeFile> = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let take = match row.partner.as_str() {
            "" => bare(&row.name, &row.description, vec![row.person.clone()]),
            partner => {
                let found = by_file.get(partner).copied().filter(|&p| rows[p].partner == row.person.file && p != i);
                let other = found.ok_or_else(|| {
                    bad(row.line, format!("expected a row of {partner} with this one as its partner, found none"))
                })?;
                if other < i {
                    continue;
                }
                let name = format!("{}-{}", row.name, rows[other].name);
                bare(&name, &row.description, vec![row.person.clone(), rows[other].person.clone()])
            }
        };
        if takes.iter().any(|t| t.name == take.name) {
            return Err(bad(row.line, format!("expected a new name, found a take {} before", take.name)));
        }
        takes.push(take);
    }
    match takes.is_empty() {
        true => Err(Error::invalid("index", "rows", "expected captures, found none")),
        false => Ok(takes),
    }
}

fn bad(line: u64, problem: String) -> Error {
    Error::invalid("index", format!("line {line}"), problem)
}

fn rows(text: &str) -> Result<Vec<Row>> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let malformed = |e: csv::Error| {
        let place = e.position().map_or("header".into(), |p| format!("line {}", p.line()));
        Error::invalid("index", place, e.to_string())
    };
    let header = reader.headers().map_err(malformed)?.clone();
    if !header.iter().any(|h| h == "file") {
        let found = header.iter().collect::<Vec<_>>().join(", ");
        return Err(Error::invalid("index", "header", format!("expected a column 'file', found {found}")));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(malformed)?;
        let line = record.position().map_or(0, csv::Position::line);
        let column =
            |name: &str| header.iter().position(|h| h == name).and_then(|i| record.get(i)).unwrap_or("").trim();
        rows.push(row(line, column)?);
    }
    Ok(rows)
}

fn row<'a>(line: u64, column: impl Fn(&str) -> &'a str) -> Result<Row> {
    let text = |name: &str| Some(column(name).to_owned()).filter(|t| !t.is_empty());
    let file = text("file").ok_or_else(|| bad(line, "expected a file, found an empty cell".into()))?;
    let fps = if column("fps").is_empty() { "fps_true" } else { "fps" };
    let import = ImportOptions {
        preset: text("preset").or_else(|| family(column("skeleton"))),
        metres_per_unit: number(line, "metres_per_unit", column("metres_per_unit"))?,
        fps: number(line, fps, column(fps))?,
        drop_first_frames: number(line, "drop_first_frames", column("drop_first_frames"))?,
        restore_thorax: number(line, "restore_thorax", column("restore_thorax"))?,
        rig: text("rig"),
        ..Default::default()
    };
    Ok(Row {
        line,
        name: text("take").unwrap_or_else(|| stem(&file)),
        partner: column("partner_file").to_owned(),
        description: column("description").to_owned(),
        person: TakePerson { file, import, ..Default::default() },
    })
}

/// The preset that a skeleton's name begins with: of `cmu-daz/128 (scaled)` it is `cmu-daz-128`.
fn family(skeleton: &str) -> Option<String> {
    let word = skeleton.split_whitespace().next()?.replace('/', "-");
    PRESETS.iter().find(|p| p.name == word).map(|p| p.name.to_owned())
}

fn number<T: FromStr>(line: u64, name: &str, cell: &str) -> Result<Option<T>> {
    if cell.is_empty() {
        return Ok(None);
    }
    let parsed = cell.parse().map_err(|_| {
        let kind = if std::any::type_name::<T>() == "bool" { "true or false" } else { "a number" };
        bad(line, format!("expected {kind} in column {name}, found '{cell}'"))
    });
    parsed.map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;

    const INDEX: &str = "file,take,partner_file,description,metres_per_unit,fps_true,drop_first_frames,skeleton,bytes\n\
        a.bvh,a,b.bvh,\"shake, hands\",0.05,60,1,cmu-daz/128 (scaled),9\n\
        b.bvh,b,a.bvh,\"shake, hands\",0.06,60,1,cmu-daz/128 (scaled),9\n\
        c.bvh,,,walk,,,,unknown,9\n";

    fn problem(text: &str) -> String {
        read_index(text).unwrap_err().to_string()
    }

    #[test]
    fn partners_are_one_take_and_empty_cells_say_nothing() {
        let takes = read_index(INDEX).unwrap();
        assert_eq!(takes.iter().map(|t| t.name.as_str()).collect::<Vec<_>>(), ["a-b", "c"]);
        let [a, b] = [&takes[0].people[0].import, &takes[0].people[1].import];
        assert_eq!(
            (a.preset.as_deref(), a.metres_per_unit, b.metres_per_unit),
            (Some("cmu-daz-128"), Some(0.05), Some(0.06))
        );
        assert_eq!((a.fps, a.drop_first_frames, takes[0].description.as_str()), (Some(60.0), Some(1), "shake, hands"));
        assert_eq!(takes[1].people[0].import, ImportOptions::default());
        assert!(takes.iter().all(|t| t.validate().is_empty()));
    }

    #[test]
    fn faults_name_their_line() {
        let broken = |from: &str, to: &str| problem(&INDEX.replacen(from, to, 1));
        assert!(broken("0.06", "six").contains("line 3: expected a number in column metres_per_unit, found 'six'"));
        assert!(broken("b.bvh,b,a.bvh", "b.bvh,b,c.bvh").contains("line 2: expected a row of b.bvh with this one"));
        assert!(broken("c.bvh,,", "a.bvh,,").contains("line 4: expected every file once"));
        assert!(broken("c.bvh,,", "c.bvh,a-b,").contains("line 4: expected a new name"));
        assert!(broken("walk,", "walk,,").contains("line 4"), "{}", broken("walk,", "walk,,"));
        assert!(broken("c.bvh", "").contains("line 4: expected a file"));
        assert!(broken("file,", "path,").contains("expected a column 'file'"));
        assert!(problem("file\n").contains("expected captures, found none"));
        assert!(problem("").contains("expected a column 'file'"));
    }
}
