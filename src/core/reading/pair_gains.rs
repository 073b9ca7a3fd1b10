//! Upper bounds of the increase of an error by flips of two signs, from the predictions of the single flips.
//!
//! At a corner with the error e, the flips of the signs j and k change the error by about `c_j + c_k`. Let M
//! be an upper bound of all terms that this prediction neglects. The flips can increase the error only if
//! `|e + c_j + c_k| + M >= |e|`. In this case, the left-hand side of the following inequality is not
//! negative:
//!
//! ```text
//! |e + c_j + c_k|^2 - |e|^2 + 2 |e| M <= p_j + p_k + 2 |c_j| |c_k| + 2 |e| M,    p_k = 2 e . c_k + |c_k|^2
//! ```
//!
//! The right-hand side needs only a few numbers per sign. Replace each number of the sign k by its largest
//! value over all signs. The right-hand side is then an upper bound for every pair that contains j.

use super::MAX_SOURCES;
use super::flip_prediction::PredictedFlip;
use nalgebra::Vector6;

/// Upper bound of the rounding error of a gain, as a share of the square of the error.
const ROUNDING: f64 = 4e-12;

/// Numbers of one flip from which the gains of pairs follow.
#[derive(Debug, Clone, Copy, Default)]
struct FlipGain {
    /// Sum of `p_k` and the part of `2 |e| M` that belongs to this flip alone, m^2 or rad^2.
    alone: f64,
    /// Length of the predicted change, m or rad.
    length: f64,
    /// Sum of the absolute rotations that the flip causes, rad.
    rotation: f64,
    /// Sum of the absolute displacements that the flip causes, m.
    displacement: f64,
}

/// Upper bounds of the increase of the error by flips of two signs at one corner of the tolerance box.
pub struct PairGains {
    flips: [FlipGain; MAX_SOURCES],
    /// Number of signs with a prediction.
    count: usize,
    /// Largest value of each field of [`FlipGain`] over all flips.
    largest: FlipGain,
    /// The result of [`super::SenseRows::weights`], multiplied by twice the size of the error.
    weights: [f64; 2],
    /// Upper bound of the rounding error of the sum in the inequality of this module, m^2 or rad^2.
    rounding: f64,
}

impl PairGains {
    /// Prepares the bounds at a corner with the error `error` along the rows of a sense. `weights` is the
    /// result of [`super::SenseRows::weights`]. A sign without a prediction in `flips` may always
    /// increase the error.
    pub fn new(flips: &[PredictedFlip], weights: [f64; 2], error: &Vector6<f64>) -> Self {
        let size = error.norm();
        let unknown = FlipGain { alone: f64::INFINITY, ..FlipGain::default() };
        let (mut gains, mut largest) = ([unknown; MAX_SOURCES], FlipGain::default());
        largest.alone = f64::NEG_INFINITY;
        for (gain, flip) in gains.iter_mut().zip(flips) {
            let length = flip.change.norm();
            let alone = 2.0 * error.dot(&flip.change) + length * length + 2.0 * size * flip.margin;
            *gain = FlipGain { alone, length, rotation: flip.rotation, displacement: flip.displacement };
            largest.alone = largest.alone.max(gain.alone);
            largest.length = largest.length.max(gain.length);
            largest.rotation = largest.rotation.max(gain.rotation);
            largest.displacement = largest.displacement.max(gain.displacement);
        }
        let rounding = ROUNDING * size * size;
        Self { flips: gains, count: flips.len(), largest, weights: weights.map(|w| 2.0 * size * w), rounding }
    }

    /// Returns whether flips of the signs `j` and `k` may increase the error.
    pub fn may_increase(&self, j: usize, k: usize) -> bool {
        self.may_be_increase(&self.flips[j], &self.flips[k])
    }

    /// Returns whether the flip of the sign `j` together with one other flip may increase the error.
    ///
    /// `count` is the number of all signs, including signs without a prediction.
    pub fn may_increase_with(&self, j: usize, count: usize) -> bool {
        count > self.count || self.may_be_increase(&self.flips[j], &self.largest)
    }

    #[inline]
    fn may_be_increase(&self, a: &FlipGain, b: &FlipGain) -> bool {
        let of_position = a.rotation * b.displacement + a.displacement * b.rotation;
        let products = self.weights[0] * of_position + self.weights[1] * a.rotation * b.rotation / 2.0;
        a.alone + b.alone + 2.0 * a.length * b.length + products + self.rounding >= 0.0
    }
}
