//! Maps in pictures: a pixel is a cell, its colour names the template.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

/// Larger pictures are no maps.
const LARGEST: u32 = 4096;

/// Template of every cell, the lowest row first. Of a pixel that is not opaque, only the colour counts.
pub(super) fn cells(path: &Path, colours: &[Option<[u8; 3]>]) -> Result<Vec<Vec<usize>>, String> {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let (width, pixels) = read(path).map_err(|problem| format!("{name}: {problem}"))?;
    let find = |(index, pixel): (usize, &[u8; 3])| {
        colours.iter().position(|colour| colour.as_ref() == Some(pixel)).ok_or_else(|| {
            let [r, g, b] = pixel;
            let (column, row) = (index % width + 1, index / width + 1);
            format!("{name}: pixel {column} of row {row}: expected a template's colour, found #{r:02x}{g:02x}{b:02x}")
        })
    };
    let all = pixels.iter().enumerate().map(find).collect::<Result<Vec<usize>, String>>()?;
    Ok(all.chunks(width).rev().map(<[usize]>::to_vec).collect())
}

/// Width and colours of a picture, row by row from above.
fn read(path: &Path) -> Result<(usize, Vec<[u8; 3]>), String> {
    let file = File::open(path).map_err(|e| e.to_string())?;
    let mut decoder = png::Decoder::new(BufReader::new(file));
    decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::STRIP_16);
    let mut reader = decoder.read_info().map_err(|e| format!("expected a PNG picture: {e}"))?;
    let (width, height) = (reader.info().width, reader.info().height);
    if width.max(height) > LARGEST {
        return Err(format!("expected at most {LARGEST} x {LARGEST} pixels, found {width} x {height}"));
    }
    let size = reader.output_buffer_size().ok_or("expected a smaller picture")?;
    let mut bytes = vec![0; size];
    let frame = reader.next_frame(&mut bytes).map_err(|e| format!("expected a whole picture: {e}"))?;
    let bytes = &bytes[..frame.buffer_size()];
    let pixels = match frame.color_type {
        png::ColorType::Rgb => bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect(),
        png::ColorType::Rgba => bytes.chunks_exact(4).map(|p| [p[0], p[1], p[2]]).collect(),
        png::ColorType::Grayscale => bytes.iter().map(|&v| [v; 3]).collect(),
        png::ColorType::GrayscaleAlpha => bytes.chunks_exact(2).map(|p| [p[0]; 3]).collect(),
        png::ColorType::Indexed => return Err("expected colours, found indices".into()),
    };
    Ok((width as usize, pixels))
}
