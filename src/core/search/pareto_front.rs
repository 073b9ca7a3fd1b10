//! Pareto front: the layouts seen so far that no other layout dominates.

use crate::cell::Goals;
use serde::{Deserialize, Serialize};

/// Largest number of members. If there are more, the most crowded member is dropped.
pub const MAX_MEMBERS: usize = 200;

/// Least difference of a coordinate at which two points of the unit cube count as different layouts.
///
/// The difference of a coordinate is a share of its range. For listed values, the share is the difference of
/// the list indices divided by the number of values.
pub const DIFFERENT: f64 = 0.01;

/// Member of a Pareto front: a layout as a point of the unit cube, with its loss in every goal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    pub point: Vec<f64>,
    /// Loss in each goal: the value of the goal, negated if the goal is maximized.
    pub losses: Vec<f64>,
}

/// Set of layouts that do not dominate each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParetoFront {
    goals: Goals,
    members: Vec<Member>,
}

/// Least and greatest loss ([`Member::losses`]) in one goal among the members of a Pareto front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    pub least: f64,
    pub greatest: f64,
}

impl Span {
    /// Returns the position of a loss in the span: 0 at the least loss, 1 at the greatest loss.
    pub fn share(&self, loss: f64) -> f64 {
        let width = self.greatest - self.least;
        (loss - self.least) / if width > 0.0 { width } else { 1.0 }
    }
}

impl ParetoFront {
    /// Returns an empty front.
    pub fn new(goals: Goals) -> Self {
        Self { goals, members: Vec::new() }
    }

    /// Returns the front of the members `all`, whose number is not limited. If several members are equal, the
    /// first of them is kept.
    pub fn of_all(goals: Goals, all: &[Member]) -> Self {
        let is_better = |a: usize, b: usize| {
            covers(&all[a].losses, &all[b].losses) && (a < b || !covers(&all[b].losses, &all[a].losses))
        };
        let stays = |k: &usize| !(0..all.len()).any(|other| other != *k && is_better(other, *k));
        let members = (0..all.len()).filter(stays).map(|k| all[k].clone()).collect();
        Self { goals, members }
    }

    /// Returns the goals of the front.
    pub fn goals(&self) -> &Goals {
        &self.goals
    }

    /// Returns the members of the front.
    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// Returns the range of the losses in each goal; None while the front is empty.
    pub fn spans(&self) -> Option<Vec<Span>> {
        let first = self.members.first()?;
        let span = |k: usize| {
            let all = self.members.iter().map(|m| m.losses[k]);
            let most = |(lo, hi): (f64, f64), v: f64| (lo.min(v), hi.max(v));
            let (least, greatest) = all.fold((first.losses[k], first.losses[k]), most);
            Span { least, greatest }
        };
        Some((0..first.losses.len()).map(span).collect())
    }

    /// Adds a layout and returns true. If a member is at least as good in every goal, returns false instead.
    ///
    /// If the front becomes too large, the most crowded member is dropped.
    pub fn take(&mut self, point: &[f64], losses: &[f64]) -> bool {
        if self.members.iter().any(|m| covers(&m.losses, losses)) {
            return false;
        }
        self.members.retain(|m| !covers(losses, &m.losses));
        self.members.push(Member { point: point.to_vec(), losses: losses.to_vec() });
        if self.members.len() > MAX_MEMBERS {
            let crowding = self.crowding();
            let least = (0..crowding.len()).min_by(|&a, &b| crowding[a].total_cmp(&crowding[b]));
            least.map(|k| self.members.remove(k));
        }
        true
    }

    /// Returns the crowding distance of every member, infinite at the ends of the front.
    ///
    /// For each goal, the members are sorted by loss. The crowding distance of a member is the difference
    /// between the losses of its two neighbours, summed over the goals (K. Deb et al., "A fast and elitist
    /// multiobjective genetic algorithm: NSGA-II", IEEE Trans. Evolutionary Computation 6(2), 2002). Each
    /// difference is a share of the range of the loss on the front.
    fn crowding(&self) -> Vec<f64> {
        let mut crowding = vec![0.0; self.members.len()];
        for (k, span) in self.spans().unwrap_or_default().iter().enumerate() {
            let loss = |m: usize| span.share(self.members[m].losses[k]);
            let mut order: Vec<usize> = (0..self.members.len()).collect();
            order.sort_by(|&a, &b| loss(a).total_cmp(&loss(b)));
            for (place, &m) in order.iter().enumerate() {
                let is_end = place == 0 || place + 1 == order.len();
                crowding[m] +=
                    if is_end { f64::INFINITY } else { loss(order[place + 1]) - loss(order[place - 1]) };
            }
        }
        crowding
    }

    /// Returns at most `most` members spread over the front, sorted by the loss in the first goal.
    ///
    /// The member with the least loss in each goal is chosen first. Then the member with the largest distance
    /// from the nearest chosen member is added repeatedly. Members that differ from a chosen member by no
    /// more than [`DIFFERENT`] are left out. Distances are computed between losses that are scaled to their
    /// ranges on the front.
    pub fn spread(&self, most: usize) -> Vec<&Member> {
        let spans = self.spans().unwrap_or_default();
        let apart = |a: &Member, b: &Member| {
            let shares = spans.iter().zip(a.losses.iter().zip(&b.losses));
            shares.map(|(s, (a, b))| (s.share(*a) - s.share(*b)).powi(2)).sum::<f64>()
        };
        let mut chosen: Vec<&Member> = Vec::new();
        let fits = |chosen: &[&Member], m: &Member| {
            chosen.len() < most && chosen.iter().all(|c| differ(&c.point, &m.point, DIFFERENT))
        };
        for k in 0..spans.len() {
            let end = self.members.iter().min_by(|a, b| a.losses[k].total_cmp(&b.losses[k]));
            chosen.extend(end.filter(|m| fits(&chosen, m)));
        }
        // Squared distance of every member from the nearest chosen member.
        let mut far: Vec<f64> = self.members.iter().map(|m| to_nearest(m, &chosen, &apart)).collect();
        while let Some(k) = (0..far.len())
            .filter(|&k| fits(&chosen, &self.members[k]))
            .reduce(|a, b| if far[b] > far[a] { b } else { a })
        {
            let taken = &self.members[k];
            chosen.push(taken);
            far.iter_mut().zip(&self.members).for_each(|(far, m)| *far = far.min(apart(m, taken)));
        }
        chosen.sort_by(|a, b| by_losses(&a.losses, &b.losses));
        chosen
    }
}

/// Returns whether the losses `a` are at most the losses `b` in every goal.
fn covers(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b)
}

fn to_nearest(m: &Member, chosen: &[&Member], apart: &impl Fn(&Member, &Member) -> f64) -> f64 {
    chosen.iter().map(|c| apart(m, c)).fold(f64::INFINITY, f64::min)
}

fn by_losses(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    orders.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
}

/// Returns whether two points of the unit cube differ by more than `share` in some coordinate.
pub fn differ(a: &[f64], b: &[f64], share: f64) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > share)
}
