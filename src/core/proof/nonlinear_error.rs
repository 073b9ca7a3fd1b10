//! Nonlinear error of a signed sample: the difference between the end points of the chain with errors and
//! the nominal chain.
//!
//! Two chains with the same joints differ by one small motion before every axis and one small motion before
//! the end point. Let `a_k` be the size of motion k, and `g_k` its effect on the end point. To first order in
//! the motions, the difference is `d = sum_k a_k g_k`. The third derivatives of d are therefore sums of third
//! derivatives of linear effects. The part of the difference beyond d is of second order in the motions.
//! Products of the sizes of the motions bound the derivatives of this part in any direction of joint space.

use super::coordinates::Coordinates;

use super::taylor_model::{ChainGeometry, RigidPieces, Taylor, along, radius, rates};
use crate::cell::{JointKind, MAX_JOINTS};
use crate::kinematic_error::{JointValues, PosedScrews, Screws};
use nalgebra::Vector3;

/// Difference of a chain with errors from the nominal chain.
#[derive(Debug, Clone)]
pub(super) struct ChainDifference {
    /// Screw axes of the chain with errors.
    pub screws: Screws,
    /// Angle of the small motion that the errors cause at every link, rad.
    turns: [f64; MAX_JOINTS + 1],
    /// Translation of the small motion that the errors cause at every link, m.
    shifts: [f64; MAX_JOINTS + 1],
    /// Upper bound of the part of the difference that is of second order in the small motions, m.
    second: f64,
    /// Upper bound of the change of [`Self::second`] per metre of prismatic travel.
    second_per_slide: f64,
}

impl ChainDifference {
    /// Prepares the difference of two chains with the same joints.
    pub fn new(nominal: &Screws, screws: Screws, pieces: &RigidPieces) -> Self {
        let n = nominal.kinds.len();
        let (turns, shifts) = nominal.motions_to(&screws);
        let (mut second, mut second_per_slide, mut sum) = (0.0, 0.0, 0.0);
        for k in 0..=n {
            sum += turns[k];
            let lever = pieces.from(k) + shifts[k..=n].iter().sum::<f64>();
            second += (turns[k] * lever + shifts[k]) * sum;
            second_per_slide += turns[k] * sum;
        }
        Self { screws, turns, shifts, second, second_per_slide }
    }

    /// Returns whether the first joint axis has no error. All errors then act after the first joint, and
    /// their directions rotate with this joint.
    pub fn keeps_first_axis(&self) -> bool {
        self.turns[0] < 1e-12 && self.shifts[0] < 1e-12
    }

    /// Returns the Taylor model of `eta . d` over a box with the half widths `radii` about a posture. Here
    /// `d` leads from the end point of the nominal chain to the end point of the chain with errors.
    ///
    /// `at` is the nominal chain at this posture, and `with` is the chain with errors at this posture.
    pub fn expand(
        &self,
        ChainGeometry { screws: nominal, coordinates, pieces }: ChainGeometry<'_>,
        at: &PosedScrews,
        with: &PosedScrews,
        eta: &Vector3<f64>,
        radii: &JointValues,
    ) -> Taylor {
        let (mut gradient, mut hessian) =
            along(&self.screws, with, &rates(&self.screws, with, Some(&with.point)), eta);
        let (g, h) = along(nominal, at, &rates(nominal, at, Some(&at.point)), eta);
        for i in 0..coordinates.count {
            gradient[i] -= g[i];
            (0..coordinates.count).for_each(|j| hessian[i][j] -= h[i][j]);
        }
        let (gradient, hessian) = coordinates.derivatives(&gradient, &hessian);
        let value = eta.dot(&(with.point - at.point));
        Taylor { value, gradient, hessian, rest: eta.norm() * self.rest(coordinates, pieces, radii) }
    }

    /// Returns an upper bound of the third-order remainder, m, of the difference that [`Self::expand`]
    /// expands.
    fn rest(&self, coordinates: &Coordinates, pieces: &RigidPieces, radii: &JointValues) -> f64 {
        let first = (0..=coordinates.count).map(|m| {
            let own = coordinates.turning[m];
            self.turns[m] * pieces.turned(coordinates, radii, m, own, 3)
                + self.shifts[m] * radius(radii, own).powi(3)
        });
        let turned: f64 = coordinates.angles.iter().zip(radii).map(|(a, r)| a * r).sum();
        let slid: f64 = radii
            .iter()
            .zip(&self.screws.kinds)
            .filter(|(_, k)| **k == JointKind::Prismatic)
            .map(|(r, _)| r)
            .sum();
        let second = self.second * turned.powi(3) + 3.0 * self.second_per_slide * turned * turned * slid;
        (first.sum::<f64>() + second) / 6.0
    }
}
