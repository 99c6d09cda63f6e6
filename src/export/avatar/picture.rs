//! Pictures on a character: whatever says it is one, and lies in the file.

use gltf_json::image::MimeType;
use gltf_json::{Image, Index, Root};

use crate::Result;
use crate::gltf::{Data, bad, embedded, find};

#[derive(Debug)]
pub(super) struct Picture {
    pub name: Option<String>,
    pub format: MimeType,
    pub bytes: Vec<u8>,
}

/// # Errors
/// There is no such picture, it lies in a file elsewhere, or is neither PNG nor JPEG.
pub(super) fn read(root: &Root, data: &mut Data, index: Index<Image>, place: &str) -> Result<Picture> {
    let image = find(&root.images, index, "images", place)?;
    let place = format!("image {index}");
    let bytes = match (image.buffer_view, &image.uri) {
        (Some(view), _) => data.view(view, &place)?.0.to_vec(),
        (None, Some(uri)) if uri.starts_with("data:") => embedded(uri, &place)?,
        (None, Some(_)) => {
            let problem = "expected the picture in the file itself, found a link; export as one .glb";
            return Err(bad(place, problem));
        }
        (None, None) => return Err(bad(place, "expected a picture, found none")),
    };
    data.spend(bytes.len().div_ceil(size_of::<f32>()), &place)?;
    let format = format(&bytes).ok_or_else(|| bad(place, "expected a PNG or JPEG picture, found something else"))?;
    Ok(Picture { name: image.name.clone(), format: MimeType(format.into()), bytes })
}

fn format(bytes: &[u8]) -> Option<&'static str> {
    let png = bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.len() >= 33 && &bytes[12..16] == b"IHDR";
    if png { Some("image/png") } else { jpeg(bytes).then_some("image/jpeg") }
}

/// Whether it begins as a JPEG file and goes on to where the size is said: segments, each with a marker and a length.
fn jpeg(bytes: &[u8]) -> bool {
    let mut rest = bytes.strip_prefix(b"\xff\xd8").unwrap_or_default();
    while let &[0xff, marker, high, low, ..] = rest {
        let length = usize::from(u16::from_be_bytes([high, low]));
        // Frames are 0xc0 to 0xcf, but for tables (c4, cc) and what is reserved (c8).
        if matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            return length >= 8 && rest.len() > 2 + length;
        }
        rest = rest.get(2 + length..).unwrap_or_default();
    }
    false
}
