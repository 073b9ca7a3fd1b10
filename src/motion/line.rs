//! A straight line of the TCP, attitude held, as moves that are straight in joint coordinates.

use super::measures::scaled_jacobian;
use super::path::between;
use crate::cell::{JointVector, MAX_JOINTS};
use crate::pose::Pose;
use crate::robot::Chain;
use nalgebra::{SVector, Vector3};

/// The TCP leaves the line by at most so much between two joint vectors (at the middle between them), m.
pub const DEVIATION: f64 = 5e-4;

/// Longest and shortest piece of a line, m.
const STEPS: (f64, f64) = (0.02, 1e-4);

/// Newton's method has arrived below this: position in arm reaches, rotation in rad.
const ARRIVED: f64 = 1e-10;
const ROUNDS: usize = 20;

/// Singular values below this count as 0: the arm does not move that way.
const RANK: f64 = 1e-9;

/// A limit counts as kept if it is passed by less than this: rounding of a posture at its limit, rad or m.
const AT_LIMIT: f64 = 1e-6;

/// Why the TCP does not get along a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stopped {
    /// A joint comes to its limit; `after`: metres along the line.
    Limit { joint: usize, after: f64 },
    /// The arm cannot follow with this attitude: out of reach or singular.
    Lost { after: f64 },
}

/// Joint vectors, the first at `from`, that take the TCP along `way` (base frame, m) with its attitude
/// held, each followed from the one before: the branch stays the same. Limits are kept from end to end,
/// for between two vectors inside them every straight move is. `reach`: a length of the size of the arm.
///
/// # Errors
/// Where it stops, and why.
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
    let (mut after, mut step, mut here) = (0.0, length / (length / STEPS.0).ceil(), *from);
    while after < length {
        let next = if after + step > length - STEPS.1 { length } else { after + step };
        let found = follow(chain, &here, &pose(next), reach);
        let held = found.filter(|there| {
            let middle = chain.forward(&chain.posture(&between(&here, there, 0.5))).translation;
            (middle - pose((after + next) / 2.0).translation).norm() <= DEVIATION
        });
        let Some(there) = held else {
            step /= 2.0;
            if step < STEPS.1 {
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

/// The joint whose limit is passed.
fn passed(chain: &Chain, q: &JointVector) -> Option<usize> {
    let outside = |(link, q): (&crate::robot::Link, &f64)| {
        *q < link.limits.0 - AT_LIMIT || *q > link.limits.1 + AT_LIMIT
    };
    chain.links.iter().zip(q).position(outside)
}

/// Newton's method from a near posture, the shortest step where there is a choice; None: no arrival.
fn follow(chain: &Chain, from: &JointVector, to: &Pose, reach: f64) -> Option<JointVector> {
    let mut q = *from;
    for _ in 0..ROUNDS {
        let frames = chain.frames(&chain.posture(&q));
        let position = (to.translation - frames.tcp.translation) / reach;
        let turn = to.rotation * frames.tcp.rotation.transpose();
        // The sine of the angle along the axis: exact to the last digit where it is small.
        let rotation = Vector3::new(
            turn[(2, 1)] - turn[(1, 2)],
            turn[(0, 2)] - turn[(2, 0)],
            turn[(1, 0)] - turn[(0, 1)],
        ) / 2.0;
        if position.norm() <= ARRIVED && rotation.norm() <= ARRIVED {
            return Some(q);
        }
        let miss = SVector::<f64, 6>::from_iterator(position.iter().chain(&rotation).copied());
        let solved = scaled_jacobian(chain, &frames, reach).svd(true, true).solve(&miss, RANK).ok()?;
        (0..MAX_JOINTS).for_each(|j| q[j] += solved[j]);
        // Far from where it started is another branch.
        if !q.iter().zip(from).all(|(q, from)| (q - from).abs() < 1.0) {
            return None;
        }
    }
    None
}
