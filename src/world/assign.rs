//! Assignment of least total cost: the Hungarian method by shortest augmenting paths (Jonker and Volgenant 1987), O(n^3).
//!
//! Written here because it must not allocate per call, costs are real numbers, and it is forty lines.

/// A reusable solver of square assignment problems.
#[derive(Clone, Debug, Default)]
pub(super) struct Assignment {
    row_price: Vec<f64>,
    column_price: Vec<f64>,
    /// Row of every column; column 0 is a helper, rows count from 1, 0 is none.
    row_of: Vec<usize>,
    from: Vec<usize>,
    least: Vec<f64>,
    done: Vec<bool>,
}

impl Assignment {
    /// The column of every row into `columns`. `cost` is row-major, n x n, finite.
    pub fn solve(&mut self, cost: &[f64], n: usize, columns: &mut Vec<usize>) {
        self.reset(n);
        for row in 1..=n {
            self.augment(row, cost, n);
        }
        columns.clear();
        columns.resize(n, 0);
        for column in 1..=n {
            columns[self.row_of[column] - 1] = column - 1;
        }
    }

    fn reset(&mut self, n: usize) {
        for prices in [&mut self.row_price, &mut self.column_price, &mut self.least] {
            prices.clear();
            prices.resize(n + 1, 0.0);
        }
        for indices in [&mut self.row_of, &mut self.from] {
            indices.clear();
            indices.resize(n + 1, 0);
        }
        self.done.resize(n + 1, false);
    }

    /// Finds a place for `row` along the cheapest chain of moves.
    fn augment(&mut self, row: usize, cost: &[f64], n: usize) {
        self.row_of[0] = row;
        self.least.fill(f64::INFINITY);
        self.done.fill(false);
        let mut column = 0;
        while self.row_of[column] != 0 {
            self.done[column] = true;
            column = self.grow(column, cost, n);
        }
        while column != 0 {
            let previous = self.from[column];
            self.row_of[column] = self.row_of[previous];
            column = previous;
        }
    }

    /// Scans the row at `column`, pays up to the next cheapest column and returns it.
    fn grow(&mut self, column: usize, cost: &[f64], n: usize) -> usize {
        let row = self.row_of[column];
        let costs = &cost[(row - 1) * n..row * n];
        let (mut next, mut step) = (0, f64::INFINITY);
        for other in (1..=n).filter(|&c| !self.done[c]) {
            let reduced = costs[other - 1] - self.row_price[row] - self.column_price[other];
            if reduced < self.least[other] {
                self.least[other] = reduced;
                self.from[other] = column;
            }
            if self.least[other] < step {
                (next, step) = (other, self.least[other]);
            }
        }
        for c in 0..=n {
            if self.done[c] {
                self.row_price[self.row_of[c]] += step;
                self.column_price[c] -= step;
            } else {
                self.least[c] -= step;
            }
        }
        next
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cheapest(cost: &[f64], n: usize, row: usize, used: &mut Vec<bool>) -> f64 {
        if row == n {
            return 0.0;
        }
        let mut best = f64::INFINITY;
        for column in 0..n {
            if !used[column] {
                used[column] = true;
                best = best.min(cost[row * n + column] + cheapest(cost, n, row + 1, used));
                used[column] = false;
            }
        }
        best
    }

    proptest! {
        #[test]
        fn total_is_that_of_brute_force(n in 0usize..8, cost in prop::collection::vec(-5.0f64..50.0, 49)) {
            let cost = &cost[..n * n];
            let mut columns = Vec::new();
            let mut assignment = Assignment::default();
            assignment.solve(cost, n, &mut columns);
            let mut sorted = columns.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted, (0..n).collect::<Vec<_>>());
            let total: f64 = columns.iter().enumerate().map(|(row, column)| cost[row * n + column]).sum();
            prop_assert!((total - cheapest(cost, n, 0, &mut vec![false; n])).abs() < 1e-9);
        }
    }
}
