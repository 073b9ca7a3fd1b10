//! The bounded step of the joints as a quadratic program, solved by a primal active-set method.

use super::step::{NormalMatrix, StepBounds, bounded_step, entry, solve_free};
use crate::cell::{JointVector, MAX_JOINTS};

/// Largest number of times that a joint leaves its bound. Few programs need more than the number of joints.
const MAX_RELEASES: usize = 8 * MAX_JOINTS;
/// Least derivative of the cost at a bound for which a joint leaves this bound, as a share of the largest
/// entry of the gradient.
const MIN_SLOPE: f64 = 1e-12;

/// Quadratic program: minimize `d^T H d / 2 - b . d` within `bounds`.
struct QuadraticProgram<'a> {
    n: usize,
    /// Lower triangle of H.
    h: &'a NormalMatrix,
    b: &'a JointVector,
    bounds: &'a StepBounds,
}

/// Returns the step d that minimizes `d^T H d / 2 - b . d` within `bounds`; None if H is not positive definite.
///
/// The lower triangle of H is `h`. The method starts at the step of [`bounded_step`]. While the cost falls if
/// a joint leaves its bound, this joint becomes free, and the method goes towards the minimum of the free
/// joints, up to the first bound (J. Nocedal, S. J. Wright, Numerical Optimization, 2006, algorithm 16.3).
pub(super) fn exact_step(
    n: usize,
    h: &NormalMatrix,
    b: &JointVector,
    bounds: &StepBounds,
) -> Option<JointVector> {
    let program = QuadraticProgram { n, h, b, bounds };
    let mut step = bounded_step(n, h, b, bounds)?;
    let mut held = [false; MAX_JOINTS];
    (0..n).for_each(|i| held[i] = step[i] <= bounds[i].0 || step[i] >= bounds[i].1);
    for _ in 0..MAX_RELEASES {
        let Some(freed) = program.release(&step, &held) else { return Some(step) };
        held[freed] = false;
        loop {
            let mut free = step;
            solve_free(n, h, b, &held, &mut free)?;
            let Some((share, joint)) = program.first_bound(&step, &free, &held) else {
                step = free;
                break;
            };
            (0..n).filter(|&i| !held[i]).for_each(|i| step[i] += share * (free[i] - step[i]));
            step[joint] = free[joint].clamp(bounds[joint].0, bounds[joint].1);
            held[joint] = true;
        }
    }
    // Rounding errors can repeat the same changes. The step is within the bounds at any time.
    Some(step)
}

impl QuadraticProgram<'_> {
    /// Returns the held joint by whose release the cost falls most steeply; None if the cost falls by no
    /// release.
    ///
    /// A release lowers the cost if the Lagrange multiplier of the bound has the wrong sign.
    fn release(&self, step: &JointVector, held: &[bool; MAX_JOINTS]) -> Option<usize> {
        let Self { n, h, b, bounds } = *self;
        let least = MIN_SLOPE * b[..n].iter().fold(0.0, |most: f64, b| most.max(b.abs()));
        let fall = |i: usize| {
            let slope = (0..n).map(|j| entry(h, i, j) * step[j]).sum::<f64>() - b[i];
            if step[i] <= bounds[i].0 { -slope } else { slope }
        };
        let movable = (0..n).filter(|&i| held[i] && bounds[i].0 < bounds[i].1);
        let falls = movable.map(|i| (fall(i), i)).filter(|(fall, _)| *fall > least);
        falls.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, i)| i)
    }

    /// Returns the first bound on the way from `step` to `free`: the share of the way in [0, 1], and the
    /// joint. Returns None if `free` is within the bounds.
    fn first_bound(
        &self,
        step: &JointVector,
        free: &JointVector,
        held: &[bool; MAX_JOINTS],
    ) -> Option<(f64, usize)> {
        let share = |i: usize| {
            let bound = free[i].clamp(self.bounds[i].0, self.bounds[i].1);
            (bound != free[i]).then(|| ((bound - step[i]) / (free[i] - step[i]), i))
        };
        (0..self.n).filter(|&i| !held[i]).filter_map(share).min_by(|a, b| a.0.total_cmp(&b.0))
    }
}
