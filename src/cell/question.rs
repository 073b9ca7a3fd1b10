//! What a cell asks must have an answer: errors, reading, quantity, senses and limits together.
//!
//! The command line changes these after loading, so the rules are here once for both.

use super::choices::{Reading, Registration};
use super::error_model::{ErrorSet, FrameErrors};
use super::model::*;
use super::sense::Unit;

/// What a fault of the question is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    Reading,
    /// An operation by index, and its sense.
    Operation(usize),
    Sense(usize),
}

/// Why a cell cannot be judged as asked, and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuestionFault {
    pub about: About,
    pub message: String,
    pub help: String,
}

impl Cell {
    /// How the errors are read if nobody says: a sample as one, anything with a tolerance at its worst.
    pub fn default_reading(&self) -> Reading {
        if self.tolerances().is_empty() { Reading::Signed } else { Reading::WorstCase }
    }

    /// Everything that keeps the question from having an answer; none of a cell as it was loaded.
    pub fn question_faults(&self) -> Vec<QuestionFault> {
        let fault = |about, message, help: &str| QuestionFault { about, message, help: help.to_string() };
        let mut faults = Vec::new();
        if self.reading == Reading::Signed {
            let help = "choose the reading worst-case or statistical";
            let told =
                |what| fault(About::Reading, format!("{what} a tolerance: no sample to read signed"), help);
            faults.extend(self.tolerances().into_iter().map(told));
        }
        if self.unit() == Unit::Share {
            for (k, operation) in self.operations.iter().enumerate().filter(|(_, o)| o.limit.is_none()) {
                let message =
                    format!("`{}` has no limit: its yield is the share of errors within one", operation.name);
                let help =
                    format!("add limit_{}, the largest error that it tolerates", operation.sense.unit.word());
                faults.push(fault(About::Operation(k), message, &help));
            }
            return faults;
        }
        let Some(first) = self.operations.first() else { return faults };
        let differs = |o: &Operation| o.sense.unit != first.sense.unit;
        for (k, other) in self.operations.iter().enumerate().filter(|(_, o)| differs(o)) {
            let [a, b] =
                [first, other].map(|o| format!("`{}` is measured in {}", o.name, o.sense.unit.word()));
            let help = "choose senses of one unit, or the statistical reading and the quantity yield";
            faults.push(fault(About::Sense(k), format!("{b}, {a}: they cannot be added"), help));
        }
        faults
    }

    /// What of the errors that count is a tolerance, with its verb.
    fn tolerances(&self) -> Vec<String> {
        let robot = self.robot.errors.get(self.errors);
        let robot = robot.filter(|set| matches!(set, ErrorSet::Tolerance(_)));
        // A taught frame moves with its equipment.
        let is_used = |k: usize| {
            self.registration != Registration::Taught && self.operations.iter().any(|o| o.equipment == k)
        };
        let equipment = self
            .equipment
            .iter()
            .enumerate()
            .filter(|(k, e)| is_used(*k) && matches!(e.errors, Some(FrameErrors::Tolerance(_))));
        let of_equipment = equipment.map(|(_, e)| format!("the errors of `{}` are", e.name));
        robot.map(|set| format!("`{}` is", set.name())).into_iter().chain(of_equipment).collect()
    }
}
