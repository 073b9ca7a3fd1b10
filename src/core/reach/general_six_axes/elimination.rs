//! Gaussian elimination of small systems of fixed size, in arrays of rows.
//!
//! These functions are faster than the decompositions of nalgebra for the determinants and for Newton's
//! method. The functions can also stop after some of the columns.

/// Exchanges rows and columns so that the entry of greatest absolute value moves to row `k` and column `k`.
///
/// The function searches the rows from `k` on, in the first `count` columns. The columns before `k` must be 0
/// in these rows. Returns the former column of the moved entry; `None` if all searched entries are 0.
#[inline(always)]
fn pivot<const ROWS: usize, const WIDTH: usize>(
    rows: &mut [[f64; WIDTH]; ROWS],
    k: usize,
    count: usize,
) -> Option<usize> {
    let (mut greatest, mut row) = (0.0, k);
    for (i, entries) in rows.iter().enumerate().skip(k) {
        let own = greatest_entry(&entries[..count]);
        if own > greatest {
            (greatest, row) = (own, i);
        }
    }
    let column = rows[row][..count].iter().position(|entry| entry.abs() == greatest && greatest > 0.0)?;
    rows.swap(k, row);
    rows.iter_mut().for_each(|entries| entries.swap(k, column));
    Some(column)
}

/// Returns the greatest absolute value of the entries.
#[inline(always)]
fn greatest_entry(entries: &[f64]) -> f64 {
    // Comparisons in this form become vector instructions.
    let greater = |a: f64, b: f64| if b > a { b } else { a };
    let mut lanes = [0.0; 4];
    let chunks = entries.chunks_exact(4);
    let rest = chunks.remainder();
    for chunk in chunks {
        for (lane, entry) in lanes.iter_mut().zip(chunk) {
            *lane = greater(*lane, entry.abs());
        }
    }
    let last = rest.iter().fold(0.0, |greatest, entry| greater(greatest, entry.abs()));
    lanes.into_iter().fold(last, greater)
}

/// Subtracts multiples of row `k` from the rows below it, so that column `k` becomes 0 in those rows.
///
/// The columns before `k` must be 0 in these rows. Whole rows are subtracted, because loops of a constant
/// length are faster.
#[inline(always)]
fn clear_below<const ROWS: usize, const WIDTH: usize>(rows: &mut [[f64; WIDTH]; ROWS], k: usize) {
    let pivot = rows[k];
    let inverse = pivot[k].recip();
    for entries in rows.iter_mut().skip(k + 1) {
        let factor = entries[k] * inverse;
        for (entry, above) in entries.iter_mut().zip(&pivot) {
            *entry -= factor * above;
        }
        entries[k] = 0.0;
    }
}

/// Eliminates the first `COUNT` columns with complete pivoting. These columns are then 0 in all rows after
/// the first `COUNT`.
///
/// The elimination ends early if the columns are linearly dependent.
pub(super) fn eliminate<const ROWS: usize, const COUNT: usize, const WIDTH: usize>(
    rows: &mut [[f64; WIDTH]; ROWS],
) {
    for k in 0..COUNT {
        if pivot(rows, k, COUNT).is_none() {
            return;
        }
        clear_below(rows, k);
    }
}

/// Reduces a square matrix to upper triangular form with complete pivoting. Returns the new order of the
/// columns.
pub(super) fn triangulate<const SIZE: usize>(rows: &mut [[f64; SIZE]; SIZE]) -> [usize; SIZE] {
    let mut columns = std::array::from_fn(|k| k);
    for k in 0..SIZE {
        let Some(column) = pivot(rows, k, SIZE) else { break };
        columns.swap(k, column);
        clear_below(rows, k);
    }
    columns
}

/// Eliminates column `k` from the rows below row `k`.
///
/// Beforehand, the function chooses row `k` or a row below it, and exchanges row `k` with the chosen row.
/// The chosen row has the greatest absolute entry in column `k`.
///
/// Returns the pivot, with its sign changed if rows were exchanged.
#[inline(always)]
fn eliminate_column<const ROWS: usize, const WIDTH: usize>(rows: &mut [[f64; WIDTH]; ROWS], k: usize) -> f64 {
    let mut row = k;
    for i in k + 1..ROWS {
        if rows[i][k].abs() > rows[row][k].abs() {
            row = i;
        }
    }
    let sign = if row == k { 1.0 } else { -1.0 };
    rows.swap(k, row);
    if rows[k][k] == 0.0 {
        return 0.0;
    }
    clear_below(rows, k);
    sign * rows[k][k]
}

/// Eliminates three columns. Returns two numbers: the product of the pivots, and the sign (1 or -1) of the
/// row exchanges.
#[inline]
pub(super) fn eliminate_three(rows: &mut [[f64; 9]; 6]) -> (f64, f64) {
    let (mut product, mut sign) = (1.0, 1.0);
    for k in 0..3 {
        let signed = eliminate_column(rows, k);
        product *= rows[k][k];
        if signed * rows[k][k] < 0.0 {
            sign = -sign;
        }
    }
    (product, sign)
}

/// Returns the determinant of a 6 x 6 matrix.
#[inline]
pub(super) fn determinant_of_six(mut rows: [[f64; 6]; 6]) -> f64 {
    (0..6).fold(1.0, |product, k| product * eliminate_column(&mut rows, k))
}

/// Returns the solution of six linear equations, or `None` if they are singular. The last column is the
/// right-hand side.
#[inline]
pub(in crate::reach) fn solve_six(mut rows: [[f64; 7]; 6]) -> Option<[f64; 6]> {
    for k in 0..6 {
        if eliminate_column(&mut rows, k) == 0.0 {
            return None;
        }
    }
    let mut solution = [0.0; 6];
    for (k, row) in rows.iter().enumerate().rev() {
        let known: f64 = row.iter().zip(&solution).skip(k + 1).map(|(entry, value)| entry * value).sum();
        solution[k] = (row[6] - known) / row[k];
    }
    Some(solution)
}
