//! Extent of a working envelope: least and greatest distance from the base axis, least and greatest height.
//!
//! The lattice of the envelope gives sampled points. Compass searches from the best of these points find each
//! of the four extremes (Kolda, Lewis and Torczon, SIAM Review 45 (2003) 385-482).
//!
//! A search consists of polls. A poll tests several points around the best point so far. All these points
//! have the same distance from the best point: the polling distance. Their directions follow a sequence.
//! Successive directions in the plane differ by the golden angle. Successive directions in space differ by
//! this angle in azimuth. The directions never repeat, so some of them point even into a sharp tip of the
//! envelope. A gain is a poll that finds a better point. The polling distance doubles after a gain.

use crate::low_discrepancy::GOLDEN_ANGLE;
use crate::low_discrepancy::halton;
use rayon::prelude::*;

/// Largest error of a refined length, m.
const ACCURACY: f64 = 1e-4;
/// Polling distance, m, below which a compass search ends.
const LEAST_STEP: f64 = ACCURACY / 10.0;
/// Number of points that one poll of a compass search tests, each in another direction.
const DIRECTIONS: usize = 8;
/// Greatest number of polls of one search; about a hundred are usual.
const MAX_POLLS: usize = 1000;
/// Extent of an envelope about the base axis, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EnvelopeExtent {
    /// Least and greatest distance from the base axis, m.
    pub radius: (f64, f64),
    /// Least and greatest height of the envelope, m.
    pub height: (f64, f64),
    /// Height, m, at which the distance from the base axis is greatest. The outline of the envelope is often
    /// nearly vertical at this height. The error of the height can therefore be as large as the distance
    /// between sampled points.
    pub widest: f64,
    /// Bound of the error of radius and height, m. Parts of the envelope that are narrower than the distance
    /// between sampled points may be missed.
    pub within: f64,
}

/// Effort of the searches that refine the extent of an envelope.
#[derive(Clone, Copy)]
pub(super) struct RefinementEffort {
    /// Number of sampled points from which searches start.
    pub starts: usize,
    /// Number of consecutive polls without a better point after which a search halves the polling distance.
    pub failures: usize,
}

/// Sampled points of an envelope, from which the extent is refined; a point has N coordinates, m.
pub(super) struct SampledEnvelope<'a, const N: usize> {
    /// Sampled points in the envelope, or on its boundary.
    pub points: &'a [[f64; N]],
    /// Distance between sampled points, m.
    pub step: f64,
    /// Function that returns the distance of a point from the base axis and the height of the point, m.
    pub radius_and_height: fn(&[f64; N]) -> (f64, f64),
    /// Function that returns whether the envelope contains a point.
    pub contains: &'a (dyn Fn(&[f64; N]) -> bool + Sync),
    pub effort: RefinementEffort,
}

/// Length (m) as a function of a point; a search looks for the greatest length.
type SoughtLength<'a, const N: usize> = dyn Fn(&[f64; N]) -> f64 + Sync + 'a;

impl<const N: usize> SampledEnvelope<'_, N> {
    /// Returns the refined extent; None if there is no sampled point.
    pub fn extent(&self) -> Option<EnvelopeExtent> {
        let of = self.radius_and_height;
        let goals: [&SoughtLength<'_, N>; 4] = [&|p| -of(p).0, &|p| of(p).0, &|p| -of(p).1, &|p| of(p).1];
        let found: Vec<[f64; N]> = goals.par_iter().map(|goal| self.farthest(goal)).collect::<Option<_>>()?;
        let [inner, outer, low, high] = [0, 1, 2, 3].map(|k| of(&found[k]));
        // An envelope counts as touching the base axis if its distance from the axis is less than `ACCURACY`.
        let least = if inner.0 < ACCURACY { 0.0 } else { inner.0 };
        Some(EnvelopeExtent {
            radius: (least, outer.0),
            height: (low.1, high.1),
            widest: outer.1,
            within: ACCURACY,
        })
    }

    /// Returns the point with the greatest value of `goal` that the searches find; None if there is no
    /// sampled point.
    fn farthest(&self, goal: &SoughtLength<'_, N>) -> Option<[f64; N]> {
        let mut sorted: Vec<&[f64; N]> = self.points.iter().collect();
        sorted.sort_by(|a, b| goal(b).total_cmp(&goal(a)));
        let mut starts: Vec<[f64; N]> = Vec::new();
        for point in sorted {
            if starts.iter().all(|start| distance(start, point) > 2.0 * self.step) {
                starts.push(*point);
            }
            if starts.len() == self.effort.starts {
                break;
            }
        }
        let ends = starts.into_iter().map(|start| self.climbed(start, goal));
        ends.reduce(|best, other| if goal(&other) > goal(&best) { other } else { best })
    }

    /// Returns the end point of a compass search that starts at `start` and maximizes `goal`.
    fn climbed(&self, start: [f64; N], goal: &SoughtLength<'_, N>) -> [f64; N] {
        // A point on the sampled boundary may lie just outside the envelope. For such a start, any polled
        // point inside the envelope counts as a gain.
        let mut best = start;
        let mut most = if (self.contains)(&start) { goal(&start) } else { f64::NEG_INFINITY };
        let (mut step, mut failures) = (self.step / 2.0, 0);
        for poll in 0..MAX_POLLS {
            if step < LEAST_STEP {
                break;
            }
            let polled = (poll * DIRECTIONS..(poll + 1) * DIRECTIONS).map(|k| {
                let towards = direction::<N>(k);
                std::array::from_fn(|i| best[i] + step * towards[i])
            });
            let better = polled.filter(|p| goal(p) > most && (self.contains)(p));
            match better.max_by(|a, b| goal(a).total_cmp(&goal(b))) {
                Some(point) => (best, most, failures, step) = (point, goal(&point), 0, 2.0 * step),
                None if failures + 1 < self.effort.failures => failures += 1,
                None => (step, failures) = (step / 2.0, 0),
            }
        }
        if most > f64::NEG_INFINITY { best } else { start }
    }
}

/// Returns unit vector `k` of a sequence that covers all directions of the plane or of space evenly.
fn direction<const N: usize>(k: usize) -> [f64; N] {
    let (sin, cos) = (GOLDEN_ANGLE * k as f64).sin_cos();
    let height = if N > 2 { halton(k as u64 + 1).next().map_or(0.0, |u| 2.0 * u - 1.0) } else { 0.0 };
    let across = (1.0 - height * height).sqrt();
    std::array::from_fn(|i| [cos * across, sin * across, height].get(i).copied().unwrap_or(0.0))
}

fn distance<const N: usize>(a: &[f64; N], b: &[f64; N]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
