//! First joint with a vertical axis. In the statistical reading, isotropic errors replace the errors before
//! this joint that act in horizontal directions. The boxes of the search then need no coordinate of this
//! joint.
//!
//! The errors before this joint act in directions that are fixed in the base. If the joint moves, these
//! directions rotate relative to the link after the joint. Let an error with the variance v translate the arm
//! along a horizontal direction u, or rotate it about u. The contribution of this error to the bound of the
//! squared statistic is `v u . M(p) u`. The matrix M depends on the position p of the measured point. Two
//! errors are of one kind if both are translations, or both are rotations about axes through the same point.
//! Two errors of one kind with the variance v in perpendicular directions together contribute `v tr M`. This
//! sum does not depend on the choice of the two directions. The bound therefore splits the variances of each
//! kind of error into two parts: an isotropic part, and an excess in one direction.
//!
//! An excess with the variance v contributes at least v times the least eigenvalue of M to the bound. Let the
//! rows of the sense be horizontal. The bound of the squared statistic is then `<A, S>` with a horizontal
//! matrix A and the covariance S (see `value_bound`). Let `a_1 >= a_2` be the eigenvalues of A in the
//! horizontal plane. A translation gives `M = A`. A rotation about u moves the point in plan by h per radian,
//! perpendicular to u. Here h is the height of the point above the rotation axis. The matrix M is then `h^2`
//! times A rotated by a quarter turn.
//!
//! In both cases, the least eigenvalue is the isotropy `2 a_2 / (a_1 + a_2)` times `tr M / 2`. An isotropic
//! error with the variance `v / 2` in each direction contributes `v tr M / 2`. The excess therefore
//! contributes at least this number times the isotropy.

use super::coordinates::DIRECTION_ROUNDING;
use crate::cell::{Quantity, Reading, Row};
use crate::kinematic_error::{ScrewMotion, Screws};
use crate::reading::{ErrorEvaluator, MAX_SOURCES};
use nalgebra::{Matrix2, Matrix3, Vector3};

/// Largest number of joints for which the bound of the worst case includes the errors before the first joint.
/// To include these errors, the search needs a coordinate of the first joint. For an arm with more joints,
/// this coordinate would need too many boxes.
const MAX_JOINTS_OF_WORST_CASE: usize = 6;

/// Isotropic errors that stand for the errors before a first joint with a vertical axis.
#[derive(Debug, Clone, Default)]
pub(super) struct FirstJoint {
    /// Motions along or about x and y. The source indices of these motions continue the list of the cell's
    /// error sources.
    pub motions: Vec<ScrewMotion>,
    /// Standard deviation of each motion in `motions`, m or rad.
    pub deviations: Vec<f64>,
    /// Number of motions at the end of `motions` that stand for the excess in one direction. The bound
    /// multiplies the terms of these motions by the [`isotropy`].
    pub excess: usize,
}

impl FirstJoint {
    /// Replaces the errors before the first joint that act along or about horizontal directions. `motions`
    /// are the motions of all error sources. The motions of the replaced errors are removed.
    ///
    /// If the reading is worst-case and the arm has more than [`MAX_JOINTS_OF_WORST_CASE`] joints, no motions
    /// replace these errors. This is also the case if the list of error sources would become longer than
    /// [`MAX_SOURCES`]. If the sense has a rotation row or a non-horizontal row, no motions replace the
    /// excess in one direction. The bound remains valid without these motions. Returns None, and leaves
    /// `motions` unchanged, if the bound needs the coordinate of the first joint.
    pub fn replace(
        screws: &Screws,
        evaluator: &ErrorEvaluator,
        motions: &mut Vec<ScrewMotion>,
        rows: &[Row],
    ) -> Option<Self> {
        let list = &evaluator.sources.list;
        let acts_across = |m: &ScrewMotion| m.link == 0 && !is_of_first_axis(m, screws);
        let across: Vec<ScrewMotion> = motions.iter().copied().filter(acts_across).collect();
        // The square of the mean is not convex in the covariance.
        let is_convex = evaluator.reading == Reading::Statistical && evaluator.quantity != Quantity::Mean;
        let leaves_out =
            evaluator.reading == Reading::WorstCase && screws.kinds.len() > MAX_JOINTS_OF_WORST_CASE;
        let can_replace = |m: &ScrewMotion| {
            let arm = (m.through - screws.points[0]).xy().norm();
            let is_alone = motions.iter().filter(|other| other.source == m.source).count() == 1;
            is_convex
                && is_alone
                && list[m.source].spread.is_some()
                && m.axis.z.abs() < DIRECTION_ROUNDING
                && (!m.turns || arm < DIRECTION_ROUNDING)
        };
        if !leaves_out && !across.iter().all(can_replace) {
            return None;
        }
        motions.retain(|m| !acts_across(m));
        if leaves_out {
            return Some(Self::default());
        }
        let is_level = rows.iter().all(|row| !row.turns && row.direction.z.abs() < DIRECTION_ROUNDING);
        let (mut isotropic, mut excess, mut rest) = (Vec::new(), Vec::new(), across);
        while let Some(&kind) = rest.first() {
            let is_alike = |m: &ScrewMotion| m.turns == kind.turns && (!m.turns || m.through == kind.through);
            let (alike, others): (Vec<_>, Vec<_>) = rest.into_iter().partition(is_alike);
            let term = |m: &ScrewMotion| {
                let u = m.axis.xy() * (m.factor * list[m.source].deviation);
                u * u.transpose()
            };
            let eigen = alike.iter().map(term).sum::<Matrix2<f64>>().symmetric_eigenvalues();
            let (most, least) = (eigen.max(), eigen.min().max(0.0));
            isotropic.push((kind, least.sqrt()));
            excess.push((kind, ((most - least).max(0.0) / 2.0).sqrt()));
            rest = others;
        }
        let mut this = Self::default();
        let kept = if is_level { excess } else { Vec::new() };
        this.excess = 2 * kept.len();
        for (kind, deviation) in isotropic.into_iter().chain(kept) {
            for axis in [Vector3::x(), Vector3::y()] {
                let source = list.len() + this.motions.len();
                this.motions.push(ScrewMotion { axis, source, factor: 1.0, ..kind });
                this.deviations.push(deviation);
            }
        }
        let fits = list.len() + this.motions.len() <= MAX_SOURCES;
        Some(if fits { this } else { Self::default() })
    }
}

/// Returns the isotropy `2 a_2 / (a_1 + a_2)` of a positive semidefinite form in horizontal directions, with
/// the eigenvalues `a_1 >= a_2`. It is between 0 and 1.
pub(super) fn isotropy(form: &Matrix3<f64>) -> f64 {
    let eigen = form.fixed_view::<2, 2>(0, 0).into_owned().symmetric_eigenvalues();
    let sum = eigen.sum();
    if sum > 0.0 { (2.0 * eigen.min() / sum).clamp(0.0, 1.0) } else { 0.0 }
}

/// Returns whether a motion before the first joint is a rotation about the first axis or a translation along
/// it.
fn is_of_first_axis(motion: &ScrewMotion, screws: &Screws) -> bool {
    let (axis, arm) = (&screws.axes[0], motion.through - screws.points[0]);
    motion.axis.cross(axis).norm() < DIRECTION_ROUNDING
        && (!motion.turns || arm.cross(axis).norm() < DIRECTION_ROUNDING)
}
