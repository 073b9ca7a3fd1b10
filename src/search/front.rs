//! The layouts seen so far of which none is better than another in every goal.

use crate::cell::Goals;
use serde::{Deserialize, Serialize};

/// Members at most; the most crowded is let go.
const MOST: usize = 200;

/// Two points of the unit cube are different layouts if a coordinate differs by more than this share of
/// its range (of a list of values: of their number).
pub const DIFFERENT: f64 = 0.01;

/// A point of the unit cube with what its goals make small.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Member {
    pub point: Vec<f64>,
    /// One per goal; those that are made large negated.
    pub losses: Vec<f64>,
}

/// A set of layouts that do not dominate each other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Front {
    goals: Goals,
    members: Vec<Member>,
}

/// Least and greatest loss of a front in one goal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    pub least: f64,
    pub greatest: f64,
}

impl Span {
    /// 0 at the least loss, 1 at the greatest.
    pub fn share(&self, loss: f64) -> f64 {
        let width = self.greatest - self.least;
        (loss - self.least) / if width > 0.0 { width } else { 1.0 }
    }
}

impl Front {
    pub fn new(goals: Goals) -> Self {
        Self { goals, members: Vec::new() }
    }

    pub fn goals(&self) -> &Goals {
        &self.goals
    }

    pub fn members(&self) -> &[Member] {
        &self.members
    }

    /// One per goal; None while nothing is known.
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

    /// Takes a layout unless a member is as good in every goal; says whether it did.
    pub fn take(&mut self, point: &[f64], losses: &[f64]) -> bool {
        let covers = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| a <= b);
        if self.members.iter().any(|m| covers(&m.losses, losses)) {
            return false;
        }
        self.members.retain(|m| !covers(losses, &m.losses));
        self.members.push(Member { point: point.to_vec(), losses: losses.to_vec() });
        if self.members.len() > MOST {
            let crowding = self.crowding();
            let least = (0..crowding.len()).min_by(|&a, &b| crowding[a].total_cmp(&crowding[b]));
            least.map(|k| self.members.remove(k));
        }
        true
    }

    /// How far apart the neighbours of every member are, summed over the goals; infinite at the ends (the
    /// crowding distance of K. Deb et al., IEEE Trans. Evolutionary Computation 6(2), 2002).
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

    /// The least in every goal, then one after another the member farthest from all chosen (losses as
    /// shares of their span), each another layout than those; at most `most`, by their first losses.
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
        // Distance of every member to the chosen ones.
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

fn to_nearest(m: &Member, chosen: &[&Member], apart: &impl Fn(&Member, &Member) -> f64) -> f64 {
    chosen.iter().map(|c| apart(m, c)).fold(f64::INFINITY, f64::min)
}

fn by_losses(a: &[f64], b: &[f64]) -> std::cmp::Ordering {
    let orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    orders.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
}

/// Whether two points of the unit cube differ by more than `share` in some coordinate.
pub fn differ(a: &[f64], b: &[f64], share: f64) -> bool {
    a.iter().zip(b).any(|(a, b)| (a - b).abs() > share)
}
