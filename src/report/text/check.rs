//! Verdicts that a map, a budget and an explanation share: limit, Monte Carlo check and overall yield.

use super::compare::margin;
use crate::assess::{Assessment, Requirement};
use crate::cell::Unit;
use crate::files::shown;
use crate::reading::{Estimate, MonteCarlo};
use crate::units::percent_from_share;

/// Describes a limit, whether it is met, and by which margin.
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
        false => "the first-order figures do NOT hold: the figures shown here come from the samples",
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

/// Returns the overall yield and the yield of each operation alone, as text. The overall yield is the share
/// of sampled arms that stay within the limits of all operations. The text is empty if the assessment has no
/// overall yield.
pub fn yield_lines(a: &Assessment<'_>) -> String {
    let line = a.cell_yield.zip(yield_in_words(a));
    line.map_or(String::new(), |(all, said)| {
        format!("yield: {:.3} %, {said}\n", percent_from_share(all.value))
    })
}

/// Describes the overall yield and the yield of each operation alone. The overall yield is the share of
/// sampled arms that stay within the limits of all operations.
///
/// Each share has its 95 % confidence interval. Returns None if the assessment has no overall yield.
pub fn yield_in_words(a: &Assessment<'_>) -> Option<String> {
    let (together, samples) = (a.cell_yield?, a.samples.iter().flatten().map(|s| s.samples).max()?);
    let alone = a.cell.operations.iter().zip(&a.samples).filter_map(|(operation, samples)| {
        Some(format!("{} {}", shown(&operation.name), share(&samples.as_ref()?.success?)))
    });
    let alone: Vec<String> = alone.collect();
    let what = if alone.len() > 1 { "the limits of all operations" } else { "the limit" };
    let each = if alone.len() > 1 { format!("; each alone: {}", alone.join(", ")) } else { String::new() };
    Some(format!("share of {samples} sampled arms that stay within {what} {}{each}", interval(&together)))
}

/// Returns a share as percent, with its 95 % confidence interval.
fn share(e: &Estimate) -> String {
    format!("{:.3} % {}", percent_from_share(e.value), interval(e))
}

/// Returns the 95 % confidence interval of a share in percent.
fn interval(e: &Estimate) -> String {
    format!("({:.3} to {:.3} %)", percent_from_share(e.low), percent_from_share(e.high))
}
