//! Kinematic chain as screw axes at a reference posture (product of exponentials).
//!
//! The TCP pose is `T(theta) = exp(S_1 theta_1) ... exp(S_n theta_n) T(0)` (R. W. Brockett 1984). Here
//! `theta_i` is the displacement of joint i from the reference posture, and `S_i` is its screw axis at that
//! posture. Errors of the chain change only the screw axes and `T(0)`. The positions of the
//! Denavit-Hartenberg frames do not matter, so rows with huge offsets that cancel are harmless.

use super::perturbation::{FrameError, Perturbation};
use crate::cell::{JointKind, MAX_JOINTS};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// One value per joint. The unused entries at the end are zero.
pub type JointValues = [f64; MAX_JOINTS];

/// Joint axes, TCP and measured point of a chain at the reference posture, in the base frame.
#[derive(Debug, Clone)]
pub struct Screws {
    pub kinds: Vec<JointKind>,
    /// Unit vectors along the joint axes.
    pub axes: [Vector3<f64>; MAX_JOINTS],
    /// Point on each joint axis, m.
    pub points: [Vector3<f64>; MAX_JOINTS],
    /// Position of the TCP, m.
    pub tip: Vector3<f64>,
    /// Position of the measured point, m. The measured point is the point at which the sense measures the
    /// error ([`crate::cell::Sense::point`]).
    pub point: Vector3<f64>,
    /// Unit vector along the tool.
    pub tool: Vector3<f64>,
}

/// Joint axes, TCP and measured point of a chain at a posture, and the motion of each link from the reference
/// posture.
pub struct PosedScrews {
    pub axes: [Vector3<f64>; MAX_JOINTS],
    pub points: [Vector3<f64>; MAX_JOINTS],
    pub links: [Pose; MAX_JOINTS + 1],
    pub tip: Vector3<f64>,
    pub point: Vector3<f64>,
    pub tool: Vector3<f64>,
}

impl Screws {
    /// Returns the joint axes, TCP and measured point of the nominal chain. `frames` holds the link frames at
    /// the reference posture.
    ///
    /// The argument `point` is the measured point ([`Self::point`]), given in the TCP frame, m.
    pub fn nominal(chain: &Chain, frames: &Frames, point: &Vector3<f64>) -> Self {
        let (mut axes, mut points) = ([Vector3::z(); MAX_JOINTS], [Vector3::zeros(); MAX_JOINTS]);
        for i in 0..chain.axes() {
            axes[i] = frames.links[i].rotation.column(2).into_owned();
            points[i] = frames.links[i].translation;
        }
        Self {
            kinds: chain.links.iter().map(|l| l.kind).collect(),
            axes,
            points,
            tip: frames.tcp.translation,
            point: frames.tcp.transform(point),
            tool: frames.tcp.rotation * chain.tool_axis,
        }
    }

    /// Returns the joint axes, TCP and measured point of the chain with a sample of errors. The joint
    /// coordinates are those of the reference posture.
    ///
    /// The point stored for each axis is the foot of a perpendicular to this axis. The perpendicular begins
    /// at the point stored for the nominal axis.
    pub fn perturbed(&self, frames: &Frames, errors: &Perturbation) -> Self {
        let mut moved = Pose::identity();
        let of_frame = |moved: &mut Pose, frame: &Pose, error: &FrameError| {
            *moved = *moved * slide(frame.rotation * Vector3::from(error.slides));
            [2, 1, 0].into_iter().for_each(|k| turn_about(moved, frame, k, error.turns[k].angle));
        };
        let mut with = self.clone();
        if let Some(error) = &errors.base {
            of_frame(&mut moved, &Pose::identity(), error);
        }
        for (i, link) in errors.links().iter().enumerate() {
            let (before, after) = (&frames.links[i], &frames.links[i + 1]);
            if let Some(joints) = &errors.joints
                && let Some(error) = &joints.errors[i]
            {
                of_frame(&mut moved, &(*before * joints.frames[i]), error);
            }
            with.axes[i] = moved.rotation * self.axes[i];
            let through = moved.transform(&self.points[i]);
            with.points[i] = through + with.axes[i] * with.axes[i].dot(&(self.points[i] - through));
            turn_about(&mut moved, before, 2, link.dtheta.angle);
            moved = moved * slide(before.rotation.column(2) * link.dr + after.rotation.column(0) * link.dl);
            turn_about(&mut moved, after, 0, link.dalpha.angle);
            turn_about(&mut moved, after, 1, link.dbeta.angle);
        }
        if let Some(error) = &errors.tool {
            of_frame(&mut moved, &frames.tcp, error);
        }
        (with.tip, with.point) = (moved.transform(&self.tip), moved.transform(&self.point));
        with.tool = moved.rotation * self.tool;
        with
    }

