//! Cycle time of a layout.

use crate::assess::Assessment;
use crate::cell::Cell;
use crate::cycle_time::{ASSUMED_FULL_SPEED_AFTER, CyclePhase, CycleStep, CycleTime};
use crate::safe_text::shown;
use std::fmt::Write;

/// Returns the cycle time of a feasible layout and the steps of the cycle. If joint speeds are missing, the
/// text states which ones. The text is empty if the layout is not feasible.
pub fn cycle_time(a: &Assessment<'_>) -> String {
    if a.evaluation.objective.is_none() {
        return String::new();
    }
    if let Some(remedy) = a.cell.speed_remedy() {
        return format!("cycle time: unknown, because {}; {remedy}\n", without_speed(a.cell));
    }
    let Some(cycle) = a.cycle_time() else { return String::new() };
    let steps: Vec<String> = cycle.steps.iter().filter_map(|step| step_in_words(a.cell, step)).collect();
    let mut out = format!("{}\n", cycle_heading(&cycle));
    for line in steps.chunks(STEPS_PER_LINE) {
        let _ = writeln!(out, "  {}", line.join(", "));
    }
    for note in cycle_notes(a.cell, &cycle) {
        let _ = writeln!(out, "  {note}");
    }
    out
}

const STEPS_PER_LINE: usize = 4;

/// Returns the total time with the label "cycle time" or "time of the operations".
pub fn cycle_heading(cycle: &CycleTime) -> String {
    let name = if cycle.is_cycle { "cycle time" } else { "time of the operations" };
    let estimate = if cycle.is_assumed { ", an estimate" } else { "" };
    format!("{name}: {:.2} s{estimate}", cycle.total())
}

/// Returns notes on a cycle time: the parts that are assumed, not checked or not counted.
pub fn cycle_notes(cell: &Cell, cycle: &CycleTime) -> Vec<String> {
    let mut notes = Vec::new();
    if cycle.is_assumed {
        notes.push(format!(
            "estimate: joints without max_acceleration_deg_s2 are assumed to reach full speed in {ASSUMED_FULL_SPEED_AFTER} s; \
             full_speed_after_s of the robot changes this"
        ));
    }
    if cycle.steps.iter().any(|step| step.phase == CyclePhase::DirectMove) {
        notes.push(
            "the direct moves are not checked for collision: [transfer] check = true checks them".into(),
        );
    }
    if !cycle.is_cycle && cell.operations.len() > 1 {
        notes.push(
            "the way back to the first operation is not included: [transfer] cycle = true adds it".into(),
        );
    }
    notes
}

/// Returns a step in words; None for an operation without a dwell.
fn step_in_words(cell: &Cell, step: &CycleStep) -> Option<String> {
    if step.phase == CyclePhase::Dwell && step.time == 0.0 {
        return None;
    }
    Some(format!("{} {:.2} s", cycle_step_name(cell, step), step.time))
}

/// Returns the name of a step with its operations.
pub fn cycle_step_name(cell: &Cell, step: &CycleStep) -> String {
    let name = |k: usize| shown(&cell.operations[k].name);
    let next = step.next.map_or(String::new(), name);
    match step.phase {
        CyclePhase::Approach => format!("approach of {}", name(step.operation)),
        CyclePhase::Dwell => format!("dwell at {}", name(step.operation)),
        CyclePhase::Retract => format!("retract from {}", name(step.operation)),
        CyclePhase::Transfer => format!("{} to {next}", name(step.operation)),
        CyclePhase::DirectMove => format!("{} directly to {next}", name(step.operation)),
    }
}

/// Returns a clause that names the joints whose maximum speed is not given.
fn without_speed(cell: &Cell) -> String {
    let missing = cell.robot.joints_without_speed();
    let names: Vec<String> = missing.iter().map(|&k| shown(&cell.robot.joints[k].name)).collect();
    match missing.len() == cell.robot.joints.iter().filter(|joint| !joint.is_passive()).count() {
        true => "the maximum speeds of the joints are not given".into(),
        false => format!(
            "{} not given: {}",
            if names.len() == 1 { "the maximum speed of a joint is" } else { "maximum speeds of joints are" },
            names.join(", ")
        ),
    }
}
