//! First-order effects of the error sources on the TCP, relative to the equipment on which the robot works.

use super::error_sources::{ErrorSources, MAX_SOURCES};
use crate::cell::{Distribution, Parameter};
use crate::kinematic_error::Expansion;
use crate::pose::{Displacement, Pose};
use nalgebra::Vector3;

/// First-order effects of the error sources on the TCP, and the mean error of the TCP (base frame).
///
/// Each column is the effect of one unit of one source. The mean error comes from the second-order terms of
/// random sources.
#[derive(Debug, Clone)]
pub struct Effects {
    pub columns: [Displacement; MAX_SOURCES],
    pub count: usize,
    pub mean: Displacement,
}

impl Default for Effects {
    fn default() -> Self {
        Self { columns: [Displacement::NONE; MAX_SOURCES], count: 0, mean: Displacement::NONE }
    }
}

impl Effects {
    /// Sets the effects of the robot's sources at the posture of `expansion`.
    ///
    /// If `mean` is true, the function also sets the mean error that second-order terms cause. Otherwise the
    /// mean error is 0.
    pub fn set(&mut self, sources: &ErrorSources, expansion: &Expansion, mean: bool) {
        self.count = sources.list.len();
        for k in 0..self.count {
            self.columns[k] = sources.robot_index(k).map_or(Displacement::NONE, |p| expansion.first(p));
        }
        self.mean = if mean { second_order_mean(sources, expansion) } else { Displacement::NONE };
    }

    /// Subtracts the motion of the equipment at the point `p` from the effects on the TCP. Frame errors of
    /// the equipment cause this small motion.
    ///
    /// `p` is in the base frame, m; `work` is the pose of the equipment in the base frame.
    pub fn less_equipment(
        &mut self,
        sources: &ErrorSources,
        equipment: usize,
        work: &Pose,
        p: &Vector3<f64>,
    ) {
        for (k, source) in sources.list.iter().enumerate() {
            if let Parameter::Equipment(e, c) = source.parameter
                && e == equipment
            {
                let axis = work.rotation.column(c % 3).into_owned();
                let moved = match c < 3 {
                    true => Displacement { position: axis, rotation: Vector3::zeros() },
                    false => Displacement { position: axis.cross(&(p - work.translation)), rotation: axis },
                };
                self.columns[k] = self.columns[k] - moved;
            }
        }
    }

    /// Subtracts the effects and the mean error of `other` from `self`. Before that, the function `change`
    /// transforms each of them.
    pub fn less(&mut self, other: &Effects, change: impl Fn(&Displacement) -> Displacement) {
        for k in 0..self.count {
            self.columns[k] = self.columns[k] - change(&other.columns[k]);
        }
        self.mean = self.mean - change(&other.mean);
    }

    /// Calls `add` for every independent random factor with two arguments: the effect of the factor at one
    /// standard deviation, and its distribution.
    pub fn independent(&self, sources: &ErrorSources, mut add: impl FnMut(Displacement, Distribution)) {
        for (k, source) in sources.list.iter().enumerate() {
            if let Some(spread) = &source.spread {
                add(self.columns[k] * source.deviation, spread.distribution);
            }
        }
        for factor in &sources.factors {
            let moved = factor.iter().fold(Displacement::NONE, |sum, &(k, v)| sum + self.columns[k] * v);
            add(moved, Distribution::Normal);
        }
    }

    /// Returns the linear error of a sample; `values` holds one value per source.
    pub fn of_sample(&self, values: &[f64]) -> Displacement {
        let columns = self.columns[..self.count].iter().zip(values);
        columns.fold(Displacement::NONE, |sum, (column, value)| sum + *column * *value)
    }
}

/// Returns the mean of the second-order terms of the TCP error: `1/2 sum_jk H_jk C_jk`.
///
/// `H_jk` is the second derivative of the TCP pose with respect to sources j and k, and `C_jk` is their
/// covariance. For independent sources, only the terms with j = k are not zero.
fn second_order_mean(sources: &ErrorSources, expansion: &Expansion) -> Displacement {
    let mut mean = Displacement::NONE;
    for (k, source) in sources.list.iter().enumerate().filter(|(_, s)| s.spread.is_some()) {
        if let Some(p) = sources.robot_index(k) {
            mean = mean + expansion.second(p, p) * (source.deviation * source.deviation / 2.0);
        }
    }
    for factor in &sources.factors {
        for (&(j, vj), &(k, vk)) in factor.iter().flat_map(|a| factor.iter().map(move |b| (a, b))) {
            if let (Some(a), Some(b)) = (sources.robot_index(j), sources.robot_index(k)) {
                mean = mean + expansion.second(a, b) * (vj * vk / 2.0);
            }
        }
    }
    mean
}
