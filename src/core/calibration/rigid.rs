//! Pose of the robot base and positions of the reflectors of one session.

use super::deformed::{Deformed, PointMotion};
use super::session::{MeasuredPosition, reflectors};
use crate::pose::{Pose, SmallRotation};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Frames of one session that the calibration finds.
#[derive(Debug, Clone, PartialEq)]
pub struct SessionFrames {
    /// Pose of the robot base in the frame of the instrument.
    pub base: Pose,
    /// Positions of the reflectors in the frame of the mechanical interface, m.
    pub reflectors: Vec<Vector3<f64>>,
}

impl SessionFrames {
    /// Number of unknowns of the base: translation and rotation.
    pub const OF_BASE: usize = 6;

    /// Returns the number of unknowns of a session: six for the base, and three for each reflector.
    pub fn unknowns(measured: &[MeasuredPosition]) -> usize {
        Self::OF_BASE + 3 * reflectors(measured)
    }

    /// Returns the number of unknowns of this session.
    pub const fn size(&self) -> usize {
        Self::OF_BASE + 3 * self.reflectors.len()
    }

    /// Returns the position of a reflector in the base frame, m, for a pose of the mechanical interface.
    pub fn reached(&self, interface: &Pose, reflector: usize) -> Vector3<f64> {
        interface.transform(&self.reflectors[reflector])
    }

    /// Returns the measured position minus the predicted position, m, base frame.
    pub fn residual(&self, interface: &Pose, measured: &MeasuredPosition) -> Vector3<f64> {
        self.base.inverse().transform(&measured.position) - self.reached(interface, measured.reflector)
    }

    /// Returns the motions of a reflector per unit of each unknown of the session, base frame.
    ///
    /// The unknowns are the translation of the base, its rotation about the axes of the base frame (rad), and
    /// the coordinates of every reflector.
    pub fn motions(&self, interface: &Pose, reflector: usize) -> Vec<PointMotion> {
        let reached = self.reached(interface, reflector);
        let axes = [0, 1, 2].map(|k| Vector3::ith(k, 1.0));
        let slides = axes.map(|slope| PointMotion { slope, ..PointMotion::none(0) });
        let turns = axes.map(|axis| PointMotion { slope: axis.cross(&reached), axis, place: 1 });
        let own = (0..3 * self.reflectors.len()).map(|k| {
            let is_own = k / 3 == reflector;
            let slope = if is_own { interface.rotation.column(k % 3).into_owned() } else { Vector3::zeros() };
            PointMotion { slope, ..PointMotion::none(usize::MAX) }
        });
        slides.into_iter().chain(turns).chain(own).collect()
    }

    /// Moves the frames by a step of the unknowns, in the order of [`Self::motions`].
    pub fn take_step(&mut self, step: &[f64]) {
        let v = |k: usize| Vector3::new(step[k], step[k + 1], step[k + 2]);
        let small = SmallRotation::of(&v(3));
        let turned = |axis: Vector3<f64>| axis + small.moved(&axis);
        let columns = [0, 1, 2].map(|k| turned(Vector3::ith(k, 1.0)));
        self.base = self.base * Pose { rotation: Matrix3::from_columns(&columns), translation: v(0) };
        let own = self.reflectors.iter_mut().enumerate();
        own.for_each(|(k, reflector)| *reflector += v(Self::OF_BASE + 3 * k));
    }
}

/// Largest number of Gauss-Newton steps of an alignment.
const STEPS: usize = 30;
/// An alignment has converged when its step (m and rad) is below this value.
const CONVERGED: f64 = 1e-10;

/// Prior standard deviation of each coordinate of a reflector, m.
pub(super) const FARTHEST_REFLECTOR: f64 = 0.3;
/// Least standard deviation of a measured position per axis, m; no instrument is more accurate.
const FINEST: f64 = 1e-6;

/// Returns the frames of a session that fit the measured positions best, by least squares. In some sessions,
/// the positions do not determine a coordinate of a reflector. An example is the height below a flange that
/// always points down. Such a coordinate stays near 0, its value at the origin of the mechanical interface.
///
/// The first estimate of the base is a rigid motion (Kabsch 1976). It is the motion that best maps the
/// origins of the mechanical interface onto the measured positions. Returns None if the positions do not
/// determine this motion.
pub fn aligned(poses: &[Deformed], measured: &[MeasuredPosition]) -> Option<SessionFrames> {
    let pairs = poses.iter().zip(measured).map(|(pose, m)| (pose.interface.translation, m.position));
    let base = superposed(pairs)?;
    let mut frames = SessionFrames { base, reflectors: vec![Vector3::zeros(); reflectors(measured)] };
    let size = SessionFrames::unknowns(measured);
    for _ in 0..STEPS {
        let squares: f64 =
            poses.iter().zip(measured).map(|(p, m)| frames.residual(&p.interface, m).norm_squared()).sum();
        let variance = (squares / (3 * measured.len()) as f64).max(FINEST.powi(2));
        let mut normal = DMatrix::identity(size, size) * 1e-12;
        let mut right = DVector::zeros(size);
        // The pull to the mechanical interface matters only for coordinates that the positions do not
        // determine.
        let pull = variance / FARTHEST_REFLECTOR.powi(2);
        let coordinates = frames.reflectors.iter().flat_map(|reflector| reflector.iter());
        for (k, coordinate) in coordinates.enumerate() {
            let k = SessionFrames::OF_BASE + k;
            normal[(k, k)] += pull;
            right[k] -= pull * coordinate;
        }
        for (pose, measured) in poses.iter().zip(measured) {
            let motions = frames.motions(&pose.interface, measured.reflector);
            let residual = frames.residual(&pose.interface, measured);
            for (j, a) in motions.iter().enumerate() {
                right[j] += a.slope.dot(&residual);
                motions.iter().enumerate().for_each(|(k, b)| normal[(j, k)] += a.slope.dot(&b.slope));
            }
        }
        let step = normal.cholesky()?.solve(&right);
        frames.take_step(step.as_slice());
        if step.amax() < CONVERGED {
            break;
        }
    }
    Some(frames)
}

/// Returns the rigid motion that best moves the first points of the pairs onto the second points (Kabsch
/// 1976).
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
