//! A plan of measuring poses as a linear problem: candidates, unknowns, misfit and task.

use super::deformed::Deformed;
use super::unknown::Unknown;
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::robot::Chain;
use nalgebra::{DMatrix, Matrix3, Matrix3xX, SMatrix, SymmetricEigen, Vector3};

/// A direction in the space of the unknowns is ignored if it hardly displaces the tool at the task. The
/// threshold is the largest mean squared displacement times this share.
const NEGLIGIBLE: f64 = 1e-12;
/// Number of unknowns of the pose of the base.
const OF_BASE: usize = 6;
/// Number of unknowns of the set-up: pose of the base and coordinates of the reflector.
const OF_SET_UP: usize = OF_BASE + 3;

/// Errors of measured positions that the unknowns do not explain, per axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct UnmodelledError {
    /// Standard deviation of the part of the error that is nearly the same at nearby poses, m.
    pub shared: f64,
    /// Length scale L of the shared part of the error, rad. At two poses with the distance d in the joint
    /// space, the correlation of this part is `exp(-d^2 / (2 L^2))`.
    pub length: f64,
    /// Standard deviation of the part of the error that is independent of the errors at all other poses, m.
    pub own: f64,
}

impl Default for UnmodelledError {
    /// Returns the unmodelled error of a measured arm, in rounded values.
    ///
    /// For the series A, B and D of a UR10 (Landgraf et al. 2021), maximum likelihood gives 0.10 to 0.21 mm
    /// for the shared part. The length scale is 0.83 to 0.99 rad, and the independent part is 0.18 to 0.22
    /// mm.
    fn default() -> Self {
        Self { shared: 2e-4, length: 1.0, own: 2e-4 }
    }
}

/// Calibration for which measuring poses are planned.
#[derive(Debug, Clone, Copy)]
pub struct IntendedCalibration<'a> {
    pub chain: &'a Chain,
    pub unknowns: &'a [Unknown],
    /// Prior standard deviations of the unknowns.
    pub priors: &'a [f64],
    /// Position of the reflector in the frame of the mechanical interface, m.
    pub reflector: Vector3<f64>,
    pub error: UnmodelledError,
}

impl IntendedCalibration<'_> {
    /// Returns the least number of poses that together give at least one measured coordinate per unknown.
    /// Each pose gives three measured coordinates. Base and reflector count as unknowns
    /// ([`Self::unknowns_with_set_up`]).
    pub fn least_poses(&self) -> usize {
        self.unknowns_with_set_up().div_ceil(3)
    }

    /// Returns the number of unknowns of the robot, the base and the reflector.
    pub fn unknowns_with_set_up(&self) -> usize {
        self.unknowns.len() + OF_SET_UP
    }

    /// Returns the displacement of a point per standard deviation of each unknown, base frame, m. `point` is
    /// the point in the interface frame, m.
    ///
    /// The last nine columns belong to the set-up, whose standard deviations are 1 m and 1 rad.
    fn slopes(&self, joints: &JointVector, point: &Vector3<f64>) -> Matrix3xX<f64> {
        let pose = Deformed::new(self.chain, joints, self.unknowns, &vec![0.0; self.unknowns.len()]);
        let at = pose.interface.transform(point);
        let robot = self.unknowns.iter().zip(self.priors);
        let robot = robot.map(|(unknown, prior)| pose.motion(self.chain, *unknown, &at).slope * *prior);
        let axes = [0, 1, 2].map(|k| Vector3::ith(k, 1.0));
        let reflector = [0, 1, 2].map(|k| pose.interface.rotation.column(k).into_owned());
        let set_up = axes.into_iter().chain(axes.map(|axis| axis.cross(&at))).chain(reflector);
        Matrix3xX::from_columns(&robot.chain(set_up).collect::<Vec<_>>())
    }
}

/// Choice of measuring poses among candidates. The plan minimizes the expected error of predicted
/// positions at the task (a list of postures).
#[derive(Debug, Clone)]
pub struct PlanProblem {
    /// Motion of the reflector at every candidate per standard deviation of each unknown, m.
    pub(super) slopes: Vec<Matrix3xX<f64>>,
    /// Points that represent the candidates (see `place`). The distance between two points is the root sum
    /// square of the contributions of all joints. A revolute joint contributes the chord of its angle
    /// difference on the unit circle.
    places: Vec<SMatrix<f64, { 2 * MAX_JOINTS }, 1>>,
    /// Directions in the space of the unknowns that displace the tool at the task. The mean squared error is
    /// the sum of the variances of the scalar products of these directions with the unknowns.
    pub(super) targets: DMatrix<f64>,
    pub(super) error: UnmodelledError,
}

