//! Weighted least squares over complex unknowns some of which are pinned: each row is a residual of few neighbouring
//! unknowns, so that the normal equations are banded.

use super::band::{Band, Complex, Factor};

/// weight x |sum of coefficient x unknown - right side|^2.
#[derive(Clone, Debug)]
pub(super) struct Row {
    /// Unknowns and their coefficients.
    pub terms: Vec<(usize, Complex)>,
    /// Weight.
    pub weight: f64,
}

/// A sum of rows.
#[derive(Clone, Debug, Default)]
pub(super) struct System {
    /// Number of unknowns.
    pub size: usize,
    /// The residuals.
    pub rows: Vec<Row>,
}

/// The normal equations with some unknowns pinned, factored.
#[derive(Clone, Debug)]
pub(super) struct Pinned {
    factor: Factor,
    pinned: Vec<bool>,
}

impl System {
    /// The value of the sum at `x`.
    #[cfg(test)]
    pub fn energy(&self, x: &[Complex], right: &[Complex]) -> f64 {
        let residual = |row: &Row, right: Complex| row.terms.iter().fold(-right, |sum, &(i, c)| sum + c * x[i]).abs();
        self.rows.iter().zip(right).map(|(row, &r)| row.weight * residual(row, r).powi(2)).sum()
    }

    /// Factors the normal equations; `None` if they leave an unknown free. O(size x band^2).
    pub fn pin(&self, pinned: Vec<bool>) -> Option<Pinned> {
        let pairs = || {
            self.rows
                .iter()
                .flat_map(|row| row.terms.iter().flat_map(move |a| row.terms.iter().map(move |b| (row, a, b))))
        };
        let free = |i: usize| !pinned[i];
        let width = pairs().map(|(_, a, b)| a.0.abs_diff(b.0)).max().unwrap_or(0);
        let mut band = Band::new(self.size, width);
        for (row, a, b) in pairs().filter(|(_, a, b)| a.0 >= b.0 && free(a.0) && free(b.0)) {
            band.add(a.0, b.0, (a.1.conj() * b.1).scale(row.weight));
        }
        (0..self.size).filter(|&i| pinned[i]).for_each(|i| band.add(i, i, Complex::ONE));
        Some(Pinned { factor: band.factor()?, pinned })
    }

    /// Minimises the sum over the unknowns that are not pinned; `x` holds the pinned ones' values and gets the
    /// others'. O(size x band).
    pub fn solve(&self, pinned: &Pinned, right: &[Complex], x: &mut [Complex]) {
        let mut normal: Vec<Complex> =
            x.iter().zip(&pinned.pinned).map(|(&x, &pin)| if pin { x } else { Complex::default() }).collect();
        for (row, &right) in self.rows.iter().zip(right) {
            let known = row.terms.iter().filter(|t| pinned.pinned[t.0]);
            let right = known.fold(right, |sum, &(i, c)| sum - c * x[i]);
            for &(i, c) in row.terms.iter().filter(|t| !pinned.pinned[t.0]) {
                normal[i] += (c.conj() * right).scale(row.weight);
            }
        }
        pinned.factor.solve(&mut normal);
        x.copy_from_slice(&normal);
    }
}
