//! Box of joint coordinates: its contraction by the constraints of an operation, and the lower bound of the
//! value in the box.

use super::coordinates::Coordinates;
use super::region::{ConstrainedQuantity, Constraint};
use super::task::Task;
use super::taylor_model::Taylor;
use crate::cell::MAX_JOINTS;
use crate::kinematic_error::{JointValues, PosedScrews};
use nalgebra::{Matrix4, Vector4};
use std::cmp::Ordering;

/// Another contraction pass follows if a pass shrinks a side of the box below this share of its length.
const MIN_SHRINKAGE: f64 = 0.8;
/// Largest number of contraction passes over one box.
const MAX_PASSES: usize = 8;

/// Box in the space of [`Coordinates`], with a lower bound of the value in the box.
#[derive(Debug, Clone)]
pub(super) struct JointBox {
    pub low: JointValues,
    pub high: JointValues,
    pub bound: f64,
    /// Index of the coordinate whose bisection is likely to raise the bound most.
    pub cut: usize,
    /// Number of boxes that the search examined before this box.
    pub number: u64,
}

/// Box contracted by the constraints, with Taylor models about its centre.
pub(super) struct ContractedBox {
    pub part: JointBox,
    /// Centre about which the constraints were expanded. The field `radii` holds the half widths of the box
    /// before its last contraction.
    centre: JointValues,
    pub radii: JointValues,
    /// Nominal chain at the centre.
    pub placed: PosedScrews,
    constraints: Vec<(Constraint, Taylor)>,
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

impl JointBox {
    /// Returns the box of all coordinates within the joint limits of a task. The box is not yet contracted.
    pub fn whole(task: &Task<'_>) -> Self {
        Self { low: task.coordinates.low, high: task.coordinates.high, bound: 0.0, cut: 0, number: 0 }
    }

    /// Bisects the box in one coordinate. The halves are not yet contracted.
    pub fn halves(&self, coordinate: usize) -> [Self; 2] {
        let middle = (self.low[coordinate] + self.high[coordinate]) / 2.0;
        let (mut left, mut right) = (self.clone(), self.clone());
        (left.high[coordinate], right.low[coordinate]) = (middle, middle);
        [left, right]
    }

    /// Returns the centre and the half widths of the box.
    pub fn centre(&self) -> (JointValues, JointValues) {
        let (mut centre, mut radii) = ([0.0; MAX_JOINTS], [0.0; MAX_JOINTS]);
        for i in 0..MAX_JOINTS {
            centre[i] = (self.low[i] + self.high[i]) / 2.0;
            radii[i] = (self.high[i] - centre[i]).max(centre[i] - self.low[i]);
        }
        (centre, radii)
    }

    /// Contracts the box by the constraints. Returns None if no posture in the box satisfies them.
    pub fn contracted(mut self, task: &Task<'_>) -> Option<ContractedBox> {
        for pass in 1.. {
            let before = self.clone();
            within_limits(&task.coordinates, &mut self)?;
            let (centre, radii) = self.centre();
            let placed = task.place(&centre);
            let mut constraints = Vec::with_capacity(4);
            for constraint in &task.constraints {
                let taylor = task.constraint(constraint, &placed, &radii);
                contract(constraint, &taylor, &centre, &radii, &mut self)?;
                constraints.push((*constraint, taylor));
            }
            let side = |part: &Self, i: usize| part.high[i] - part.low[i];
            let shrunk =
                (0..task.coordinates.count).any(|i| side(&self, i) < MIN_SHRINKAGE * side(&before, i));
            if !shrunk || pass == MAX_PASSES {
                return Some(ContractedBox { part: self, centre, radii, placed, constraints });
            }
        }
        None
    }

    /// Contracts the box by the constraints, and bounds the value in the box. Returns None if no posture in
    /// the box satisfies the constraints.
    pub fn judged(self, task: &Task<'_>) -> Option<Self> {
        self.contracted(task).map(|contracted| contracted.bounded(task).0)
    }
}

impl ContractedBox {
    /// Returns the Taylor model of a constrained quantity over the box.
    pub fn model(&self, task: &Task<'_>, of: ConstrainedQuantity) -> Taylor {
        let known = self.constraints.iter().find(|(constraint, _)| constraint.of == of);
        let unlimited = Constraint { of, low: f64::NEG_INFINITY, high: f64::INFINITY };
        match known {
            Some((_, taylor)) => taylor.clone(),
            None => task.constraint(&unlimited, &self.placed, &self.radii),
        }
    }

    /// Bounds the value in the box. Also returns the value of its Taylor model at the centre, m or rad.
    pub fn bounded(self, task: &Task<'_>) -> (JointBox, f64) {
        let taylor = task.worth(&self.centre, &self.placed, &self.radii);
        let value = taylor.as_ref().map_or(0.0, |taylor| taylor.value);
        let (bound, cut) = bound(taylor, &self.constraints, &self.radii, task.coordinates.count);
        (JointBox { bound: bound.max(self.part.bound), cut, ..self.part }, value)
    }
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
    // The coordinate to bisect is chosen from the Lagrangian with the thin constraints alone. The curvature
    // of all crossed constraints is added to its remainder. The slopes of wide constraints are left out. Such
    // a slope could cancel the slope of the value, although the value varies over the width of the
    // constraint.
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
pub(super) fn widest(taylor: Option<&Taylor>, radii: &JointValues, count: usize) -> usize {
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
