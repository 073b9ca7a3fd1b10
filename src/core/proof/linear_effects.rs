//! Weighted sum of the linear effects of all error sources, with its derivatives.
//!
//! A small rotation about an axis `w` through a point o moves the point p by `g = w x (p - o)` per radian.
//! For a translation, `g` is the axis and `w` is 0. The weighted sum over all motions k is `phi = sum eta_k
//! . g_k + zeta_k . w_k`. The weights `eta_k` and `zeta_k` are vectors. The derivatives of `phi` follow
//! from two sums over the motions of each link: `F = sum eta g^T + zeta w^T` and `P = sum eta w^T`.

use super::coordinates::JointMatrix;
use super::taylor_model::{ChainGeometry, Taylor, radius};
use crate::cell::{JointKind, MAX_JOINTS};
use crate::kinematic_error::{JointValues, PosedScrews, ScrewMotion, Screws};
use nalgebra::{Matrix3, Vector3};

/// Effect of one small motion in the chain on the measured point, at one posture. The measured point is the
/// point whose error the sense measures.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effect {
    /// Displacement of the measured point, per unit of the motion.
    pub g: Vector3<f64>,
    /// Unit vector along the rotation axis; 0 for a translation.
    pub w: Vector3<f64>,
    /// Distance from the axis of a rotation to the next joint axis, m; 0 for a translation.
    ///
    /// For a motion after the last joint, this is the distance to the measured point.
    own: f64,
}

/// Returns the effect of every motion at a posture. `joints` is the number of joints of the chain.
pub(super) fn effects(motions: &[ScrewMotion], placed: &PosedScrews, joints: usize) -> Vec<Effect> {
    let effect = |motion: &ScrewMotion| {
        let link = &placed.links[motion.link];
        let axis = link.rotation * motion.axis;
        if !motion.turns {
            return Effect { g: axis, w: Vector3::zeros(), own: 0.0 };
        }
        let through = link.transform(&motion.through);
        let next = if motion.link == joints { &placed.point } else { &placed.points[motion.link] };
        Effect { g: axis.cross(&(placed.point - through)), w: axis, own: (next - through).norm() }
    };
    motions.iter().map(effect).collect()
}

/// Weighted motions whose effects are summed.
#[derive(Clone, Copy)]
pub(super) struct WeightedMotions<'a> {
    pub motions: &'a [ScrewMotion],
    pub effects: &'a [Effect],
    /// Weights (eta, zeta) of each motion, for the displacement of the point and for the rotation axis.
    pub weights: &'a [(Vector3<f64>, Vector3<f64>)],
}

/// Expands the weighted sum of effects over a box with the half widths `radii` about a posture, as a Taylor
/// model.
///
/// The sum over the motions k is `phi = sum eta_k . g_k + zeta_k . w_k`. The weights are (eta, zeta), and the
/// effects are (g, w).
///
/// `rates` are the derivatives of the measured point with respect to the joint displacements.
pub(super) fn expand(
    geometry: ChainGeometry<'_>,
    placed: &PosedScrews,
    sum: WeightedMotions<'_>,
    rates: &[Vector3<f64>; MAX_JOINTS],
    radii: &JointValues,
) -> Taylor {
    let (ChainGeometry { screws, coordinates, pieces }, WeightedMotions { motions, effects, weights }) =
        (geometry, sum);
    let n = screws.kinds.len();
    let (mut f, mut p) = ([Matrix3::zeros(); MAX_JOINTS + 1], [Matrix3::zeros(); MAX_JOINTS + 1]);
    // There are three sums for each link: the weights of rotations, these weights times lever arms, and the
    // other weights.
    let mut sizes = [[0.0; 3]; MAX_JOINTS + 1];
    for ((motion, effect), (eta, zeta)) in motions.iter().zip(effects).zip(weights) {
        let m = motion.link;
        f[m] += eta * effect.g.transpose() + zeta * effect.w.transpose();
        p[m] += eta * effect.w.transpose();
        let (eta, zeta) = (eta.norm(), zeta.norm());
        let turn = if motion.turns { eta } else { 0.0 };
        sizes[m][0] += turn;
        sizes[m][1] += turn * effect.own;
        sizes[m][2] += zeta + eta - turn;
    }
    let value = f.iter().map(Matrix3::trace).sum();
    let (gradient, hessian) = by_theta(screws, placed, &mut f, &mut p, rates);
    let (gradient, hessian) = coordinates.derivatives(&gradient, &hessian);
    let rest = (0..=n).map(|m| {
        let own = coordinates.turning[m];
        let rigid = (sizes[m][1] + sizes[m][2]) * radius(radii, own).powi(3);
        rigid + sizes[m][0] * pieces.turned(coordinates, radii, m, own, 3)
    });
    Taylor { value, gradient, hessian, rest: rest.sum::<f64>() / 6.0 }
}

/// Sums over the motions of each link, with one matrix per link.
type LinkSums = [Matrix3<f64>; MAX_JOINTS + 1];

/// Returns the first and second derivatives of the weighted sum of effects with respect to the joint
/// displacements.
///
/// On entry, `f` and `p` hold for each link the sums F and P of the module documentation.
///
/// Joint i rotates the effects of the motions after it in the chain. The sums `f` give this part of the
/// derivatives. For the motions that precede joint i, the joint moves the point on which they act. The sums
/// `p` give this other part.
fn by_theta(
    screws: &Screws,
    placed: &PosedScrews,
    f: &mut LinkSums,
    p: &mut LinkSums,
    rates: &[Vector3<f64>; MAX_JOINTS],
) -> (JointValues, JointMatrix) {
    let n = screws.kinds.len();
    // F now sums over all links from k on, and P over all links up to k.
    (0..n).rev().for_each(|k| f[k] += f[k + 1]);
    (0..n).for_each(|k| p[k + 1] += p[k]);
    let turns = |i: usize| screws.kinds[i] == JointKind::Revolute;
    let (mut gradient, mut hessian) = ([0.0; MAX_JOINTS], [[0.0; MAX_JOINTS]; MAX_JOINTS]);
    for i in 0..n {
        let z = &placed.axes[i];
        gradient[i] = -axial(&p[i]).dot(&rates[i]);
        if !turns(i) {
            continue;
        }
        gradient[i] += axial(&f[i + 1]).dot(z);
        let before = z.cross(&axial(&p[i]));
        for j in i..n {
            // Motions before joint i contribute eta . (w x (z_i x rate_j)). Motions between joints i and j
            // contribute eta . (z_i x (w x rate_j)).
            let between = p[j] - p[i];
            let tilted = z * between.trace() - between * z;
            hessian[i][j] = (before + tilted).dot(&rates[j]);
            if turns(j) {
                let zj = &placed.axes[j];
                hessian[i][j] += zj.dot(&(f[j + 1] * z)) - f[j + 1].trace() * zj.dot(z);
            }
        }
    }
    (gradient, hessian)
}

/// Returns `sum g x eta`, given the matrix `m = sum eta g^T` of vectors eta and g.
fn axial(m: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)])
}
