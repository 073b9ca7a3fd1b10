//! Forward kinematics with errors, and its exact derivatives.

use super::harmonics::wave;
use super::unknown::Unknown;
use crate::cell::{JointKind, JointVector, MAX_JOINTS, PER_LINK, Parameter};
use crate::pose::{Displacement, Pose, SmallRotation};
use crate::robot::{Chain, lever};
use nalgebra::{Matrix3, Vector3};

/// Pose of the mechanical interface of a robot with errors, and the frames in which the errors act. All
/// poses are given in the base frame.
#[derive(Debug, Clone)]
pub struct Deformed {
    pub interface: Pose,
    /// Frame before each Denavit-Hartenberg row. Here dq acts about z (along z for a prismatic joint), and dr
    /// along z.
    before: Vec<Pose>,
    /// Frame after the common normal of each row. Here dl acts along x, and dalpha about x.
    normal: Vec<Pose>,
    /// Frame after the twist of each row. Here dbeta acts about y.
    after: Vec<Pose>,
    /// Actuator coordinates, rad or m.
    q: JointVector,
    /// Lever of every link (second index) about the axis of every joint (first index), m, without errors.
    levers: [[f64; MAX_JOINTS]; MAX_JOINTS],
}

impl Deformed {
    /// Returns the deformed chain at actuator coordinates `q` for the values of the unknowns.
    ///
    /// The errors of a Denavit-Hartenberg row are small motions in the order
    /// `Rz(dq) Tz(dr) Tx(dl) Rx(dalpha) Ry(dbeta)`. Each motion acts in a frame of this row. The levers of
    /// the elastic terms are computed for the chain without errors.
    pub fn new(chain: &Chain, q: &JointVector, unknowns: &[Unknown], values: &[f64]) -> Self {
        let nominal = chain.posture(q);
        let frames = chain.frames(&nominal);
        let mut levers = [[0.0; MAX_JOINTS]; MAX_JOINTS];
        let mut rows = [[0.0; PER_LINK]; MAX_JOINTS];
        for (unknown, value) in unknowns.iter().zip(values) {
            let mut drive = |j: usize, by: f64| {
                let driven = rows.iter_mut().zip(&chain.coupling).skip(j);
                driven.for_each(|(row, coupling)| row[0] += coupling[j] * by);
            };
            match *unknown {
                Unknown::Row(Parameter::Dq(j)) => drive(j, *value),
                Unknown::Harmonic { joint, order, sine } => drive(joint, value * wave(q[joint], order, sine)),
                Unknown::Row(Parameter::Dr(i)) => rows[i][1] += value,
                Unknown::Row(Parameter::Dl(i)) => rows[i][2] += value,
                Unknown::Row(Parameter::Dalpha(i)) => rows[i][3] += value,
                Unknown::Row(Parameter::Dbeta(i)) => rows[i][4] += value,
                Unknown::Row(_) => {}
                Unknown::Elastic { joint, link } => {
                    levers[joint][link] = lever(&frames, joint, link);
                    rows[joint][0] += value * levers[joint][link];
                }
            }
        }
        let mut at = chain.mount;
        let (mut before, mut normal, mut after) = (Vec::new(), Vec::new(), Vec::new());
        for (i, link) in chain.links.iter().enumerate() {
            before.push(at);
            let [dq, dr, dl, dalpha, dbeta] = rows[i];
            let (turn, slide) = match link.kind {
                JointKind::Revolute => (dq, 0.0),
                JointKind::Prismatic => (0.0, dq),
            };
            let turned = about(2, turn) * about_sin_cos(2, nominal.sin[i], nominal.cos[i]);
            let rotation = at.rotation * turned;
            let offset = rotation.column(2) * (nominal.r[i] + dr + slide);
            let translation = at.translation + offset + rotation.column(0) * (link.l + dl);
            normal.push(Pose { rotation, translation });
            let twist = about_sin_cos(0, link.sin_alpha, link.cos_alpha) * about(0, dalpha);
            after.push(Pose { rotation: rotation * twist, translation });
            at = Pose { rotation: rotation * twist * about(1, dbeta), translation };
        }
        Self { interface: at, before, normal, after, q: *q, levers }
    }

