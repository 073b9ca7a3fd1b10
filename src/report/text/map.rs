//! Summary of the error maps, operation by operation.

use super::check::{requirement_line, samples_line, yield_lines};
use super::{feasibility, mm1, percent, percent1};
use crate::assess::Assessment;
use crate::cell::{Cell, Model, Unit};
use crate::error_map::{Extrapolation, NodeSign, OperationMap};
use crate::kinematic_error::{Discrepancy, discrepancy};
use crate::reading::Figures;
use crate::record::value_word;
use crate::safe_text::shown;
use crate::units::deg_from_rad;
use std::fmt::Write;

/// Returns the summary of every map, of the motions between the operations, and of the feasibility.
pub fn maps(a: &Assessment<'_>) -> String {
    // The reasons why a layout is not feasible come before its error maps.
    let mut out = super::certificate(a);
    if a.evaluation.objective.is_none() {
        out.push_str(&feasibility(a));
    }
    for map in &a.maps {
        let _ = writeln!(out, "{}", map_summary(a, map));
    }
    for t in &a.evaluation.transfers {
        let [from, to] = [t.from, t.to].map(|k| &a.cell.operations[k].name);
        let travel = deg_from_rad(t.travel);
        let _ = writeln!(out, "from {from} to {to}: {}, {travel:.1} deg of joint travel", t.way.in_words());
    }
    out.push_str(&super::cycle_time(a));
    out.push_str(&yield_lines(a));
    out.push_str(&super::assumptions(a.cell));
    out
}

/// Returns the limit of an operation and the margin to it; None without a limit.
fn limit_in_words(a: &Assessment<'_>, operation: usize) -> Option<String> {
    Some(requirement_line(a.requirement(operation)?, a.cell.unit()))
}

fn map_summary(a: &Assessment<'_>, map: &OperationMap) -> String {
    let cell = a.cell;
    let operation = &cell.operations[map.operation];
    let surface = &cell.equipment[operation.equipment].name;
    let mut out = format!(
        "{} on {surface}: {} of {} nodes usable",
        operation.name,
        map.count(NodeSign::Usable),
        map.nodes.len()
    );
    for sign in NodeSign::ALL.into_iter().filter(|sign| !sign.is_usable() && map.count(*sign) > 0) {
        let _ = write!(out, ", {} {}", map.count(sign), sign.label());
    }
    let (sense, unit) = (&operation.sense.name, cell.unit());
    match map.best_node().and_then(|n| Some((n, n.posture.as_ref()?))) {
        Some((node, p)) => {
            let (x, y, z) = (mm1(node.position.x), mm1(node.position.y), mm1(node.position.z));
            let (word, value) = (value_word(cell), unit.from_si(p.value));
            let at = format!("at node ({}, {}), x {x} y {y} z {z} mm", node.i, node.j);
            let word_of_unit = unit.word();
            let _ = match map.value.filter(|_| operation.over.needs_every_node()) {
                Some(all) => write!(
                    out,
                    "\n  {word} in {sense}, {} of {}: {:.6} {word_of_unit}; the worst node {value:.6} {word_of_unit} {at}",
                    operation.over.name(),
                    operation.place.in_words(),
                    unit.from_si(all),
                ),
                None => write!(out, "\n  least {word} in {sense}: {value:.6} {word_of_unit} {at}"),
            };
            if let Some(said) = limit_in_words(a, map.operation) {
                let _ = write!(out, "\n  {said}");
            }
            if let Some(said) = refined_summary(a, map.operation) {
                let _ = write!(out, "\n  {said}");
            }
            if let Some(k) = map.sense(sense).filter(|k| p.figures[*k].worst.is_finite()) {
                let _ =
                    write!(out, "\n  at this node: {}", risk(&p.figures[k], operation.sense.unit, p.success));
            }
            if let Some(said) = samples_summary(a, map.operation) {
                let _ = write!(out, "\n  {said}");
            }
        }
        None => out.push_str("\n  no usable node"),
    }
    if map.best.is_some() {
        let _ = write!(out, "\n  {}", discrepancy_summary(map));
        let _ = write!(out, "\n  {}", guard_summary(cell, map));
    }
    out
}

