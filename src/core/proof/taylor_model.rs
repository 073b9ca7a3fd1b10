//! Taylor models: second-order expansions over a box of coordinates, with a bound of the remainder.
//!
//! Every expanded function is a sum of products of vectors fixed to links. A joint rotates all factors of a
//! product, one factor, or no factor. Each mixed partial derivative of a product is therefore again a single
//! product. The size of this derivative is at most the product `s` of the lengths of the factors. The radius
//! of a coordinate is half its range in the box. Let `rho` be the sum of the radii of the coordinates that
//! rotate any factor. Then the third-order term of the product over the box is at most `s rho^3 / 6`. If a
//! prismatic joint with the radius `r_t` lengthens a factor, `3 rho^2 r_t / 6` is added to this bound.

use super::coordinates::{Coordinates, JointMatrix};
use crate::cell::{JointKind, MAX_JOINTS};
use crate::kinematic_error::{JointValues, PosedScrews, Screws};
use nalgebra::Vector3;

/// Geometry of a chain, shared by all its Taylor models.
#[derive(Clone, Copy)]
pub(super) struct ChainGeometry<'a> {
    pub screws: &'a Screws,
    pub coordinates: &'a Coordinates,
    pub pieces: &'a RigidPieces,
}

/// Taylor model of a function: value and derivatives at the centre of a box, and a bound of the remainder
/// over the box.
#[derive(Debug, Clone)]
pub(super) struct Taylor {
    pub value: f64,
    pub gradient: JointValues,
    pub hessian: JointMatrix,
    pub rest: f64,
}

impl Taylor {
    /// Returns an upper bound, over a box with the half widths `radii`, of the deviation of the function from
    /// its value at the centre.
    pub fn spread(&self, radii: &JointValues) -> f64 {
        let linear: f64 = self.gradient.iter().zip(radii).map(|(g, r)| g.abs() * r).sum();
        linear + self.bend(radii)
    }

    /// Returns an upper bound, over a box with the half widths `radii`, of the deviation of the function from
    /// its linear expansion.
    pub fn bend(&self, radii: &JointValues) -> f64 {
        let rows = self
            .hessian
            .iter()
            .zip(radii)
            .map(|(row, r)| r * row.iter().zip(radii).map(|(h, r)| h.abs() * r).sum::<f64>());
        0.5 * rows.sum::<f64>() + self.rest
    }

    /// Replaces the model by `self - factor * other`.
    pub fn less(&mut self, factor: f64, other: &Taylor) {
        self.value -= factor * other.value;
        self.rest += factor.abs() * other.rest;
        for i in 0..MAX_JOINTS {
            self.gradient[i] -= factor * other.gradient[i];
            (0..MAX_JOINTS).for_each(|j| self.hessian[i][j] -= factor * other.hessian[i][j]);
        }
    }

    /// Returns a lower bound of the function in a box with the half widths `radii`.
    ///
    /// Let `t_i` be the deviation of coordinate i from the centre, `r_i` its half width, and h an entry of
    /// the Hessian. A mixed term is bounded by squares: `|h t_i t_j| <= |h| (t_i^2 r_j / r_i + t_j^2 r_i /
    /// r_j) / 2`. Each square is 0 if its coordinate is at the centre, so the bound remains tight if the
    /// minimum is at the centre.
    pub fn least(&self, radii: &JointValues, count: usize) -> f64 {
        let one = |i: usize| {
            let r = radii[i];
            if r == 0.0 {
                return 0.0;
            }
            let crossed: f64 =
                (0..count).filter(|&j| j != i).map(|j| self.hessian[i][j].abs() * radii[j] / r).sum();
            let (g, h) = (self.gradient[i].abs(), self.hessian[i][i] - crossed);
            if h * r > g { -g * g / (2.0 * h) } else { -g * r + h * r * r / 2.0 }
        };
        self.value + (0..count).map(one).sum::<f64>() - self.rest
    }
}

/// Returns the derivatives of `point` with respect to the joint displacements. If `point` is None, returns
/// the derivatives of the tool axis instead.
pub(super) fn rates(
    screws: &Screws,
    placed: &PosedScrews,
    point: Option<&Vector3<f64>>,
) -> [Vector3<f64>; MAX_JOINTS] {
    let mut rates = [Vector3::zeros(); MAX_JOINTS];
    for (i, kind) in screws.kinds.iter().enumerate() {
        rates[i] = match (kind, point) {
            (JointKind::Revolute, Some(p)) => placed.axes[i].cross(&(p - placed.points[i])),
            (JointKind::Revolute, None) => placed.axes[i].cross(&placed.tool),
            (JointKind::Prismatic, Some(_)) => placed.axes[i],
            (JointKind::Prismatic, None) => Vector3::zeros(),
        };
    }
    rates
}

