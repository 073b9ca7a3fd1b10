//! The Lagrangian dual of an allocation as a function of its multipliers, with its derivatives.

use super::cone_cut::ConeCut;
use super::lagrangian::{Charged, charged};
use crate::cell::ToleranceCost;
use nalgebra::{DMatrix, DVector, Vector6};
use std::rc::Rc;

/// One constraint with its multipliers.
#[derive(Debug, Clone)]
pub struct DualTerm {
    pub figure: usize,
    pub cut: Rc<ConeCut>,
    /// Multiplier vector of a sign pattern in several axes. For any other constraint, the multiplier is the
    /// first component.
    pub y: Vector6<f64>,
}

/// Value of the dual at one set of multipliers, with the scales that attain it.
pub struct DualPoint {
    pub value: f64,
    pub scales: Vec<Charged>,
}

impl DualTerm {
    /// Returns the cost saved per relative increase of the limit.
    pub fn shadow_price(&self) -> f64 {
        match *self.cut {
            ConeCut::Ellipsoid { .. } => 2.0 * self.y[0],
            _ => self.y.norm(),
        }
    }

    /// Returns the number of multipliers.
    fn count(&self) -> usize {
        match *self.cut {
            ConeCut::Vertex { rows, .. } => rows,
            _ => 1,
        }
    }
}

/// Returns the linear and the quadratic price of every scale, which follow from the multipliers.
pub fn charges(count: usize, terms: &[DualTerm]) -> (Vec<f64>, Vec<f64>) {
    let (mut p, mut q) = (vec![0.0; count], vec![0.0; count]);
    for DualTerm { cut, y, .. } in terms {
        match &**cut {
            ConeCut::Row { columns, .. } => p.iter_mut().zip(columns).for_each(|(p, c)| *p += y[0] * c),
            ConeCut::Vertex { columns, .. } => {
                p.iter_mut().zip(columns).for_each(|(p, c)| *p += y.dot(c));
            }
            ConeCut::Ellipsoid { roots, .. } => {
                q.iter_mut().zip(roots).for_each(|(q, r)| *q += y[0] * r * r);
            }
        }
    }
    (p, q)
}

/// Returns the value of the dual and the scales that attain it.
pub fn dual(costs: &[ToleranceCost], terms: &[DualTerm]) -> DualPoint {
    let (p, q) = charges(costs.len(), terms);
    let scales: Vec<Charged> =
        costs.iter().zip(p.iter().zip(&q)).map(|(cost, (p, q))| charged(cost, *p, *q)).collect();
    let limits = terms.iter().map(|DualTerm { cut, y, .. }| match &**cut {
        ConeCut::Row { constant, .. } => y[0] * (1.0 - constant),
        ConeCut::Vertex { constant, .. } => y.norm() - y.dot(constant),
        ConeCut::Ellipsoid { constant, .. } => y[0] * (1.0 - constant * constant),
    });
    DualPoint { value: scales.iter().map(|c| c.least).sum::<f64>() - limits.sum::<f64>(), scales }
}

/// Returns the first and the negative second derivatives of the dual with respect to the multipliers.
pub fn derivatives(terms: &[DualTerm], point: &DualPoint) -> (DVector<f64>, DMatrix<f64>) {
    let size: usize = terms.iter().map(DualTerm::count).sum();
    let mut gradient = DVector::zeros(size);
    let mut hessian = DMatrix::zeros(size, size);
    // Slopes of the constraints with respect to each scale.
    let mut slopes = DMatrix::zeros(size, point.scales.len());
    let mut at = 0;
    for term in terms {
        let scales = point.scales.iter().map(|u| u.scale);
        match &*term.cut {
            ConeCut::Row { columns, constant } => {
                gradient[at] = constant - 1.0;
                for (k, (c, u)) in columns.iter().zip(scales).enumerate() {
                    gradient[at] += c * u;
                    slopes[(at, k)] = *c;
                }
            }
            ConeCut::Vertex { columns, constant, rows } => {
                let length = term.y.norm();
                let unit = term.y / length;
                let vertex = constant + columns.iter().zip(scales).map(|(c, u)| c * u).sum::<Vector6<f64>>();
                for r in 0..*rows {
                    gradient[at + r] = vertex[r] - unit[r];
                    columns.iter().enumerate().for_each(|(k, c)| slopes[(at + r, k)] = c[r]);
                    for s in 0..*rows {
                        let same = if r == s { 1.0 } else { 0.0 };
                        hessian[(at + r, at + s)] += (same - unit[r] * unit[s]) / length;
                    }
                }
            }
            ConeCut::Ellipsoid { roots, constant } => {
                gradient[at] = constant * constant - 1.0;
                for (k, (root, u)) in roots.iter().zip(scales).enumerate() {
                    gradient[at] += (root * u).powi(2);
                    slopes[(at, k)] = 2.0 * root * root * u;
                }
            }
        }
        at += term.count();
    }
    for (k, u) in point.scales.iter().enumerate().filter(|(_, u)| u.curvature.is_finite()) {
        let column = slopes.column(k);
        hessian.ger(1.0 / u.curvature, &column, &column, 1.0);
    }
    (gradient, hessian)
}

/// Returns the step lengths below 1 at which a multiplier passes 0, the longest first.
pub fn crossings(terms: &[DualTerm], step: &DVector<f64>) -> Vec<f64> {
    let (mut at, mut found) = (0, Vec::new());
    for term in terms {
        let along: f64 = (0..term.count()).map(|r| term.y[r] * step[at + r]).sum();
        let size = term.y.norm_squared();
        at += term.count();
        if size + along < 0.0 {
            // This length is slightly greater than the exact length, so that rounding does not keep the term.
            found.push(-size / along * (1.0 + 1e-9));
        }
    }
    found.sort_by(|a, b| b.total_cmp(a));
    found
}

/// Returns the terms with their multipliers moved by a step. Terms whose multipliers would pass 0 are left
/// out.
pub fn stepped(terms: &[DualTerm], step: &DVector<f64>, length: f64) -> Vec<DualTerm> {
    let mut at = 0;
    let mut moved = Vec::with_capacity(terms.len());
    for term in terms {
        let mut y = term.y;
        (0..term.count()).for_each(|r| y[r] += length * step[at + r]);
        at += term.count();
        if y.dot(&term.y) > 0.0 {
            moved.push(DualTerm { y, ..term.clone() });
        }
    }
    moved
}
