//! Registration: frames measured with the robot itself, namely a best-fit base frame or taught surface
//! frames.
//!
//! A registration is a rigid motion M fitted to the errors at several points: by least squares, or from three
//! taught points. The controller works in the frame moved by M, so an error E at a node becomes `M^-1 E`. In
//! the linear model, `M^-1 E` is the twist of E minus the twist of M. In the nonlinear and second-order
//! models, the fit is repeated on the remaining errors until it finds no further motion. This iteration
//! converges quadratically, and small errors lose no digits.

use super::position_moments::ErrorMoments;
use super::workspace_average::WorkspaceAverage;
use super::{Effects, ErrorSources, MAX_SOURCES};
use crate::cell::Model;
use crate::kinematic_error::{Perturbation, position_error};
use crate::pose::{Displacement, SmallRotation};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// Largest number of iterations of an exact fit. Three or four suffice for errors of millimetres.
const MAX_ITERATIONS: usize = 16;

/// Threshold of convergence. An exact fit has converged when the displacement (m) plus the rotation (rad) of
/// its correction is below this value.
const CONVERGED: f64 = 1e-17;

/// Distance, m, below which two points count as the same.
const SAME_POINT: f64 = 1e-6;

/// Least-squares fit of the base frame to the TCP position errors over the workspace.
///
/// The fit minimizes the mean square of the errors over all postures between the joint limits. The centre of
/// the fit is the mean TCP position over these postures.
#[derive(Debug, Clone)]
pub struct BestFit {
    workspace: WorkspaceAverage,
    /// Centre of the fit: mean of the TCP position, base frame, m.
    centre: Vector3<f64>,
    /// Covariance `E[r r^T]` of the vector r from the centre to the TCP, m2.
    covariance: Matrix3<f64>,
    /// Inverse of the inertia matrix `E[|r|^2 I - r r^T]`, where r is the vector from the centre to the TCP.
    inverse: Matrix3<f64>,
    /// Part of each source's effect that the fit removes, as a twist. The reference point is the centre of
    /// the fit.
    pub effects: Effects,
}

impl BestFit {
    /// Prepares the best fit of a chain; if `mean` is true, the fit includes the mean error of the
    /// second-order terms.
    pub fn new(chain: &Chain, sources: &ErrorSources, mean: bool) -> Self {
        let is_elastic = sources.list.iter().any(|s| s.parameter.is_elastic());
        let workspace = WorkspaceAverage::new(chain, is_elastic);
        let (centre, square) = workspace.position(&sources.perturbation(chain, &[]));
        let covariance = square - centre * centre.transpose();
        let inertia = Matrix3::identity() * covariance.trace() - covariance;
        // If all points lie on one line, the rotation about this line is undetermined. The pseudo-inverse
        // then yields no rotation about this line.
        let inverse = inertia.pseudo_inverse(1e-12 * inertia.norm()).unwrap_or_else(|_| Matrix3::zeros());
        let mut fit = Self { workspace, centre, covariance, inverse, effects: Effects::default() };
        fit.effects = fit.of_sources(chain, sources, mean);
        fit
    }

    /// Returns the rigid motion fitted to the errors of a sample. The reference point is the centre of the
    /// fit.
    pub fn motion(&self, errors: &Perturbation, model: Model) -> Displacement {
        let undo = |left: &mut ErrorMoments, back: &Displacement| {
            let turn = SmallRotation::of(&back.rotation);
            // Columns of R - 1, where R is the rotation.
            let turn =
                Matrix3::from_columns(&[Vector3::x(), Vector3::y(), Vector3::z()].map(|e| turn.moved(&e)));
            left.product += turn * (self.covariance + left.product);
            left.mean += back.position + turn * left.mean;
        };
        exact(self.about_centre(self.workspace.error(errors, model)), |left| self.twist(left), undo)
    }

    /// Returns the vector from the centre of the fit to the TCP, base frame, m.
    pub fn arm(&self, frames: &Frames) -> Vector3<f64> {
        frames.tcp.translation - self.centre
    }

    /// Returns the moments `E[d]` (m) and `E[d r^T]` (m2) of an error d.
    ///
    /// Here r is the vector from the centre of the fit to the TCP. The argument holds the moments with the
    /// TCP position p instead of r.
    fn about_centre(&self, error: ErrorMoments) -> ErrorMoments {
        ErrorMoments { product: error.product - error.mean * self.centre.transpose(), ..error }
    }

    /// Returns the twist that fits small displacements d best in the sense of least squares.
    ///
    /// The argument holds the moments `E[d]` and `E[d r^T]`, where r is the vector from the centre of the fit
    /// to the TCP. The centre of the fit is the reference point of the twist.
    fn twist(&self, ErrorMoments { mean, product }: &ErrorMoments) -> Displacement {
        // The mean of r x d.
        let moment =
            Vector3::new(product.m32 - product.m23, product.m13 - product.m31, product.m21 - product.m12);
        Displacement { position: *mean, rotation: self.inverse * moment }
    }

