//! Kinematic chain as screw axes at a reference posture (product of exponentials).
//!
//! The TCP pose is `T(theta) = exp(S_1 theta_1) ... exp(S_n theta_n) T(0)`, where `theta_i` is the
//! displacement of joint i from the reference posture, and `S_i` is its screw axis at that posture (R. W.
//! Brockett 1984). Errors of the chain change only the screw axes and `T(0)`. The positions of the
//! Denavit-Hartenberg frames do not matter, so rows with huge offsets that cancel are harmless.

use crate::cell::{JointKind, MAX_JOINTS, PER_FRAME, Parameter};
use crate::kinematic_error::{FrameError, Perturbation};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// One value per joint; the unused tail is zero.
pub(super) type JointValues = [f64; MAX_JOINTS];

/// Joint axes and end points of a chain at the reference posture, base frame.
#[derive(Debug, Clone)]
pub(super) struct Screws {
    pub kinds: Vec<JointKind>,
    pub axes: [Vector3<f64>; MAX_JOINTS],
    pub points: [Vector3<f64>; MAX_JOINTS],
    /// Position of the TCP, m.
    pub tip: Vector3<f64>,
    /// Position of the point whose error counts, m.
    pub point: Vector3<f64>,
    /// Unit vector along the tool.
    pub tool: Vector3<f64>,
}

/// Joint axes and end points of a chain at a posture, and the motion of each link from the reference posture.
pub(super) struct PosedScrews {
    pub axes: [Vector3<f64>; MAX_JOINTS],
    pub points: [Vector3<f64>; MAX_JOINTS],
    pub links: [Pose; MAX_JOINTS + 1],
    pub tip: Vector3<f64>,
    pub point: Vector3<f64>,
    pub tool: Vector3<f64>,
}

impl Screws {
    /// Returns the nominal chain with `frames` as reference posture.
    ///
    /// `point` is the point whose error counts, in the TCP frame, m.
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

    /// Returns the chain with a sample of errors, at the joint coordinates of the reference posture.
    ///
    /// The point stored for each axis is the foot of the perpendicular from the point stored for the nominal
    /// axis.
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

    /// Returns the joint axes and end points for the joint displacements `theta` from the reference posture.
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

/// Small motion at one place in the chain, which moves all parts from this place to the tool.
///
/// Axis and point are given at the reference posture, in the base frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct ScrewMotion {
    /// Number of joints that precede the motion in the chain.
    pub link: usize,
    /// Whether the motion is a rotation; otherwise it is a translation.
    pub turns: bool,
    pub axis: Vector3<f64>,
    pub through: Vector3<f64>,
    /// Index of the error source.
    pub source: usize,
    /// Size of the motion per unit of the source.
    pub factor: f64,
}

/// Returns the small motions that one unit of an error parameter causes in the chain.
///
/// A parameter of the equipment causes no motion of the chain.
pub(super) fn motions(
    chain: &Chain,
    frames: &Frames,
    parameter: Parameter,
    source: usize,
) -> Vec<ScrewMotion> {
    let one = |link: usize, frame: &Pose, axis: usize, turns: bool, factor: f64| ScrewMotion {
        link,
        turns,
        axis: frame.rotation.column(axis).into_owned(),
        through: frame.translation,
        source,
        factor,
    };
    let of_frame =
        |link: usize, frame: &Pose, c: usize| vec![one(link, frame, c % 3, c >= PER_FRAME / 2, 1.0)];
    let rows = &frames.links;
    match parameter {
        Parameter::Dq(j) => (j..chain.axes())
            .filter(|&i| chain.coupling[i][j] != 0.0)
            .map(|i| {
                let turns = chain.links[i].kind == JointKind::Revolute;
                one(i, &rows[i], 2, turns, chain.coupling[i][j])
            })
            .collect(),
        Parameter::Dr(i) => vec![one(i, &rows[i], 2, false, 1.0)],
        Parameter::Dl(i) => vec![one(i + 1, &rows[i + 1], 0, false, 1.0)],
        Parameter::Dalpha(i) => vec![one(i + 1, &rows[i + 1], 0, true, 1.0)],
        Parameter::Dbeta(i) => vec![one(i + 1, &rows[i + 1], 1, true, 1.0)],
        Parameter::Base(c) => of_frame(0, &Pose::identity(), c),
        Parameter::Tool(c) => of_frame(chain.axes(), &frames.tcp, c),
        Parameter::Joint(i, c) => of_frame(i, &(rows[i] * chain.joint_frames[i]), c),
        Parameter::Equipment(..) => Vec::new(),
    }
}

fn turn_about(moved: &mut Pose, frame: &Pose, axis: usize, angle: f64) {
    *moved = *moved * about(&frame.rotation.column(axis).into_owned(), &frame.translation, angle);
}

fn slide(by: Vector3<f64>) -> Pose {
    Pose { rotation: Matrix3::identity(), translation: by }
}

/// Returns the rotation by `angle` (rad) about the line along `axis` through the point `through`.
pub(super) fn about(axis: &Vector3<f64>, through: &Vector3<f64>, angle: f64) -> Pose {
    if angle == 0.0 {
        return Pose::IDENTITY;
    }
    let rotation = Rotation3::from_axis_angle(&Unit::new_unchecked(*axis), angle).into_inner();
    Pose { rotation, translation: through - rotation * through }
}
