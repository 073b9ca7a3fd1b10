//! Last joint that only rotates the tool about the joint axis. The boxes of the search need no coordinate of
//! this joint.
//!
//! Let the TCP be the measured point, on the axis of the last joint, and let the tool axis be the axis of
//! this joint. A rotation of the joint then changes only the effects of the errors after the joint (on the
//! tool side). These effects rotate about the tool axis `a`. The lower bound therefore uses the least
//! contribution of these effects over all rotations, in closed form.
//!
//! Statistical reading: let C be the covariance of the TCP that the errors after the joint cause at one
//! angle. C has the principal variances `c_1 >= c_2` perpendicular to the tool axis, and the variance `m`
//! along it. The squared statistic of the whole covariance S is at least `<A, S>` with a positive
//! semidefinite matrix A (see `value_bound`). Here `<A, S>` is the sum of the products of corresponding
//! entries. Let `a_1 >= a_2` be the eigenvalues of A, restricted to the plane perpendicular to the tool axis.
//! Then `<A, R C R^T> >= a_1 c_2 + a_2 c_1 + m a . A a` for every rotation R about the axis (J. von Neumann's
//! trace inequality). The tangent `<A, S>` bounds the squared statistic at every rotation only if this square
//! is convex in the covariance. The square of the mean is not convex. The bound of the mean therefore needs
//! the coordinate of the last joint.
//!
//! Worst case: let each error k after the joint move the TCP by up to `w_k g_k`. Let R be a rotation of the
//! tool. At the worst corner, these errors move the TCP by `sum_k w_k |d . R g_k|` in the direction d. As a
//! function of the angle of R, this sum is concave between the zeros of its terms, so it is least at one of
//! these zeros.

use super::coordinates::DIRECTION_ROUNDING;
use crate::cell::{JointKind, Quantity, Reading, Row};
use crate::kinematic_error::{ScrewMotion, Screws};
use crate::reading::ErrorEvaluator;
use crate::robot::Chain;
use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use std::f64::consts::{FRAC_PI_2, PI};

/// Errors after a last joint that only rotates the tool about its axis.
#[derive(Debug, Clone)]
pub(super) struct LastJoint {
    /// TCP displacement perpendicular to the tool axis that each error causes, in axes that rotate with the
    /// tool, m.
    ///
    /// In the statistical reading, each error has the size of one standard deviation. In the worst case, it
    /// has the size of its tolerance.
    across: Vec<Vector2<f64>>,
    /// Displacement of the TCP along the tool axis that each error causes, m.
    along: Vec<f64>,
    /// Principal variances of the TCP perpendicular to the tool axis, the greater one first, m^2.
    variances: (f64, f64),
}

/// Directions of the tool axis: all directions within an angle (rad) of a unit vector in the base frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct ToolAxisRange {
    pub axis: Vector3<f64>,
    pub angle: f64,
}

impl ToolAxisRange {
    /// Returns the directions with an elevation in a range (rad). If `range` is None, the result
    /// contains all directions.
    pub fn of_elevations(range: Option<(f64, f64)>) -> Self {
        let (low, high) = range.unwrap_or((-FRAC_PI_2, FRAC_PI_2));
        let (down, up) = (high + FRAC_PI_2, FRAC_PI_2 - low);
        let (axis, angle) = if down < up { (-Vector3::z(), down) } else { (Vector3::z(), up) };
        Self { axis, angle: angle.max(0.0) + DIRECTION_ROUNDING }
    }
}

impl LastJoint {
    /// Returns the errors after the last joint. Returns None if the bound needs the coordinate of this joint.
    ///
    /// `motions` are the motions of the error sources, and `rows` the rows of the sense.
    pub fn new(
        chain: &Chain,
        screws: &Screws,
        evaluator: &ErrorEvaluator,
        motions: &[ScrewMotion],
        rows: &[Row],
    ) -> Option<Self> {
        let n = chain.axes();
        let last = n.checked_sub(1)?;
        let link = &chain.links[last];
        let is_coupled = (0..last).any(|k| chain.coupling[last][k] != 0.0 || chain.coupling[k][last] != 0.0);
        // Half a turn suffices, because a rotation by half a turn changes neither variances nor widths.
        let turns = link.kind == JointKind::Revolute && link.limits.1 - link.limits.0 >= PI;
        let axis = screws.axes[last];
        let off = [screws.tool, screws.tip - screws.points[last], screws.point - screws.points[last]];
        let is_on_axis = off.iter().all(|v| v.cross(&axis).norm() <= DIRECTION_ROUNDING);
        if last == 0 || is_coupled || !turns || !is_on_axis || rows.iter().any(|row| row.turns) {
            return None;
        }
        let sources = &evaluator.sources;
        let size = |source: usize| match evaluator.reading {
            Reading::Signed => None,
            Reading::WorstCase => Some(sources.list[source].plus_minus),
            // The square of the mean is not convex in the covariance.
            Reading::Statistical if evaluator.quantity == Quantity::Mean => None,
            // A correlated error is not independent of the other errors, so its variance cannot be added
            // separately.
            Reading::Statistical => {
                sources.list[source].spread.is_some().then_some(sources.list[source].deviation)
            }
        };
        let frame = across(&screws.tool);
        let (mut moved, mut along): (Vec<(usize, Vector2<f64>)>, Vec<f64>) = Default::default();
        for motion in motions.iter().filter(|motion| motion.link == n) {
            let g = match motion.turns {
                true => motion.axis.cross(&(screws.point - motion.through)),
                false => motion.axis,
            };
            let g = g * (motion.factor * size(motion.source)?);
            if moved.iter().any(|(source, _)| *source == motion.source) {
                return None;
            }
            moved.push((motion.source, Vector2::new(frame[0].dot(&g), frame[1].dot(&g))));
            along.push(screws.tool.dot(&g));
        }
        let across: Vec<Vector2<f64>> = moved.into_iter().map(|(_, g)| g).collect();
        let mixed = across.iter().zip(&along).map(|(g, a)| (g * *a).abs().sum()).sum::<f64>();
        if mixed > DIRECTION_ROUNDING * across.iter().map(Vector2::norm_squared).sum::<f64>() {
            return None;
        }
        let covariance: Matrix2<f64> = across.iter().map(|g| g * g.transpose()).sum();
        let eigen = covariance.symmetric_eigenvalues();
        let variances = (eigen.max().max(0.0), eigen.min().max(0.0));
        Some(Self { across, along, variances })
    }

