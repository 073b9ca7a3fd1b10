//! Uniform tightening: the loosest common scale of all tolerances that meets every requirement.

use super::linear_figure::FigureScratch;
use super::problem::ToleranceProblem;

/// Number of bisections, enough to determine a scale to its last digit.
const BISECTIONS: usize = 60;

/// Returns the common scale of uniform tightening, and the scale of every tolerance. The scale of a tolerance
/// is the common scale, clamped to the range of its cost model. A cost model with grades uses the
/// loosest grade whose scale is at most the common scale. If all grades have greater scales, the scale is
/// that of the tightest grade.
///
/// Returns None if a figure exceeds its limit even at the tightest tolerances.
pub fn uniform_scale(problem: &ToleranceProblem) -> Option<(f64, Vec<f64>)> {
    let mut scratch = FigureScratch::default();
    let scales = |u: f64| -> Vec<f64> { problem.costs.iter().map(|cost| cost.ordered(u)).collect() };
    let mut keeps = |u: f64| {
        let scales = scales(u);
        problem.requirements.iter().all(|r| r.figure.value(&scales, &mut scratch) <= r.limit)
    };
    let ends = problem.costs.iter().map(|cost| cost.range);
    let (mut low, mut high) =
        ends.fold((f64::INFINITY, 0.0_f64), |(low, high), (a, b)| (low.min(a), high.max(b)));
    if keeps(high) {
        return Some((high, scales(high)));
    }
    if !keeps(low) {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if keeps(middle) { low = middle } else { high = middle }
    }
    Some((low, scales(low)))
}
