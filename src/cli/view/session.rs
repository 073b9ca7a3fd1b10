//! State that all open pages share: undo history, current step, and evaluation settings.

use super::question::EvaluationSettings;
use super::values::LayoutValues;

/// Largest number of steps kept; the first step is always kept.
const MAX_STEPS: usize = 1000;

/// One state of the layout in the undo history.
#[derive(Clone)]
pub struct Step {
    pub values: LayoutValues,
    /// Change that led to this step, in words.
    pub what: String,
}

/// Undo history and evaluation settings of one run of `sweetspot view`.
pub struct Session {
    /// Counter that grows with every change in this session. A page compares the counter to notice a change
    /// that another page made.
    pub revision: u64,
    pub question: EvaluationSettings,
    steps: Vec<Step>,
    at: usize,
}

impl Session {
    /// Returns a session whose history starts at a layout.
    pub fn new(start: LayoutValues, question: EvaluationSettings) -> Self {
        let steps = vec![Step { values: start, what: "the layout as drawn".into() }];
        Self { revision: 1, question, steps, at: 0 }
    }

    /// Returns the current step.
    pub fn now(&self) -> &Step {
        &self.steps[self.at]
    }

    /// Returns the step before the current step; None if the current step is the first.
    pub fn before(&self) -> Option<&Step> {
        self.at.checked_sub(1).map(|k| &self.steps[k])
    }

    /// Returns the coordinates of the first step.
    pub fn start(&self) -> &LayoutValues {
        &self.steps[0].values
    }

    /// Returns the number of steps that can be undone, and the number that can be redone.
    pub fn depth(&self) -> (usize, usize) {
        (self.at, self.steps.len() - 1 - self.at)
    }

    /// Adds a step after the current one and drops the undone steps. Does nothing if the layout is unchanged.
    pub fn step(&mut self, values: LayoutValues, what: String) {
        if self.now().values == values {
            return;
        }
        self.steps.truncate(self.at + 1);
        if self.steps.len() >= MAX_STEPS {
            self.steps.remove(1);
        }
        self.steps.push(Step { values, what });
        self.at = self.steps.len() - 1;
        self.revision += 1;
    }

    /// Goes one step back or forward. Does nothing if there is no such step.
    pub fn travel(&mut self, back: bool) {
        let to = if back { self.at.checked_sub(1) } else { Some(self.at + 1) };
        if let Some(to) = to.filter(|to| *to < self.steps.len()) {
            self.at = to;
            self.revision += 1;
        }
    }

    /// Changes sense, model and reading.
    pub fn ask(&mut self, question: EvaluationSettings) {
        if self.question != question {
            self.question = question;
            self.revision += 1;
        }
    }
}