/// Returns the first derivatives of `eta . x` with respect to the joint displacements.
///
/// Here x is the point or axis with the first derivatives `rates`.
pub(super) fn slopes(rates: &[Vector3<f64>; MAX_JOINTS], eta: &Vector3<f64>) -> JointValues {
    rates.map(|rate| eta.dot(&rate))
}

/// Returns the first and second derivatives of `eta . x` with respect to the joint displacements.
///
/// Here x is the point or axis with the first derivatives `rates`. Let joint i be revolute, with the axis
/// `z_i`, and let i <= j. The second derivative of x with respect to joints i and j is the cross product of
/// `z_i` and `rates[j]`.
pub(super) fn along(
    screws: &Screws,
    placed: &PosedScrews,
    rates: &[Vector3<f64>; MAX_JOINTS],
    eta: &Vector3<f64>,
) -> (JointValues, JointMatrix) {
    let mut hessian = [[0.0; MAX_JOINTS]; MAX_JOINTS];
    for (i, kind) in screws.kinds.iter().enumerate() {
        if *kind == JointKind::Revolute {
            let turned = eta.cross(&placed.axes[i]);
            (i..screws.kinds.len()).for_each(|j| hessian[i][j] = turned.dot(&rates[j]));
        }
    }
    (slopes(rates, eta), hessian)
}

/// Rigid segments of a chain. Segment k leads from joint axis k to the next axis, and the last segment
/// leads to the end point.
///
/// Joints are counted from 1, and segment k belongs to link k, which comes after k joints.
#[derive(Debug, Clone)]
pub(super) struct RigidPieces {
    /// Largest length of each segment, m, including prismatic travel.
    pub lengths: [f64; MAX_JOINTS + 1],
    /// Index of the prismatic coordinate that lengthens each segment, if any.
    pub slide: [Option<usize>; MAX_JOINTS + 1],
    pub count: usize,
}

impl RigidPieces {
    /// Computes the segments of a chain from joint axis to joint axis, and from the last axis to the point
    /// `end`.
    pub fn new(screws: &Screws, end: &Vector3<f64>, coordinates: &Coordinates) -> Self {
        let n = screws.kinds.len();
        let mut pieces = Self { lengths: [0.0; MAX_JOINTS + 1], slide: [None; MAX_JOINTS + 1], count: n };
        for k in 1..=n {
            let next = if k == n { end } else { &screws.points[k] };
            pieces.lengths[k] = (next - screws.points[k - 1]).norm();
            if screws.kinds[k - 1] == JointKind::Prismatic {
                pieces.slide[k] = Some(k - 1);
                pieces.lengths[k] += coordinates.high[k - 1].max(-coordinates.low[k - 1]);
            }
        }
        pieces
    }

    /// Returns the total length of the segments after a link, up to the end of the chain, m.
    pub fn from(&self, link: usize) -> f64 {
        self.lengths[link + 1..=self.count].iter().sum()
    }

    /// Returns an upper bound of the size of a directional derivative of order `power`.
    ///
    /// Let u be a unit vector fixed to `link`. The function f of the coordinates q is a sum over all segments
    /// after `link`. The terms of f are the products of a segment and u. Let d be a change of the
    /// coordinates, in which each coordinate changes by at most its radius. Consider the derivative of order
    /// `power` of `f(q + t d)` with respect to t, at t = 0. The result bounds the size of this derivative for
    /// every such d and every q in the box.
    ///
    /// Let `s` be the largest length of a segment, and `rho` the sum of the radii of the coordinates that
    /// rotate the segment, u or both. Each segment adds `s rho^power` to the bound. A segment that a
    /// prismatic coordinate with the radius `r` lengthens also adds `power rho^(power - 1) r`.
    ///
    /// Bit i of `own` is set if coordinate i rotates u.
    pub fn turned(
        &self,
        coordinates: &Coordinates,
        radii: &JointValues,
        link: usize,
        own: u8,
        power: i32,
    ) -> f64 {
        let of = |k: usize| {
            let rho = radius(radii, own | coordinates.turning[k]);
            let longer = self.slide[k].map_or(0.0, |i| f64::from(power) * rho.powi(power - 1) * radii[i]);
            self.lengths[k] * rho.powi(power) + longer
        };
        (link + 1..=self.count).map(of).sum()
    }
}

/// Returns the sum of the radii of the coordinates whose bits are set.
pub(super) fn radius(radii: &JointValues, bits: u8) -> f64 {
    radii.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1).map(|(_, r)| r).sum()
}
