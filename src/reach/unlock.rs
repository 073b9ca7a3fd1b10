//! Redundant arms: one joint takes one value after the other, the rest is solved in closed form.

use super::inverse::{Approach, Gap, Inverse};
use super::kernel::{Locked, PoseKernel};
use crate::robot::Posture;
use nalgebra::Vector3;

/// An interval in which a redundant joint might still find a posture is cut into finer and finer parts.
const ROUNDS: usize = 5;
const INSIDE: usize = 11;

/// A target nearer to reach than this may be in reach somewhere between, m.
const GRAZING: f64 = 0.01;

impl Inverse {
    /// All attitudes with the redundant joint at one value, the k-th; returns the metres missing.
    pub(super) fn solve_locked(
        &self,
        (locked, kernel): (&Locked, &PoseKernel),
        (k, value): (usize, f64),
        target: &Vector3<f64>,
        approach: &Approach,
        found: &mut impl FnMut(u32, &Posture),
    ) -> f64 {
        let (held, inverse) = locked.at(value);
        let (mut part, mut posture) = (locked.template, self.template);
        let mut missing = f64::INFINITY;
        for a in 0..approach.hold.columns.len() {
            let flange = locked.rest_of(&self.flange(a, target, approach), &inverse);
            let by = kernel.solve(&flange, &mut part, &mut |branch, part| {
                locked.join(part, &held, &mut posture);
                found((k as u32) << 16 | (a as u32) << 4 | u32::from(branch), &posture);
            });
            missing = missing.min(by);
        }
        missing
    }

    /// [`Self::visit`] of a redundant arm: its values in turn; if none has a posture, between them.
    pub(super) fn unlock(
        &self,
        locked: &Locked,
        target: &Vector3<f64>,
        approach: &Approach,
        mut found: impl FnMut(u32, &Posture),
    ) -> Gap {
        if locked.hasty.is_some() {
            let mut any = false;
            for (k, value) in locked.values.iter().enumerate() {
                let mut keep = |index: u32, posture: &Posture| {
                    if self.excess(posture, target, approach) == 0.0 {
                        any = true;
                        found(index, posture);
                    }
                };
                self.solve_locked((locked, locked.quick()), (k, *value), target, approach, &mut keep);
            }
            if any {
                return Gap { reach: 0.0, limits: 0.0 };
            }
        }
        let mut gap_at = |k: usize, value: f64| {
            let (mut limits, mut usable) = (f64::INFINITY, false);
            let reach = self.solve_locked(
                (locked, &locked.kernel),
                (k, value),
                target,
                approach,
                &mut |index, posture| {
                    let excess = self.excess(posture, target, approach);
                    limits = limits.min(excess);
                    if excess == 0.0 {
                        usable = true;
                        found(index, posture);
                    }
                },
            );
            (Gap { reach, limits: if reach > 0.0 { 0.0 } else { limits } }, usable)
        };
        let mut any = false;
        let gaps: [Gap; Locked::STEPS] = std::array::from_fn(|k| {
            let (gap, usable) = gap_at(k, locked.values[k]);
            any |= usable;
            gap
        });
        let least = (0..gaps.len()).fold(0, |least, k| if gaps[k].is_less(&gaps[least]) { k } else { least });
        if any || gaps[least].reach > locked.near() {
            return gaps[least];
        }
        // Every dip of the gap may hide a posture.
        let (mut best, last) = (gaps[least], gaps.len() - 1);
        for k in 0..gaps.len() {
            let higher = |other: usize| !gaps[other].is_less(&gaps[k]);
            if locked.hasty.is_none() && (k == 0 || higher(k - 1)) && (k == last || higher(k + 1)) {
                let (mut lo, mut hi) = (locked.values[k.saturating_sub(1)], locked.values[(k + 1).min(last)]);
                for _ in 0..ROUNDS {
                    let (step, mut nearest) = ((hi - lo) / (INSIDE + 1) as f64, (Gap::ALL, lo));
                    for inner in 1..=INSIDE {
                        let value = lo + step * inner as f64;
                        let (gap, usable) = gap_at(gaps.len() + k, value);
                        if usable {
                            return gap;
                        }
                        nearest = if gap.is_less(&nearest.0) { (gap, value) } else { nearest };
                    }
                    best = if nearest.0.is_less(&best) { nearest.0 } else { best };
                    (lo, hi) = (nearest.1 - step, nearest.1 + step);
                }
            }
        }
        if best.reach > GRAZING {
            return best;
        }
        // A window too narrow for all that: the numeric way walks along the edge of the reach.
        for (k, goal) in self.goals(target, approach).iter().enumerate() {
            if let Some(q) = locked.numeric.one(goal) {
                let posture = self.chain.posture(&q);
                if self.excess(&posture, target, approach) == 0.0 {
                    found(((2 * gaps.len()) << 16 | k) as u32, &posture);
                    return Gap { reach: 0.0, limits: 0.0 };
                }
            }
        }
        best
    }
}
