//! Import of captures: tells the format, reads the file, repairs what captures get wrong.

mod format;
mod repair;

use std::path::Path;

pub use format::Format;
pub use repair::{guess_unit, repair, standing_height};

use super::retarget::rigfile::RigFile;
use super::take::ImportOptions;
use super::{Clip, asfamc, bvh, fbx, gltf};
use crate::{Error, Result};

/// Fastest rate at which animations are sampled, however fast the wish.
const FASTEST: f32 = 1000.0;

/// What a reader found in a file, in the file's own units.
pub(crate) struct Capture {
    /// The characters, each named uniquely; frame i is the same moment in all of them.
    pub clips: Vec<Clip>,
    /// Metres per unit, where the format says.
    pub metres_per_unit: Option<f32>,
}

/// Reads the one character of the capture at `path` and repairs it: metres, true frame rate, leading frames dropped,
/// thorax restored. For the formats see [`Format`].
///
/// Time 0 of the clip is the first frame kept. Where neither `metres_per_unit` nor the file says the unit, it is
/// guessed by [`guess_unit`].
///
/// # Errors
/// The file is bad (names the place), an option does not fit it (names the option), or it holds several characters
/// and `character` does not say which (names them).
pub fn load(path: &Path, options: &ImportOptions) -> Result<Clip> {
    let mut clips = load_all(path, options)?;
    if clips.len() == 1 {
        return Ok(clips.remove(0));
    }
    let expected = "expected the name of one character (or 'load_all')";
    let problem = format!("{expected}, found {}", names(&clips, path));
    Err(Error::invalid(path.display().to_string(), "import.character", problem))
}

/// Reads all characters of the capture at `path`, or the one that `character` names, and repairs each. See [`load`].
///
/// A clip is named after the file's stem; those of a file with several characters `stem.character`.
///
/// # Errors
/// As [`load`], except that several characters are welcome.
pub fn load_all(path: &Path, options: &ImportOptions) -> Result<Vec<Clip>> {
    let options = &options.resolved()?;
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    let capture = read(path, &bytes, options)?;
    finish(path, capture, options).map_err(|e| e.in_file(path))
}

/// Reads and repairs all characters of a capture whose content is `bytes`; `name` stands in for the file's name.
/// Files beside it (the ASF of an AMC, the buffers of a glTF) are not looked for.
///
/// # Errors
/// As [`load_all`].
pub fn from_bytes(name: &str, bytes: &[u8], options: &ImportOptions) -> Result<Vec<Clip>> {
    let path = Path::new(name);
    let capture = match Format::of(path, bytes)? {
        Format::Amc => Err(Error::invalid("", "format", "expected a file on disk, found AMC without its ASF")),
        format => alone(format, bytes, None, options),
    };
    capture.and_then(|capture| finish(path, capture, options)).map_err(|e| e.in_file(path))
}

fn read(path: &Path, bytes: &[u8], options: &ImportOptions) -> Result<Capture> {
    let folder = path.parent().map(|p| if p.as_os_str().is_empty() { Path::new(".") } else { p });
    match Format::of(path, bytes)? {
        // Two files: it names the one that is bad.
        Format::Amc => asfamc::load(path, bytes, options.skeleton.as_deref()),
        format => alone(format, bytes, folder, options).map_err(|e| e.in_file(path)),
    }
}

/// Reads a format that needs one file, but for buffers in the folder.
fn alone(format: Format, bytes: &[u8], folder: Option<&Path>, options: &ImportOptions) -> Result<Capture> {
    let (animation, fps) = (options.animation.as_deref(), sampled(options)?);
    match format {
        Format::Gltf => gltf::read(bytes, gltf::Source { folder, animation, fps }),
        Format::Fbx => fbx::read(bytes, animation, fps),
        Format::Bvh | Format::Amc => Ok(Capture { clips: vec![bvh::read(bytes)?], metres_per_unit: None }),
    }
}

/// The rate at which keys are sampled, if one is asked for.
fn sampled(options: &ImportOptions) -> Result<Option<f32>> {
    match options.fps.filter(|fps| !(bvh::MIN_FPS..=FASTEST).contains(fps)) {
        Some(fps) => {
            Err(Error::invalid("", "import.fps", format!("expected {} to {FASTEST}, found {fps}", bvh::MIN_FPS)))
        }
        None => Ok(options.fps),
    }
}

/// Names, picks and repairs.
fn finish(path: &Path, capture: Capture, options: &ImportOptions) -> Result<Vec<Clip>> {
    let Capture { mut clips, metres_per_unit } = capture;
    let several = clips.len() > 1;
    if let Some(wanted) = options.character.as_ref().filter(|_| several) {
        let known = names(&clips, path);
        clips.retain(|clip| &clip.name == wanted);
        if clips.is_empty() {
            return Err(Error::invalid("", "import.character", format!("expected one of {known}, found '{wanted}'")));
        }
    }
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    for clip in &mut clips {
        if let Some(name) = &options.rig {
            RigFile::find(name, path)?.apply(&mut clip.skeleton)?;
        }
        clip.name = if several { format!("{stem}.{}", clip.name) } else { stem.to_string() };
    }
    clips.into_iter().map(|clip| repair(clip, &with_unit(options, metres_per_unit))).collect()
}

fn with_unit(options: &ImportOptions, of_file: Option<f32>) -> ImportOptions {
    ImportOptions { metres_per_unit: options.metres_per_unit.or(of_file), ..options.clone() }
}

/// The characters' names for a message.
fn names(clips: &[Clip], path: &Path) -> String {
    const SHOWN: usize = 12;
    let prefix = format!("{}.", path.file_stem().unwrap_or_default().to_string_lossy());
    let short = |clip: &Clip| clip.name.strip_prefix(&prefix).unwrap_or(&clip.name).to_owned();
    let shown: Vec<String> = clips.iter().take(SHOWN).map(|clip| format!("'{}'", short(clip))).collect();
    let more = if clips.len() > SHOWN { format!(" and {} more", clips.len() - SHOWN) } else { String::new() };
    format!("{}{more}", shown.join(", "))
}
