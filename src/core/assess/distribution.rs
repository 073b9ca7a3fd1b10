//! Monte Carlo distribution of the error at a spot; the spot may have been chosen under any reading.

use super::{Assessment, SAMPLES};
use crate::cell::{Interpretation, Model, NO_TOLERANCES, Quantity, Reading, Unit};
use crate::error_map::PostureRecord;
use crate::kinematic_error::NEGLIGIBLE;
use crate::layout::Workcell;
use crate::reading::{Figures, MonteCarlo, monte_carlo};

/// Distribution of the error at an operation's spot, m or rad. The error is the size of the component that
/// matters to the operation (its sense).
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorDistribution {
    pub operation: usize,
    pub unit: Unit,
    /// Monte Carlo estimates, computed with the nonlinear model.
    pub samples: MonteCarlo,
    /// Figures of the first-order statistics (RMS, mean, percentiles) and the worst case.
    pub figures: Figures,
    /// Error of the signed sample under the model of the cell; None if the error set has no signed sample.
    pub signed: Option<f64>,
    /// Limit of the operation, m or rad; None without a limit.
    pub limit: Option<f64>,
}

impl ErrorDistribution {
    /// Draws samples of the error at the spot of an operation.
    ///
    /// # Errors
    /// Returns the reason if the operation has no spot, or if its error has no distribution.
    pub fn at_spot(a: &Assessment<'_>, operation: usize) -> Result<Self, String> {
        let cell = a.cell;
        if cell.errors_compensate() {
            return Err(NO_TOLERANCES.into());
        }
        let (_, posture) = a.spot(operation).ok_or("the operation has no usable node")?;
        let judged = |model, reading| judged(a, operation, posture, model, reading);
        let (read, figures) = judged(cell.model, Reading::Statistical)?;
        if figures.p99 <= NEGLIGIBLE {
            return Err(
                "the error does not vary at this spot: all parameters are exact, or a registration removes their errors"
                    .to_string(),
            );
        }
        let kept = a.samples[operation].clone();
        let samples = kept.map_or_else(|| sampled(a, &read, operation, posture, figures.p95), Ok)?;
        let signed = judged(cell.model, Reading::Signed).ok().map(|(_, figures)| figures.error);
        let of = &cell.operations[operation];
        Ok(Self { operation, unit: of.sense.unit, samples, figures, signed, limit: of.limit })
    }
}

/// Returns a workcell that uses `model` and `reading`, and the error figures of `posture` in that workcell.
fn judged(
    a: &Assessment<'_>,
    operation: usize,
    posture: &PostureRecord,
    model: Model,
    reading: Reading,
) -> Result<(Workcell, Figures), String> {
    let interpretation =
        Interpretation { model, reading, quantity: Quantity::P95, ..a.cell.interpretation() };
    if let Some(fault) = a.cell.faults_of(&interpretation).first() {
        return Err(fault.message.clone());
    }
    let read = a.workcell.interpreted(&interpretation)?;
    let posed = read.posed(&a.layout, &a.maps, operation, posture);
    let (situation, frames) = posed.map_err(|why| why.in_words().to_string())?;
    let evaluator = read.evaluator(operation);
    let figures = evaluator.judge(&situation, &frames, &mut evaluator.memory()).figures[evaluator.own()];
    Ok((read, figures))
}

fn sampled(
    a: &Assessment<'_>,
    read: &Workcell,
    operation: usize,
    posture: &PostureRecord,
    p95: f64,
) -> Result<MonteCarlo, String> {
    let posed = read.posed(&a.layout, &a.maps, operation, posture);
    let (situation, frames) = posed.map_err(|why| why.in_words().to_string())?;
    let evaluator = read.evaluator(operation);
    Ok(monte_carlo(evaluator, &situation, &frames, SAMPLES, a.cell.search.seed, p95))
}
