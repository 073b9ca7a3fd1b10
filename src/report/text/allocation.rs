//! Text of a tolerance allocation: a table of the present and the cheapest tolerances, then the findings.

use super::fixed;
use super::table::TextTable;
use crate::files::shown;
use crate::record::{
    AllocatedEntry, AllocationDocument, AllocationRequirement, AllocationStatus, ShortfallEntry, ToleranceEnd,
};
use crate::units::rounded;
use std::fmt::Write;

/// Largest number of requirements, bounds or names that one list shows.
const MAX_LISTED: usize = 5;

/// Returns the allocation as text.
pub fn allocation(d: &AllocationDocument) -> String {
    let mut out = limits(d);
    out.push_str(&table(d));
    // Writing to a String cannot fail.
    if !d.fixed.is_empty() {
        let _ = writeln!(out, "  not allocated, because they are measured or correlated: {}", few(&d.fixed));
    }
    if d.status == AllocationStatus::Infeasible {
        d.shortfalls.iter().take(MAX_LISTED).for_each(|s| out.push_str(&shortfall(s)));
        let more = d.shortfalls.len().saturating_sub(MAX_LISTED);
        if more > 0 {
            let _ = writeln!(out, "  and {more} more nodes at which the limit cannot be met");
        }
        return out;
    }
    out.push_str(&costs(d));
    out.push_str(&bindings(d));
    out.push_str(&judgement(d));
    let of_end = |end: ToleranceEnd| -> Vec<String> {
        let at = d.parameters.iter().filter(|p| p.at_end == Some(end));
        at.map(|p| p.parameter.clone()).collect()
    };
    let loosened: Vec<String> = d
        .parameters
        .iter()
        .filter(|p| p.scale.is_some_and(|scale| scale > 1.0 + 1e-6))
        .map(|p| p.parameter.clone())
        .collect();
    let lists = [
        ("may be loosened", loosened),
        (
            "at the loosest end of their ranges, so wider ranges would lower the cost",
            of_end(ToleranceEnd::Loosest),
        ),
        (
            "at the tightest end of their ranges, so wider ranges would lower the cost",
            of_end(ToleranceEnd::Tightest),
        ),
    ];
    for (what, names) in lists.iter().filter(|(_, names)| !names.is_empty()) {
        let _ = writeln!(out, "  {what}: {}", few(names));
    }
    out
}

/// Returns the limits of the operations in one line.
fn limits(d: &AllocationDocument) -> String {
    let mut names: Vec<&str> = Vec::new();
    for requirement in &d.requirements {
        if !names.contains(&requirement.operation.as_str()) {
            names.push(&requirement.operation);
        }
    }
    let each = names.iter().map(|name| {
        let own: Vec<_> = d.requirements.iter().filter(|r| r.operation == *name).collect();
        let (unit, limit) = own.first().map_or(("", 0.0), |r| (r.unit.word(), r.limit));
        let at = match own[..] {
            [one] => format!("at node ({}, {})", one.node[0], one.node[1]),
            _ => format!("at each of {} nodes", own.len()),
        };
        format!("{} at most {} {unit} {at}", shown(name), rounded(limit, 6))
    });
    let each: Vec<String> = each.collect();
    let figure = d.demanded_yield.map_or(d.quantity.clone(), |share| format!("error (yield {share})"));
    format!("the {figure} of {}\n", each.join("; "))
}

fn table(d: &AllocationDocument) -> String {
    let mut table = TextTable::indented(1);
    let is_solved = d.cost.is_some();
    let has_grades = d.parameters.iter().any(|p| p.grade.is_some());
    let mut head = vec!["parameter", "now +-", "cost"];
    head.extend(if is_solved { vec!["cheapest +-", "cost", "scale"] } else { vec!["tightest +-"] });
    if has_grades {
        head.push("grade");
    }
    table.row(head);
    for p in &d.parameters {
        let own = |value: f64| format!("{} {}", rounded(value, 6), p.unit.word());
        let mut row = vec![p.parameter.clone(), own(p.before), fixed(p.cost_before, 4)];
        match (p.after, p.cost, p.scale) {
            (Some(after), Some(cost), Some(scale)) => {
                row.extend([own(after), fixed(cost, 4), fixed(scale, 4) + end_word(p)]);
            }
            _ => row.push(own(p.before * p.scale_range[0])),
        }
        if has_grades {
            row.push(p.grade.as_ref().map_or(String::new(), |name| shown(name)));
        }
        table.row(row);
    }
    table.render()
}

fn end_word(p: &AllocatedEntry) -> &'static str {
    match p.at_end {
        Some(ToleranceEnd::Loosest) => " (loosest)",
        Some(ToleranceEnd::Tightest) => " (tightest)",
        None => "",
    }
}

