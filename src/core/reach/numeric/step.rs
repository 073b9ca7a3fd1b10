//! Bounded step of the joints: a step d that approximately minimizes `d^T H d / 2 - b . d` within bounds.
//!
//! Here H is the Hessian of the cost and -b its gradient. All arrays are on the stack.

use crate::cell::{JointVector, MAX_JOINTS};

/// Symmetric matrix of the normal equations, stored as its lower triangle.
pub(super) type NormalMatrix = [[f64; MAX_JOINTS]; MAX_JOINTS];

/// Least and greatest step of each joint, rad or m.
pub(super) type StepBounds = [(f64, f64); MAX_JOINTS];

/// Returns a step d within `bounds` that approximately minimizes `d^T H d / 2 - b . d`.
///
/// The lower triangle of H is `h`. The method is an active-set method in which a bound, once active, remains
/// active. A joint whose step violates a bound is fixed at the bound, and the step of the other joints is
/// computed again. The result is None if H is not positive definite.
pub(super) fn bounded_step(
    n: usize,
    h: &NormalMatrix,
    b: &JointVector,
    bounds: &StepBounds,
) -> Option<JointVector> {
    let mut step = *b;
    solve(n, h, &mut step)?;
    let mut held = [false; MAX_JOINTS];
    loop {
        let leaves = |i: &usize| !held[*i] && (step[*i] < bounds[*i].0 || step[*i] > bounds[*i].1);
        let mut leaving = [false; MAX_JOINTS];
        (0..n).filter(leaves).for_each(|i| leaving[i] = true);
        if leaving == [false; MAX_JOINTS] {
            return Some(step);
        }
        for i in (0..n).filter(|&i| leaving[i]) {
            step[i] = step[i].clamp(bounds[i].0, bounds[i].1);
            held[i] = true;
        }
        solve_free(n, h, b, &held, &mut step)?;
    }
}

/// Solves for the steps of the free joints; the joints in `held` keep their values in `step`.
///
/// Returns None if the matrix of the free joints is not positive definite.
pub(super) fn solve_free(
    n: usize,
    h: &NormalMatrix,
    b: &JointVector,
    held: &[bool; MAX_JOINTS],
    step: &mut JointVector,
) -> Option<()> {
    let (mut free, mut count) = ([0; MAX_JOINTS], 0);
    for i in (0..n).filter(|&i| !held[i]) {
        free[count] = i;
        count += 1;
    }
    let (mut part, mut right) = (NormalMatrix::default(), JointVector::default());
    for (k, &i) in free[..count].iter().enumerate() {
        let pulled: f64 = (0..n).filter(|&j| held[j]).map(|j| entry(h, i, j) * step[j]).sum();
        right[k] = b[i] - pulled;
        for (l, &j) in free[..=k].iter().enumerate() {
            part[k][l] = entry(h, i, j);
        }
    }
    solve(count, &part, &mut right)?;
    for (&i, d) in free[..count].iter().zip(right) {
        step[i] = d;
    }
    Some(())
}

/// Returns an entry of the symmetric matrix H, whose lower triangle is `h`.
pub(super) fn entry(h: &NormalMatrix, i: usize, j: usize) -> f64 {
    if i >= j { h[i][j] } else { h[j][i] }
}

/// Replaces `b` by the solution of `H x = b` (Cholesky decomposition); None if H is not positive definite.
#[inline]
fn solve(n: usize, h: &NormalMatrix, b: &mut JointVector) -> Option<()> {
    let mut lower = *h;
    let mut inverse = JointVector::default();
    for i in 0..n {
        for j in 0..i {
            let dot: f64 = (0..j).map(|k| lower[i][k] * lower[j][k]).sum();
            lower[i][j] = (lower[i][j] - dot) * inverse[j];
        }
        let square = lower[i][i] - (0..i).map(|k| lower[i][k] * lower[i][k]).sum::<f64>();
        if !(square > 0.0 && square.is_finite()) {
            return None;
        }
        inverse[i] = 1.0 / square.sqrt();
        b[i] = (b[i] - (0..i).map(|k| lower[i][k] * b[k]).sum::<f64>()) * inverse[i];
    }
    for i in (0..n).rev() {
        b[i] = (b[i] - (i + 1..n).map(|k| lower[k][i] * b[k]).sum::<f64>()) * inverse[i];
    }
    Some(())
}
