//! Branch and bound over boxes of joint coordinates, with bounds from Taylor models.
//!
//! In every box, the constraints are expanded first. If a constraint cannot be met, the box is discarded.
//! Otherwise the constraints contract the box, and Lagrangian relaxation bounds the value `phi` from below.
//! Let `c_m` be the constrained quantities and `lambda_m` any multipliers. The bound is the sum of two lower
//! bounds. The first is the bound of `phi - sum lambda_m c_m` over the whole box. The second is the bound of
//! `sum lambda_m c_m` over the allowed values of `c_m`. Let the multipliers be those of the optimum in the
//! box. The error of the bound then decreases with the square of the size of the box. Boxes therefore need
//! not become small where constraints are active.

use super::joint_box::{ContractedBox, JointBox, widest};
use super::task::Task;
use super::witness::{Witness, kept_near, near};
use crate::cell::JointVector;
use rayon::prelude::*;
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicBool, Ordering as MemoryOrdering};

/// Number of boxes examined per round. The number is large enough to occupy all threads, and small enough
/// that the examined boxes have bounds close to the least bound.
const BOXES_PER_ROUND: usize = 64;
/// Number of boxes per round in which the search looks for a posture that keeps all constraints.
const WITNESSES_PER_ROUND: usize = 8;
/// Largest number of boxes that are examined to prove that no posture satisfies the constraints.
const MAX_EMPTY_BOXES: usize = 200;
/// Margin subtracted from the bound to allow for rounding errors. The margin is the bound times this number,
/// plus this number in m or rad.
///
/// The values that are bounded are accurate to 1e-13.
const ROUNDING: f64 = 1e-11;
/// Least length, m or rad, of a side of a box that is bisected.
const MIN_SIDE: f64 = 1e-12;
/// The search treats two values as equal if they differ by less than this value, m or rad.
const NEGLIGIBLE: f64 = 1e-9;
/// The search accepts 0 as the lower bound if the least value found (m or rad) is below this threshold.
pub(super) const VANISHES: f64 = 1e-6;

/// Result of the search over boxes.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct BoxSearchResult {
    /// Lower bound of the value of every posture that satisfies the constraints, m or rad.
    pub bound: f64,
    /// Number of boxes examined.
    pub boxes: u64,
    /// Least value found among postures that satisfy the constraints, with the joint coordinates of its
    /// posture. None if no such posture was found.
    pub best: Option<(f64, JointVector)>,
    pub interrupted: bool,
}

/// Returns a lower bound of the value over all postures that satisfy the constraints; None if no posture
/// satisfies them.
///
/// The search ends when the relative gap between the bound and the least value found is at most `gap`, or
/// after `boxes` boxes. `known` is the value of a known posture, or infinity. The result does not depend on
/// the number of threads.
pub(super) fn least(
    task: &Task<'_>,
    known: f64,
    gap: f64,
    boxes: u64,
    stop: &AtomicBool,
) -> Option<BoxSearchResult> {
    let mut heap: BinaryHeap<JointBox> = JointBox::whole(task).judged(task).into_iter().collect();
    let mut found = BoxSearchResult { bound: f64::INFINITY, boxes: 1, best: None, interrupted: false };
    let mut memory = task.memory();
    let mut upper = known;
    let enough = |upper: f64| {
        (upper * (1.0 - gap)).min(upper - NEGLIGIBLE).max(if upper < VANISHES {
            0.0
        } else {
            f64::MIN_POSITIVE
        })
    };
    while let Some(first) = heap.peek() {
        if first.bound >= enough(upper) || found.boxes >= boxes {
            break;
        }
        if stop.load(MemoryOrdering::Relaxed) {
            found.interrupted = true;
            break;
        }
        let mut round: Vec<JointBox> = std::iter::from_fn(|| heap.pop()).take(BOXES_PER_ROUND).collect();
        for part in round.iter().take(WITNESSES_PER_ROUND) {
            let Some(witness) = near(task, part.centre().0, &part.low, &part.high, &mut memory) else {
                continue;
            };
            let Witness { value, ceiling } = witness;
            upper = upper.min(ceiling).min(value.map_or(f64::INFINITY, |(value, _)| value));
            found.best = found.best.into_iter().chain(value).min_by(|a, b| a.0.total_cmp(&b.0));
        }
        // A box too small to bisect keeps its bound.
        round.retain(|part| {
            let is_point = part.high[part.cut] - part.low[part.cut] < MIN_SIDE;
            found.bound = if is_point { found.bound.min(part.bound) } else { found.bound };
            !is_point
        });
        // A box is checked for self-collision only if its bound is too low.
        let judged = |half: JointBox| {
            let half = half.judged(task)?;
            let (centre, radii) = half.centre();
            let is_excluded = half.bound < enough(upper) && task.collides_with_itself(&centre, &radii);
            (!is_excluded).then_some(half)
        };
        let halves: Vec<[Option<JointBox>; 2]> =
            round.par_iter().map(|part| part.halves(part.cut).map(judged)).collect();
        for mut part in halves.into_iter().flatten().flatten() {
            (part.number, found.boxes) = (found.boxes, found.boxes + 1);
            // A box whose bound already suffices is not bisected again. Only its bound is kept.
            match part.bound >= enough(upper) {
                true => found.bound = found.bound.min(part.bound),
                false => heap.push(part),
            }
        }
    }
    found.bound = heap.peek().map_or(found.bound, |part| found.bound.min(part.bound));
    if found.bound == f64::INFINITY {
        return None;
    }
    found.bound = lowered(found.bound);
    Some(found)
}

/// Returns whether certainly no posture satisfies the constraints. The result is false if this is not proven
/// within [`MAX_EMPTY_BOXES`] boxes.
pub(super) fn is_empty(task: &Task<'_>) -> bool {
    let mut open = vec![JointBox::whole(task)];
    for _ in 0..MAX_EMPTY_BOXES {
        let Some(part) = open.pop() else { return true };
        let Some(ContractedBox { part, .. }) = part.contracted(task) else { continue };
        let (centre, radii) = part.centre();
        if task.collides_with_itself(&centre, &radii) {
            continue;
        }
        if kept_near(task, centre, &part.low, &part.high).is_some() {
            return false;
        }
        open.extend(part.halves(widest(None, &radii, task.coordinates.count)));
    }
    false
}

/// Returns a bound (m or rad) lowered by the margin for rounding errors, but at least 0.
pub(super) fn lowered(bound: f64) -> f64 {
    (bound * (1.0 - ROUNDING) - ROUNDING).max(0.0)
}
