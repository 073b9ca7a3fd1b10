//! The error budget: which tolerance to tighten first.

use super::check::{requirement_line, samples_line};
use super::table::TextTable;
use super::{amount, fixed, no_tolerances, percent1, place_words};
use crate::assess::{BudgetReport, Tighter};
use crate::cell::Reading;
use crate::kinematic_error::NEGLIGIBLE;
use crate::reading::{Figures, Share};
use crate::record::{ParameterUnit, parameter_names as names};
use crate::units::mm_from_m;
use nalgebra::Vector3;
use std::fmt::Write;

/// Returns the error budget of one spot as text.
pub fn budget(a: &BudgetReport<'_>) -> String {
    let evaluator = &a.context.evaluator;
    let by = if evaluator.reading == Reading::Statistical { "variance" } else { "worst case" };
    let at = match evaluator.reading {
        Reading::Signed => "of the signed values",
        _ => "of the positive tolerances",
    };
    let mut out = place_words(&a.context);
    if a.judged.figures[evaluator.own()].worst <= NEGLIGIBLE {
        // An error this small consists of rounding errors, so the shares of the parameters have no meaning.
        out.push_str(match a.context.situation.site.taught.is_some() {
            true => "  this point was touched to teach the frame: no error remains here\n",
            false => "  no parameter has an effect here\n",
        });
        return out;
    }
    let order = match a.worst {
        Some(_) => format!("ordered by share of the {by}"),
        None => "ordered by size of the effect".into(),
    };
    let _ = writeln!(
        out,
        "  sense {}, {order}; columns x, y, z: linear effects {at}, in world axes",
        evaluator.sense.name
    );
    out.push_str(&shares(a));
    out.push_str(&totals(a));
    out.push_str(&verdicts(a));
    out.push_str(&tighten(a));
    out
}

fn shares(a: &BudgetReport<'_>) -> String {
    let unit = a.context.evaluator.sense.unit;
    let mut table = TextTable::indented(1);
    let alone = format!("alone {}", unit.word());
    table.row(["parameter", "+-", "x mm", "y mm", "z mm", &alone, "of worst case", "of variance"]);
    let cell = a.context.cell;
    for share in &a.budget.shares {
        let own = ParameterUnit::new(cell, share.parameter);
        let mut row = vec![
            names::parameter(cell, share.parameter),
            format!("{} {}", value(own, share.plus_minus), own.word()),
        ];
        row.extend(terms(&share.term));
        row.push(fixed(unit.from_si(share.alone), 4));
        let part = |of: f64| a.worst.map_or_else(|| "-".into(), |_| percent1(of));
        row.extend([share.of_worst, share.of_variance].map(part));
        table.row(row);
    }
    if a.context.evaluator.reading == Reading::Signed {
        let sum = a.budget.shares.iter().map(|s: &Share| s.term).sum::<Vector3<f64>>();
        table.row(["sum".to_string(), String::new()].into_iter().chain(terms(&sum)));
    }
    table.render()
}

fn terms(v: &Vector3<f64>) -> [String; 3] {
    [v.x, v.y, v.z].map(|m| fixed(mm_from_m(m), 4))
}

/// Returns the value of a parameter in its unit, rounded to 6 decimals.
fn value(unit: ParameterUnit, si: f64) -> String {
    crate::units::rounded(unit.from_si(si), 6).to_string()
}

fn totals(a: &BudgetReport<'_>) -> String {
    let Some(found) = &a.worst else { return format!("  {}\n", no_tolerances()) };
    let evaluator = &a.context.evaluator;
    let unit = evaluator.sense.unit;
    let Figures { worst_linear, worst, rms, mean, p95, p99, .. } = a.judged.figures[evaluator.own()];
    let [worst_linear, worst, rms, mean, p95, p99] =
        [worst_linear, worst, rms, mean, p95, p99].map(|v| fixed(unit.from_si(v), 4));
    let bound = if found.exact { "" } else { " at most" };
    let word = unit.word();
    let success = a.judged.success.map_or(String::new(), |s| format!(", yield {s:.6}"));
    let by = if a.check.as_ref().is_some_and(|c| !c.confirmed) { "by samples" } else { "to first order" };
    format!(
        "  worst case {worst_linear} {word}{bound} by the linear model, {worst} {word} by the {} model\n  \
         rms {rms}, mean {mean}, p95 {p95}, p99 {p99} {word}{success}, {by}\n",
        evaluator.model.name()
    )
}

/// Returns one text line about the limit, and one text line about the Monte Carlo check of the first-order
/// figures.
fn verdicts(a: &BudgetReport<'_>) -> String {
    let unit = a.context.evaluator.sense.unit;
    let limit = a.context.requirement(a.judged.value).map(|r| requirement_line(r, unit));
    let check = a.check.as_ref().map(|c| samples_line(&c.samples, unit, c.confirmed));
    limit.into_iter().chain(check).map(|line| format!("  {line}\n")).collect()
}

fn tighten(a: &BudgetReport<'_>) -> String {
    let cell = a.context.cell;
    let figure = super::tightened_word(&a.context);
    let unit = a.unit();
    let mut out = String::new();
    for tighter @ Tighter { parameters, figure: left } in &a.tighter {
        let names: Vec<String> = parameters.iter().map(|p| names::parameter(cell, *p)).collect();
        let all = if names.len() > 1 { " together" } else { "" };
        let _ = writeln!(
            out,
            "  halving {}{all} cuts {figure} by {}, from {} to {}",
            names.join(", "),
            percent1(a.cut(tighter)),
            amount(unit, a.figure),
            amount(unit, *left)
        );
    }
    out
}