    /// Returns a covariance of the TCP (m^2, base frame) that stands for the errors after the joint. The
    /// tangent that bounds a percentile is taken at the sum of this covariance and `others`.
    ///
    /// `others` is the covariance that all other errors cause. The covariance that the errors after the joint
    /// cause depends on the rotation of the tool about its axis. The result is a weighted average of this
    /// covariance over such rotations. The weights make the sum with `others` as isotropic as possible
    /// perpendicular to the tool axis. Under the convexity assumption of the module `value_bound`, an
    /// isotropic covariance gives the least percentiles for a given trace.
    pub fn covariance(&self, others: &Matrix3<f64>, tool: &ToolAxisRange) -> Matrix3<f64> {
        let frame = across(&tool.axis);
        let eigen = within(others, &frame).symmetric_eigen();
        let greater = usize::from(eigen.eigenvalues[1] > eigen.eigenvalues[0]);
        let axis = |k: usize| {
            let v = eigen.eigenvectors.column(k);
            frame[0] * v[0] + frame[1] * v[1]
        };
        let [p, q] = [axis(greater), axis(1 - greater)];
        let (most, least) = self.variances;
        let (mean, half) = ((most + least) / 2.0, (most - least) / 2.0);
        let half = half.min((eigen.eigenvalues.max() - eigen.eigenvalues.min()) / 2.0);
        p * p.transpose() * (mean - half)
            + q * q.transpose() * (mean + half)
            + tool.axis * tool.axis.transpose() * self.along_squared()
    }

    /// Returns a lower bound of `<form, C>`, the sum of the products of corresponding entries. The matrix
    /// `form` must be positive semidefinite. C is the covariance of the TCP that the errors after the joint
    /// cause. The bound holds for every rotation of the tool about its axis, and for every axis direction in
    /// `tool`.
    pub fn least_form(&self, form: &Matrix3<f64>, tool: &ToolAxisRange) -> f64 {
        let eigen = within(form, &across(&tool.axis)).symmetric_eigenvalues();
        let (most, least) = self.variances;
        let along = self.along_squared();
        let sum = eigen.max() * least + eigen.min() * most + along * tool.axis.dot(&(form * tool.axis));
        // A rotation Q by the angle t changes the form by at most |Q^T A Q - A| <= 2 t |A|.
        (sum - 2.0 * tool.angle * form.norm() * (most + least + along)).max(0.0)
    }

    /// Returns the variance of the TCP along the tool axis that the errors after the joint cause, m^2.
    fn along_squared(&self) -> f64 {
        self.along.iter().map(|a| a * a).sum()
    }

    /// Returns a lower bound of the greatest `d . e` over all errors within their tolerances. The vector e is
    /// the TCP displacement that the errors after the joint cause. The bound holds for every rotation of the
    /// tool about its axis, and for every axis direction in `tool`.
    pub fn least_width(&self, d: &Vector3<f64>, tool: &ToolAxisRange) -> f64 {
        let level = (d - tool.axis * tool.axis.dot(d)).norm();
        let width = |zero: &Vector2<f64>| -> f64 {
            let normal = Vector2::new(-zero.y, zero.x) / zero.norm();
            self.across.iter().map(|g| normal.dot(g).abs()).sum()
        };
        let moving = self.across.iter().filter(|g| g.norm() > 0.0);
        let narrowest = moving.map(width).fold(f64::INFINITY, f64::min);
        let narrowest = if narrowest.is_finite() { narrowest } else { 0.0 };
        let along: f64 = self.along.iter().map(|a| a.abs()).sum();
        let all = along + self.across.iter().map(|g| g.norm()).sum::<f64>();
        let sum = level * narrowest + along * tool.axis.dot(d).abs();
        (sum - tool.angle * d.norm() * all).max(0.0)
    }
}

/// Returns two unit vectors that are perpendicular to a unit vector and to each other.
fn across(axis: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let p = axis.cross(&Vector3::ith(axis.iamin(), 1.0)).normalize();
    [p, axis.cross(&p)]
}

/// Returns a quadratic form restricted to the plane of two perpendicular unit vectors.
fn within(form: &Matrix3<f64>, frame: &[Vector3<f64>; 2]) -> Matrix2<f64> {
    Matrix2::from_fn(|i, j| frame[i].dot(&(form * frame[j])))
}
