//! Cuts: convex constraints on the tolerance scales, each a second-order cone or a linear inequality. Every
//! set of tolerances that meets a requirement satisfies all cuts of this requirement.

use nalgebra::Vector6;

/// Convex constraint on the tolerance scales `u`.
///
/// An affine function of `u`, or the norm of a vector of affine functions, must be at most 1. The error
/// figures are scaled so that their limits are 1.
#[derive(Debug, Clone, PartialEq)]
pub enum ConeCut {
    /// Constraint of a worst case in one axis, for one sign pattern: `constant + sum_k columns_k u_k <= 1`.
    /// A sign pattern gives every error a sign.
    Row { columns: Vec<f64>, constant: f64 },
    /// Constraint of a worst case in several axes, for one sign pattern:
    /// `|constant + sum_k columns_k u_k| <= 1`. A sign pattern gives every error a sign. Only the first
    /// `rows` components count.
    Vertex { columns: Vec<Vector6<f64>>, constant: Vector6<f64>, rows: usize },
    /// Constraint of a root sum square: `|(constant, roots_k u_k, ...)| <= 1`.
    Ellipsoid { roots: Vec<f64>, constant: f64 },
}

impl ConeCut {
    /// Returns the constraint of one sign pattern; `u` are scales at which this pattern is the worst.
    pub fn vertex(columns: Vec<Vector6<f64>>, constant: Vector6<f64>, rows: usize, u: &[f64]) -> Self {
        if rows > 1 {
            return Self::Vertex { columns, constant, rows };
        }
        let sum = constant[0] + columns.iter().zip(u).map(|(c, u)| c[0] * u).sum::<f64>();
        let sign = if sum < 0.0 { -1.0 } else { 1.0 };
        Self::Row { columns: columns.iter().map(|c| sign * c[0]).collect(), constant: sign * constant[0] }
    }

    /// Returns whether two cuts are the same constraint. A sign pattern and its opposite give the same
    /// constraint.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Vertex { columns: a, constant: f, .. }, Self::Vertex { columns: b, constant: g, .. }) => {
                let same = |sign: f64| *f == g * sign && a.iter().zip(b).all(|(a, b)| *a == b * sign);
                same(1.0) || same(-1.0)
            }
            _ => self == other,
        }
    }

    /// Returns the number of rows of the constraint in a cone program.
    pub fn height(&self) -> usize {
        match self {
            Self::Row { .. } => 1,
            Self::Vertex { rows, .. } => 1 + rows,
            Self::Ellipsoid { roots, .. } => 2 + roots.len(),
        }
    }

    /// Calls `put` with the row, parameter and coefficient of each term of the affine function `s(u)` of a
    /// cone program. Returns the constant part of `s(u)`. The cut states that `s(u)` lies in the cone.
    pub fn rows(&self, mut put: impl FnMut(usize, usize, f64)) -> Vec<f64> {
        match self {
            Self::Row { columns, constant } => {
                columns.iter().enumerate().for_each(|(k, c)| put(0, k, -c));
                vec![1.0 - constant]
            }
            Self::Vertex { columns, constant, rows } => {
                for (k, column) in columns.iter().enumerate() {
                    (0..*rows).for_each(|r| put(1 + r, k, column[r]));
                }
                std::iter::once(1.0).chain(constant.iter().take(*rows).copied()).collect()
            }
            Self::Ellipsoid { roots, constant } => {
                roots.iter().enumerate().for_each(|(k, root)| put(2 + k, k, *root));
                let zeros = std::iter::repeat_n(0.0, roots.len());
                [1.0, *constant].into_iter().chain(zeros).collect()
            }
        }
    }

    /// Adds the linear inequality that a dual vector of the constraint proves: `prices . u <= limit`.
    ///
    /// Let `s` be the vector whose norm the cut limits. For any vector y, `|s| <= 1` implies `y . s <= |y|`.
    /// For a second-order cone, the components of the dual vector `z` after the first are `-y`. Every `y`
    /// gives a valid inequality, whatever the accuracy of `z`. Returns `|y|`, the shadow price of the limit.
    pub fn add_inequality(&self, z: &[f64], prices: &mut [f64], limit: &mut f64) -> f64 {
        match self {
            Self::Row { columns, constant } => {
                let y = z.first().copied().unwrap_or(0.0).max(0.0);
                prices.iter_mut().zip(columns).for_each(|(p, c)| *p += y * c);
                *limit += y * (1.0 - constant);
                y
            }
            Self::Vertex { columns, constant, .. } => {
                let mut y = Vector6::zeros();
                y.iter_mut().zip(z.iter().skip(1)).for_each(|(y, z)| *y = -z);
                prices.iter_mut().zip(columns).for_each(|(p, c)| *p += y.dot(c));
                *limit += y.norm() - y.dot(constant);
                y.norm()
            }
            Self::Ellipsoid { roots, constant } => {
                let tail = z.get(1..).unwrap_or_default();
                let size = tail.iter().map(|z| z * z).sum::<f64>().sqrt();
                for ((price, root), z) in prices.iter_mut().zip(roots).zip(tail.iter().skip(1)) {
                    *price -= z * root;
                }
                *limit += size + tail.first().map_or(0.0, |z| z * constant);
                size
            }
        }
    }
}
