//! What a search remembers of the layouts it has evaluated.

use serde::{Deserialize, Serialize};

/// An objective this share lower is an improvement to the rule of stagnation.
const IMPROVEMENT: f64 = 1e-6;

/// What one evaluation tells the search: all that a journal keeps of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(from = "(f64, u8)", into = "(f64, u8)")]
pub struct Answer {
    pub cost: f64,
    pub feasible: bool,
}

/// A pair, so that a journal of thousands stays small.
impl From<(f64, u8)> for Answer {
    fn from((cost, feasible): (f64, u8)) -> Self {
        Self { cost, feasible: feasible != 0 }
    }
}

impl From<Answer> for (f64, u8) {
    fn from(answer: Answer) -> Self {
        (answer.cost, u8::from(answer.feasible))
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
    /// Evaluations and cost at the last improvement worth the name.
    improved: (u64, f64),
}

impl Record {
    pub fn new(point: Vec<f64>) -> Self {
        Self { point, ..Self::default() }
    }

    /// Objective of the best feasible layout, m.
    pub fn best(&self) -> Option<f64> {
        self.trace.last().map(|t| t.1)
    }

    pub fn note(&mut self, point: &[f64], answer: Answer) {
        let Answer { cost, feasible } = answer;
        self.evaluations += 1;
        self.feasible += u64::from(feasible);
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

    /// A solver has been answered and thinks: here the rules of stopping look.
    pub fn pause(&mut self) {
        self.stillness = self.stillness.max(self.evaluations - self.improved.0);
    }
}
