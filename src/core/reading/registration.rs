//! Registration: frames measured with the robot itself, a best-fitted base and taught surfaces.
//!
//! A registration is a rigid motion M that a rule fits to the errors at some points. The controller works in
//! the moved frame, so an error E at a node becomes `M^-1 E`. To first order this is a difference of twists.
//! For the other models the rule is applied again to the errors that remain. This iteration converges
//! quadratically and keeps the digits of small errors.

use super::{Effects, ErrorSources};
use crate::cell::Model;
use crate::kinematic_error::{Perturbation, position_error};
use crate::pose::{Displacement, SmallRotation};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// Number of postures over which the base frame is fitted.
const POSTURES: usize = 64;

/// Largest number of iterations of an exact fit. Three or four suffice for errors of millimetres.
const MAX_ITERATIONS: usize = 16;

/// Size of a correction (m and rad) below which an exact fit has converged.
const CONVERGED: f64 = 1e-17;

/// Distance, m, below which two points are the same.
const SAME_POINT: f64 = 1e-6;

/// Best fit of the base frame: the least squares of the TCP position errors at 64 low-discrepancy postures
/// between the joint limits.
#[derive(Debug, Clone)]
pub struct BestFit {
    postures: Vec<Frames>,
    centre: Vector3<f64>,
    /// Inverse of the inertia matrix `sum (|r|^2 I - r r^T)`, where r are the vectors from the centre to the
    /// TCP positions of the fit.
    inverse: Matrix3<f64>,
    /// Part of the effect of each source that the fit removes: a twist with the translation of the centre.
    pub effects: Effects,
}

impl BestFit {
    /// Prepares the best fit of a chain; if `mean` is true, the fit includes the mean error of the
    /// second-order terms.
    pub fn new(chain: &Chain, sources: &ErrorSources, mean: bool) -> Self {
        let postures: Vec<Frames> =
            (0..POSTURES).map(|k| chain.frames(&chain.posture(&chain.halton_sample(k)))).collect();
        let centre = postures.iter().map(|f| f.tcp.translation).sum::<Vector3<f64>>() / POSTURES as f64;
        let inertia = postures.iter().map(|f| f.tcp.translation - centre).fold(Matrix3::zeros(), |sum, r| {
            sum + Matrix3::identity() * r.norm_squared() - r * r.transpose()
        });
        // Points on one line leave the rotation about it undetermined; then the pseudo-inverse takes none.
        let inverse = inertia.pseudo_inverse(1e-12 * inertia.norm()).unwrap_or_else(|_| Matrix3::zeros());
        let mut fit = Self { postures, centre, inverse, effects: Effects::default() };
        fit.effects = fit.of_sources(chain, sources, mean);
        fit
    }

    /// Returns the rigid motion fitted to a sample, with the translation of the centre of the fit.
    pub fn motion(&self, errors: &Perturbation, model: Model) -> Displacement {
        let mut moved = [Vector3::zeros(); POSTURES];
        for (moved, posture) in moved.iter_mut().zip(&self.postures) {
            *moved = position_error(posture, errors, model);
        }
        let point = |k: usize| self.postures[k].tcp.translation;
        exact(&point, &mut moved, &self.centre, |moved| self.twist(moved))
    }

    /// Returns the postures of the fit.
    pub fn postures(&self) -> &[Frames] {
        &self.postures
    }

    /// Returns the vector from the centre of the fit to the TCP, base frame, m.
    pub fn arm(&self, frames: &Frames) -> Vector3<f64> {
        frames.tcp.translation - self.centre
    }

    /// Returns the least-squares twist of small displacements, with the translation of the centre of the fit.
    fn twist(&self, moved: &[Vector3<f64>]) -> Displacement {
        let position = moved.iter().sum::<Vector3<f64>>() / POSTURES as f64;
        let arms = self.postures.iter().map(|f| f.tcp.translation - self.centre);
        let moment: Vector3<f64> = arms.zip(moved).map(|(r, d)| r.cross(d)).sum();
        Displacement { position, rotation: self.inverse * moment }
    }

    /// Returns the part of the effect of each source that the fit removes: a twist with the translation of
    /// the centre.
    fn of_sources(&self, chain: &Chain, sources: &ErrorSources, mean: bool) -> Effects {
        let mut expansion = sources.expansion(chain);
        let each: Vec<Effects> = self
            .postures
            .iter()
            .map(|frames| {
                let mut effects = Effects::default();
                expansion.set(frames);
                effects.set(sources, &expansion, mean);
                effects
            })
            .collect();
        let fit =
            |pick: &dyn Fn(&Effects) -> Vector3<f64>| self.twist(&each.iter().map(pick).collect::<Vec<_>>());
        let mut fitted = Effects { count: sources.list.len(), ..Effects::default() };
        for k in 0..fitted.count {
            fitted.columns[k] = fit(&|effects| effects.columns[k].position);
        }
        fitted.mean = fit(&|effects| effects.mean.position);
        fitted
    }
}

/// Surface frame taught by touching three points: the origin, a point on the x axis and a point in the xy
/// plane.
#[derive(Debug, Clone)]
pub struct Taught {
    /// Postures that touch the points.
    pub postures: [Frames; 3],
    /// Part of the effect of each source that the taught frame removes: a twist with the translation of the
    /// origin.
    pub effects: Effects,
}

impl Taught {
    /// Prepares a taught frame; if `mean` is true, the frame includes the mean error of the second-order
    /// terms.
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

    /// Returns the rigid motion of the taught frame for a sample, with the translation of its origin.
    pub fn motion(&self, errors: &Perturbation, model: Model) -> Displacement {
        let mut moved = [0, 1, 2].map(|i| position_error(&self.postures[i], errors, model));
        let point = |k: usize| self.point(k);
        exact(&point, &mut moved, &self.point(0), |moved| self.twist(moved))
    }

    /// Returns whether a point (base frame, m) is one of the touched points.
    pub fn touches(&self, p: &Vector3<f64>) -> bool {
        self.distance(p) < SAME_POINT
    }

    /// Returns the distance of a target (base frame, m) from the nearest touched point, m.
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

    /// Returns the twist of the taught frame, with the translation of its origin, for small displacements of
    /// the three points.
    fn twist(&self, moved: &[Vector3<f64>]) -> Displacement {
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

/// Returns the rigid motion, with the translation of `centre`, that an exact fit by `rule` finds.
///
/// The displacements `moved` of the points are reduced by the fitted motion until the rule finds none left.
fn exact(
    point: &dyn Fn(usize) -> Vector3<f64>,
    moved: &mut [Vector3<f64>],
    centre: &Vector3<f64>,
    rule: impl Fn(&[Vector3<f64>]) -> Displacement,
) -> Displacement {
    // Motion undone so far, seen at the centre.
    let mut undone = Displacement::NONE;
    for _ in 0..MAX_ITERATIONS {
        let back = rule(moved).inverse();
        undone = undone.then(&back);
        let turn = SmallRotation::of(&back.rotation);
        for (k, d) in moved.iter_mut().enumerate() {
            let from_centre = point(k) + *d - centre;
            *d += back.position + turn.moved(&from_centre);
        }
        if back.position.norm() + back.rotation.norm() < CONVERGED {
            break;
        }
    }
    undone.inverse()
}
