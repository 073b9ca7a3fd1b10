//! Error budget of a spot: the share of each parameter, and the gain from tightening its tolerance.

use super::posture_check::PostureCheck;
use super::posture_context::PostureContext;
use crate::cell::{Parameter, Reading, Unit};
use crate::reading::{Budget, ErrorEvaluator, EvaluatorScratch, PostureErrors, WorstCase};

/// Number of parameters whose tolerances are halved in trials. These parameters have the largest shares of
/// the budget.
const TIGHTENED: usize = 3;

/// Result of a trial: the worst case or statistical quantity after the tolerances of `parameters` are halved.
#[derive(Debug, Clone, PartialEq)]
pub struct Tighter {
    pub parameters: Vec<Parameter>,
    /// Worst case or statistical quantity after the tolerances of [`Self::parameters`] are halved. The unit
    /// is [`BudgetReport::unit`]: m, rad or a share.
    pub figure: f64,
}

/// Error budget of one posture, with the effect of halved tolerances. Tolerances are halved for the
/// parameters that have the largest shares of the budget.
pub struct BudgetReport<'a> {
    pub context: PostureContext<'a>,
    pub budget: Budget,
    pub judged: PostureErrors,
    /// Monte Carlo check of the posture; None unless the reading is statistical.
    pub check: Option<PostureCheck>,
    /// Worst case of the error component that matters to the operation (its sense); None if the errors are
    /// not tolerances ([`ErrorEvaluator::has_tolerances`]).
    pub worst: Option<WorstCase>,
    /// Error figure that smaller tolerances reduce. In the statistical reading, it is the first-order
    /// quantity, such as the RMS. In any other reading, it is the worst case. The figure is infinite if the
    /// errors are not tolerances.
    pub figure: f64,
    /// Results of trials with halved tolerances. The trials concern up to three parameters, which have the
    /// largest shares of the budget. Each trial halves the tolerance of one of these parameters. If there are
    /// several parameters, a last trial halves the tolerances of all of them. There are no trials if the
    /// errors are not tolerances.
    pub tighter: Vec<Tighter>,
}

impl<'a> BudgetReport<'a> {
    /// Computes the error budget of a posture.
    pub fn new(context: PostureContext<'a>) -> Self {
        let PostureContext { evaluator, situation, frames, .. } = &context;
        let mut memory = evaluator.memory();
        let budget = Budget::new(evaluator, situation, frames, &mut memory);
        let (judged, check) = PostureCheck::judged(&context, &mut memory);
        if !evaluator.has_tolerances() {
            return Self {
                budget,
                judged,
                check,
                worst: None,
                figure: f64::INFINITY,
                tighter: Vec::new(),
                context,
            };
        }
        evaluator.prepare(situation, frames, &mut memory);
        let worst = evaluator.worst(&evaluator.sense, situation, frames, &mut memory);
        let first: Vec<Parameter> = budget.shares.iter().take(TIGHTENED).map(|s| s.parameter).collect();
        let mut tried: Vec<Vec<Parameter>> = first.iter().map(|p| vec![*p]).collect();
        if first.len() > 1 {
            tried.push(first);
        }
        let tighter = tried.into_iter().map(|parameters| {
            let figure = figure(&halved(evaluator, &parameters), &context, &mut memory);
            Tighter { parameters, figure }
        });
        let tighter = tighter.collect();
        let figure = figure(evaluator, &context, &mut memory);
        Self { budget, judged, check, worst: Some(worst), figure, tighter, context }
    }

    /// Returns the unit of [`Self::figure`]: m, rad or a share.
    pub fn unit(&self) -> Unit {
        match self.context.cell.is_yield() {
            true => Unit::Share,
            false => self.context.evaluator.sense.unit,
        }
    }

    /// Returns the share (0 to 1) by which a trial reduces [`Self::figure`].
    pub fn cut(&self, tighter: &Tighter) -> f64 {
        if self.figure > 0.0 { 1.0 - tighter.figure / self.figure } else { 0.0 }
    }
}

/// Returns the quantity of the statistical reading, or the worst case in any other reading.
fn figure(evaluator: &ErrorEvaluator, context: &PostureContext<'_>, memory: &mut EvaluatorScratch) -> f64 {
    let PostureContext { situation, frames, .. } = context;
    if evaluator.reading == Reading::Statistical {
        return evaluator.value(situation, frames, memory);
    }
    evaluator.prepare(situation, frames, memory);
    evaluator.worst(&evaluator.sense, situation, frames, memory).by_model
}

/// Returns a copy of an evaluator in which the tolerances of `parameters` are halved.
fn halved(evaluator: &ErrorEvaluator, parameters: &[Parameter]) -> ErrorEvaluator {
    let mut tighter = evaluator.clone();
    for k in 0..tighter.sources.list.len() {
        if parameters.contains(&tighter.sources.list[k].parameter) {
            tighter.sources.scale(k, 0.5);
        }
    }
    tighter
}
