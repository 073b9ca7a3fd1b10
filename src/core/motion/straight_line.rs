//! Straight line of the TCP with constant attitude, as a sequence of short moves that are straight in joint
//! coordinates.

use super::continuous_collision::between;
use super::measures::joint_displacements;
use crate::cell::{JointVector, MAX_JOINTS};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::{Vector3, Vector6};

/// Largest allowed deviation of the TCP from the line, m, measured in the middle of each move.
pub const DEVIATION: f64 = 5e-4;

/// Greatest length of the line that one move covers, m.
const MAX_STEP: f64 = 0.02;

/// Least length of the line that one move covers, m. If a shorter move is needed, the arm counts as unable to
/// follow the line.
const MIN_STEP: f64 = 1e-4;

/// Convergence threshold of Newton's method: position as a share of the arm's reach, rotation in rad.
const CONVERGED: f64 = 1e-10;

const MAX_ITERATIONS: usize = 20;

/// Threshold of the singular values of the Jacobian. The arm counts as unable to move in a singular
/// direction whose singular value is below this threshold.
const RANK_TOLERANCE: f64 = 1e-9;

/// Tolerance of a joint limit, rad or m, for the rounding errors of a posture at the limit.
const LIMIT_TOLERANCE: f64 = 1e-6;

/// Reason why the TCP cannot follow a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stopped {
    /// The joint with the index `joint` is beyond its limit at the length `after` (m) along the line.
    Limit { joint: usize, after: f64 },
    /// The arm cannot follow the line beyond the length `after`, m. The line is out of reach beyond this
    /// length, or the arm is singular.
    Lost { after: f64 },
}

/// Returns joint vectors, beginning with `from`, that move the TCP along the vector `way` (base frame, m).
///
/// The attitude is the same at all vectors. Each vector is computed near the vector before it, so that the
/// branch does not change. All vectors after `from` and the straight moves between them are within the joint
/// limits, with a tolerance of 1e-6 rad or m. The vector `from` itself is not checked. `reach` is a
/// characteristic length of the arm, m.
///
/// # Errors
/// Returns the reason why the arm cannot follow the whole line. In every [`Stopped`], `after` is a length
/// along the line, measured from the start of the line. In [`Stopped::Lost`], the arm can follow the line up
/// to this length. In [`Stopped::Limit`], the move that ends at this length takes a joint beyond its limit.
pub fn straight(
    chain: &Chain,
    from: &JointVector,
    way: &Vector3<f64>,
    reach: f64,
) -> Result<Vec<JointVector>, Stopped> {
    let start = chain.forward(&chain.posture(from));
    let length = way.norm();
    let mut knots = vec![*from];
    if length == 0.0 {
        return Ok(knots);
    }
    let pose = |after: f64| Pose { translation: start.translation + way * (after / length), ..start };
    let (mut after, mut step, mut here) = (0.0, length / (length / MAX_STEP).ceil(), *from);
    // From this knot on, the steps are equally long.
    let mut uniform = 0;
    while after < length {
        let next = if after + step > length - MIN_STEP { length } else { after + step };
        let found = follow(chain, &here, extrapolated(&knots[uniform..]), &pose(next), reach);
        let held = found.filter(|there| {
            let middle = chain.forward(&chain.posture(&between(&here, there, 0.5))).translation;
            (middle - pose((after + next) / 2.0).translation).norm() <= DEVIATION
        });
        let Some(there) = held else {
            step /= 2.0;
            uniform = knots.len() - 1;
            if step < MIN_STEP {
                return Err(Stopped::Lost { after });
            }
            continue;
        };
        if let Some(joint) = passed(chain, &there) {
            return Err(Stopped::Limit { joint, after: next });
        }
        (here, after) = (there, next);
        knots.push(here);
    }
    Ok(knots)
}

/// Returns the first joint outside its limits; None if no joint is outside.
fn passed(chain: &Chain, q: &JointVector) -> Option<usize> {
    let outside = |(link, q): (&crate::robot::Link, &f64)| {
        *q < link.limits.0 - LIMIT_TOLERANCE || *q > link.limits.1 + LIMIT_TOLERANCE
    };
    chain.links.iter().zip(q).position(outside)
}

/// Returns the extrapolated joint vector after the last of several equally spaced joint vectors. The result
/// lies on the parabola through the last three vectors, or on the line through two vectors. A single vector
/// is returned unchanged.
fn extrapolated(knots: &[JointVector]) -> JointVector {
    match knots {
        [.., c, b, a] => std::array::from_fn(|i| 3.0 * (a[i] - b[i]) + c[i]),
        [.., b, a] => std::array::from_fn(|i| 2.0 * a[i] - b[i]),
        [.., a] => *a,
        [] => [0.0; MAX_JOINTS],
    }
}

/// Solves for the joint coordinates at the pose `to` by Newton's method, which starts from `guess`. The
/// solution is near the posture `from`. Each step is the least-norm solution of the linearized equations.
///
/// Returns None if the method does not converge. The function also returns None if any joint coordinate
/// departs from `from` by at least 1 rad or 1 m. The solution then belongs to another branch.
fn follow(
    chain: &Chain,
    from: &JointVector,
    guess: JointVector,
    to: &Pose,
    reach: f64,
) -> Option<JointVector> {
    let (mut q, mut frames) = (guess, Frames::default());
    for _ in 0..MAX_ITERATIONS {
        chain.place(&chain.posture(&q), &mut frames);
        let position = (to.translation - frames.tcp.translation) / reach;
        let turn = to.rotation * frames.tcp.rotation.transpose();
        // The rotation axis times the sine of the angle is accurate for a small rotation.
        let rotation = Vector3::new(
            turn[(2, 1)] - turn[(1, 2)],
            turn[(0, 2)] - turn[(2, 0)],
            turn[(1, 0)] - turn[(0, 1)],
        ) / 2.0;
        if position.norm() <= CONVERGED && rotation.norm() <= CONVERGED {
            return Some(q);
        }
        let miss = Vector6::from_iterator(position.iter().chain(&rotation).copied());
        let solved = joint_displacements(chain, &frames, reach, &miss, RANK_TOLERANCE)?;
        (0..MAX_JOINTS).for_each(|j| q[j] += solved[j]);
        // A solution far from the start belongs to another branch.
        if !q.iter().zip(from).all(|(q, from)| (q - from).abs() < 1.0) {
            return None;
        }
    }
    None
}
