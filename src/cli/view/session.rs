//! What the pages share: the steps taken, which of them is shown, and how the errors are read.

use super::question::Question;
use super::values::Values;

/// Steps kept; the start always is.
const MOST: usize = 1000;

/// One state of the layout.
pub struct Step {
    pub values: Values,
    /// What was done to come here.
    pub what: String,
}

pub struct Session {
    /// Counts every change, so that a page sees that another has made one.
    pub revision: u64,
    pub question: Question,
    steps: Vec<Step>,
    at: usize,
}

impl Session {
    pub fn new(start: Values, question: Question) -> Self {
        let steps = vec![Step { values: start, what: "the layout as drawn".into() }];
        Self { revision: 1, question, steps, at: 0 }
    }

    pub fn now(&self) -> &Step {
        &self.steps[self.at]
    }

    /// The step before the one that is shown.
    pub fn before(&self) -> Option<&Step> {
        self.at.checked_sub(1).map(|k| &self.steps[k])
    }

    pub fn start(&self) -> &Values {
        &self.steps[0].values
    }

    /// How many steps can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        (self.at, self.steps.len() - 1 - self.at)
    }

    /// A new step after the one that is shown; what was undone is gone. Nothing if it changes nothing.
    pub fn step(&mut self, values: Values, what: String) {
        if self.now().values == values {
            return;
        }
        self.steps.truncate(self.at + 1);
        if self.steps.len() >= MOST {
            self.steps.remove(1);
        }
        self.steps.push(Step { values, what });
        self.at = self.steps.len() - 1;
        self.revision += 1;
    }

    /// Goes a step back or forth, if there is one.
    pub fn travel(&mut self, back: bool) {
        let to = if back { self.at.checked_sub(1) } else { Some(self.at + 1) };
        if let Some(to) = to.filter(|to| *to < self.steps.len()) {
            self.at = to;
            self.revision += 1;
        }
    }

    pub fn ask(&mut self, question: Question) {
        if self.question != question {
            self.question = question;
            self.revision += 1;
        }
    }
}
