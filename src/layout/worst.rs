//! What a layout is worth if it may be misplaced: `evaluate` of a robust search.
//!
//! The value of an operation is its worst over the corners of the box of its placement tolerances, and as
//! drawn, with the point of the surface and the posture kept. Of the spots that touch nothing, from the
//! least value as drawn up, the one with the least worst value is chosen: exactly that of the first
//! [`FEW`] nodes, and of all if fewer do, for no spot can be worth less than it is as drawn.

use super::misplacement::{Boxes, Moves, Points, in_plan};
use super::{BLOCKED, Evaluation, INFEASIBLE, Workcell, Workspace, combined, shortfall, ways};
use crate::cell::Layout;
use crate::clearance::{Overlap, Party, PlacedSolids};
use crate::error_map::{Kept, Outcome, Probe, Spot, Status, Unjudged};
use crate::reach::Cost;

/// Nodes judged at the corners, at most.
const FEW: usize = 16;

/// What one lost corner of all costs, m: less than having no spot even as drawn.
const LOST: f64 = 0.1;

/// An operation at a spot if misplaced.
enum Worst {
    Value(f64),
    /// Its posture is lost somewhere; so much is missing (m), over all corners.
    Lost(f64),
}

pub(super) fn evaluate(workcell: &Workcell, layout: &Layout, workspace: &mut Workspace) -> Evaluation {
    let Workcell { cell, mapper, plan, scene, .. } = workcell;
    plan.overlaps(layout, &mut workspace.overlaps);
    scene.place(layout, &mut workspace.placed);
    let (mut outcomes, mut spots, mut values) = (Vec::new(), Vec::new(), Vec::new());
    let mut missing = 0.0;
    for k in 0..cell.operations.len() {
        let Workspace { placed, scratch, .. } = workspace;
        let mut outcome = mapper.outcome(k, layout, scene, placed, &spots, scratch);
        if let Outcome::Found(first) = outcome {
            let (spot, worst) = hardened(workcell, (k, first), layout, &spots, workspace);
            outcome = Outcome::Found(spot);
            match worst {
                Worst::Value(value) => values.push(value),
                Worst::Lost(by) => missing += by,
            }
        }
        spots.push(if let Outcome::Found(spot) = outcome { Some(spot) } else { None });
        outcomes.push(outcome);
    }
    let overlaps = workspace.overlaps.clone();
    // The ways between the spots are asked as drawn.
    let (transfers, blocked) = ways(mapper, &overlaps, (layout, scene, &workspace.placed), &spots);
    let apart = overlap_depth(workcell, layout, workspace).max(overlaps.iter().map(|o| o.depth).sum());
    let stands = apart == 0.0 && blocked.is_none() && values.len() == outcomes.len();
    let objective = stands.then(|| combined(cell, &values));
    let cost = objective.map(|objective| workcell.priced(objective, &values));
    let cost = cost.unwrap_or_else(|| {
        let shortfalls: f64 = outcomes.iter().map(|o| shortfall(cell, o)).sum();
        let blocked = if blocked.is_some() { BLOCKED } else { 0.0 };
        workcell.weight() * (INFEASIBLE + apart + blocked + shortfalls + missing)
    });
    Evaluation { overlaps, outcomes, transfers, blocked, objective, cost }
}

/// The deepest overlap of a layout that is misplaced, m. A table stands lower where the floor does: that
/// is no overlap with it.
fn overlap_depth(workcell: &Workcell, layout: &Layout, workspace: &mut Workspace) -> f64 {
    let found = &mut workspace.overlaps;
    if let Some(wide) = &workcell.wide {
        wide.overlaps(layout, found);
        if !found.iter().any(is_between_solids) {
            return 0.0;
        }
    }
    let depth = |moves: &Moves| {
        workcell.plan.overlaps(&workcell.cell.misplaced(layout, moves), found);
        found.iter().filter(|o| is_between_solids(o)).map(|o| o.depth).sum::<f64>()
    };
    in_plan(&workcell.cell).iter().map(depth).fold(0.0, f64::max)
}

/// Whether an overlap is with something else than the floor.
pub(super) fn is_between_solids(overlap: &Overlap) -> bool {
    ![overlap.a, overlap.b].contains(&Party::Floor)
}

