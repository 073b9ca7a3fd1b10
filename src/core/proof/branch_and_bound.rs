//! Branch and bound over boxes of joint coordinates, with bounds from Taylor models.
//!
//! In every box, the constraints are expanded first. If a constraint cannot be met, the box is discarded.
//! Otherwise the constraints contract the box, and Lagrangian relaxation bounds the value `phi` from below.
//! Let `c_m` be the constrained quantities and `lambda_m` any multipliers. The bound is the sum of two lower
//! bounds. The first is the bound of `phi - sum lambda_m c_m` over the whole box. The second is the bound of
//! `sum lambda_m c_m` over the allowed values of `c_m`. Let the multipliers be those of the optimum in the
//! box. The error of the bound then decreases with the square of the size of the box. Boxes therefore need
//! not become small where constraints are active.

use super::coordinates::Coordinates;
use super::region::Constraint;
use super::task::Task;
use super::taylor_model::Taylor;
use super::witness::{Witness, near};
use crate::cell::{JointVector, MAX_JOINTS};
use crate::kinematic_error::JointValues;
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicBool, Ordering as MemoryOrdering};

/// Number of boxes examined per round. The number is large enough to occupy all threads, and small enough
/// that the examined boxes have bounds close to the least bound.
const BOXES_PER_ROUND: usize = 64;
/// Number of boxes per round in which the search looks for a posture that keeps all constraints.
const WITNESSES_PER_ROUND: usize = 8;
/// Share of the length of a side of a box that remains after a contraction pass. If a side shrinks below
/// this share, another contraction pass follows.
const MIN_SHRINKAGE: f64 = 0.8;
/// Largest number of contraction passes over one box.
const MAX_PASSES: usize = 8;
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

/// Box in the space of [`Coordinates`], with a lower bound of the value in the box.
#[derive(Debug, Clone)]
struct JointBox {
    low: JointValues,
    high: JointValues,
    bound: f64,
    /// Index of the coordinate in which the box is bisected.
    cut: usize,
    number: u64,
}

impl Ord for JointBox {
    /// Compares boxes so that the heap returns the box with the least bound first.
    ///
    /// Among boxes with equal bounds, the heap returns the newest box first.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for JointBox {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for JointBox {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for JointBox {}

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
    let (low, high) = (task.coordinates.low, task.coordinates.high);
    let mut heap: BinaryHeap<JointBox> = whole(task, low, high).into_iter().collect();
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
            let Some(witness) = near(task, centre(part).0, &part.low, &part.high, &mut memory) else {
                continue;
            };
            let Witness { value, joints, ceiling } = witness;
            upper = upper.min(value).min(ceiling);
            if found.best.is_none_or(|(best, _)| value < best) {
                found.best = Some((value, joints));
            }
        }
        // A box too small to bisect keeps its bound.
        round.retain(|part| {
            let is_point = part.high[part.cut] - part.low[part.cut] < MIN_SIDE;
            found.bound = if is_point { found.bound.min(part.bound) } else { found.bound };
            !is_point
        });
        let halves: Vec<[Option<JointBox>; 2]> = round.par_iter().map(|part| split(task, part)).collect();
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
    found.bound = (found.bound * (1.0 - ROUNDING) - ROUNDING).max(0.0);
    Some(found)
}

fn whole(task: &Task<'_>, low: JointValues, high: JointValues) -> Option<JointBox> {
    judge(task, JointBox { low, high, bound: 0.0, cut: 0, number: 0 })
}

fn split(task: &Task<'_>, part: &JointBox) -> [Option<JointBox>; 2] {
    let middle = (part.low[part.cut] + part.high[part.cut]) / 2.0;
    let (mut left, mut right) = (part.clone(), part.clone());
    (left.high[part.cut], right.low[part.cut]) = (middle, middle);
    [left, right].map(|half| judge(task, half))
}

fn centre(part: &JointBox) -> (JointValues, JointValues) {
    let (mut centre, mut radii) = ([0.0; MAX_JOINTS], [0.0; MAX_JOINTS]);
    for i in 0..MAX_JOINTS {
        centre[i] = (part.low[i] + part.high[i]) / 2.0;
        radii[i] = (part.high[i] - centre[i]).max(centre[i] - part.low[i]);
    }
    (centre, radii)
}

