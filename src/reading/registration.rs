//! What the cell has measured with the robot itself: a fitted base frame, taught surface frames.
//!
//! Either is a rigid motion M that follows the errors at some points as well as its rule can; the
//! controller then works in the moved frame, and what is left at a node is `M^-1 E`. To first order
//! that is a difference of twists; for the exact models the same rule is applied again to what is
//! left, which converges quadratically and keeps the digits of small errors.

use super::{Effects, ErrorSources};
use crate::cell::Model;
use crate::kinematic_error::{Perturbation, position_error};
use crate::pose::{Displacement, SmallRotation};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// Postures over which the base frame is fitted.
const POSTURES: usize = 64;

/// Rounds of an exact fit at most, and what is left when it is done (m, rad). Errors of
/// millimetres take three or four.
const ROUNDS: usize = 16;
const NOTHING: f64 = 1e-17;

/// Points nearer than this are one, m.
const SAME_POINT: f64 = 1e-6;

/// The base frame, best-fitted (least squares of the positions) over quasi-random postures between
/// the joint limits.
#[derive(Debug, Clone)]
pub struct BestFit {
    postures: Vec<Frames>,
    centre: Vector3<f64>,
    /// Of the matrix `sum |r|^2 - r r^T` about the centre.
    inverse: Matrix3<f64>,
    /// What the fit takes of each source, seen at the centre.
    pub effects: Effects,
}

impl BestFit {
    pub fn new(chain: &Chain, sources: &ErrorSources, mean: bool) -> Self {
        let postures: Vec<Frames> =
            (0..POSTURES).map(|k| chain.frames(&chain.posture(&chain.halton_sample(k)))).collect();
        let centre = postures.iter().map(|f| f.tcp.translation).sum::<Vector3<f64>>() / POSTURES as f64;
        let inertia = postures.iter().map(|f| f.tcp.translation - centre).fold(Matrix3::zeros(), |sum, r| {
            sum + Matrix3::identity() * r.norm_squared() - r * r.transpose()
        });
        // Points in one line leave the turn about it open: none is taken then.
        let inverse = inertia.pseudo_inverse(1e-12 * inertia.norm()).unwrap_or_else(|_| Matrix3::zeros());
        let mut fit = Self { postures, centre, inverse, effects: Effects::default() };
        fit.effects = fit.of_sources(chain, sources, mean);
        fit
    }

    /// The motion that a sample makes, seen at the centre.
    pub fn motion(&self, errors: &Perturbation, model: Model) -> Displacement {
        let mut moved = [Vector3::zeros(); POSTURES];
        for (moved, posture) in moved.iter_mut().zip(&self.postures) {
            *moved = position_error(posture, errors, model);
        }
        let point = |k: usize| self.postures[k].tcp.translation;
        exact(&point, &mut moved, &self.centre, |moved| self.twist(moved))
    }

    /// The postures fitted over.
    pub fn postures(&self) -> &[Frames] {
        &self.postures
    }

    /// From the centre to the TCP.
    pub fn arm(&self, frames: &Frames) -> Vector3<f64> {
        frames.tcp.translation - self.centre
    }

    /// Least squares of small displacements, seen at the centre.
    fn twist(&self, moved: &[Vector3<f64>]) -> Displacement {
        let position = moved.iter().sum::<Vector3<f64>>() / POSTURES as f64;
        let arms = self.postures.iter().map(|f| f.tcp.translation - self.centre);
        let moment: Vector3<f64> = arms.zip(moved).map(|(r, d)| r.cross(d)).sum();
        Displacement { position, rotation: self.inverse * moment }
    }

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

/// A surface frame taught by touching three points: its origin, one on its x axis, one in its plane.
#[derive(Debug, Clone)]
pub struct Taught {
    /// The touching postures.
    pub postures: [Frames; 3],
    /// What the taught frame takes of each source, seen at the origin.
    pub effects: Effects,
}

impl Taught {
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

    /// The motion that a sample makes, seen at the origin.
    pub fn motion(&self, errors: &Perturbation, model: Model) -> Displacement {
        let mut moved = [0, 1, 2].map(|i| position_error(&self.postures[i], errors, model));
        let point = |k: usize| self.point(k);
        exact(&point, &mut moved, &self.point(0), |moved| self.twist(moved))
    }

    /// Whether a point is one of those touched.
    pub fn touches(&self, p: &Vector3<f64>) -> bool {
        self.distance(p) < SAME_POINT
    }

    /// Distance of a target from the nearest point touched, m.
    pub fn distance(&self, p: &Vector3<f64>) -> f64 {
        let distances = self.postures.iter().map(|f| (f.tcp.translation - p).norm());
        distances.fold(f64::INFINITY, f64::min)
    }

    /// From the origin to the TCP.
    pub fn arm(&self, frames: &Frames) -> Vector3<f64> {
        frames.tcp.translation - self.point(0)
    }

    fn point(&self, k: usize) -> Vector3<f64> {
        self.postures[k].tcp.translation
    }

    /// The rule of three points for small displacements, seen at the origin.
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

/// The motion, seen at `centre`, that leaves nothing of displaced points to its rule.
fn exact(
    point: &dyn Fn(usize) -> Vector3<f64>,
    moved: &mut [Vector3<f64>],
    centre: &Vector3<f64>,
    rule: impl Fn(&[Vector3<f64>]) -> Displacement,
) -> Displacement {
    // Undone so far, seen at the centre.
    let mut undone = Displacement::NONE;
    for _ in 0..ROUNDS {
        let back = rule(moved).inverse();
        undone = undone.then(&back);
        let turn = SmallRotation::of(&back.rotation);
        for (k, d) in moved.iter_mut().enumerate() {
            let from_centre = point(k) + *d - centre;
            *d += back.position + turn.moved(&from_centre);
        }
        if back.position.norm() + back.rotation.norm() < NOTHING {
            break;
        }
    }
    undone.inverse()
}
