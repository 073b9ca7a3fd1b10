//! Second-order expansions over a box, with a bound on what they leave out.
//!
//! Every quantity here is a sum of products of vectors fixed to links. A joint turns a product as a
//! whole, one factor of it, or nothing, so that each mixed partial derivative of a product is a single
//! product again, no longer than the lengths of its factors allow. Hence, for radii `r` of a box, the
//! third-order term of a product of length `s` that coordinates with radii summing to `rho` can turn is
//! at most `s rho^3 / 6`, and `3 rho^2 r_t / 6` more where a slide `t` makes a factor longer.

use super::coordinates::{Coordinates, Matrix};
use super::screws::{Placed, Screws, Values};
use crate::cell::{JointKind, MAX_JOINTS};
use nalgebra::Vector3;

/// Value, derivatives by the coordinates, and a bound of the rest over the box.
#[derive(Debug, Clone)]
pub(super) struct Taylor {
    pub value: f64,
    pub gradient: Values,
    pub hessian: Matrix,
    pub rest: f64,
}

impl Taylor {
    /// How far the quantity can be from its value in a box of these radii.
    pub fn spread(&self, radii: &Values) -> f64 {
        let linear: f64 = self.gradient.iter().zip(radii).map(|(g, r)| g.abs() * r).sum();
        linear + self.bend(radii)
    }

    /// The same without the linear part.
    pub fn bend(&self, radii: &Values) -> f64 {
        let rows = self
            .hessian
            .iter()
            .zip(radii)
            .map(|(row, r)| r * row.iter().zip(radii).map(|(h, r)| h.abs() * r).sum::<f64>());
        0.5 * rows.sum::<f64>() + self.rest
    }

    /// `self - factor * other`.
    pub fn less(&mut self, factor: f64, other: &Taylor) {
        self.value -= factor * other.value;
        self.rest += factor.abs() * other.rest;
        for i in 0..MAX_JOINTS {
            self.gradient[i] -= factor * other.gradient[i];
            (0..MAX_JOINTS).for_each(|j| self.hessian[i][j] -= factor * other.hessian[i][j]);
        }
    }

    /// No more than the quantity anywhere in the box. `|h t_i t_j|` is shared so that it vanishes with
    /// each: an inner minimum stays visible.
    pub fn least(&self, radii: &Values, count: usize) -> f64 {
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

/// Rates of a point or direction by the joints: `z x (p - c)` or `z`.
pub(super) fn rates(
    screws: &Screws,
    placed: &Placed,
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

/// First and second derivatives by theta of `eta . x` whose rates are given: `d_ij x = z_i x rate_j`.
pub(super) fn along(
    screws: &Screws,
    placed: &Placed,
    rates: &[Vector3<f64>; MAX_JOINTS],
    eta: &Vector3<f64>,
) -> (Values, Matrix) {
    let (mut gradient, mut hessian) = ([0.0; MAX_JOINTS], [[0.0; MAX_JOINTS]; MAX_JOINTS]);
    for (i, kind) in screws.kinds.iter().enumerate() {
        gradient[i] = eta.dot(&rates[i]);
        if *kind == JointKind::Revolute {
            let turned = eta.cross(&placed.axes[i]);
            (i..screws.kinds.len()).for_each(|j| hessian[i][j] = turned.dot(&rates[j]));
        }
    }
    (gradient, hessian)
}

/// The rigid pieces from axis to axis out to the end: piece k belongs to link k, m.
#[derive(Debug, Clone)]
pub(super) struct Pieces {
    /// With the most that a slide adds.
    pub lengths: [f64; MAX_JOINTS + 1],
    /// The coordinate that slides within a piece.
    pub slide: [Option<usize>; MAX_JOINTS + 1],
    pub count: usize,
}

impl Pieces {
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

    /// Lengths of the pieces from a link on, m.
    pub fn from(&self, link: usize) -> f64 {
        self.lengths[link + 1..=self.count].iter().sum()
    }

    /// `sum |s| rho^power` of derivatives of the given power over the pieces behind a link, turned by
    /// `own`, the coordinates that turn a factor on that link, and by their own.
    pub fn turned(&self, coordinates: &Coordinates, radii: &Values, link: usize, own: u8, power: i32) -> f64 {
        let of = |k: usize| {
            let rho = radius(radii, own | coordinates.turning[k]);
            let longer = self.slide[k].map_or(0.0, |i| f64::from(power) * rho.powi(power - 1) * radii[i]);
            self.lengths[k] * rho.powi(power) + longer
        };
        (link + 1..=self.count).map(of).sum()
    }
}

/// Sum of the radii of some coordinates, given as bits.
pub(super) fn radius(radii: &Values, bits: u8) -> f64 {
    radii.iter().enumerate().filter(|(i, _)| bits >> i & 1 == 1).map(|(_, r)| r).sum()
}
