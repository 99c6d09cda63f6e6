//! The table a check prints.

use std::fmt;

/// What one clause of the contract came to.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Row {
    /// Number of the clause of the contract.
    pub clause: u8,
    /// What was measured.
    pub row: String,
    /// The worst value found; `f64::MAX` where a number of the crowd is not finite.
    pub value: f64,
    /// The largest value allowed.
    pub limit: f64,
    /// Unit of both; empty for counts.
    pub unit: String,
    /// True if the value is within the limit.
    pub ok: bool,
    /// Where the worst value was found: character, frame, instance; empty if there was nothing to measure.
    pub place: String,
}

/// One row per clause of the contract.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Report {
    /// The rows, sorted by clause.
    pub rows: Vec<Row>,
}

impl Report {
    /// True if every row is within its limit.
    pub fn ok(&self) -> bool {
        self.rows.iter().all(|row| row.ok)
    }

    /// The rows beyond their limit.
    pub fn failures(&self) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(|row| !row.ok)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let width = self.rows.iter().map(|r| r.row.chars().count()).max().unwrap_or(0);
        writeln!(f, "     {:2} {:width$} {:>9} {:>9} {:6} worst at", "", "contract", "found", "limit", "unit")?;
        for r in &self.rows {
            let mark = if r.ok { "ok  " } else { "FAIL" };
            let (value, limit) = (number(r.value), number(r.limit));
            writeln!(
                f,
                "{mark} {:2} {:width$} {value:>9} {limit:>9} {:6} {}",
                r.clause,
                r.row,
                r.unit,
                r.place,
                width = width + 1
            )?;
        }
        Ok(())
    }
}

fn number(v: f64) -> String {
    if v == v.round() && v.abs() < 1e6 {
        format!("{v:.0}")
    } else if v.abs() >= 1e6 {
        format!("{v:.1e}")
    } else {
        format!("{v:.4}")
    }
}

/// Paths and poses are stored in 32 and 16 bits: a solver that stops at a limit may lie this far beyond it.
const ROUNDING: f64 = 1.0005;

/// The largest value offered, and where it was found. The first of equals stays.
#[derive(Clone, Debug, Default)]
pub(super) struct Worst {
    value: f64,
    place: String,
}

impl Worst {
    /// Takes `value` if it is larger than all before; a value that is not a number is larger than all that are.
    pub(super) fn offer(&mut self, value: f64, place: impl FnOnce() -> String) {
        let value = if value.is_nan() { f64::MAX } else { value.min(f64::MAX) };
        if value > self.value || self.place.is_empty() {
            *self = Self { value: value.max(0.0), place: place() };
        }
    }

    /// The worse of the two, this one if they are equal.
    pub(super) fn merge(self, other: Self) -> Self {
        if other.value > self.value || self.place.is_empty() { other } else { self }
    }

    /// The row that holds this against `limit`.
    pub(super) fn row(self, clause: u8, row: &str, limit: f64, unit: &str) -> Row {
        let ok = self.value <= limit * ROUNDING;
        Row { clause, row: row.into(), value: self.value, limit, unit: unit.into(), ok, place: self.place }
    }
}

/// Counts faults and remembers where the first was.
#[derive(Clone, Debug, Default)]
pub(super) struct Faults {
    count: usize,
    first: String,
}

impl Faults {
    /// One more fault.
    pub(super) fn add(&mut self, place: impl FnOnce() -> String) {
        if self.count == 0 {
            self.first = place();
        }
        self.count += 1;
    }

    /// Number of faults.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The row that allows none.
    pub(super) fn row(self, clause: u8, row: &str) -> Row {
        let value = self.count as f64;
        Row { clause, row: row.into(), value, limit: 0.0, unit: String::new(), ok: self.count == 0, place: self.first }
    }
}
