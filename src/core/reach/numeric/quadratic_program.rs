//! The bounded step of the joints as a quadratic program, solved by the library clarabel.

use super::step::{NormalMatrix, StepBounds};
use crate::cell::{JointVector, MAX_JOINTS};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};

/// Returns the step d that minimizes `d^T H d / 2 - b . d` within `bounds`; None if the solver fails.
///
/// The matrix H is given by its lower triangle `h`. This function takes a hundred times as long as
/// [`super::step::bounded_step`]. Unlike `bounded_step`, this function frees every joint that would lower the
/// cost by leaving its bound.
pub(super) fn exact_step(
    n: usize,
    h: &NormalMatrix,
    b: &JointVector,
    bounds: &StepBounds,
) -> Option<JointVector> {
    let lower = || (0..n).flat_map(|i| (0..=i).map(move |j| (i, j)));
    // clarabel reads the upper triangle.
    let (rows, columns): (Vec<_>, Vec<_>) = lower().map(|(i, j)| (j, i)).unzip();
    let p = CscMatrix::new_from_triplets(n, n, rows, columns, lower().map(|(i, j)| h[i][j]).collect());
    let linear: Vec<f64> = b[..n].iter().map(|b| -b).collect();
    // Rows of A d <= b: d <= hi and -d <= -lo.
    let columns = (0..n).chain(0..n).collect();
    let signs = (0..2 * n).map(|row| if row < n { 1.0 } else { -1.0 }).collect();
    let a = CscMatrix::new_from_triplets(2 * n, n, (0..2 * n).collect(), columns, signs);
    let least = bounds[..n].iter().map(|(lo, _)| -lo);
    let limits: Vec<f64> = bounds[..n].iter().map(|(_, hi)| *hi).chain(least).collect();
    let settings = DefaultSettings { verbose: false, ..DefaultSettings::default() };
    let cones = [NonnegativeConeT(2 * n)];
    let mut solver = DefaultSolver::new(&p, &linear, &a, &limits, &cones, settings).ok()?;
    solver.solve();
    let solved = matches!(solver.solution.status, SolverStatus::Solved | SolverStatus::AlmostSolved);
    let mut step = [0.0; MAX_JOINTS];
    for ((step, x), (lo, hi)) in step.iter_mut().zip(&solver.solution.x).zip(bounds) {
        *step = x.clamp(*lo, *hi);
    }
    solved.then_some(step)
}
