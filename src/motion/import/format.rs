//! Which format a capture's file is in: by its content, else by its extension.

use std::path::Path;

use crate::{Error, Result};

/// The formats of captures that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Biovision hierarchy: one character, no units.
    Bvh,
    /// Acclaim motion (AMC); its skeleton is the ASF file beside it. One character.
    Amc,
    /// Autodesk FBX, binary or text, with any number of characters.
    Fbx,
    /// glTF 2.0, text (`.gltf`) or binary (`.glb`), with any number of characters.
    Gltf,
}

/// How far into a file the words are looked for that tell its format.
const LOOK: usize = 4096;

impl Format {
    /// The format of a file with this name and content.
    ///
    /// # Errors
    /// None that is read; the message lists those that are.
    pub fn of(path: &Path, bytes: &[u8]) -> Result<Self> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
        let known = match extension.as_str() {
            "bvh" => Some(Self::Bvh),
            "amc" => Some(Self::Amc),
            "fbx" => Some(Self::Fbx),
            "gltf" | "glb" => Some(Self::Gltf),
            _ => None,
        };
        let found = Self::of_content(bytes).or(known);
        found.ok_or_else(|| {
            let read =
                "expected a capture: BVH (.bvh), AMC with its ASF beside it (.amc), FBX (.fbx), glTF (.gltf, .glb)";
            let found = match extension.as_str() {
                "asf" => "the skeleton of AMC files (.asf): name the .amc file".to_owned(),
                "" => "none of them, and no extension".to_owned(),
                other => format!("none of them (.{other})"),
            };
            Error::invalid(path.display().to_string(), "format", format!("{read}; found {found}"))
        })
    }

    fn of_content(bytes: &[u8]) -> Option<Self> {
        let head = String::from_utf8_lossy(&bytes[..bytes.len().min(LOOK)]);
        let head = head.trim_start_matches('\u{feff}').trim_start();
        let starts = |word: &str| head.get(..word.len()).is_some_and(|h| h.eq_ignore_ascii_case(word));
        let line = |word: &str| head.lines().any(|l| l.trim().eq_ignore_ascii_case(word));
        if bytes.starts_with(b"glTF") || (starts("{") && head.contains('"')) {
            Some(Self::Gltf)
        } else if starts("Kaydara FBX") || starts("; FBX") || line("FBXHeaderExtension:  {") {
            Some(Self::Fbx)
        } else if starts("HIERARCHY") {
            Some(Self::Bvh)
        } else if line(":FULLY-SPECIFIED") || line(":DEGREES") || line(":RADIANS") {
            Some(Self::Amc)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str, content: &str) -> Result<Format> {
        Format::of(Path::new(name), content.as_bytes())
    }

    #[test]
    fn content_says_more_than_the_name() {
        assert_eq!(of("a.txt", "\u{feff}\n HIERARCHY\nROOT").unwrap(), Format::Bvh);
        assert_eq!(of("a.fbx", "hierarchy").unwrap(), Format::Bvh);
        assert_eq!(of("a", "#!OML\n:FULLY-SPECIFIED\n:DEGREES\n1").unwrap(), Format::Amc);
        assert_eq!(of("a.bin", "glTF\u{2}").unwrap(), Format::Gltf);
        assert_eq!(of("a", "{ \"asset\": {} }").unwrap(), Format::Gltf);
        assert_eq!(of("a", "Kaydara FBX Binary  \0").unwrap(), Format::Fbx);
        assert_eq!(of("a", "; FBX 7.4.0 project file\n").unwrap(), Format::Fbx);
    }

    #[test]
    fn the_name_decides_where_the_content_says_nothing() {
        assert_eq!(of("a.BVH", "").unwrap(), Format::Bvh);
        assert_eq!(of("a.amc", "1\nroot 0").unwrap(), Format::Amc);
        assert_eq!(of("a.glb", "broken").unwrap(), Format::Gltf);
    }

    #[test]
    fn one_message_lists_what_is_read() {
        let says = |name: &str| of(name, "solid").unwrap_err().to_string();
        for known in ["BVH", "AMC", "FBX", "glTF", "none of them (.c3d)"] {
            assert!(says("walk.c3d").contains(known), "{}", says("walk.c3d"));
        }
        assert!(says("02.asf").contains("name the .amc file"));
        assert!(says("walk").contains("no extension"));
    }
}
