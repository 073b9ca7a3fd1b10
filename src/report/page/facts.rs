//! Cards of the verdict: requirement, tolerances, yield, gain, proven gap, runner-up and objective.

use super::content::{NOTHING, plain};
use super::quantities::{down, quantity, told};
use super::subject::Subject;
use crate::assess::{Assessment, Requirement};
use crate::cell::{Cell, Objective, Unit};
use crate::files::shown;
use crate::proof::Covers;
use crate::record::{
    FactEntry, FactMood, ProvenOperation, RunnerUpEntry, SearchResult, VerdictDocument, nine_digits,
    reading_word,
};
use crate::report::text::{self, yield_in_words};
use crate::units::percent_from_share;

/// Returns the cards of a verdict whose other fields are complete.
pub fn facts(v: &VerdictDocument, subject: &Subject<'_>) -> Vec<FactEntry> {
    let (a, cell) = (subject.shown(), subject.cell());
    let mut facts = Vec::new();
    if v.objective_value.is_some() {
        facts.push(requirement(a));
        facts.extend(withstood(a));
        facts.extend(joint_yield(a));
    }
    if let Some(found) = &subject.found {
        if v.feasible {
            facts.push(gain(v, cell.unit()));
        }
        facts.push(gap(found, v, cell.unit()));
    }
    if let Some(next) = &v.runner_up {
        let RunnerUpEntry { value, text, note, .. } = next.clone();
        facts.push(FactEntry {
            label: "Runner-up".into(),
            value: Some(value),
            text,
            note,
            mood: FactMood::Plain,
        });
    }
    facts.extend(v.objective_value.map(|value| objective(cell, value)));
    facts
}

/// Returns the entry on the objective, the value that the search minimizes.
fn objective(cell: &Cell, value: f64) -> FactEntry {
    let text = told(cell.unit(), value);
    let note = format!("what the optimizer minimizes: {}; {}", summed(cell), reading_in_words(cell));
    FactEntry { label: "Objective".into(), value: Some(value), text, note, mood: FactMood::Plain }
}

/// Describes how the objective combines the operations.
fn summed(cell: &Cell) -> String {
    let senses = cell.operations.iter().map(|o| format!("{} in {}", shown(&o.name), shown(&o.sense.name)));
    let names: Vec<String> = senses.collect();
    let weighted = cell.operations.iter().any(|o| o.weight != 1.0);
    let how = match (names.len(), cell.search.objective) {
        (1, objective) if objective != Objective::ToleranceCost => "",
        (_, Objective::WeightedSum) if weighted => "weighted sum of ",
        (_, Objective::WeightedSum) => "sum of ",
        (_, Objective::WeightedMaximum) if weighted => "weighted maximum of ",
        (_, Objective::WeightedMaximum) => "maximum of ",
        (_, Objective::Lexicographic) => "in order of priority: ",
        (_, Objective::ToleranceCost) => "cost of the tolerances that meet the limits in ",
    };
    let misplaced = if cell.search.robust { ", at the worst misplacement" } else { "" };
    format!("{how}{}{misplaced}", names.join(" and "))
}

/// Describes what the value of the objective means under the reading (interpretation of the errors) of the
/// cell.
///
/// A statistic over all arms, such as p95, describes the error at one spot. If the objective combines several
/// spots, the share of arms with a smaller objective is not known.
pub fn reading_in_words(cell: &Cell) -> String {
    let set = shown(cell.error_set().name());
    let every_node = cell.operations.iter().any(|o| o.over.needs_every_node());
    let alone = match cell.operations.len() {
        _ if every_node => "at each node alone, ",
        0 | 1 => "",
        _ => "in each operation alone, ",
    };
    let priced = match cell.search.objective {
        Objective::ToleranceCost => "cost of the cheapest tolerances that meet the limit, as judged by: ",
        _ => "",
    };
    let alone = format!("{priced}{alone}");
    match reading_word(cell) {
        "error" => format!("for the single arm with the errors {set}"),
        "worst case" => format!("{alone}largest value for any arm within the tolerances {set}"),
        "p95" => format!("{alone}95 of 100 arms built to the tolerances {set} have a smaller error"),
        "p99" => format!("{alone}99 of 100 arms built to the tolerances {set} have a smaller error"),
        "share of failures" => {
            format!("{alone}share of arms that exceed the limit, among arms built to the tolerances {set}")
        }
        word => format!("{alone}the {word} over the arms built to the tolerances {set}"),
    }
}

