//! Lines and words of the two files. Lines count from 1; `#` begins a comment.

use glam::Vec3;

use crate::{Error, Result};

/// A line's number and its words.
pub(super) type Line<'a> = (usize, Vec<&'a str>);

/// The text of a file's bytes.
pub(super) fn text<'a>(bytes: &'a [u8], file: &str) -> Result<&'a str> {
    std::str::from_utf8(bytes).map(|text| text.trim_start_matches('\u{feff}')).map_err(|e| {
        let line = 1 + bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count();
        Error::invalid(file, format!("line {line}"), "expected text, found bytes that are not UTF-8")
    })
}

/// An error of the ASF reader at a line.
pub(super) fn bad(line: usize, problem: impl Into<String>) -> Error {
    Error::invalid("ASF", format!("line {line}"), problem)
}

/// Text for a message, cut to a length that fits one.
pub(super) fn quoted(text: &str) -> String {
    let short: String = text.chars().take(40).collect();
    if short.len() < text.len() { format!("'{short}...'") } else { format!("'{short}'") }
}

/// A finite number.
pub(super) fn number(word: Option<&&str>, line: usize, what: &str) -> Result<f32> {
    let word = word.ok_or_else(|| bad(line, format!("expected {what}, found the end of the line")))?;
    let value = word.parse::<f32>().ok().filter(|v| v.is_finite());
    value.ok_or_else(|| bad(line, format!("expected {what}, found {}", quoted(word))))
}

/// The first three of `words` as a vector.
pub(super) fn vector(words: &[&str], line: usize) -> Result<Vec3> {
    let mut v = Vec3::ZERO;
    for i in 0..3 {
        v[i] = number(words.get(i), line, "3 numbers")?;
    }
    Ok(v)
}
