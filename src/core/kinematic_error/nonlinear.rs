//! Nonlinear error model, eqs. (4)-(6) of the seed paper: `dT = prod(A_i + dA_i) - T`.
//!
//! Here `A_i` is the transform of link i, `dA_i` is the change that the errors cause, and T is the pose of
//! the TCP without errors. The product is evaluated as a sequence of small motions.

use super::{FrameError, Perturbation, Turn};
use crate::pose::{Displacement, Pose, SmallRotation};
use crate::robot::Frames;
use nalgebra::{Matrix3, Vector3};

/// Small motion at one place in the chain. The motion moves all frames from that place to the tool.
enum SmallMotion<'a> {
    Slide(Vector3<f64>),
    Turn { axis: Vector3<f64>, through: &'a Vector3<f64>, by: &'a Turn },
}

/// Returns the position error of the TCP in the base frame, m. The function allocates no memory.
#[inline]
pub fn position_error(frames: &Frames, errors: &Perturbation) -> Vector3<f64> {
    match errors.joints {
        None => position_walk::<false>(frames, errors),
        Some(_) => position_walk::<true>(frames, errors),
    }
}

/// Returns the position error of the TCP in the base frame, m. `JOINTS` states whether joint frames have
/// errors.
///
/// The two cases are compiled separately. One loop for both cases would take 50 % longer when no joint frame
/// has errors. A loop that is inlined into a larger function takes 30 % longer.
#[inline(never)]
fn position_walk<const JOINTS: bool>(frames: &Frames, errors: &Perturbation) -> Vector3<f64> {
    let p = &frames.tcp.translation;
    let mut e = Vector3::zeros();
    walk_back::<JOINTS>(frames, errors, |motion| e += moved(&motion, &(p + e)));
    e
}

/// Returns the position error (m) and the rotation error (rad) of the TCP in the base frame.
pub fn pose_error(frames: &Frames, errors: &Perturbation) -> Displacement {
    let p = &frames.tcp.translation;
    let (mut e, mut rotation) = (Vector3::zeros(), SmallRotation::none());
    walk_back::<true>(frames, errors, |motion| {
        e += moved(&motion, &(p + e));
        if let SmallMotion::Turn { axis, by, .. } = motion {
            rotation = SmallRotation::about(&axis, by.angle).after(&rotation);
        }
    });
    Displacement { position: e, rotation: rotation.vector() }
}

/// Returns the displacement of the point `x` by a motion.
///
/// A rotation by the matrix R about an axis through the point o displaces `x` by `(R - 1)(x - o)`. This
/// displacement is computed by Rodrigues' formula.
#[inline]
fn moved(motion: &SmallMotion<'_>, x: &Vector3<f64>) -> Vector3<f64> {
    match motion {
        SmallMotion::Slide(by) => *by,
        SmallMotion::Turn { axis, through, by } => {
            let w = x - *through;
            axis.cross(&w) * by.sin + (axis * axis.dot(&w) - w) * by.versine
        }
    }
}

/// Calls `visit` with the small motions from the tool back to the base.
///
/// If `JOINTS` is true, the motions of the joint frames are included.
#[inline]
fn walk_back<const JOINTS: bool>(
    frames: &Frames,
    errors: &Perturbation,
    mut visit: impl FnMut(SmallMotion<'_>),
) {
    if let Some(tool) = &errors.tool {
        frame_back(tool, &frames.tcp.rotation, &frames.tcp.translation, &mut visit);
    }
    for (i, link) in errors.links().iter().enumerate().rev() {
        let (before, after) = (&frames.links[i], &frames.links[i + 1]);
        turn_back(after, 1, &link.dbeta, &mut visit);
        turn_back(after, 0, &link.dalpha, &mut visit);
        visit(SmallMotion::Slide(after.rotation.column(0) * link.dl + before.rotation.column(2) * link.dr));
        turn_back(before, 2, &link.dtheta, &mut visit);
        if JOINTS
            && let Some(joints) = &errors.joints
            && let Some(error) = &joints.errors[i]
        {
            let Pose { rotation, translation } = *before * joints.frames[i];
            frame_back(error, &rotation, &translation, &mut visit);
        }
    }
    if let Some(base) = &errors.base {
        frame_back(base, &Matrix3::identity(), &Vector3::zeros(), &mut visit);
    }
}

/// Calls `visit` with the rotation about an axis of a frame, unless the angle is 0.
#[inline]
fn turn_back(frame: &Pose, axis: usize, by: &Turn, visit: &mut impl FnMut(SmallMotion<'_>)) {
    if by.angle != 0.0 {
        let axis = frame.rotation.column(axis).into_owned();
        visit(SmallMotion::Turn { axis, through: &frame.translation, by });
    }
}

/// Calls `visit` with the motions of one frame error: rotations about x, y and z, then the translation.
fn frame_back(
    error: &FrameError,
    axes: &Matrix3<f64>,
    through: &Vector3<f64>,
    visit: &mut impl FnMut(SmallMotion<'_>),
) {
    for k in 0..3 {
        visit(SmallMotion::Turn { axis: axes.column(k).into_owned(), through, by: &error.turns[k] });
    }
    visit(SmallMotion::Slide(axes * Vector3::from(error.slides)));
}
