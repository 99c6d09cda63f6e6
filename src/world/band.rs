//! Symmetric positive definite systems with a narrow band, solved without allocation: L D L^T without fill-in.

/// Entries below the diagonal that may differ from zero: three knots of two coordinates reach five back.
pub(super) const WIDTH: usize = 5;

/// The lower half of a symmetric matrix: row r holds (r, r), (r, r - 1), ..., (r, r - WIDTH).
pub(super) type Row = [f64; WIDTH + 1];

/// Solves in place: `rows` becomes the factors, `x` the solution. O(rows x WIDTH^2). The matrix must be positive
/// definite.
pub(super) fn solve(rows: &mut [Row], x: &mut [f64]) {
    factor(rows);
    forward(rows, x);
    for (value, row) in x.iter_mut().zip(rows.iter()) {
        *value *= row[0];
    }
    backward(rows, x);
}

/// Leaves L below the diagonal and 1 / D on it.
fn factor(rows: &mut [Row]) {
    for r in 0..rows.len() {
        let (above, row) = rows.split_at_mut(r);
        match above.last_chunk() {
            Some(above) => factor_row(above, &mut row[0], WIDTH),
            None => {
                let mut few = [Row::default(); WIDTH];
                few[WIDTH - r..].copy_from_slice(above);
                factor_row(&few, &mut row[0], r);
            }
        }
    }
}

/// The factors of a row, of whose predecessors the last `reach` count.
#[inline(always)]
fn factor_row(above: &[Row; WIDTH], row: &mut Row, reach: usize) {
    let mut scaled = Row::default();
    for k in (1..=reach).rev() {
        let mut sum = row[k];
        for d in k + 1..=reach {
            sum -= scaled[d] * above[WIDTH - k][d - k];
        }
        scaled[k] = sum;
    }
    for k in 1..=reach {
        let unit = scaled[k] * above[WIDTH - k][0];
        row[0] -= scaled[k] * unit;
        row[k] = unit;
    }
    row[0] = 1.0 / row[0];
}

fn forward(rows: &[Row], x: &mut [f64]) {
    for (r, row) in rows.iter().enumerate() {
        let (above, own) = x.split_at_mut(r);
        let mut sum = own[0];
        match above.last_chunk::<WIDTH>() {
            Some(above) => (1..=WIDTH).for_each(|k| sum -= row[k] * above[WIDTH - k]),
            None => (1..=r).for_each(|k| sum -= row[k] * above[r - k]),
        }
        own[0] = sum;
    }
}

fn backward(rows: &[Row], x: &mut [f64]) {
    for r in (0..rows.len()).rev() {
        let (own, below) = x[r..].split_at_mut(1);
        let below_rows = &rows[r + 1..];
        match (below.first_chunk::<WIDTH>(), below_rows.first_chunk::<WIDTH>()) {
            (Some(below), Some(rows)) => (1..=WIDTH).for_each(|k| own[0] -= rows[k - 1][k] * below[k - 1]),
            _ => (1..=below.len()).for_each(|k| own[0] -= below_rows[k - 1][k] * below[k - 1]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Gauss elimination with pivoting on the full matrix.
    fn dense(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
        let n = b.len();
        for c in 0..n {
            let pivot = (c..n).max_by(|&i, &j| a[i][c].abs().total_cmp(&a[j][c].abs())).unwrap();
            a.swap(c, pivot);
            b.swap(c, pivot);
            for r in c + 1..n {
                let f = a[r][c] / a[c][c];
                let pivot_row = a[c].clone();
                a[r].iter_mut().zip(&pivot_row).skip(c).for_each(|(x, p)| *x -= f * p);
                b[r] -= f * b[c];
            }
        }
        for r in (0..n).rev() {
            b[r] = (b[r] - (r + 1..n).map(|k| a[r][k] * b[k]).sum::<f64>()) / a[r][r];
        }
        b
    }

    proptest! {
        #[test]
        fn banded_solution_is_the_dense_one(n in 1usize..40, numbers in prop::collection::vec(-1.0f64..1.0, 320)) {
            // B B^T + I with B lower banded is positive definite and banded.
            let b = |r: usize, c: usize| if c <= r && r - c <= WIDTH { numbers[r * (WIDTH + 1) + r - c] } else { 0.0 };
            let entry = |r: usize, c: usize| (0..n).map(|k| b(r, k) * b(c, k)).sum::<f64>() + f64::from(r == c);
            let full: Vec<Vec<f64>> = (0..n).map(|r| (0..n).map(|c| entry(r, c)).collect()).collect();
            let right: Vec<f64> = (0..n).map(|i| numbers[300 - i]).collect();
            let mut rows: Vec<Row> =
                (0..n).map(|r| std::array::from_fn(|k| if k <= r { entry(r, r - k) } else { 0.0 })).collect();
            let mut x = right.clone();
            solve(&mut rows, &mut x);
            for (banded, exact) in x.iter().zip(dense(full, right)) {
                prop_assert!((banded - exact).abs() < 1e-9 * exact.abs().max(1.0), "{banded} {exact}");
            }
        }
    }
}
