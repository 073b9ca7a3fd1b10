//! Value and derivatives of the quantities that the constraints of an operation limit.

use super::region::{ConstrainedQuantity, Constraint};
use super::task::Task;
use super::taylor_model::{Taylor, along, radius, rates, slopes};
use crate::cell::MAX_JOINTS;
use crate::kinematic_error::{JointValues, PosedScrews};
use nalgebra::Vector3;

impl Task<'_> {
    /// Returns the Taylor model of the [`ConstrainedQuantity`] of a constraint over a box with the half
    /// widths `radii`.
    pub fn constraint(&self, constraint: &Constraint, placed: &PosedScrews, radii: &JointValues) -> Taylor {
        let (rates, direction) = self.rates_along(constraint, placed);
        let (mut gradient, mut hessian) = along(&self.screws, placed, &rates, &direction);
        let rest = match constraint.of {
            ConstrainedQuantity::Height => self.to_tip.turned(&self.coordinates, radii, 0, 0, 3),
            ConstrainedQuantity::Axis(_) => {
                let last = self.coordinates.turning[self.coordinates.count];
                radius(radii, last).powi(3)
            }
            ConstrainedQuantity::RadiusSquared => {
                gradient[self.coordinates.count..].fill(0.0);
                for i in 0..self.coordinates.count {
                    (i..self.coordinates.count)
                        .for_each(|j| hessian[i][j] += 2.0 * rates[i].xy().dot(&rates[j].xy()));
                }
                let [one, two, three] =
                    [1, 2, 3].map(|power| self.to_tip.turned(&self.coordinates, radii, 0, 0, power));
                2.0 * (self.reach() * three + 3.0 * one * two)
            }
        };
        let (gradient, hessian) = self.coordinates.derivatives(&gradient, &hessian);
        Taylor { value: constraint.value(&placed.tip, &placed.tool), gradient, hessian, rest: rest / 6.0 }
    }

    /// Returns the gradient of the [`ConstrainedQuantity`] of a constraint with respect to the coordinates.
    pub fn gradient(&self, constraint: &Constraint, placed: &PosedScrews) -> JointValues {
        let (rates, direction) = self.rates_along(constraint, placed);
        self.coordinates.gradient(&slopes(&rates, &direction))
    }

    /// Returns the derivatives of a point or an axis with respect to the joint displacements, and a vector.
    /// Their scalar products are the derivatives of the [`ConstrainedQuantity`] of a constraint.
    fn rates_along(
        &self,
        constraint: &Constraint,
        placed: &PosedScrews,
    ) -> ([Vector3<f64>; MAX_JOINTS], Vector3<f64>) {
        let tip = &placed.tip;
        let (point, direction) = match constraint.of {
            ConstrainedQuantity::Height => (Some(tip), Vector3::z()),
            ConstrainedQuantity::Axis(direction) => (None, direction),
            ConstrainedQuantity::RadiusSquared => (Some(tip), Vector3::new(tip.x, tip.y, 0.0) * 2.0),
        };
        (rates(&self.screws, placed, point), direction)
    }
}
