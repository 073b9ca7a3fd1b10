//! Pose accuracy of a series of robots. The errors of the robots follow the distributions of the tolerances,
//! and each robot is tested at the five poses of ISO 9283. A low-discrepancy sequence replaces random
//! numbers.

use super::base_fit::BaseFit;
use super::test_cube::TestCube;
use crate::cell::{Distribution, Model, Spread};
use crate::kinematic_error::{Perturbation, position_error};
use crate::low_discrepancy::richtmyer_steps;
use crate::reading::normal_quantile::normal_quantile;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Number of robots of a series that are tested.
const ROBOTS: usize = 2048;

/// Predicted pose accuracy of a series of robots, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseAccuracy {
    /// Median, over all robots, of each robot's mean pose accuracy at the five poses.
    pub median: f64,
    /// 5 % quantile, over all robots, of each robot's mean pose accuracy at the five poses.
    pub best: f64,
    /// 95 % quantile, over all robots, of each robot's mean pose accuracy at the five poses.
    pub worst: f64,
    /// Median, over all robots, of each robot's largest pose accuracy at the five poses.
    pub largest_pose: f64,
    /// Median, over all robots, of the pose accuracy at each of the five poses.
    pub poses: [f64; 5],
}

/// Test of a series of robots as in ISO 9283.
pub struct PoseAccuracyTest<'a> {
    chain: &'a Chain,
    pub(super) frames: [Frames; 5],
    /// Fit of the base frame; None if the errors are measured relative to the nominal base.
    fit: Option<BaseFit>,
}

impl<'a> PoseAccuracyTest<'a> {
    /// Prepares the test in a cube. If `fitted` is true, the base frame is fitted to each robot.
    pub fn new(chain: &'a Chain, cube: &TestCube, fitted: bool) -> Self {
        let frames = cube.poses.each_ref().map(|pose| chain.frames(&chain.posture(&pose.joints)));
        Self { chain, frames, fit: fitted.then(|| BaseFit::new(chain)) }
    }

    /// Returns the distance (m) of the attained position from the command position at each pose, for one
    /// robot.
    pub fn distances(&self, errors: &Perturbation) -> [f64; 5] {
        let at = self.frames.each_ref().map(|frames| frames.tcp.translation);
        let removed = self.fit.as_ref().map_or([Vector3::zeros(); 5], |fit| fit.displacements(errors, &at));
        std::array::from_fn(|p| {
            (position_error(&self.frames[p], errors, Model::Nonlinear) - removed[p]).norm()
        })
    }

    /// Returns the pose accuracy of the series whose parameters have the tolerances in `spreads`.
    ///
    /// The tolerances are in the order of [`crate::cell::Parameter::of_robot`]. Every call uses the same
    /// points of the low-discrepancy sequence, so the accuracy is a continuous function of the tolerances.
    pub fn accuracy(&self, spreads: &[Spread]) -> PoseAccuracy {
        let mut at: Vec<(f64, f64)> = richtmyer_steps().take(spreads.len()).map(|step| (0.5, step)).collect();
        let (mut means, mut largest) = (Vec::with_capacity(ROBOTS), Vec::with_capacity(ROBOTS));
        let mut poses = [(); 5].map(|()| Vec::with_capacity(ROBOTS));
        let mut values = vec![0.0; spreads.len()];
        for _ in 0..ROBOTS {
            for ((value, spread), (u, step)) in values.iter_mut().zip(spreads).zip(&mut at) {
                *u = (*u + *step).fract();
                *value = spread.deviation() * standard(spread.distribution, *u);
            }
            let distances = self.distances(&Perturbation::of_values(self.chain, &values));
            means.push(distances.iter().sum::<f64>() / 5.0);
            largest.push(distances.into_iter().fold(0.0, f64::max));
            poses.iter_mut().zip(distances).for_each(|(all, distance)| all.push(distance));
        }
        PoseAccuracy {
            median: quantile(&mut means, 0.5),
            best: quantile(&mut means, 0.05),
            worst: quantile(&mut means, 0.95),
            largest_pose: quantile(&mut largest, 0.5),
            poses: poses.each_mut().map(|all| quantile(all, 0.5)),
        }
    }
}

/// Returns the quantile at probability `u` of a distribution with mean 0 and standard deviation 1.
fn standard(distribution: Distribution, u: f64) -> f64 {
    let u = u.clamp(1e-12, 1.0 - 1e-12);
    match distribution {
        Distribution::Normal => normal_quantile(u),
        Distribution::Uniform => 3f64.sqrt() * (2.0 * u - 1.0),
        Distribution::Triangular => {
            let tail = (2.0 * u.min(1.0 - u)).sqrt();
            6f64.sqrt() * (1.0 - tail) * (u - 0.5).signum()
        }
    }
}

/// Returns the quantile of the values at the probability `share`.
fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let place = share * (values.len() - 1) as f64;
    let (low, high) = (values[place.floor() as usize], values[place.ceil() as usize]);
    low + (high - low) * place.fract()
}