/// The spot with the least worst value, and that; of an operation at all of its nodes, those.
fn hardened(
    workcell: &Workcell,
    (k, first): (usize, Spot),
    layout: &Layout,
    spots: &[Option<Spot>],
    workspace: &mut Workspace,
) -> (Spot, Worst) {
    let Workcell { cell, mapper, scene, .. } = workcell;
    let layouts: Vec<Layout> = Boxes::of(cell, k)
        .moves(1.0, Points::Corners)
        .iter()
        .map(|moves| cell.misplaced(layout, moves))
        .collect();
    let scenes: Vec<PlacedSolids> = layouts
        .iter()
        .map(|layout| {
            let mut placed = PlacedSolids::default();
            scene.place(layout, &mut placed);
            placed
        })
        .collect();
    let mut probes: Vec<Result<Probe<'_>, Unjudged>> = layouts
        .iter()
        .zip(&scenes)
        .map(|(layout, placed)| Probe::new((mapper, scene, placed), k, layout, spots))
        .collect();
    let Workspace { placed, scratch, .. } = workspace;
    if cell.operations[k].over.takes_all() {
        let all = mapper.every_free(k, layout, scene, placed, spots, scratch).unwrap_or_default();
        let kept: Vec<_> = all.iter().filter_map(|spot| kept(workcell, k, layout, spots, spot)).collect();
        return (first, worst_of(workcell, k, first.value, &kept, &mut probes));
    }
    let mut least = Least { best: None, lost: LOST, judged: 0 };
    mapper.free_spots((k, layout), scene, placed, spots, scratch, |spot| {
        // Nothing is worth less misplaced than as drawn.
        if least.judged == FEW || least.best.is_some_and(|(worst, _)| spot.value >= worst) {
            return false;
        }
        let kept = kept(workcell, k, layout, spots, &spot);
        least.note(spot, kept.map(|kept| worst_of(workcell, k, spot.value, &[kept], &mut probes)));
        true
    });
    match least.best {
        Some((worst, spot)) => (spot, Worst::Value(worst)),
        None => (first, Worst::Lost(least.lost)),
    }
}

/// The least worst value so far and its spot; if there is none, how little is missing.
struct Least {
    best: Option<(f64, Spot)>,
    lost: f64,
    judged: usize,
}

impl Least {
    fn note(&mut self, spot: Spot, worst: Option<Worst>) {
        self.judged += 1;
        match worst {
            Some(Worst::Value(worst)) if self.best.is_none_or(|(least, _)| worst < least) => {
                self.best = Some((worst, spot));
            }
            Some(Worst::Lost(by)) => self.lost = self.lost.min(by),
            _ => {}
        }
    }
}

/// A spot as something to keep; joints where the branches have no lasting numbers.
fn kept(workcell: &Workcell, k: usize, layout: &Layout, spots: &[Option<Spot>], spot: &Spot) -> Option<Kept> {
    let at = workcell.mapper.local(k, spot.node);
    let mut joints = Default::default();
    if workcell.inverse().cost() == Cost::Numeric {
        let mut placed = PlacedSolids::default();
        workcell.scene.place(layout, &mut placed);
        let station = (&workcell.mapper, &*workcell.scene, &placed);
        joints = Probe::new(station, k, layout, spots).ok()?.joints(at, spot.branch)?;
    }
    Some(Kept { at, branch: spot.branch, joints })
}

/// The worst value of an operation whose points and postures are kept, as drawn and at every corner.
fn worst_of(
    workcell: &Workcell,
    k: usize,
    drawn: f64,
    kept: &[Kept],
    probes: &mut [Result<Probe<'_>, Unjudged>],
) -> Worst {
    let (mut worst, mut missing) = (drawn, 0.0);
    let over = workcell.cell.operations[k].over;
    let corners = probes.len();
    for probe in probes {
        let values: Result<Vec<f64>, Status> = match probe {
            Ok(probe) => kept.iter().map(|kept| probe.keeping(kept)).collect(),
            Err(why) => Err(Status::Unjudged(*why)),
        };
        match values {
            Ok(mut values) => worst = worst.max(over.of(&mut values)),
            Err(status) => missing += loss(&status) / corners as f64,
        }
    }
    if missing > 0.0 { Worst::Lost(missing) } else { Worst::Value(worst) }
}

/// What a lost corner counts, up to [`LOST`].
fn loss(status: &Status) -> f64 {
    let share = match status {
        Status::OutOfReach { by } => 0.5 + by.min(0.5),
        Status::JointLimit { .. } | Status::Attitude { .. } | Status::NotConverged { .. } => 0.4,
        _ => 0.2,
    };
    LOST * share
}
