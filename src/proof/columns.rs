//! The linear effects of all sources, and their sum in given directions with its derivatives.
//!
//! With `g = w x (p - o)` what a turn does to the point p and `w` its turn (of a slide: `g` its axis),
//! `phi = sum eta_k . g_k + zeta_k . w_k`. All derivatives follow from sums over the motions of each
//! link: `F = sum eta g^T + zeta w^T` and `P = sum eta w^T`.

use super::coordinates::{Coordinates, Matrix};
use super::screws::{Motion, Placed, Screws, Values};
use super::taylor::{Pieces, Taylor, radius};
use crate::cell::{JointKind, MAX_JOINTS};
use nalgebra::{Matrix3, Vector3};

/// A motion at a posture: what it does to the point, its axis, zero of a slide.
#[derive(Debug, Clone, Copy)]
pub(super) struct Effect {
    pub g: Vector3<f64>,
    pub w: Vector3<f64>,
    /// From where it acts to the first axis behind it, m.
    own: f64,
}

pub(super) fn effects(motions: &[Motion], placed: &Placed, joints: usize) -> Vec<Effect> {
    let effect = |motion: &Motion| {
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

/// Expands `phi`; one (eta, zeta) per motion.
pub(super) fn expand(
    (screws, coordinates, pieces): (&Screws, &Coordinates, &Pieces),
    placed: &Placed,
    (motions, effects): (&[Motion], &[Effect]),
    weights: &[(Vector3<f64>, Vector3<f64>)],
    rates: &[Vector3<f64>; MAX_JOINTS],
    radii: &Values,
) -> Taylor {
    let n = screws.kinds.len();
    let (mut f, mut p) = ([Matrix3::zeros(); MAX_JOINTS + 1], [Matrix3::zeros(); MAX_JOINTS + 1]);
    // Sizes of the turns, of their own pieces, and of what is rigid with the link.
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
    let (gradient, hessian) = by_theta(screws, placed, (&mut f, &mut p), rates);
    let (gradient, hessian) = coordinates.derivatives(&gradient, &hessian);
    let rest = (0..=n).map(|m| {
        let own = coordinates.turning[m];
        let rigid = (sizes[m][1] + sizes[m][2]) * radius(radii, own).powi(3);
        rigid + sizes[m][0] * pieces.turned(coordinates, radii, m, own, 3)
    });
    Taylor { value, gradient, hessian, rest: rest.sum::<f64>() / 6.0 }
}

/// First and second derivatives by theta. Joint i turns the motions behind it as they are (F), and moves
/// the point under those before it (P).
fn by_theta(
    screws: &Screws,
    placed: &Placed,
    (f, p): (&mut [Matrix3<f64>; MAX_JOINTS + 1], &mut [Matrix3<f64>; MAX_JOINTS + 1]),
    rates: &[Vector3<f64>; MAX_JOINTS],
) -> (Values, Matrix) {
    let n = screws.kinds.len();
    // F of all links from k on, P of all up to k.
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
            // eta . (w x (z_i x rate_j)) of the motions before i, eta . (z_i x (w x rate_j)) of those between.
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

/// `sum g x eta` of `sum eta g^T`.
fn axial(m: &Matrix3<f64>) -> Vector3<f64> {
    Vector3::new(m[(2, 1)] - m[(1, 2)], m[(0, 2)] - m[(2, 0)], m[(1, 0)] - m[(0, 1)])
}
