//! Average over the workspace: moments of the TCP position and of its error if all actuator coordinates are
//! independent and uniform between the joint limits.
//!
//! The moments are propagated from the tool to the base, joint by joint. Rigid transforms and small motions
//! map the moments linearly, and the mean over the range of a joint has a closed form ([`Harmonics`]). So the
//! average is exact, unless an actuator drives later joints through the coupling. The mean over the range of
//! such an actuator is computed by a Gauss-Legendre rule with a relative error below 1e-4.
//!
//! Elastic deflections depend on all joints at once. The part of the error that they cause is averaged over
//! the postures of a Halton sequence. The rest of the error is averaged as described above.

use super::position_moments::{ErrorMoments, Harmonics, PositionMoments};
use crate::cell::{JointKind, JointVector, MAX_JOINTS, Model};
use crate::kinematic_error::{Perturbation, position_error};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::{DMatrix, Matrix3, Vector3};
use std::ops::Range;

/// Number of nodes of a Gauss-Legendre rule, in addition to the nodes for the oscillation of the integrand.
const SPARE_NODES: f64 = 4.0;
/// Greatest number of nodes of a Gauss-Legendre rule. This number suffices for a joint with 10 turns in each
/// direction.
const MAX_NODES: f64 = 128.0;

/// Number of postures over which elastic deflections are averaged.
const ELASTIC_POSTURES: usize = 1024;

/// A chain prepared for averages over its workspace.
#[derive(Debug, Clone)]
pub struct WorkspaceAverage {
    mount: Pose,
    tool: Pose,
    rows: Vec<AveragedRow>,
    /// Ranges of rows such that no actuator of one range drives a joint of another range.
    segments: Vec<Range<usize>>,
    /// Postures over which elastic deflections are averaged; empty if no error is elastic.
    postures: Vec<Frames>,
}

/// One Denavit-Hartenberg row with the actuator of its joint.
#[derive(Debug, Clone)]
struct AveragedRow {
    kind: JointKind,
    /// Fourier coefficients of the angle theta at actuator coordinate 0.
    theta: Harmonics,
    /// Fourier coefficients of the angle theta at a random actuator coordinate; used only for a revolute
    /// joint.
    random_theta: Harmonics,
    /// Link transform of the row without the rotation theta, at actuator coordinate 0.
    link: Pose,
    /// Least and greatest actuator coordinate, rad or m.
    range: (f64, f64),
    /// Coupling factors by which this actuator and the actuators before it move the joint.
    coupling: Vec<f64>,
    /// Gauss-Legendre rule over the range, as actuator coordinates and weights whose sum is 1.
    ///
    /// The rule is empty if the actuator drives no later joint.
    nodes: Vec<(f64, f64)>,
}

/// Errors whose moments are averaged, and the model that gives their effect.
#[derive(Clone, Copy)]
struct AveragedErrors<'a> {
    errors: &'a Perturbation,
    model: Model,
}

impl WorkspaceAverage {
    /// Prepares the averages over the workspace of a chain; `elastic` states whether any error is elastic.
    pub fn new(chain: &Chain, elastic: bool) -> Self {
        let axes = chain.axes();
        let drives = |j: usize, i: usize| {
            let (low, high) = chain.links[j].limits;
            chain.coupling[i][j] != 0.0 && low < high
        };
        let is_crossed = |row: usize| (row..axes).any(|i| (0..row).any(|j| drives(j, i)));
        let starts: Vec<usize> = (0..=axes).filter(|row| !is_crossed(*row)).collect();
        let segments = starts.windows(2).map(|ends| ends[0]..ends[1]).collect();
        let rows = (0..axes).map(|j| {
            let driven: f64 =
                (j + 1..axes).filter(|&i| drives(j, i)).map(|i| chain.coupling[i][j].abs()).sum();
            AveragedRow::new(chain, j, driven)
        });
        let count = if elastic { ELASTIC_POSTURES } else { 0 };
        let postures = (0..count).map(|k| chain.frames(&chain.posture(&chain.halton_sample(k))));
        let (rows, postures) = (rows.collect(), postures.collect());
        Self { mount: chain.mount, tool: chain.tool, rows, segments, postures }
    }

    /// Returns mean (m) and second moment (m2) of the TCP position without errors, base frame. The values in
    /// `errors` do not affect the result.
    pub fn position(&self, errors: &Perturbation) -> (Vector3<f64>, Matrix3<f64>) {
        let PositionMoments { mean, square, .. } = self.moments(errors, Model::Linear);
        (mean, square)
    }

    /// Returns the moments of the position error of the TCP by a model, base frame. Without elastic errors,
    /// the function allocates no memory.
    pub fn error(&self, errors: &Perturbation, model: Model) -> ErrorMoments {
        let PositionMoments { error, second, .. } = self.moments(errors, model);
        match errors.elastic {
            None => error + second,
            Some(_) => error + second + self.elastic(errors, model),
        }
    }

    /// Returns the part of the moments of the position error that elastic deflections cause.
    fn elastic(&self, errors: &Perturbation, model: Model) -> ErrorMoments {
        let rigid = errors.rigid();
        let sum = self.postures.iter().fold(ErrorMoments::NONE, |sum, frames| {
            let mean = position_error(frames, errors, model) - position_error(frames, &rigid, model);
            sum + ErrorMoments { mean, product: mean * frames.tcp.translation.transpose() }
        });
        sum * (1.0 / self.postures.len().max(1) as f64)
    }

