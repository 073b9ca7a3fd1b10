//! Tests the lower bound of the objective of hitachi_cell. For the bound, each operation has the best spot at
//! any place with an allowed height of its surface.
//!
//! The errors of all joints after the waist rotate with the waist. With the tool down, the xy error therefore
//! depends only on branch, radius and height. The sum of the least values over radius and height of both
//! surfaces is a lower bound of the objective.

use crate::common::shipped;
use nalgebra::Vector3;
use sweetspot::cell::Attitude;
use sweetspot::cell::Model;
use sweetspot::kinematic_error::{Perturbation, position_error};
use sweetspot::reach::Inverse;
use sweetspot::robot::Chain;

/// Computes the least xy error (mm) over all branches with the tool down, for a TCP at a radius and a height
/// (mm) straight ahead.
struct Errors {
    chain: Chain,
    errors: Perturbation,
    arm: Inverse,
}

impl Errors {
    fn at(&self, radius: f64, height: f64) -> f64 {
        let target = Vector3::new(0.0, radius / 1e3, height / 1e3);
        let mut least = f64::INFINITY;
        let down = self.arm.tool_attitudes(&Attitude::elevation(-std::f64::consts::FRAC_PI_2), 0.0);
        self.arm.visit(&target, &down, &mut self.arm.scratch(), |_, posture| {
            let e = position_error(&self.chain.frames(posture), &self.errors, Model::Nonlinear);
            least = least.min(1e3 * e.x.hypot(e.y));
        });
        least
    }

    /// Returns the least error over radius and height, by a scan and then by finer and finer grids around the
    /// best point.
    fn least(&self, low: f64, high: f64) -> f64 {
        let heights = (0..=((high - low) / 2.0) as usize).map(|k| low + 2.0 * k as f64);
        let points = heights.flat_map(|h| (0..1900).map(move |r| (f64::from(r), h)));
        let scanned = points.map(|(r, h)| (self.at(r, h), r, h));
        let (mut least, mut radius, mut height) = scanned.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap();
        let mut step = 2.0;
        for _ in 0..40 {
            let (r0, h0) = (radius, height);
            for (i, j) in (-10..=10).flat_map(|i| (-10..=10).map(move |j| (i, j))) {
                let r = r0 + step * f64::from(i) / 10.0;
                let h = (h0 + step * f64::from(j) / 10.0).clamp(low, high);
                let e = self.at(r, h);
                if e < least {
                    (least, radius, height) = (e, r, h);
                }
            }
            step *= 0.7;
        }
        least
    }
}

#[test]
fn the_lower_bound_of_hitachi_cell_matches_brute_force() {
    let cell = shipped("hitachi_cell.toml");
    let chain = Chain::new(&cell.robot);
    let errors = Perturbation::new(&chain, crate::common::signed(&cell));
    let errors = Errors { arm: Inverse::new(&chain), chain, errors };
    // The TCP works 100 mm above the surfaces: the table from 300 to 900 mm, the conveyor at 600 mm.
    let bound = errors.least(400.0, 1000.0) + errors.least(700.0, 700.0);
    assert!((bound - 20.429670).abs() < 1e-6, "{bound}");
}