/// Contracts a box by the constraints, and bounds the value in the box. Returns None if the box becomes
/// empty.
fn judge(task: &Task<'_>, mut part: JointBox) -> Option<JointBox> {
    for pass in 1.. {
        let before = part.clone();
        within_limits(&task.coordinates, &mut part)?;
        let (y, radii) = centre(&part);
        let placed = task.place(&y);
        let mut kept = Vec::with_capacity(4);
        for constraint in &task.constraints {
            let taylor = task.constraint(constraint, &placed, &radii);
            contract(constraint, &taylor, &y, &radii, &mut part)?;
            kept.push((*constraint, taylor));
        }
        let side = |part: &JointBox, i: usize| part.high[i] - part.low[i];
        let shrunk = (0..task.coordinates.count).any(|i| side(&part, i) < MIN_SHRINKAGE * side(&before, i));
        if shrunk && pass < MAX_PASSES {
            continue;
        }
        let taylor = task.worth(&y, &placed, &radii);
        let (bound, cut) = bound(taylor, &kept, &radii, task.coordinates.count);
        return Some(JointBox { bound: bound.max(part.bound), cut, ..part });
    }
    None
}

/// Contracts a box to the coordinates within the actuator limits. Returns None if the box becomes empty.
fn within_limits(coordinates: &Coordinates, part: &mut JointBox) -> Option<()> {
    for (row, low, high) in &coordinates.limits {
        let (mut least, mut most) = (0.0, 0.0);
        for (i, g) in row.iter().enumerate() {
            least += (g * part.low[i]).min(g * part.high[i]);
            most += (g * part.low[i]).max(g * part.high[i]);
        }
        if least > *high || most < *low {
            return None;
        }
        for (i, g) in row.iter().enumerate().filter(|(_, g)| **g != 0.0) {
            let (own_least, own_most) =
                ((g * part.low[i]).min(g * part.high[i]), (g * part.low[i]).max(g * part.high[i]));
            let (from, to) = ((low - (most - own_most)) / g, (high - (least - own_least)) / g);
            clip(part, i, from.min(to), from.max(to))?;
        }
    }
    Some(())
}

/// Contracts a box by a constraint, using the Taylor model of the constraint at the centre `y` of the box.
///
/// Returns None if the box becomes empty.
fn contract(
    constraint: &Constraint,
    taylor: &Taylor,
    y: &JointValues,
    radii: &JointValues,
    part: &mut JointBox,
) -> Option<()> {
    let bend = taylor.bend(radii);
    let (low, high) = (constraint.low - taylor.value - bend, constraint.high - taylor.value + bend);
    let linear: f64 = taylor.gradient.iter().zip(radii).map(|(g, r)| g.abs() * r).sum();
    if linear < low || -linear > high {
        return None;
    }
    for (i, g) in taylor.gradient.iter().enumerate() {
        let others = linear - g.abs() * radii[i];
        // The box is contracted only if the constraint cuts it, which avoids the division of one rounding
        // error by another.
        if g.abs() * radii[i] > 1e-12
            && (high + others < g.abs() * radii[i] || low - others > -g.abs() * radii[i])
        {
            let (from, to) = ((low - others) / g, (high + others) / g);
            clip(part, i, y[i] + from.min(to), y[i] + from.max(to))?;
        }
    }
    Some(())
}

fn clip(part: &mut JointBox, i: usize, low: f64, high: f64) -> Option<()> {
    // The slack keeps rounding errors from making the interval of a side empty.
    let slack = 1e-14 * (1.0 + low.abs().max(high.abs()));
    part.low[i] = part.low[i].max(low - slack);
    part.high[i] = part.high[i].min(high + slack);
    (part.low[i] <= part.high[i]).then_some(())
}