/// Returns the spot refined between the nodes, and its gain over the best node.
fn refined_summary(a: &Assessment<'_>, k: usize) -> Option<String> {
    let (refined, unit) = (a.refined[k].as_ref()?, a.cell.unit());
    let [x, y, z] = [refined.position.x, refined.position.y, refined.position.z].map(mm1);
    let (u, v) = (mm1(refined.at.0), mm1(refined.at.1));
    let (value, word, gain) = (unit.from_si(refined.value), unit.word(), percent1(refined.gain()));
    let worst = refined.most.map_or(String::new(), |most| {
        format!(", at most {:.6} {word} within the placement tolerances,", unit.from_si(most))
    });
    Some(format!(
        "refined between the nodes: {value:.6} {word} ({gain} less){worst} at x {x} y {y} z {z} mm, on the surface x {u} y {v} mm"
    ))
}

/// Returns worst case, RMS and percentiles of the error at a spot.
fn risk(f: &Figures, unit: Unit, success: Option<f64>) -> String {
    let [worst, rms, p95, p99] = [f.worst, f.rms, f.p95, f.p99].map(|v| format!("{:.4}", unit.from_si(v)));
    let success = success.map_or(String::new(), |s| format!(", yield {s:.6}"));
    let unit = unit.word();
    format!("worst case {worst}, rms {rms}, p95 {p95}, p99 {p99} {unit}{success}")
}

/// Describes how well the Monte Carlo samples agree with the first-order figures.
fn samples_summary(a: &Assessment<'_>, k: usize) -> Option<String> {
    let samples = a.samples[k].as_ref()?;
    Some(samples_line(samples, a.cell.operations[k].sense.unit, a.first_order_holds(k)?))
}

/// Returns the largest difference of each model from the nonlinear model, and whether the chosen model can be
/// trusted.
fn guard_summary(cell: &Cell, map: &OperationMap) -> String {
    let most = |model| percent(map.off(model, cell.guard).0);
    let trust = distrust(cell, map)
        .unwrap_or_else(|| format!("the {} model can be trusted at every node", cell.model.name()));
    format!(
        "largest difference from the nonlinear model: linear {}, second-order {}; {trust}",
        most(Model::Linear),
        most(Model::SecondOrder)
    )
}

/// Returns the warning that the chosen model cannot be trusted; None if the model can be trusted at every
/// usable node.
pub fn distrust(cell: &Cell, map: &OperationMap) -> Option<String> {
    let (most, above, all) = map.off(cell.model, cell.guard);
    (above > 0).then(|| {
        format!(
            "do NOT trust the {} model at {above} of {all} nodes (off by up to {}, more than the guard of {})",
            cell.model.name(),
            percent(most),
            percent(cell.guard)
        )
    })
}

/// Returns the warning that errors are extrapolated outside the joint ranges of the calibration. Returns None
/// if no usable node has a posture outside these ranges.
pub fn extrapolation(cell: &Cell, map: &OperationMap) -> Option<String> {
    let found = Extrapolation::of(cell, map)?;
    let joints = found.joints.iter().map(|&joint| shown(&cell.robot.joints[joint].name));
    Some(format!(
        "the errors of {} of {} usable nodes{} are extrapolated, because these joints are outside the ranges of the measured postures: {}",
        found.nodes,
        found.usable,
        if found.has_spot { ", the spot among them," } else { "" },
        joints.collect::<Vec<_>>().join(", ")
    ))
}

/// Returns the largest discrepancy of the linear model. Section 4.3 of the seed paper claims at most 1 %.
fn discrepancy_summary(map: &OperationMap) -> String {
    let all: Vec<Discrepancy> = map.usable().map(|(_, _, p)| discrepancy(&p.nonlinear, &p.linear)).collect();
    let of = |f: fn(&Discrepancy) -> Option<f64>| {
        let values: Vec<f64> = all.iter().filter_map(f).collect();
        let most = values.iter().copied().fold(0.0, f64::max);
        (most, values.iter().filter(|&&v| v > 1.0).count())
    };
    let said = |name: &str, (most, above): (f64, usize)| match above {
        0 => format!("{name} {most:.3} %"),
        n => format!("{name} {most:.3} % (above 1 % at {n} node{})", if n == 1 { "" } else { "s" }),
    };
    let parts = [
        said("resultant", of(|d| d.resultant)),
        said("x", of(|d| d.x)),
        said("y", of(|d| d.y)),
        said("z", of(|d| d.z)),
    ];
    format!("largest discrepancy between linear and nonlinear model: {}", parts.join(", "))
}
