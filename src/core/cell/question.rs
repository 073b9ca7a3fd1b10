//! Interpretation of a cell's errors: error model, reading, quantity, registration and sense together.
//!
//! [`Cell::faults_of`] checks every interpretation. An interpretation comes from a cell file, a command-line
//! flag or the web page of `sweetspot view`. The rules for these three sources are stated only in this file.

use super::choices::{Model, NodeAggregation, Objective, Quantity, Reading, Registration};
use super::error_model::{ErrorSet, FrameErrors};
use super::goal::Goal;
use super::model::*;
use super::robot_model::JointKind;
use super::sense::Sense;
use crate::safe_text::shown;

/// Interpretation of the errors of a cell: error model, reading, quantity, registration and sense.
#[derive(Debug, Clone, PartialEq)]
pub struct Interpretation {
    pub model: Model,
    pub reading: Reading,
    /// Quantity that the search minimizes in the statistical reading.
    pub quantity: Quantity,
    pub registration: Registration,
    /// Sense (error component) that every operation gets; None if each operation keeps its own sense.
    pub sense: Option<Sense>,
}

/// Subject of a [`QuestionFault`]: the reading, a setting of the search, a limit or a sense.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum About {
    Reading,
    /// Objective of the search.
    Objective,
    /// Goals of the search.
    Goals,
    /// Limit of the operation with this index.
    Operation(usize),
    Sense(usize),
}

/// Reason why the errors of a cell cannot be interpreted as requested, with advice on what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuestionFault {
    pub about: About,
    pub message: String,
    pub help: String,
}

impl Interpretation {
    /// Returns the sense of an operation under this interpretation.
    fn sense_of<'s>(&'s self, operation: &'s Operation) -> &'s Sense {
        self.sense.as_ref().unwrap_or(&operation.sense)
    }

    /// Returns the limit of an operation under this interpretation.
    ///
    /// The result is None if the operation has no limit, or if the sense of this interpretation has another
    /// unit.
    fn limit_of(&self, operation: &Operation) -> Option<f64> {
        operation.limit.filter(|_| operation.sense.unit == self.sense_of(operation).unit)
    }

    /// Returns whether the values of the operations are shares of failures (statistical reading, quantity
    /// yield).
    fn is_yield(&self) -> bool {
        (self.reading, self.quantity) == (Reading::Statistical, Quantity::Yield)
    }
}

impl Cell {
    /// Returns the reading that applies if the cell file states none.
    ///
    /// The reading is worst-case if any error set in use states tolerances, otherwise signed.
    pub fn default_reading(&self) -> Reading {
        if self.tolerances(self.registration).is_empty() { Reading::Signed } else { Reading::WorstCase }
    }

    /// Returns how the errors of this cell are interpreted.
    pub fn interpretation(&self) -> Interpretation {
        Interpretation {
            model: self.model,
            reading: self.reading,
            quantity: self.quantity,
            registration: self.registration,
            sense: None,
        }
    }

    /// Returns a copy of this cell with another interpretation of its errors.
    ///
    /// # Errors
    /// Returns every reason why the interpretation in `interpretation` cannot be applied to the errors of
    /// this cell.
    pub fn with_interpretation(&self, interpretation: &Interpretation) -> Result<Cell, Vec<QuestionFault>> {
        self.asked_but_for(interpretation, |_| false)
    }

    /// Returns a copy of this cell with another interpretation of its errors. The senses of the operations
    /// are allowed to have different units.
    ///
    /// The caller must use the copy only for values of single operations, and must not add up these values.
    ///
    /// # Errors
    /// Returns every reason why the interpretation in `interpretation` cannot be applied to the errors of
    /// this cell. Different units of the senses are no such reason.
    pub fn with_interpretation_per_operation(
        &self,
        interpretation: &Interpretation,
    ) -> Result<Cell, Vec<QuestionFault>> {
        self.asked_but_for(interpretation, |fault| matches!(fault.about, About::Sense(_)))
    }

    fn asked_but_for(
        &self,
        interpretation: &Interpretation,
        ignored: impl Fn(&QuestionFault) -> bool,
    ) -> Result<Cell, Vec<QuestionFault>> {
        let mut faults = self.faults_of(interpretation);
        faults.retain(|fault| !ignored(fault));
        if !faults.is_empty() {
            return Err(faults);
        }
        let Interpretation { model, reading, quantity, registration, sense } = interpretation.clone();
        let mut cell = Cell { model, reading, quantity, registration, ..self.clone() };
        if let Some(sense) = sense {
            for operation in &mut cell.operations {
                operation.limit = interpretation.limit_of(operation);
                operation.sense = sense.clone();
            }
        }
        Ok(cell)
    }

    /// Returns every reason why the interpretation that this cell states cannot be applied to its errors. The
    /// list is empty for a cell that was read from a file.
    pub fn interpretation_faults(&self) -> Vec<QuestionFault> {
        self.faults_of(&self.interpretation())
    }