    /// Returns the part of each source's effect that the fit removes, as a twist. The reference point is the
    /// centre of the fit.
    fn of_sources(&self, chain: &Chain, sources: &ErrorSources, mean: bool) -> Effects {
        let count = sources.list.len();
        let moments =
            |values: &[f64], model| self.workspace.error(&sources.perturbation(chain, values), model);
        let fitted = |error| self.twist(&self.about_centre(error));
        let mut effects = Effects { count, ..Effects::default() };
        let mut values = [0.0; MAX_SOURCES];
        let values = &mut values[..count];
        for k in 0..count {
            values.fill(0.0);
            values[k] = 1.0;
            effects.columns[k] = fitted(moments(values, Model::Linear));
        }
        for factor in sources.independent().into_iter().filter(|_| mean) {
            values.fill(0.0);
            factor.iter().for_each(|&(k, value)| values[k] = value);
            let linear = moments(values, Model::Linear) * -1.0;
            effects.mean = effects.mean + fitted(moments(values, Model::SecondOrder) + linear);
        }
        effects
    }
}

/// Surface frame taught by touching three points: the origin, a point on the x axis and a point in the xy
/// plane.
#[derive(Debug, Clone)]
pub struct Taught {
    /// Postures that touch the points.
    pub postures: [Frames; 3],
    /// Part of each source's effect that the taught frame removes, as a twist. The reference point is the
    /// origin of this frame.
    pub effects: Effects,
}

impl Taught {
    /// Prepares a taught frame. The second-order terms cause a mean error. If `mean` is true,
    /// [`Self::effects`] also holds the part of this error that the frame removes.
    pub fn new(chain: &Chain, sources: &ErrorSources, postures: [Frames; 3], mean: bool) -> Self {
        let mut taught = Self { postures, effects: Effects::default() };
        let mut expansion = sources.expansion(chain);
        let each = taught.postures.map(|frames| {
            let mut effects = Effects::default();
            expansion.set(&frames);
            effects.set(sources, &expansion, mean);
            effects
        });
        let count = sources.list.len();
        let mut effects = Effects { count, ..Effects::default() };
        for k in 0..count {
            effects.columns[k] = taught.twist(&[0, 1, 2].map(|i| each[i].columns[k].position));
        }
        effects.mean = taught.twist(&[0, 1, 2].map(|i| each[i].mean.position));
        taught.effects = effects;
        taught
    }

    /// Returns the rigid motion by which the errors of a sample move the taught frame. The reference point of
    /// the motion is the origin of this frame.
    pub fn motion(&self, errors: &Perturbation, model: Model) -> Displacement {
        let moved = [0, 1, 2].map(|i| position_error(&self.postures[i], errors, model));
        let undo = |moved: &mut [Vector3<f64>; 3], back: &Displacement| {
            let turn = SmallRotation::of(&back.rotation);
            for (k, d) in moved.iter_mut().enumerate() {
                let from_origin = self.point(k) + *d - self.point(0);
                *d += back.position + turn.moved(&from_origin);
            }
        };
        exact(moved, |moved| self.twist(moved), undo)
    }

    /// Returns whether a point (base frame, m) is one of the touched points.
    pub fn touches(&self, p: &Vector3<f64>) -> bool {
        self.distance(p) < SAME_POINT
    }

    /// Returns the distance of a point (base frame, m) from the nearest touched point, m.
    pub fn distance(&self, p: &Vector3<f64>) -> f64 {
        let distances = self.postures.iter().map(|f| (f.tcp.translation - p).norm());
        distances.fold(f64::INFINITY, f64::min)
    }

    /// Returns the vector from the origin of the taught frame to the TCP, base frame, m.
    pub fn arm(&self, frames: &Frames) -> Vector3<f64> {
        frames.tcp.translation - self.point(0)
    }

    fn point(&self, k: usize) -> Vector3<f64> {
        self.postures[k].tcp.translation
    }

    /// Returns the twist by which small displacements of the three points move the taught frame. The
    /// reference point is the origin of this frame.
    fn twist(&self, moved: &[Vector3<f64>; 3]) -> Displacement {
        let [along, third] = [1, 2].map(|k| self.point(k) - self.point(0));
        let x = along.normalize();
        let z = x.cross(&third).normalize();
        let (lx, x3, y3) = (along.norm(), third.dot(&x), third.dot(&z.cross(&x)));
        let (second, third) = (moved[1] - moved[0], moved[2] - moved[0]);
        let (about_y, about_z) = (-second.dot(&z) / lx, second.dot(&z.cross(&x)) / lx);
        let about_x = (third.dot(&z) + about_y * x3) / y3;
        Displacement { position: moved[0], rotation: x * about_x + z.cross(&x) * about_y + z * about_z }
    }
}

/// Applies `rule` repeatedly to the displacements `left`, and returns the total rigid motion.
///
/// After each application, `undo` removes the motion that this application found. The iteration ends when
/// `rule` finds no further motion.
fn exact<T>(
    mut left: T,
    rule: impl Fn(&T) -> Displacement,
    undo: impl Fn(&mut T, &Displacement),
) -> Displacement {
    let mut undone = Displacement::NONE;
    for _ in 0..MAX_ITERATIONS {
        let back = rule(&left).inverse();
        undone = undone.then(&back);
        undo(&mut left, &back);
        if back.position.norm() + back.rotation.norm() < CONVERGED {
            break;
        }
    }
    undone.inverse()
}
