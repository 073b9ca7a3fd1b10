//! Choice of rows that are spread over a table.

use crate::low_discrepancy::GOLDEN_STEP;

/// Returns at most `most` row indices, all below `count`, in ascending order.
///
/// The rows are spread over the table in unequal steps. If the joints move in turn, equal steps could always
/// select rows in which the same joint has moved.
pub fn spread_out(count: usize, most: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (0..count).collect();
    let place = |k: &usize| (*k as f64 * GOLDEN_STEP).fract();
    all.sort_by(|a, b| place(a).total_cmp(&place(b)));
    all.truncate(most);
    all.sort_unstable();
    all
}
