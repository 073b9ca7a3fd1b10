//! Feasibility of a layout, and the reasons if it is infeasible. Only operations without a spot are mapped.

use super::posture_context::no_usable_node;
use crate::cell::{Cell, Layout};
use crate::clearance::Overlap;
use crate::error_map::{OperationMap, Outcome};
use crate::layout::{Evaluation, Workcell, evaluate, separated};
use crate::safe_text::shown;
use crate::units::mm_from_m;

/// Evaluation of a layout with the reasons why it is infeasible.
///
/// Only the errors that the search minimizes are computed. An [`Assessment`](super::Assessment) computes many
/// more errors at every node.
pub struct Feasibility {
    pub evaluation: Evaluation,
    /// Reasons why the layout is infeasible, in words; empty if it is feasible.
    pub reasons: Vec<String>,
}

impl Feasibility {
    /// Evaluates one layout.
    pub fn new(workcell: &Workcell, layout: &Layout) -> Self {
        let evaluation = evaluate(workcell, layout);
        if evaluation.objective.is_some() {
            return Self { evaluation, reasons: Vec::new() };
        }
        let apart = if evaluation.overlaps.is_empty() { None } else { separated(workcell, layout) };
        let maps = workcell.maps_without_spot(layout);
        let reasons = reasons(&workcell.cell, layout, &evaluation, apart.as_ref(), maps.iter());
        Self { evaluation, reasons }
    }
}

/// Returns why a layout is infeasible, in words; empty if it is feasible.
///
/// `apart` is the nearest layout without overlaps. `spotless` are the maps of the operations without a spot.
pub fn reasons<'m>(
    cell: &Cell,
    layout: &Layout,
    evaluation: &Evaluation,
    apart: Option<&Layout>,
    spotless: impl Iterator<Item = &'m OperationMap>,
) -> Vec<String> {
    if let Some(misfit) = &evaluation.misfit {
        return vec![misfit.in_words(cell)];
    }
    let overlaps = evaluation.overlaps.iter().map(|o| o.in_words(cell));
    let apart = apart.map(|apart| nearest_without_overlap(cell, layout, apart));
    // An operation that has a spot but no certificate is reported by `misplaced`.
    let is_certain = |map: &&OperationMap| {
        !matches!(evaluation.outcomes.get(map.operation), Some(Outcome::Uncertain { .. }))
    };
    let spotless = spotless.filter(is_certain).map(|map| no_usable_node(cell, map));
    let blocked = evaluation.blocked.iter().map(|b| b.in_words(cell));
    let misplaced = misplaced(cell, evaluation);
    overlaps.chain(apart).chain(spotless).chain(blocked).chain(misplaced).collect()
}

/// Returns, in words, the reasons that arise only from misplacements within the placement tolerances.
fn misplaced(cell: &Cell, evaluation: &Evaluation) -> Vec<String> {
    let within = "within the placement tolerances";
    let near = evaluation.near.iter().filter(|near| {
        let is_drawn = |o: &&Overlap| (o.a, o.b) == (near.a, near.b);
        !evaluation.overlaps.iter().any(|o| is_drawn(&o))
    });
    let near = near.map(|o| format!("{within}: {}", o.in_words(cell)));
    let named = |k: usize| shown(&cell.operations[k].name);
    let uncertain = evaluation.outcomes.iter().enumerate().filter_map(|(k, outcome)| match outcome {
        Outcome::Uncertain { why, .. } => Some(format!("{within}: {}: {}", named(k), why.in_words(cell))),
        _ => None,
    });
    near.chain(uncertain).collect()
}

/// Describes in words where to move overlapping equipment: the nearest placements found without overlap.
fn nearest_without_overlap(cell: &Cell, layout: &Layout, apart: &Layout) -> String {
    let moves = cell.equipment.iter().zip(layout.placements.iter().zip(&apart.placements));
    let moved = moves.filter(|(_, (from, to))| from != to).map(|(e, (_, to))| {
        let world = if e.on.is_some() { " (world)" } else { "" };
        format!("{} at x {:.1}, y {:.1} mm{world}", e.name, mm_from_m(to.x), mm_from_m(to.y))
    });
    format!("nearest overlap-free placements found: {}", moved.collect::<Vec<_>>().join("; "))
}
