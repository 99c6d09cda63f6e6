//! An AMC file with the ASF file beside it.

use std::path::{Path, PathBuf};

use super::{amc, asf};
use crate::motion::import::Capture;
use crate::{Error, Result};

/// Reads the AMC file at `path`, whose content is `bytes`, with its skeleton: the ASF file called `skeleton` (relative
/// to `path`'s folder), else the one beside it with the same stem or the stem up to the last underscore (`02_01.amc`:
/// `02.asf`), else the only one in the folder.
///
/// # Errors
/// No skeleton, or one of the two files is bad (named, with the line).
pub(crate) fn load(path: &Path, bytes: &[u8], skeleton: Option<&str>) -> Result<Capture> {
    let asf = match skeleton {
        Some(name) => folder(path).join(name),
        None => find(path)?,
    };
    let text = std::fs::read(&asf).map_err(|e| Error::io(&asf, e))?;
    let figure = asf::read(&text).map_err(|e| e.in_file(&asf))?;
    let clip = amc::read(&figure, bytes).map_err(|e| e.in_file(path))?;
    Ok(Capture { clips: vec![clip], metres_per_unit: figure.metres_per_unit })
}

fn folder(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

fn find(path: &Path) -> Result<PathBuf> {
    let folder = folder(path);
    let entries = std::fs::read_dir(folder).map_err(|e| Error::io(folder, e))?;
    let is_asf = |p: &PathBuf| p.extension().is_some_and(|e| e.eq_ignore_ascii_case("asf"));
    let mut found: Vec<PathBuf> = entries.filter_map(|e| Some(e.ok()?.path())).filter(is_asf).collect();
    found.sort();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let subject = stem.rsplit_once('_').map_or(stem.as_str(), |(subject, _)| subject);
    let named = |name: &str| found.iter().find(|p| p.file_stem().is_some_and(|s| s.eq_ignore_ascii_case(name)));
    if let Some(asf) = named(&stem).or_else(|| named(subject)).or(found.first().filter(|_| found.len() == 1)) {
        return Ok(asf.clone());
    }
    let expected = format!("expected the skeleton {subject}.asf beside it, or a single .asf file, or its name here");
    let problem = format!("{expected}; found {} .asf files in {}", found.len(), folder.display());
    Err(Error::invalid(path.display().to_string(), "import.skeleton", problem))
}