    /// Returns the sizes of the small motions by which another chain with the same joints differs from this
    /// chain. Entry k of each array belongs to the motion that acts on axis k and on everything after it. The
    /// entry after the last axis belongs to the motion of the measured point. The first array holds angles
    /// (rad), the second array translations (m).
    ///
    /// Errors that cancel each other, such as large offsets along parallel axes, do not contribute.
    pub fn motions_to(&self, other: &Screws) -> ([f64; MAX_JOINTS + 1], [f64; MAX_JOINTS + 1]) {
        let n = self.kinds.len();
        let (mut turns, mut shifts) = ([0.0; MAX_JOINTS + 1], [0.0; MAX_JOINTS + 1]);
        let (mut rotation, mut from, mut to) = (Matrix3::identity(), self.points[0], self.points[0]);
        for k in 0..=n {
            let (next, point, moved) = match k == n {
                true => (rotation, self.point, other.point),
                false => (least(&self.axes[k], &other.axes[k]), self.points[k], other.points[k]),
            };
            turns[k] = angle(&(rotation.transpose() * next));
            // Distance between the point and the place to which the earlier motions alone would move it.
            shifts[k] = (to + rotation * (point - from) - moved).norm();
            (rotation, from, to) = (next, point, moved);
        }
        (turns, shifts)
    }

    /// Returns the joint axes, TCP and measured point for the joint displacements `theta` from the reference
    /// posture.
    pub fn place(&self, theta: &JointValues) -> PosedScrews {
        let mut placed = PosedScrews {
            axes: self.axes,
            points: self.points,
            links: [Pose::identity(); MAX_JOINTS + 1],
            tip: self.tip,
            point: self.point,
            tool: self.tool,
        };
        let mut link = Pose::identity();
        for (i, kind) in self.kinds.iter().enumerate() {
            let axis = link.rotation * self.axes[i];
            let through = link.transform(&self.points[i]);
            (placed.axes[i], placed.points[i]) = (axis, through);
            link = match kind {
                JointKind::Revolute => about(&axis, &through, theta[i]) * link,
                JointKind::Prismatic => slide(axis * theta[i]) * link,
            };
            placed.links[i + 1] = link;
        }
        (placed.tip, placed.point) = (link.transform(&self.tip), link.transform(&self.point));
        placed.tool = link.rotation * self.tool;
        placed
    }
}

fn turn_about(moved: &mut Pose, frame: &Pose, axis: usize, angle: f64) {
    *moved = *moved * about(&frame.rotation.column(axis).into_owned(), &frame.translation, angle);
}

fn slide(by: Vector3<f64>) -> Pose {
    Pose { rotation: Matrix3::identity(), translation: by }
}

/// Returns the rotation by `angle` (rad) about the line along `axis` through the point `through`.
pub fn about(axis: &Vector3<f64>, through: &Vector3<f64>, angle: f64) -> Pose {
    if angle == 0.0 {
        return Pose::IDENTITY;
    }
    let rotation = Rotation3::from_axis_angle(&Unit::new_unchecked(*axis), angle).into_inner();
    Pose { rotation, translation: through - rotation * through }
}

/// Returns the rotation of least angle that takes the unit vector `from` to `to`.
fn least(from: &Vector3<f64>, to: &Vector3<f64>) -> Matrix3<f64> {
    let cross = from.cross(to);
    let sine = cross.norm();
    if sine == 0.0 {
        return Matrix3::identity();
    }
    about(&(cross / sine), &Vector3::zeros(), sine.atan2(from.dot(to))).rotation
}

/// Returns the angle of a rotation, rad. Small angles are accurate to the last digit.
fn angle(r: &Matrix3<f64>) -> f64 {
    let twice = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]);
    twice.norm().atan2(r.trace() - 1.0)
}
