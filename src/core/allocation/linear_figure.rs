//! Figure of the linear error model as a function of the scales of the tolerances.

use super::cone_cut::ConeCut;
use super::limit_row::LimitRow;
use crate::reading::farthest;
use crate::reading::zonotope::{MAX_GENERATORS, ZonotopeScratch};
use nalgebra::Vector6;

/// Error figure of one operation at one node: a worst case or a root sum square. The figure grows with the
/// scales `u`.
#[derive(Debug, Clone, PartialEq)]
pub enum LinearFigure {
    /// Worst case: the largest `|sum_j s_j f_j + sum_k s_k g_k u_k|` over all signs.
    WorstCase {
        /// Number of leading components of each error vector that are taken into account. All other
        /// components are ignored.
        rows: usize,
        /// Error `g_k` that each parameter causes at its present tolerance.
        generators: Vec<Vector6<f64>>,
        /// Errors `f_j` that no tolerance changes.
        fixed: Vec<Vector6<f64>>,
    },
    /// Root sum square: `sqrt(constant + sum_k squares_k u_k^2)`.
    RootSumSquare { squares: Vec<f64>, constant: f64 },
}

/// Working memory for [`LinearFigure`].
#[derive(Default)]
pub struct FigureScratch {
    zonotope: ZonotopeScratch,
    columns: Vec<Vector6<f64>>,
    signs: Vec<f64>,
    /// Working memory for lower bounds: a constraint along one direction, and scales.
    pub(super) bound: (LimitRow, Vec<f64>),
}

impl LinearFigure {
    /// Returns the figure at the scales `u`. If the error has more than three components, the returned worst
    /// case can exceed the exact worst case.
    pub fn value(&self, u: &[f64], scratch: &mut FigureScratch) -> f64 {
        match self {
            Self::WorstCase { rows, generators, fixed } => {
                let columns = generators.iter().zip(u).map(|(g, u)| g * *u).chain(fixed.iter().copied());
                scratch.columns.clear();
                scratch.columns.extend(columns.take(MAX_GENERATORS));
                scratch.signs.clear();
                scratch.signs.resize(scratch.columns.len(), 1.0);
                let found = farthest(&scratch.columns, *rows, &mut scratch.zonotope, &mut scratch.signs);
                found.upper.max(found.value)
            }
            Self::RootSumSquare { squares, constant } => {
                let sum: f64 = squares.iter().zip(u).map(|(w, u)| w * u * u).sum();
                (constant + sum).max(0.0).sqrt()
            }
        }
    }

    /// Returns the figure at the scales `u`, and the cut that limits the figure at these scales. For a worst
    /// case, this is the cut of the worst sign pattern.
    pub(super) fn cut(&self, u: &[f64], scratch: &mut FigureScratch) -> (f64, ConeCut) {
        let value = self.value(u, scratch);
        let cut = match self {
            Self::WorstCase { rows, .. } => {
                let (columns, constant) = self.signed(scratch);
                ConeCut::vertex(columns, constant, *rows, u)
            }
            Self::RootSumSquare { squares, constant } => ConeCut::Ellipsoid {
                roots: squares.iter().map(|w| w.max(0.0).sqrt()).collect(),
                constant: constant.max(0.0).sqrt(),
            },
        };
        (value, cut)
    }

    /// Writes to `row` the component of the error along the direction of the worst sign pattern at the scales
    /// `u`. This component never exceeds the worst case. For a root sum square, the function copies the
    /// squares and the constant to `row`.
    pub(super) fn along_worst(&self, u: &[f64], row: &mut LimitRow, scratch: &mut FigureScratch) {
        row.linear.clear();
        row.squares.clear();
        match self {
            Self::RootSumSquare { squares, constant } => {
                row.squares.extend_from_slice(squares);
                row.constant = *constant;
            }
            Self::WorstCase { generators, fixed, .. } => {
                self.value(u, scratch);
                let (own, others) = scratch.signs.split_at(generators.len().min(scratch.signs.len()));
                let constant: Vector6<f64> = fixed.iter().zip(others).map(|(f, s)| f * *s).sum();
                let signed = generators.iter().zip(u).zip(own).map(|((g, u), s)| g * (*u * *s));
                let vertex = signed.sum::<Vector6<f64>>() + constant;
                let direction = vertex.try_normalize(0.0).unwrap_or_default();
                // A generator that reduces the component along this direction gets the opposite sign in the
                // row.
                row.linear.extend(generators.iter().map(|g| g.dot(&direction).abs()));
                row.constant = fixed.iter().map(|f| f.dot(&direction).abs()).sum();
            }
        }
    }

    /// Adds to a row the absolute values of the scalar products of the errors with a multiplier vector.
    ///
    /// At any scales, the added error never exceeds the worst case times the length of the vector. So the
    /// length of the vector is the weight of the worst case in the row. For a root sum square, the function
    /// adds the square of the figure, multiplied by the first component of the vector.
    pub(super) fn add_along(&self, y: &Vector6<f64>, row: &mut LimitRow) {
        match self {
            Self::RootSumSquare { squares, constant } => {
                row.squares.iter_mut().zip(squares).for_each(|(sum, w)| *sum += w * y[0]);
                row.constant += constant * y[0];
            }
            Self::WorstCase { generators, fixed, .. } => {
                row.linear.iter_mut().zip(generators).for_each(|(sum, g)| *sum += g.dot(y).abs());
                row.constant += fixed.iter().map(|f| f.dot(y).abs()).sum::<f64>();
            }
        }
    }

    /// Returns the generators and the sum of the fixed errors, with the signs that the last [`Self::value`]
    /// found.
    fn signed(&self, scratch: &FigureScratch) -> (Vec<Vector6<f64>>, Vector6<f64>) {
        let Self::WorstCase { generators, fixed, .. } = self else { return (Vec::new(), Vector6::zeros()) };
        let signed = |(g, s): (&Vector6<f64>, &f64)| g * *s;
        let (own, others) = scratch.signs.split_at(generators.len().min(scratch.signs.len()));
        let columns = generators.iter().zip(own).map(signed).collect();
        (columns, fixed.iter().zip(others).map(signed).sum())
    }

    /// Returns a figure whose value at any scales is `factor` times the value of this figure.
    pub fn scaled(&self, factor: f64) -> Self {
        match self {
            Self::WorstCase { rows, generators, fixed } => Self::WorstCase {
                rows: *rows,
                generators: generators.iter().map(|g| g * factor).collect(),
                fixed: fixed.iter().map(|f| f * factor).collect(),
            },
            Self::RootSumSquare { squares, constant } => Self::RootSumSquare {
                squares: squares.iter().map(|w| w * factor * factor).collect(),
                constant: constant * factor * factor,
            },
        }
    }

    /// Returns whether the figure is a worst case in more than one axis. Such a figure needs several cuts:
    /// one constraint for each sign pattern that is binding.
    pub fn has_many_cuts(&self) -> bool {
        matches!(self, Self::WorstCase { rows, .. } if *rows > 1)
    }

    /// Returns the number of parameters.
    pub fn parameters(&self) -> usize {
        match self {
            Self::WorstCase { generators, .. } => generators.len(),
            Self::RootSumSquare { squares, .. } => squares.len(),
        }
    }
}
