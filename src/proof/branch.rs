//! Branch and bound over boxes of joint coordinates.
//!
//! In every box the constraints are expanded first: one that cannot be met drops the box, the others
//! make it smaller. Then, for any multipliers, `phi - sum lambda_m c_m` over the whole box and
//! `lambda_m c_m` over the allowed `c_m` bound the value from below: with those of the box's own optimum
//! the bound is of second order, so that boxes need not get small where constraints hold the optimum.

use super::coordinates::Coordinates;
use super::region::Constraint;
use super::screws::Values;
use super::task::Task;
use super::taylor::Taylor;
use super::witness::near;
use crate::cell::{JointVector, MAX_JOINTS};
use nalgebra::{Matrix4, Vector4};
use rayon::prelude::*;
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::sync::atomic::{AtomicBool, Ordering as MemoryOrdering};

/// Boxes of a round: many enough for all threads, few enough to stay near the least bound.
const ROUND: usize = 64;
/// Of a round so many look for a better posture near their centre.
const TRIED: usize = 8;
/// A box is looked at again if constraints make a side smaller than this share.
const SHRUNK: f64 = 0.8;
const PASSES: usize = 8;
/// Taken off every bound for rounding, m or rad and as a share: the figures are good to 1e-13.
const ROUNDING: f64 = 1e-11;
/// A side shorter than this is not cut, m or rad.
const POINT: f64 = 1e-12;
/// A difference that matters to nobody, m or rad.
const NOTHING: f64 = 1e-9;
/// Where some posture is worth less than this, 0 is all that can be proven.
pub(super) const VANISHES: f64 = 1e-6;

/// How a search over boxes ended.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Found {
    /// No posture is worth less.
    pub bound: f64,
    pub boxes: u64,
    /// The least value of a posture that keeps the constraints.
    pub best: Option<(f64, JointVector)>,
    pub interrupted: bool,
}

/// A part of the joint space.
#[derive(Debug, Clone)]
struct Part {
    low: Values,
    high: Values,
    bound: f64,
    /// The coordinate to cut.
    cut: usize,
    number: u64,
}

impl Ord for Part {
    /// The least bound is the greatest of the heap; of equal ones the youngest, for it is the smallest.
    fn cmp(&self, other: &Self) -> Ordering {
        other.bound.total_cmp(&self.bound).then(self.number.cmp(&other.number))
    }
}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Part {}