fn requirement(a: &Assessment<'_>) -> FactEntry {
    let unit = a.cell.unit();
    let all = (0..a.maps.len()).filter_map(|k| Some((k, a.requirement(k)?)));
    // A limit without a known bound may have a large margin, but it is not met.
    let order =
        |x: &Requirement, y: &Requirement| x.is_met().cmp(&y.is_met()).then(x.margin.total_cmp(&y.margin));
    let tightest = all.min_by(|(_, x), (_, y)| order(x, y));
    let Some((k, r)) = tightest else {
        let note = "no operation of the cell has a limit with which its error is compared".to_string();
        return FactEntry {
            label: "Requirement".into(),
            value: None,
            text: "none".into(),
            note,
            mood: FactMood::Plain,
        };
    };
    let (name, limit) = (shown(&a.cell.operations[k].name), quantity(unit, r.limit));
    let margin = quantity(unit, r.margin.abs());
    let (text, note, mood) = match r.is_met() {
        false if !r.known => {
            let why = "no bound of its error over all misplacements is known";
            ("not guaranteed", format!("the limit {limit} of {name} is not guaranteed: {why}"), FactMood::Bad)
        }
        false if r.is_unproven() => {
            let most = quantity(unit, r.limit - r.margin);
            let why = format!("the proven upper bound of its error over all misplacements is {most}");
            ("not guaranteed", format!("the limit {limit} of {name} is not guaranteed: {why}"), FactMood::Bad)
        }
        // If the objective is a cost, `limit` is the cost of the tightest tolerances.
        true if unit == Unit::Cost => (
            "met",
            format!("{name} meets its limit; the tightest tolerances would cost {limit}"),
            FactMood::Good,
        ),
        false if unit == Unit::Cost => {
            ("missed", format!("{name} exceeds its limit even with the tightest tolerances"), FactMood::Bad)
        }
        true => {
            ("met", format!("{name} meets its limit of {limit} with a margin of {margin}"), FactMood::Good)
        }
        false => ("missed", format!("{name} exceeds its limit of {limit} by {margin}"), FactMood::Bad),
    };
    FactEntry {
        label: "Requirement".into(),
        value: Some(nine_digits(unit.from_si(r.margin))),
        text: text.into(),
        note,
        mood,
    }
}

/// Returns the entry on the placement tolerances; None if no certificate was computed.
fn withstood(a: &Assessment<'_>) -> Option<FactEntry> {
    let certificate = a.certificate.as_ref()?;
    let unit = a.cell.unit();
    let worst = a.cell.operations.iter().enumerate().map(|(k, operation)| match a.worst(k) {
        Some(worst) => format!("{} at most {}", shown(&operation.name), quantity(unit, worst)),
        None => {
            let why = a.workcell.no_value_bound(k).map_or("", |why| why.in_words());
            format!("{} not bounded: {why}", shown(&operation.name))
        }
    });
    let worst: Vec<String> = worst.collect();
    let (text, mood) = match certificate.holds() {
        true => ("certified", FactMood::Good),
        false => ("not certified", FactMood::Bad),
    };
    let note = format!("at every misplacement within the placement tolerances: {}", worst.join(", "));
    Some(FactEntry { label: "Placement tolerances".into(), value: None, text: text.into(), note, mood })
}

/// Returns the entry on the overall yield: the share of sampled arms that stay within the limits of all
/// operations. Returns None if the assessment has no overall yield.
fn joint_yield(a: &Assessment<'_>) -> Option<FactEntry> {
    let value = a.cell_yield?.value;
    let (text, note) = (format!("{:.3} %", percent_from_share(value)), yield_in_words(a)?);
    Some(FactEntry {
        label: "Yield".into(),
        value: Some(nine_digits(value)),
        text,
        note,
        mood: FactMood::Plain,
    })
}

fn gain(v: &VerdictDocument, unit: Unit) -> FactEntry {
    let (text, note, mood) = match (v.gain_percent, v.start_value) {
        (Some(gain), Some(start)) => {
            let mood = if gain > 0.05 { FactMood::Good } else { FactMood::Plain };
            (
                format!("{gain:.1} %"),
                format!("less than the layout as drawn, which has {}", told(unit, start)),
                mood,
            )
        }
        _ => (
            NOTHING.into(),
            "the layout as drawn is not feasible, so there is nothing to compare with".into(),
            FactMood::Plain,
        ),
    };
    FactEntry { label: "Gain".into(), value: v.gain_percent, text, note, mood }
}

/// Returns the entry on the gap between the objective of the best layout found and the proven lower bound.
fn gap(found: &SearchResult, v: &VerdictDocument, unit: Unit) -> FactEntry {
    let covers = match found.proof.covers {
        Covers::Part => {
            format!("; the bound counts the values of these operations as 0: {}", unproven(found))
        }
        _ => String::new(),
    };
    let proven = |bound: f64| {
        let bound = down(unit, bound);
        format!("it is proven that no layout within the ranges has an objective below {bound}{covers}")
    };
    let (text, note) = match (found.gap_percent, found.bound) {
        (Some(gap), Some(bound)) => {
            let least = found.least_value.filter(|_| bound > 0.0).map(|least| 100.0 * (least / bound - 1.0));
            let nearer = least.map(text::gap).filter(|least| *least != text::gap(gap));
            let nearer = nearer.map_or(String::new(), |least| {
                format!(
                    "; the least objective found is {least} above this bound, and the search recommends a \
                     nearly equal layout with more room"
                )
            });
            // The gap is rounded up, so that the printed gap is never too small.
            (text::gap(gap), proven(bound) + &nearer)
        }
        (None, Some(bound)) => ("none".into(), proven(bound)),
        _ if found.proof.covers == Covers::Infeasible => {
            ("no layout".into(), format!("it is proven that no layout is feasible: {}", unproven(found)))
        }
        _ => ("none".into(), format!("nothing is proven: {}", unproven(found))),
    };
    FactEntry { label: "Proven gap".into(), value: v.gap_percent, text, note, mood: FactMood::Plain }
}

fn unproven(found: &SearchResult) -> String {
    let why = |p: &ProvenOperation| Some(format!("{}: {}", shown(&p.name), plain(p.why_not.as_ref()?)));
    found.proof.operations.iter().filter_map(why).collect::<Vec<_>>().join("; ")
}
