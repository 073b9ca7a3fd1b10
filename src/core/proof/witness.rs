//! Witnesses: postures that keep all constraints. The value of the operation in a witness is an upper bound
//! of the least value over all such postures.

use super::region::Constraint;
use super::task::Task;
use crate::cell::{JointVector, MAX_JOINTS};
use crate::kinematic_error::{JointValues, PosedScrews};
use crate::reading::EvaluatorScratch;
use nalgebra::{Matrix4, Vector4};

/// Largest violation of joint limits and constraints that is accepted in a witness, m or rad.
const TOLERANCE: f64 = 1e-9;

/// Posture that stays within the joint limits and satisfies the constraints.
pub(super) struct Witness {
    /// Value of the operation in the posture, m or rad, and the actuator coordinates of the posture, rad or
    /// m. The field is None if the robot touches itself in the posture.
    pub value: Option<(f64, JointVector)>,
    /// Lower bound of the value for a box that contains only this posture, m or rad. The search cannot prove
    /// a greater lower bound for the operation, because some box always contains this posture.
    pub ceiling: f64,
}

/// Searches a box of joint coordinates for a posture that stays within the joint limits and satisfies the
/// constraints. Returns None if no such posture is found. See [`kept_near`] for the arguments.
pub(super) fn near(
    task: &Task<'_>,
    y: JointValues,
    low: &JointValues,
    high: &JointValues,
    memory: &mut EvaluatorScratch,
) -> Option<Witness> {
    let (y, placed) = kept_near(task, y, low, high)?;
    let value = Some(task.value(&y, memory)).filter(|(_, joints)| !task.self_collision.is_in(joints));
    let bound = task.worth(&y, &placed, &[0.0; MAX_JOINTS]);
    Some(Witness { value, ceiling: bound.map_or(0.0, |bound| bound.value.max(0.0)) })
}

/// Searches a box of joint coordinates for coordinates whose posture stays within the joint limits, satisfies
/// the constraints and is not excluded by its self-collision. Returns the coordinates and the nominal chain.
///
/// The search starts at the coordinates `y` and takes least-norm Newton steps. After each step, the
/// coordinates are clamped to the box from `low` to `high`. The best posture is often in a corner of the
/// set of allowed postures. Therefore a violation of up to [`TOLERANCE`] is accepted. No lower bound
/// depends on this tolerance.
pub(super) fn kept_near(
    task: &Task<'_>,
    mut y: JointValues,
    low: &JointValues,
    high: &JointValues,
) -> Option<(JointValues, PosedScrews)> {
    const MAX_STEPS: usize = 12;
    for _ in 0..MAX_STEPS {
        let placed = task.place(&y);
        let excess = |c: &Constraint| {
            let value = c.value(&placed.tip, &placed.tool);
            value - value.clamp(c.low, c.high)
        };
        let missed = task.constraints.iter().map(|c| (c, excess(c))).filter(|(_, by)| by.abs() > TOLERANCE);
        // Each missed constraint with its excess and the gradient of its quantity.
        let off: Vec<(f64, JointValues)> =
            missed.take(4).map(|(c, by)| (by, task.gradient(c, &placed))).collect();
        if off.is_empty() {
            let inside = task.coordinates.limits.iter().zip(task.coordinates.actuators(&y));
            let kept = inside
                .into_iter()
                .all(|((_, low, high), q)| (low - TOLERANCE..=high + TOLERANCE).contains(&q));
            let is_usable = kept && !task.collides_with_itself(&y, &[0.0; MAX_JOINTS]);
            return is_usable.then_some((y, placed));
        }
        let (mut normal, mut right) = (Matrix4::identity(), Vector4::zeros());
        for (i, (by, a)) in off.iter().enumerate() {
            for (j, (_, b)) in off.iter().enumerate() {
                normal[(i, j)] = a.iter().zip(b).map(|(a, b)| a * b).sum();
            }
            normal[(i, i)] += 1e-12;
            right[i] = *by;
        }
        let step = normal.lu().solve(&right)?;
        for (i, y) in y.iter_mut().enumerate() {
            let by: f64 = off.iter().zip(step.iter()).map(|((_, a), step)| a[i] * step).sum();
            *y = (*y - by).clamp(low[i], high[i]);
        }
    }
    None
}