impl PlanProblem {
    /// Prepares the choice among `candidates`. The chosen poses are to reduce the expected error at the
    /// postures in `task`.
    pub fn new(intended: &IntendedCalibration<'_>, candidates: &[JointVector], task: &[JointVector]) -> Self {
        let slopes: Vec<_> = candidates.iter().map(|q| intended.slopes(q, &intended.reflector)).collect();
        let registered = registered(&slopes, intended.unknowns.len());
        let tcp = intended.chain.tool.translation;
        let tasks: Vec<_> = task.iter().map(|q| intended.slopes(q, &tcp)).collect();
        let targets = targets(&tasks, &registered);
        let places = candidates.iter().map(|q| place(intended.chain, q)).collect();
        Self { slopes, places, targets, error: intended.error }
    }

    /// Returns the number of candidates.
    pub fn candidates(&self) -> usize {
        self.slopes.len()
    }

    /// Returns the prior covariance of the positions of two candidates, without the independent errors.
    pub(super) fn prior(&self, i: usize, j: usize) -> Matrix3<f64> {
        let columns = self.slopes[i].column_iter().zip(self.slopes[j].column_iter());
        let modelled = columns.fold(Matrix3::zeros(), |sum, (a, b)| sum + a * b.transpose());
        let UnmodelledError { shared, length, .. } = self.error;
        let apart = (self.places[i] - self.places[j]).norm_squared() / length.powi(2);
        modelled + Matrix3::identity() * (shared.powi(2) * (-apart / 2.0).exp())
    }
}

/// Returns the point that represents a posture in comparisons, with two coordinates per joint. Postures whose
/// joint angles differ by full revolutions have the same point. The distance between two points is the root
/// sum square of the contributions of all joints. A revolute joint contributes the chord of its angle
/// difference on the unit circle. The whole travel of a prismatic joint counts as half a revolution.
fn place(chain: &Chain, q: &JointVector) -> SMatrix<f64, { 2 * MAX_JOINTS }, 1> {
    let mut place = SMatrix::zeros();
    for (i, link) in chain.links.iter().enumerate() {
        let travel = link.limits.1 - link.limits.0;
        (place[2 * i], place[2 * i + 1]) = match link.kind {
            JointKind::Revolute => q[i].sin_cos(),
            JointKind::Prismatic if travel > 0.0 => (2.0 * q[i] / travel, 0.0),
            JointKind::Prismatic => (0.0, 0.0),
        };
    }
    place
}

/// Returns, for each unknown, the motion of the base that best fits the motions of the reflector at all
/// candidates.
fn registered(slopes: &[Matrix3xX<f64>], unknowns: usize) -> DMatrix<f64> {
    // Without this small term, candidates in a line would leave a rotation undetermined.
    let mut normal = DMatrix::identity(OF_BASE, OF_BASE) * (1e-9 * slopes.len() as f64);
    let mut right = DMatrix::zeros(OF_BASE, unknowns);
    for slopes in slopes {
        let (robot, base) = (slopes.columns(0, unknowns), slopes.columns(unknowns, OF_BASE));
        normal.gemm_tr(1.0, &base, &base, 1.0);
        right.gemm_tr(1.0, &base, &robot, 1.0);
    }
    // The normal matrix is positive definite unless it contains NaN.
    normal.cholesky().map_or_else(|| DMatrix::zeros(OF_BASE, unknowns), |c| c.solve(&right))
}

/// Returns the directions in the space of the unknowns that displace the tool at the task. The length of a
/// direction is the displacement of the tool for a unit step along this direction. The displacement is the
/// root mean square over the postures of the task.
///
/// Let T be the matrix of these directions, and a the vector of the unknowns. The mean squared displacement
/// is `|T^T a|^2`.
fn targets(tasks: &[Matrix3xX<f64>], registered: &DMatrix<f64>) -> DMatrix<f64> {
    let unknowns = registered.ncols();
    let mut squares = DMatrix::zeros(unknowns, unknowns);
    for slopes in tasks {
        let base = slopes.columns(unknowns, OF_BASE) * registered;
        let seen = slopes.columns(0, unknowns) - base;
        squares.gemm_tr(1.0 / tasks.len() as f64, &seen, &seen, 1.0);
    }
    let eigen = SymmetricEigen::new(squares);
    let least = eigen.eigenvalues.max() * NEGLIGIBLE;
    let kept: Vec<_> = (0..unknowns).filter(|&k| eigen.eigenvalues[k] > least).collect();
    DMatrix::from_fn(unknowns, kept.len(), |i, k| {
        eigen.eigenvectors[(i, kept[k])] * eigen.eigenvalues[kept[k]].sqrt()
    })
}