fn costs(d: &AllocationDocument) -> String {
    let (Some(cost), Some(bound), Some(gap)) = (d.cost, d.lower_bound, d.duality_gap) else {
        return String::new();
    };
    let mut out =
        format!("  cost {} now, {} with the cheapest tolerances\n", fixed(d.cost_before, 6), fixed(cost, 6));
    let _ = match &d.uniform {
        Some(u) => writeln!(
            out,
            "  uniform tightening (scale {}) costs {}; the cheapest tolerances save {} % of this cost",
            fixed(u.scale, 4),
            fixed(u.cost, 6),
            fixed(u.saving_percent, 1)
        ),
        None => writeln!(out, "  no common scale of all tolerances meets the limits"),
    };
    let _ = writeln!(
        out,
        "  according to the linear error model, no tolerances within the ranges cost less than {} (duality gap at most \
         {gap:.0e})",
        fixed(bound, 6)
    );
    out
}

/// Returns lines about the requirements at their limits, in order of decreasing shadow price. Only the first
/// [`MAX_LISTED`] requirements get a line, and a last line states the number of the others. If the allocation
/// is solved and no requirement is at its limit, a line says so.
fn bindings(d: &AllocationDocument) -> String {
    let mut binding: Vec<&AllocationRequirement> = d.requirements.iter().filter(|r| r.is_binding).collect();
    binding.sort_by(|a, b| b.shadow_price.unwrap_or(0.0).total_cmp(&a.shadow_price.unwrap_or(0.0)));
    let mut out = String::new();
    for r in binding.iter().take(MAX_LISTED) {
        // A small step in a round number: 0.1 of the unit, or less if the limit is small.
        let step = [0.1, 0.01].into_iter().find(|step| *step <= 0.05 * r.limit).unwrap_or(0.01 * r.limit);
        let saved = r.shadow_price.zip(d.cost).filter(|(_, cost)| *cost > 0.0);
        let saved = saved.map_or(0.0, |(price, cost)| 100.0 * price * step / cost);
        let unit = r.unit.word();
        let (name, node) = (shown(&r.operation), format!("({}, {})", r.node[0], r.node[1]));
        let _ = writeln!(
            out,
            "  {name} at node {node} is at its limit of {} {unit} ({} with the present tolerances): raising this limit by {} {unit} would save {} % of the cost",
            rounded(r.limit, 6),
            fixed(r.before, 4),
            rounded(step, 9),
            fixed(saved, 2)
        );
    }
    if binding.len() > MAX_LISTED {
        let _ = writeln!(out, "  and {} more nodes are at their limits", binding.len() - MAX_LISTED);
    }
    if binding.is_empty() && d.cost.is_some() {
        out.push_str("  no limit is binding: every tolerance is at the loosest end of its range, or the next looser grade exceeds a limit\n");
    }
    out
}

fn judgement(d: &AllocationDocument) -> String {
    let Some(j) = &d.judgement else { return String::new() };
    let mut out = String::new();
    let model = d.model.name();
    if j.missed_percent > 1e-4 {
        let _ = writeln!(
            out,
            "  the first solution exceeded a limit by {} % according to the {model} model; {} further rounds \
            corrected this",
            fixed(j.missed_percent, 4),
            j.rounds
        );
    }
    if j.sampled_rounds > 0 {
        let _ = writeln!(
            out,
            "  samples refuted the first-order figures, so {} rounds tightened the tolerances further",
            j.sampled_rounds
        );
    }
    for r in d.requirements.iter().filter(|r| r.sampled.is_some()).take(MAX_LISTED) {
        let unit = r.unit.word();
        let _ = writeln!(
            out,
            "  {} at node ({}, {}): {} {unit} by samples of the nonlinear model",
            shown(&r.operation),
            r.node[0],
            r.node[1],
            fixed(r.sampled.unwrap_or(0.0), 4)
        );
    }
    if d.status == AllocationStatus::Exceeded {
        let _ = writeln!(out, "  NOT KEPT: a limit is still exceeded by {} %", fixed(j.excess_percent, 4));
    }
    out
}

fn shortfall(s: &ShortfallEntry) -> String {
    let unit = s.unit.word();
    let mut out = format!(
        "  {} at node ({}, {}): even the tightest tolerances give {} {unit}, {} {unit} above the limit of {}\n",
        shown(&s.operation),
        s.node[0],
        s.node[1],
        fixed(s.least, 4),
        fixed(s.excess, 4),
        rounded(s.limit, 6)
    );
    let bounds = s.in_the_way.iter().take(3).map(|b| {
        let tightest = rounded(b.tightest, 6);
        format!(
            "{} (at least {tightest} {}; without this error {} {unit})",
            b.parameter,
            b.unit.word(),
            fixed(b.without, 4)
        )
    });
    let _ = writeln!(out, "    in the way: {}", bounds.collect::<Vec<_>>().join(", "));
    out
}

/// Returns a list of the first names, and the number of further names.
fn few(names: &[String]) -> String {
    let first = names.iter().take(2 * MAX_LISTED).map(|name| shown(name)).collect::<Vec<_>>().join(", ");
    match names.len().saturating_sub(2 * MAX_LISTED) {
        0 => first,
        more => format!("{first} and {more} more"),
    }
}
