//! Hermitian banded systems: L D L^H without fill-in outside the band, in double precision.

use std::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use glam::Vec2;

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// One.
    pub const ONE: Self = Self { re: 1.0, im: 0.0 };

    /// A real number.
    pub fn real(re: f64) -> Self {
        Self { re, im: 0.0 }
    }

    /// e^(i angle).
    pub fn unit(angle: f64) -> Self {
        Self { re: angle.cos(), im: angle.sin() }
    }

    /// Conjugate.
    pub fn conj(self) -> Self {
        Self { re: self.re, im: -self.im }
    }

    /// Absolute value.
    pub fn abs(self) -> f64 {
        self.re.hypot(self.im)
    }

    /// Angle in [-pi, pi].
    pub fn arg(self) -> f64 {
        self.im.atan2(self.re)
    }

    /// Times a real number.
    pub fn scale(self, by: f64) -> Self {
        Self { re: self.re * by, im: self.im * by }
    }

    /// Of length one. Not for zero.
    pub fn normalized(self) -> Self {
        self.scale(1.0 / self.abs())
    }
}

impl From<Vec2> for Complex {
    /// The ground vector (x, z) as z + i x.
    fn from(v: Vec2) -> Self {
        Self { re: v.y as f64, im: v.x as f64 }
    }
}

impl From<Complex> for Vec2 {
    fn from(c: Complex) -> Self {
        Vec2::new(c.im as f32, c.re as f32)
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { re: self.re + o.re, im: self.im + o.im }
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        Self { re: self.re - o.re, im: self.im - o.im }
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self { re: self.re * o.re - self.im * o.im, im: self.re * o.im + self.im * o.re }
    }
}

impl Neg for Complex {
    type Output = Self;
    fn neg(self) -> Self {
        Self { re: -self.re, im: -self.im }
    }
}

impl AddAssign for Complex {
    fn add_assign(&mut self, o: Self) {
        *self = *self + o;
    }
}

impl SubAssign for Complex {
    fn sub_assign(&mut self, o: Self) {
        *self = *self - o;
    }
}

/// The lower half of a Hermitian matrix whose entries lie within `width` of the diagonal.
#[derive(Clone, Debug)]
pub(super) struct Band {
    size: usize,
    width: usize,
    /// Row-major; entry (row, row - k) is at `row * (width + 1) + k`.
    entries: Vec<Complex>,
}

impl Band {
    /// A matrix of zeros.
    pub fn new(size: usize, width: usize) -> Self {
        Self { size, width, entries: vec![Complex::default(); size * (width + 1)] }
    }

    /// Adds to entry (row, column), which must lie in the lower half.
    pub fn add(&mut self, row: usize, column: usize, value: Complex) {
        self.entries[row * (self.width + 1) + row - column] += value;
    }

    fn at(&self, row: usize, column: usize) -> Complex {
        self.entries[row * (self.width + 1) + row - column]
    }

    /// The factors L (unit lower) and D; `None` if the matrix is not positive definite. O(size x width^2).
    pub fn factor(mut self) -> Option<Factor> {
        for row in 0..self.size {
            let low = row.saturating_sub(self.width);
            // Entries hold L times D until the pivot of the row is known.
            for column in low..row {
                let inner = low.max(column.saturating_sub(self.width))..column;
                let sum = inner.fold(self.at(row, column), |sum, k| sum - self.at(row, k) * self.at(column, k).conj());
                self.entries[row * (self.width + 1) + row - column] = sum;
            }
            let mut pivot = self.at(row, row).re;
            let scale = pivot;
            for column in low..row {
                let scaled = self.at(row, column);
                let unit = scaled.scale(1.0 / self.at(column, column).re);
                pivot -= (scaled * unit.conj()).re;
                self.entries[row * (self.width + 1) + row - column] = unit;
            }
            if pivot.is_nan() || pivot <= 1e-13 * scale {
                return None;
            }
            self.entries[row * (self.width + 1)] = Complex::real(pivot);
        }
        Some(Factor { band: self })
    }
}

/// L D L^H.
#[derive(Clone, Debug)]
pub(super) struct Factor {
    band: Band,
}

impl Factor {
    /// Solves in place. O(size x width).
    pub fn solve(&self, x: &mut [Complex]) {
        let Band { size, width, .. } = self.band;
        for row in 0..size {
            let known = row.saturating_sub(width)..row;
            x[row] = known.fold(x[row], |sum, k| sum - self.band.at(row, k) * x[k]);
        }
        for (row, value) in x.iter_mut().enumerate() {
            *value = value.scale(1.0 / self.band.at(row, row).re);
        }
        for row in (0..size).rev() {
            for k in row.saturating_sub(width)..row {
                let back = self.band.at(row, k).conj() * x[row];
                x[k] -= back;
            }
        }
    }
}
