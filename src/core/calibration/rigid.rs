//! Pose of the robot base and place of the reflector of one session.

use super::deformed::{Deformed, PointMotion};
use super::session::MeasuredPosition;
use crate::pose::{Pose, SmallRotation};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Frames of one session that the calibration finds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SessionFrames {
    /// Pose of the robot base in the frame of the instrument.
    pub base: Pose,
    /// Reflector in the frame of the mechanical interface, m.
    pub reflector: Vector3<f64>,
}

impl SessionFrames {
    /// Number of unknowns: translation and rotation of the base, and the three coordinates of the reflector.
    pub const UNKNOWNS: usize = 9;

    /// Returns the reflector in the base frame, m, for a pose of the mechanical interface.
    pub fn reached(&self, interface: &Pose) -> Vector3<f64> {
        interface.transform(&self.reflector)
    }

    /// Returns the measured position minus the predicted one, m, base frame.
    pub fn residual(&self, interface: &Pose, measured: &MeasuredPosition) -> Vector3<f64> {
        self.base.inverse().transform(&measured.position) - self.reached(interface)
    }

    /// Returns the derivatives of the predicted position with respect to the unknowns of the session.
    ///
    /// The columns are the translation of the base, its rotation about the axes of the base frame (rad), and
    /// the reflector.
    pub fn derivatives(&self, interface: &Pose) -> SMatrix<f64, 3, 9> {
        let reached = self.reached(interface);
        let mut columns = SMatrix::<f64, 3, 9>::zeros();
        for k in 0..3 {
            let axis = Vector3::ith(k, 1.0);
            columns.set_column(k, &axis);
            columns.set_column(3 + k, &axis.cross(&reached));
            columns.set_column(6 + k, &interface.rotation.column(k));
        }
        columns
    }

    /// Returns the motions of the reflector by the unknowns of the session, in the order of
    /// [`Self::derivatives`].
    pub fn motions(&self, interface: &Pose) -> [PointMotion; 9] {
        let columns = self.derivatives(interface);
        std::array::from_fn(|k| {
            let (axis, place) = match k / 3 {
                0 => (Vector3::zeros(), 0),
                1 => (Vector3::ith(k - 3, 1.0), 1),
                _ => (Vector3::zeros(), usize::MAX),
            };
            PointMotion { slope: columns.column(k).into_owned(), axis, place }
        })
    }

    /// Returns the frames after a step of the unknowns, in the order of [`Self::derivatives`].
    pub fn moved(&self, step: &[f64]) -> Self {
        let v = |k: usize| Vector3::new(step[k], step[k + 1], step[k + 2]);
        let rotation = v(3);
        let small = SmallRotation::of(&rotation);
        let turned = |axis: Vector3<f64>| axis + small.moved(&axis);
        let columns = [0, 1, 2].map(|k| turned(Vector3::ith(k, 1.0)));
        let by = Pose { rotation: Matrix3::from_columns(&columns), translation: v(0) };
        Self { base: self.base * by, reflector: self.reflector + v(6) }
    }
}

/// Largest number of Gauss-Newton steps of an alignment.
const STEPS: usize = 30;
/// Step (m and rad) below which an alignment has converged.
const CONVERGED: f64 = 1e-10;

/// Returns the frames of a session that fit the measured positions best, by least squares.
///
/// The first estimate of the base is the rigid motion (Kabsch 1976) from the mechanical interface to the
/// measured positions. Returns None if the positions do not determine it.
pub fn aligned(poses: &[Deformed], measured: &[MeasuredPosition]) -> Option<SessionFrames> {
    let base =
        superposed(poses.iter().map(|p| p.interface.translation).zip(measured.iter().map(|m| m.position)))?;
    let mut frames = SessionFrames { base, reflector: Vector3::zeros() };
    for _ in 0..STEPS {
        let mut normal = SMatrix::<f64, 9, 9>::identity() * 1e-12;
        let mut right = SVector::<f64, 9>::zeros();
        for (pose, measured) in poses.iter().zip(measured) {
            let columns = frames.derivatives(&pose.interface);
            normal += columns.transpose() * columns;
            right += columns.transpose() * frames.residual(&pose.interface, measured);
        }
        let step = normal.cholesky()?.solve(&right);
        frames = frames.moved(step.as_slice());
        if step.amax() < CONVERGED {
            break;
        }
    }
    Some(frames)
}

/// Returns the rigid motion that moves the first point of each pair onto the second best.
fn superposed(pairs: impl Iterator<Item = (Vector3<f64>, Vector3<f64>)> + Clone) -> Option<Pose> {
    let count = pairs.clone().count() as f64;
    let zero = (Vector3::zeros(), Vector3::zeros());
    let (a, b) = pairs.clone().fold(zero, |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
    let (a, b) = (a / count, b / count);
    let spread: Matrix3<f64> = pairs.map(|(p, m)| (m - b) * (p - a).transpose()).sum();
    let svd = spread.svd(true, true);
    let (u, v) = (svd.u?, svd.v_t?);
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, (u * v).determinant().signum()));
    let rotation = u * mirror * v;
    Some(Pose { rotation, translation: b - rotation * a })
}
