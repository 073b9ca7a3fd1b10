//! What a search remembers of the layouts it has evaluated.

use super::front::Front;
use super::shortlist::Shortlist;
use super::space::Space;
use super::stopping::Stopping;
use serde::{Deserialize, Serialize};

/// An objective this share lower is an improvement to the rule of stagnation.
const IMPROVEMENT: f64 = 1e-6;

/// What one evaluation tells the search: all that a journal keeps of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(from = "Row", into = "Row")]
pub struct Answer {
    pub cost: f64,
    pub feasible: bool,
    /// Of a feasible layout in a search for a front: what its goals make small.
    pub losses: Vec<f64>,
}

/// An answer in few characters, so that a journal of thousands stays small.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Row {
    Plain(f64, u8),
    WithLosses(f64, u8, Vec<f64>),
}

impl From<Row> for Answer {
    fn from(row: Row) -> Self {
        let (cost, feasible, losses) = match row {
            Row::Plain(cost, feasible) => (cost, feasible, Vec::new()),
            Row::WithLosses(cost, feasible, losses) => (cost, feasible, losses),
        };
        Self { cost, feasible: feasible != 0, losses }
    }
}

impl From<Answer> for Row {
    fn from(Answer { cost, feasible, losses }: Answer) -> Self {
        let feasible = u8::from(feasible);
        if losses.is_empty() { Row::Plain(cost, feasible) } else { Row::WithLosses(cost, feasible, losses) }
    }
}

/// The evaluations so far, and the best of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Record {
    pub evaluations: u64,
    pub feasible: u64,
    /// The point of the unit cube with the least cost.
    pub point: Vec<f64>,
    pub cost: Option<f64>,
    /// Evaluations and objective (m) at each improvement of the best feasible layout.
    pub trace: Vec<(u64, f64)>,
    /// The longest time without improvement, in evaluations, as seen where solvers pause.
    pub stillness: u64,
    /// Evaluations and cost at the last improvement worth the name; of a front, evaluations at its last
    /// new member.
    improved: (u64, f64),
    /// If it is searched for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub front: Option<Front>,
    /// If more than the best is kept.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shortlist: Option<Shortlist>,
}

impl Record {
    pub fn new(point: Vec<f64>, stopping: &Stopping) -> Self {
        let Stopping { pareto, keep, .. } = *stopping;
        let front = (!pareto.is_empty()).then(|| Front::new(pareto));
        // With a front, that many of its members are told.
        let shortlist = (front.is_none() && keep > 0).then(|| Shortlist::new(keep));
        Self { point, front, shortlist, ..Self::default() }
    }

    /// Objective of the best feasible layout, m.
    pub fn best(&self) -> Option<f64> {
        self.trace.last().map(|t| t.1)
    }

    pub fn note(&mut self, space: &Space<'_>, point: &[f64], answer: &Answer) {
        let Answer { cost, feasible, .. } = *answer;
        self.evaluations += 1;
        self.feasible += u64::from(feasible);
        if feasible && (self.front.is_some() || self.shortlist.is_some()) {
            self.collect(&space.settled(point), answer);
        }
        if self.cost.is_some_and(|best| cost >= best) {
            return;
        }
        if self.cost.is_none() || cost < self.improved.1 - IMPROVEMENT * self.improved.1.abs() {
            self.improved = (self.evaluations, cost);
        }
        self.cost = Some(cost);
        self.point = point.to_vec();
        if feasible {
            self.trace.push((self.evaluations, cost));
        }
    }

    /// Into the front or the shortlist.
    fn collect(&mut self, settled: &[f64], answer: &Answer) {
        if let Some(front) = &mut self.front
            && !answer.losses.is_empty()
            && front.take(settled, &answer.losses)
        {
            self.improved.0 = self.evaluations;
        }
        if let Some(shortlist) = &mut self.shortlist {
            shortlist.take(settled, answer.cost);
        }
    }

    /// A solver has been answered and thinks: here the rules of stopping look.
    pub fn pause(&mut self) {
        self.stillness = self.stillness.max(self.evaluations - self.improved.0);
    }
}