    /// Returns the chain with its mechanical interface displaced by a small motion, base frame.
    pub fn displaced(mut self, by: &Displacement) -> Self {
        let small = SmallRotation::of(&by.rotation);
        let turned = |axis: Vector3<f64>| axis + small.moved(&axis);
        let columns = [0, 1, 2].map(|k| turned(self.interface.rotation.column(k).into_owned()));
        let translation = self.interface.translation + by.position;
        self.interface = Pose { rotation: Matrix3::from_columns(&columns), translation };
        self
    }

    /// Returns the motion of the point `x` (m, base frame) per unit of an unknown.
    pub fn motion(&self, chain: &Chain, unknown: Unknown, x: &Vector3<f64>) -> PointMotion {
        let slide = |frame: &Pose, axis: usize, place: usize| PointMotion {
            slope: frame.rotation.column(axis).into_owned(),
            axis: Vector3::zeros(),
            place,
        };
        let turn = |frame: &Pose, axis: usize, place: usize| {
            let axis = frame.rotation.column(axis).into_owned();
            PointMotion { slope: axis.cross(&(x - frame.translation)), axis, place }
        };
        // The indices 0 and 1 belong to the motions of the base.
        let place = |row: usize, k: usize| 2 + PER_LINK * row + k;
        let drive = |i: usize| match chain.links[i].kind {
            JointKind::Revolute => turn(&self.before[i], 2, place(i, 0)),
            JointKind::Prismatic => slide(&self.before[i], 2, place(i, 0)),
        };
        let driven = |j: usize, size: f64| {
            let driven = (j..chain.axes()).map(|i| (drive(i), chain.coupling[i][j] * size));
            driven.fold(PointMotion::none(place(j, 0)), |sum, (motion, by)| sum.plus(&motion, by))
        };
        match unknown {
            Unknown::Row(Parameter::Dq(j)) => driven(j, 1.0),
            Unknown::Harmonic { joint, order, sine } => driven(joint, wave(self.q[joint], order, sine)),
            Unknown::Row(Parameter::Dr(i)) => slide(&self.before[i], 2, place(i, 1)),
            Unknown::Row(Parameter::Dl(i)) => slide(&self.normal[i], 0, place(i, 2)),
            Unknown::Row(Parameter::Dalpha(i)) => turn(&self.normal[i], 0, place(i, 3)),
            Unknown::Row(Parameter::Dbeta(i)) => turn(&self.after[i], 1, place(i, 4)),
            Unknown::Row(_) => PointMotion::none(0),
            Unknown::Elastic { joint, link } => {
                PointMotion::none(place(joint, 0)).plus(&drive(joint), self.levers[joint][link])
            }
        }
    }
}

/// Motion of a point per unit of an unknown, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointMotion {
    /// Displacement of the point, m per unit.
    pub slope: Vector3<f64>,
    /// Rotation vector of the motion, rad per unit.
    pub axis: Vector3<f64>,
    /// Index of the motion along the arm. A motion nearer to the base has a smaller index.
    pub place: usize,
}

impl PointMotion {
    /// Returns the zero motion with the index `place` along the arm.
    pub fn none(place: usize) -> Self {
        Self { slope: Vector3::zeros(), axis: Vector3::zeros(), place }
    }

    fn plus(self, other: &Self, by: f64) -> Self {
        Self { slope: self.slope + other.slope * by, axis: self.axis + other.axis * by, ..self }
    }
}

/// Returns the rotation by `angle` (rad) about x (0), y (1) or z (2).
pub fn about(axis: usize, angle: f64) -> Matrix3<f64> {
    let (sin, cos) = angle.sin_cos();
    about_sin_cos(axis, sin, cos)
}

fn about_sin_cos(axis: usize, sin: f64, cos: f64) -> Matrix3<f64> {
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut m = Matrix3::zeros();
    (m[(axis, axis)], m[(j, j)], m[(k, k)]) = (1.0, cos, cos);
    (m[(k, j)], m[(j, k)]) = (sin, -sin);
    m
}