/// Returns a lower bound of the value in a box, and the coordinate whose bisection is likely to raise the
/// bound most.
fn bound(
    worth: Option<Taylor>,
    constraints: &[(Constraint, Taylor)],
    radii: &JointValues,
    count: usize,
) -> (f64, usize) {
    let Some(worth) = worth else { return (0.0, widest(None, radii, count)) };
    // A constraint is crossed if its boundary crosses the box. A crossed constraint is thin if its allowed
    // range is narrower than the largest deviation of its quantity from the value at the centre.
    let crosses = |(c, t): &&(Constraint, Taylor)| {
        let spread = t.spread(radii);
        t.value - spread < c.low || t.value + spread > c.high
    };
    let crossed: Vec<&(Constraint, Taylor)> = constraints.iter().filter(crosses).take(4).collect();
    let thin: Vec<&(Constraint, Taylor)> =
        crossed.iter().copied().filter(|(c, t)| c.high - c.low < t.spread(radii)).collect();
    // The coordinate to bisect is chosen from the value relaxed by the thin constraints alone, plus the
    // curvature of all crossed constraints. A wide constraint could cancel the slope of the value, although
    // the value varies over the width of this constraint.
    let (mut best, mut judged) = (worth.least(radii, count), worth.clone());
    let sets = if thin.len() == crossed.len() { vec![thin] } else { vec![thin, crossed] };
    for (k, set) in sets.iter().enumerate().filter(|(_, set)| !set.is_empty()) {
        let (mut lagrange, mut allowed, mut bend) = (worth.clone(), 0.0, 0.0);
        for ((constraint, taylor), lambda) in set.iter().zip(multipliers(&worth, set, radii).iter()) {
            lagrange.less(*lambda, taylor);
            allowed += (lambda * constraint.low).min(lambda * constraint.high);
            bend += lambda.abs() * taylor.bend(radii);
        }
        best = best.max(lagrange.least(radii, count) + allowed);
        match k {
            0 => judged = lagrange,
            _ => judged.rest += bend,
        }
    }
    (best.max(0.0), widest(Some(&judged), radii, count))
}

/// Returns the Lagrange multipliers of the constraints in `set`, by least squares.
///
/// Consider the value minus the sum of the constrained quantities times their multipliers. The multipliers
/// minimize the length of the gradient of this difference. Each component of the gradient is first multiplied
/// by the radius of its coordinate in the box.
fn multipliers(worth: &Taylor, set: &[&(Constraint, Taylor)], radii: &JointValues) -> Vector4<f64> {
    let (mut normal, mut right) = (Matrix4::identity(), Vector4::zeros());
    let product = |a: &JointValues, b: &JointValues| -> f64 {
        (0..MAX_JOINTS).map(|k| a[k] * b[k] * radii[k] * radii[k]).sum()
    };
    for (i, (_, a)) in set.iter().enumerate() {
        for (j, (_, b)) in set.iter().enumerate() {
            normal[(i, j)] = product(&a.gradient, &b.gradient);
        }
        normal[(i, i)] += 1e-9 * normal[(i, i)] + 1e-24;
        right[i] = product(&a.gradient, &worth.gradient);
    }
    let found = normal.lu().solve(&right).unwrap_or_else(Vector4::zeros);
    if found.iter().all(|v| v.is_finite()) { found } else { Vector4::zeros() }
}

/// Returns the coordinate that contributes most to the difference between the value at the centre and the
/// lower bound.
fn widest(taylor: Option<&Taylor>, radii: &JointValues, count: usize) -> usize {
    let sum: f64 = radii.iter().sum();
    let weight = |i: usize| match taylor {
        None => radii[i],
        Some(t) => {
            let bent: f64 = t.hessian[i].iter().zip(radii).map(|(h, r)| h.abs() * r).sum();
            radii[i] * (t.gradient[i].abs() + bent / 2.0 + t.rest / sum.max(f64::MIN_POSITIVE))
        }
    };
    let wide = |&a: &usize, &b: &usize| {
        weight(a).total_cmp(&weight(b)).then(radii[a].total_cmp(&radii[b])).then(b.cmp(&a))
    };
    (0..count).max_by(wide).unwrap_or(0)
}