/// The least value over all postures that keep the constraints, to a share of `gap` or within so many
/// boxes; `known`: a value that some posture has. The same for any number of threads. None if no posture
/// keeps them.
pub(super) fn least(task: &Task<'_>, known: f64, gap: f64, boxes: u64, stop: &AtomicBool) -> Option<Found> {
    let (low, high) = (task.coordinates.low, task.coordinates.high);
    let mut heap: BinaryHeap<Part> = whole(task, low, high).into_iter().collect();
    let mut found = Found { bound: f64::INFINITY, boxes: 1, best: None, interrupted: false };
    let mut memory = task.memory();
    let mut upper = known;
    let enough = |upper: f64| {
        (upper * (1.0 - gap)).min(upper - NOTHING).max(if upper < VANISHES { 0.0 } else { f64::MIN_POSITIVE })
    };
    while let Some(first) = heap.peek() {
        if first.bound >= enough(upper) || found.boxes >= boxes {
            break;
        }
        if stop.load(MemoryOrdering::Relaxed) {
            found.interrupted = true;
            break;
        }
        let mut round: Vec<Part> = std::iter::from_fn(|| heap.pop()).take(ROUND).collect();
        for part in round.iter().take(TRIED) {
            if let Some((value, joints)) = near(task, centre(part).0, (&part.low, &part.high), &mut memory)
                && found.best.is_none_or(|(best, _)| value < best)
            {
                found.best = Some((value, joints));
                upper = upper.min(value);
            }
        }
        // A point has no halves.
        round.retain(|part| {
            let is_point = part.high[part.cut] - part.low[part.cut] < POINT;
            found.bound = if is_point { found.bound.min(part.bound) } else { found.bound };
            !is_point
        });
        let halves: Vec<[Option<Part>; 2]> = round.par_iter().map(|part| split(task, part)).collect();
        for mut part in halves.into_iter().flatten().flatten() {
            (part.number, found.boxes) = (found.boxes, found.boxes + 1);
            // Good enough for ever: only its bound is kept.
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

fn whole(task: &Task<'_>, low: Values, high: Values) -> Option<Part> {
    judge(task, Part { low, high, bound: 0.0, cut: 0, number: 0 })
}

fn split(task: &Task<'_>, part: &Part) -> [Option<Part>; 2] {
    let middle = (part.low[part.cut] + part.high[part.cut]) / 2.0;
    let (mut left, mut right) = (part.clone(), part.clone());
    (left.high[part.cut], right.low[part.cut]) = (middle, middle);
    [left, right].map(|half| judge(task, half))
}

fn centre(part: &Part) -> (Values, Values) {
    let (mut centre, mut radii) = ([0.0; MAX_JOINTS], [0.0; MAX_JOINTS]);
    for i in 0..MAX_JOINTS {
        centre[i] = (part.low[i] + part.high[i]) / 2.0;
        radii[i] = (part.high[i] - centre[i]).max(centre[i] - part.low[i]);
    }
    (centre, radii)
}

/// Makes a box as small as the constraints allow and bounds it; None if nothing of it is left.
fn judge(task: &Task<'_>, mut part: Part) -> Option<Part> {
    for pass in 1.. {
        let before = part.clone();
        within_limits(&task.coordinates, &mut part)?;
        let (y, radii) = centre(&part);
        let placed = task.place(&y);
        let mut kept = Vec::with_capacity(4);
        for constraint in &task.constraints {
            let taylor = task.constraint(constraint, &placed, &radii);
            contract(constraint, &taylor, (&y, &radii), &mut part)?;
            kept.push((*constraint, taylor));
        }
        let side = |part: &Part, i: usize| part.high[i] - part.low[i];
        let shrunk = (0..task.coordinates.count).any(|i| side(&part, i) < SHRUNK * side(&before, i));
        if shrunk && pass < PASSES {
            continue;
        }
        let taylor = task.worth(&y, &placed, &radii);
        let (bound, cut) = bound(taylor, &kept, &radii, task.coordinates.count);
        return Some(Part { bound: bound.max(part.bound), cut, ..part });
    }
    None
}

/// Cuts off what no actuator can reach.
fn within_limits(coordinates: &Coordinates, part: &mut Part) -> Option<()> {
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

/// Cuts off what cannot meet a constraint, by its expansion at the centre.
fn contract(
    constraint: &Constraint,
    taylor: &Taylor,
    (y, radii): (&Values, &Values),
    part: &mut Part,
) -> Option<()> {
    let bend = taylor.bend(radii);
    let (low, high) = (constraint.low - taylor.value - bend, constraint.high - taylor.value + bend);
    let linear: f64 = taylor.gradient.iter().zip(radii).map(|(g, r)| g.abs() * r).sum();
    if linear < low || -linear > high {
        return None;
    }
    for (i, g) in taylor.gradient.iter().enumerate() {
        let others = linear - g.abs() * radii[i];
        // Whether it can cut anything, and not by a division of rounding by rounding.
        if g.abs() * radii[i] > 1e-12
            && (high + others < g.abs() * radii[i] || low - others > -g.abs() * radii[i])
        {
            let (from, to) = ((low - others) / g, (high + others) / g);
            clip(part, i, y[i] + from.min(to), y[i] + from.max(to))?;
        }
    }
    Some(())
}

fn clip(part: &mut Part, i: usize, low: f64, high: f64) -> Option<()> {
    // Rounding must not cut a side to nothing.
    let slack = 1e-14 * (1.0 + low.abs().max(high.abs()));
    part.low[i] = part.low[i].max(low - slack);
    part.high[i] = part.high[i].min(high + slack);
    (part.low[i] <= part.high[i]).then_some(())
}

/// The least value in a box, and the coordinate whose cut promises most.
fn bound(
    worth: Option<Taylor>,
    constraints: &[(Constraint, Taylor)],
    radii: &Values,
    count: usize,
) -> (f64, usize) {
    let Some(worth) = worth else { return (0.0, widest(None, radii, count)) };
    // Those that the box crosses; of those the ones that are thin there.
    let crosses = |(c, t): &&(Constraint, Taylor)| {
        let spread = t.spread(radii);
        t.value - spread < c.low || t.value + spread > c.high
    };
    let crossed: Vec<&(Constraint, Taylor)> = constraints.iter().filter(crosses).take(4).collect();
    let thin: Vec<&(Constraint, Taylor)> =
        crossed.iter().copied().filter(|(c, t)| c.high - c.low < t.spread(radii)).collect();
    // The cut looks at the slopes that thin constraints leave, and at the bend of the others: a wide one
    // with the slope of the value would hide its own width.
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

/// Multipliers that leave the least slope over the box, by least squares.
fn multipliers(worth: &Taylor, set: &[&(Constraint, Taylor)], radii: &Values) -> Vector4<f64> {
    let (mut normal, mut right) = (Matrix4::identity(), Vector4::zeros());
    let product =
        |a: &Values, b: &Values| -> f64 { (0..MAX_JOINTS).map(|k| a[k] * b[k] * radii[k] * radii[k]).sum() };
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

/// The coordinate to which the bound owes most of its distance from the value at the centre.
fn widest(taylor: Option<&Taylor>, radii: &Values, count: usize) -> usize {
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