    /// Returns the moments of the TCP position and its error, base frame.
    fn moments(&self, errors: &Perturbation, model: Model) -> PositionMoments {
        let mut at = PositionMoments::ORIGIN;
        if let Some(error) = &errors.tool {
            at.add_frame(model, &Pose::IDENTITY, error);
        }
        at = at.placed(&self.tool);
        let (errors, mut joints) = (AveragedErrors { errors, model }, [0.0; MAX_JOINTS]);
        for rows in self.segments.iter().rev() {
            at = self.before(rows.clone(), &at, &mut joints, errors);
        }
        at = at.placed(&self.mount);
        if let Some(error) = &errors.errors.base {
            at.add_frame(model, &Pose::IDENTITY, error);
        }
        at
    }

    /// Returns the moments in the frame before the rows `rows`, given the moments `after` in the frame after
    /// these rows.
    ///
    /// `joints` holds the coordinates of the actuators that drive these rows.
    fn before(
        &self,
        rows: Range<usize>,
        after: &PositionMoments,
        joints: &mut JointVector,
        errors: AveragedErrors<'_>,
    ) -> PositionMoments {
        if rows.is_empty() {
            return *after;
        }
        let (row, later) = (&self.rows[rows.start], rows.start + 1..rows.end);
        if row.nodes.is_empty() {
            let inner = self.before(later, after, joints, errors);
            return row.before(rows.start, &inner, joints, None, errors);
        }
        let mut sum = PositionMoments::ORIGIN;
        for &(q, weight) in &row.nodes {
            joints[rows.start] = q;
            let inner = self.before(later.clone(), after, joints, errors);
            sum = sum + row.before(rows.start, &inner, joints, Some(q), errors) * weight;
        }
        joints[rows.start] = 0.0;
        sum
    }
}

impl AveragedRow {
    /// Prepares row `j` of a chain; `driven` is the sum of the factors by which its actuator drives later
    /// joints.
    fn new(chain: &Chain, j: usize, driven: f64) -> Self {
        let link = &chain.links[j];
        let own = if link.kind == JointKind::Revolute { 1.0 } else { 0.0 };
        // The moments are of degree 2 in sine and cosine of an angle. On the interval -1 to 1, n nodes
        // suffice for an angular frequency of 2 n.
        let frequency = 2.0 * (own + driven) * (link.limits.1 - link.limits.0) / 2.0;
        let count = (SPARE_NODES + frequency / 2.0).ceil().min(MAX_NODES) as usize;
        let theta = Harmonics::of_angle(link.theta);
        Self {
            kind: link.kind,
            theta,
            random_theta: theta.plus(&Harmonics::of_range(link.limits)),
            link: link.pose(1.0, 0.0, link.r),
            range: link.limits,
            coupling: chain.coupling[j][..=j].to_vec(),
            nodes: if driven > 0.0 { gauss_legendre(count, link.limits) } else { Vec::new() },
        }
    }

    /// Returns the moments in the frame before row `index`, given the moments `after` in the frame after this
    /// row.
    ///
    /// `at` is the coordinate of the actuator. If `at` is None, the moments are averaged over the range of
    /// the actuator. `joints` holds the coordinates of the actuators that drive the joint.
    fn before(
        &self,
        index: usize,
        after: &PositionMoments,
        joints: &JointVector,
        at: Option<f64>,
        AveragedErrors { errors, model }: AveragedErrors<'_>,
    ) -> PositionMoments {
        let (error, origin, mut moments) = (&errors.links()[index], Vector3::zeros(), *after);
        moments.add_turn(model, &Vector3::y(), &origin, &error.dbeta);
        moments.add_turn(model, &Vector3::x(), &origin, &error.dalpha);
        let axis = self.link.rotation.transpose() * Vector3::z();
        moments.add_slide(&(Vector3::x() * error.dl + axis * error.dr));
        let driven: f64 = self.coupling[..index].iter().zip(joints).map(|(c, q)| c * q).sum();
        moments = self.moved(&moments.placed(&self.link), driven, at);
        moments.add_turn(model, &Vector3::z(), &origin, &error.dtheta);
        if let Some(of_joints) = &errors.joints
            && let Some(error) = &of_joints.errors[index]
        {
            moments.add_frame(model, &of_joints.frames[index], error);
        }
        moments
    }

    /// Returns the moments after the motion of the joint; `driven` (rad or m) is the part of the motion that
    /// other actuators cause.
    fn moved(&self, moments: &PositionMoments, driven: f64, at: Option<f64>) -> PositionMoments {
        match self.kind {
            JointKind::Revolute => {
                let own = at.map_or(self.random_theta, |q| self.theta.plus(&Harmonics::of_angle(q)));
                moments.turned(&own.plus(&Harmonics::of_angle(driven)))
            }
            JointKind::Prismatic => {
                let (low, high) = at.map_or(self.range, |q| (q, q));
                let (mean, variance) = ((low + high) / 2.0 + driven, (high - low).powi(2) / 12.0);
                moments.turned(&self.theta).slid(mean, mean * mean + variance)
            }
        }
    }
}

/// Returns nodes and weights of the Gauss-Legendre rule for the mean over a range.
///
/// The nodes are the eigenvalues of the Jacobi matrix of the Legendre polynomials. The weights are the
/// squares of the first components of its eigenvectors (Golub and Welsch, Mathematics of Computation 23
/// (1969) 221-230).
fn gauss_legendre(count: usize, (low, high): (f64, f64)) -> Vec<(f64, f64)> {
    let beside = |k: usize| k as f64 / (4.0 * (k * k) as f64 - 1.0).sqrt();
    let jacobi =
        DMatrix::from_fn(count, count, |i, j| if i.abs_diff(j) == 1 { beside(i.max(j)) } else { 0.0 });
    let eigen = jacobi.symmetric_eigen();
    let node = |k: usize| (low + high + (high - low) * eigen.eigenvalues[k]) / 2.0;
    (0..count).map(|k| (node(k), eigen.eigenvectors[(0, k)].powi(2))).collect()
}
