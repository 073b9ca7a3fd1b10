//! Verdicts that a map, a budget and an explanation share: limit, Monte Carlo check and joint yield.

use super::compare::margin;
use crate::assess::{Assessment, Requirement};
use crate::cell::Unit;
use crate::files::shown;
use crate::reading::{Estimate, MonteCarlo};
use crate::units::percent_from_share;

/// Returns a limit and the margin that is left.
pub fn requirement_line(r: Requirement, unit: Unit) -> String {
    format!("limit {:.4} {}: {}", unit.from_si(r.limit), unit.word(), margin(unit, r))
}

/// Describes how well the Monte Carlo samples of an operation agree with the first-order figures.
pub fn samples_line(samples: &MonteCarlo, unit: Unit, holds: bool) -> String {
    let said = |e: &Estimate| {
        let [value, low, high] = [e.value, e.low, e.high].map(|v| unit.from_si(v));
        format!("{value:.4} ({low:.4} to {high:.4})")
    };
    let verdict = match holds {
        true => "the first-order figures hold",
        false => "the first-order figures do NOT hold: the figures shown here are those of the samples",
    };
    format!(
        "{} Monte Carlo samples of the nonlinear model: rms {}, p95 {}, p99 {} {}; {verdict}",
        samples.samples,
        said(&samples.rms),
        said(&samples.p95),
        said(&samples.p99),
        unit.word()
    )
}

/// Returns the yield of all operations together and of each alone; empty without a joint yield.
pub fn yield_lines(a: &Assessment<'_>) -> String {
    yield_in_words(a).map_or(String::new(), |said| format!("{said}\n"))
}

/// Describes the yield of all operations together and of each alone; None without a joint yield.
pub fn yield_in_words(a: &Assessment<'_>) -> Option<String> {
    let (together, samples) = (a.cell_yield?, a.samples.iter().flatten().map(|s| s.samples).max()?);
    let alone = a.cell.operations.iter().zip(&a.samples).filter_map(|(operation, samples)| {
        Some(format!("{} {}", shown(&operation.name), share(&samples.as_ref()?.success?)))
    });
    let alone: Vec<String> = alone.collect();
    let what = if alone.len() > 1 { "the limits of all operations" } else { "the limit" };
    let each = if alone.len() > 1 { format!("; each alone: {}", alone.join(", ")) } else { String::new() };
    Some(format!("yield: {} of {samples} sampled arms keep {what}{each}", share(&together)))
}

/// Returns a share as percent, with its 95 % confidence interval.
fn share(e: &Estimate) -> String {
    let [value, low, high] = [e.value, e.low, e.high].map(percent_from_share);
    format!("{value:.3} % ({low:.3} to {high:.3} %)")
}