    /// Returns every reason why the interpretation in `interpretation` cannot be applied to the errors of
    /// this cell.
    pub fn faults_of(&self, interpretation: &Interpretation) -> Vec<QuestionFault> {
        let fault = |about, message, help: &str| QuestionFault { about, message, help: help.to_string() };
        let mut faults = Vec::new();
        if interpretation.reading == Reading::Signed {
            let help = "choose the reading worst-case or statistical";
            let told = |what| {
                fault(About::Reading, format!("{what} a set of tolerances, not a signed sample"), help)
            };
            faults.extend(self.tolerances(interpretation.registration).into_iter().map(told));
        }
        if self.search.prices_tolerances() {
            faults.extend(self.pricing_faults(interpretation));
        }
        faults.extend(self.time_fault());
        if interpretation.is_yield() {
            let unlimited = |o: &Operation| interpretation.limit_of(o).is_none();
            for (k, operation) in self.operations.iter().enumerate().filter(|(_, o)| unlimited(o)) {
                let message =
                    format!("the quantity `yield` needs a limit, but `{}` has none", operation.name);
                let word = interpretation.sense_of(operation).unit.word();
                let help = format!("add limit_{word}, the largest allowed error");
                faults.push(fault(About::Operation(k), message, &help));
            }
            return faults;
        }
        if self.search.objective == Objective::ToleranceCost {
            return faults;
        }
        let Some(first) = self.operations.first() else { return faults };
        let unit = |o: &Operation| interpretation.sense_of(o).unit;
        for (k, other) in self.operations.iter().enumerate().filter(|(_, o)| unit(o) != unit(first)) {
            let [a, b] = [first, other].map(|o| format!("`{}` is measured in {}", o.name, unit(o).word()));
            let help = "choose senses that all have the same unit, or choose the statistical reading and the quantity yield";
            faults.push(fault(
                About::Sense(k),
                format!("{b}, but {a}: values of different units cannot be added"),
                help,
            ));
        }
        faults
    }

    /// Returns every reason why the cost of the cheapest tolerances that meet the limits is not defined.
    fn pricing_faults(&self, interpretation: &Interpretation) -> Vec<QuestionFault> {
        let mut faults = Vec::new();
        let mut refuse = |about, message: String, help: &str| {
            faults.push(QuestionFault { about, message, help: help.to_string() });
        };
        let priced = self.search.objective == Objective::ToleranceCost;
        if interpretation.reading == Reading::Signed {
            let help = "choose the reading worst-case or statistical";
            refuse(
                About::Reading,
                "a signed sample has no tolerances, so the cost of tolerances is not defined".into(),
                help,
            );
        }
        if priced && self.search.robust {
            let help = "remove `robust`, or search for the least error";
            refuse(About::Objective, "a robust search cannot minimize the cost of tolerances".into(), help);
        }
        if priced && !self.search.pareto.is_empty() {
            let help = "remove `pareto`, or use the objective `sum` with the goals `error` and `cost`";
            refuse(
                About::Objective,
                "the objective `tolerance-cost` cannot be combined with `pareto`".into(),
                help,
            );
        }
        for (k, operation) in self.operations.iter().enumerate() {
            if interpretation.limit_of(operation).is_none() {
                let word = interpretation.sense_of(operation).unit.word();
                let message = format!("`{}` has no limit that the tolerances must meet", operation.name);
                refuse(About::Operation(k), message, &format!("add limit_{word}, the largest allowed error"));
            }
            if matches!(operation.over, NodeAggregation::Mean | NodeAggregation::P95) {
                let message =
                    format!("`{}` is judged by the {} over its nodes", operation.name, operation.over.name());
                let help =
                    "use over = \"best\" (limit at the best node) or over = \"max\" (limit at every node)";
                refuse(
                    About::Operation(k),
                    format!(
                        "{message}, but the cost of tolerances is defined only for limits at single nodes"
                    ),
                    help,
                );
            }
        }
        faults
    }

    /// Returns why the search cannot minimize the cycle time; None if it can, or if the time is not a goal.
    fn time_fault(&self) -> Option<QuestionFault> {
        let missing = self.robot.joints_without_speed();
        if missing.is_empty() || !self.search.pareto.iter().any(|goal| goal == Goal::Time) {
            return None;
        }
        let names = missing.iter().map(|&k| format!("`{}`", shown(&self.robot.joints[k].name)));
        let names = names.collect::<Vec<_>>().join(", ");
        let message =
            format!("the goal `time` needs the maximum speed of every joint, which is missing for {names}");
        Some(QuestionFault { about: About::Goals, message, help: self.speed_remedy().unwrap_or_default() })
    }

    /// Returns advice on how to state the speeds that cycle times need; None if no speed is missing.
    pub fn speed_remedy(&self) -> Option<String> {
        let first = *self.robot.joints_without_speed().first()?;
        let key = match self.robot.joints[first].kind {
            JointKind::Revolute => "max_velocity_deg_s = 180",
            JointKind::Prismatic => "max_velocity_mm_s = 500",
        };
        Some(format!(
            "add [[robot.rate]] with joint = {} and {key}, and such an entry for every other joint without a speed",
            first + 1
        ))
    }

    /// Returns one text for each error set in use that states tolerances.
    ///
    /// The text is the beginning of a message: "`name` is" or "the errors of `name` are".
    fn tolerances(&self, registration: Registration) -> Vec<String> {
        let robot = self.robot.errors.get(self.errors);
        let robot = robot.filter(|set| matches!(set, ErrorSet::Tolerance(_)));
        // A taught frame moves with its equipment, so errors of the equipment are ignored.
        let is_used = |k: usize| {
            registration != Registration::Taught && self.operations.iter().any(|o| o.equipment == k)
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
