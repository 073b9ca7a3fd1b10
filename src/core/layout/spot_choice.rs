//! The choice of the spot of one operation, for evaluation and maps alike.
//!
//! A robust search judges a spot by its worst value. This is the maximum of the value as drawn and the values
//! at the corners of the placement tolerances. The point on the surface and the branch of the posture are the
//! same at all corners. Usable spots are judged in ascending order of their value as drawn, and the spot with
//! the least worst value is chosen. The worst value is never below the value as drawn. So the search ends
//! when the next spot's value as drawn reaches the least worst value found. At most [`MAX_NODES`] nodes are
//! judged; if the search ends at this number, a better spot may exist.

use super::misplacement::{BoxPoints, Moves, ToleranceBoxes};
use super::workcell::Workcell;
use crate::cell::Layout;
use crate::error_map::{HeldPosture, MapperWorkspace, Outcome, PlacedLayout, Probe, Spot, Status, Unjudged};
use crate::reach::Cost;

/// Greatest number of nodes judged at the corners of the placement tolerances.
const MAX_NODES: usize = 16;

/// Largest penalty of a spot whose posture cannot be used at a corner of the placement tolerances, m.
///
/// The penalty of an operation without a spot is larger.
const LOST_PENALTY: f64 = 0.1;

/// One operation whose spot is to be chosen in a placed layout.
pub struct SpotQuery<'a> {
    pub workcell: &'a Workcell,
    pub placed: &'a PlacedLayout<'a>,
    pub operation: usize,
    /// Spots of the earlier operations.
    pub spots: &'a [Option<Spot>],
}

/// Contribution of an operation's spot to the objective.
pub enum SpotValue {
    /// Value of the spot (m, rad, or share of failures); in a robust search, the worst value over the
    /// placement tolerances.
    Kept(f64),
    /// Penalty (m) of a spot whose posture cannot be used at a corner of the placement tolerances.
    Lost(f64),
}

impl SpotQuery<'_> {
    /// Chooses the least-error spot or, in a robust search, the spot with the least worst value.
    pub fn choose(&self, memory: &mut MapperWorkspace) -> (Outcome, Option<SpotValue>) {
        match self.placed.outcome(self.operation, self.spots, memory) {
            Outcome::Found(first) if self.workcell.cell.search.robust => {
                let (spot, value) = hardened(self, first, memory);
                (Outcome::Found(spot), Some(value))
            }
            Outcome::Found(spot) => (Outcome::Found(spot), Some(SpotValue::Kept(spot.value))),
            other => (other, None),
        }
    }
}

/// Returns the spot with the least worst value, and this value; `first` is the least-error spot.
///
/// If the operation happens at every node, there is no choice: the function returns `first`.
fn hardened(query: &SpotQuery<'_>, first: Spot, memory: &mut MapperWorkspace) -> (Spot, SpotValue) {
    let SpotQuery { workcell, placed, operation, spots } = *query;
    let corners = ToleranceBoxes::of(&workcell.cell, operation).moves(1.0, BoxPoints::Corners);
    let misplaced = |moves: &Moves| workcell.cell.misplaced(placed.layout(), moves);
    let layouts: Vec<Layout> = corners.iter().map(misplaced).collect();
    let placed_corners: Vec<PlacedLayout<'_>> =
        layouts.iter().map(|layout| workcell.placed(layout)).collect();
    let probe = |placed| Probe::new(placed, operation, spots);
    let mut corners = Corners { query, probes: placed_corners.iter().map(probe).collect() };
    if workcell.cell.operations[operation].over.needs_every_node() {
        let all = placed.every_free(operation, spots, memory).unwrap_or_default();
        let held: Vec<_> = all.iter().filter_map(|spot| held(query, spot)).collect();
        return (first, corners.worst(first.value, &held));
    }
    let mut least = LeastWorst { best: None, lost: LOST_PENALTY, judged: 0 };
    placed.free_spots(operation, spots, memory, |spot| {
        // The worst value of a spot is never below its value as drawn.
        if least.judged == MAX_NODES || least.best.is_some_and(|(worst, _)| spot.value >= worst) {
            return false;
        }
        least.note(spot, held(query, &spot).map(|held| corners.worst(spot.value, &[held])));
        true
    });
    match least.best {
        Some((worst, spot)) => (spot, SpotValue::Kept(worst)),
        None => (first, SpotValue::Lost(least.lost)),
    }
}

/// Least worst value so far with its spot, or the least penalty if every judged spot is unusable at some
/// corner.
struct LeastWorst {
    best: Option<(f64, Spot)>,
    lost: f64,
    judged: usize,
}

impl LeastWorst {
    fn note(&mut self, spot: Spot, worst: Option<SpotValue>) {
        self.judged += 1;
        match worst {
            Some(SpotValue::Kept(worst)) if self.best.is_none_or(|(least, _)| worst < least) => {
                self.best = Some((worst, spot));
            }
            Some(SpotValue::Lost(by)) => self.lost = self.lost.min(by),
            _ => {}
        }
    }
}

/// Returns the posture that the operation keeps at a spot while bodies are misplaced.
///
/// The joint coordinates are set only if the inverse kinematics is numeric.
fn held(query: &SpotQuery<'_>, spot: &Spot) -> Option<HeldPosture> {
    let at = query.workcell.mapper.grid(query.operation).local(spot.node);
    let joints = match query.workcell.inverse().cost() {
        Cost::Numeric => {
            Probe::new(query.placed, query.operation, query.spots).ok()?.joints(at, spot.branch)?
        }
        _ => Default::default(),
    };
    Some(HeldPosture { at, branch: spot.branch, joints })
}

/// Corners of the box of placement tolerances, each with a probe that evaluates the operation there.
struct Corners<'a> {
    query: &'a SpotQuery<'a>,
    probes: Vec<Result<Probe<'a>, Unjudged>>,
}

impl Corners<'_> {
    /// Computes the worst of the value as drawn and the values at the corners of the placement tolerances.
    ///
    /// The points and postures in `held` stay the same.
    fn worst(&mut self, drawn: f64, held: &[HeldPosture]) -> SpotValue {
        let (mut worst, mut lost) = (drawn, 0.0);
        let over = self.query.workcell.cell.operations[self.query.operation].over;
        let count = self.probes.len();
        for probe in &mut self.probes {
            let values: Result<Vec<f64>, Status> = match probe {
                Ok(probe) => held.iter().map(|held| probe.holding(held)).collect(),
                Err(why) => Err(Status::Unjudged(*why)),
            };
            match values {
                Ok(mut values) => worst = worst.max(over.of(&mut values)),
                Err(status) => lost += penalty(&status) / count as f64,
            }
        }
        if lost > 0.0 { SpotValue::Lost(lost) } else { SpotValue::Kept(worst) }
    }
}

/// Returns the penalty (m) of one corner of the placement tolerances at which the posture cannot be used.
///
/// The penalty is at most [`LOST_PENALTY`].
fn penalty(status: &Status) -> f64 {
    let share = match status {
        Status::OutOfReach { by } => 0.5 + by.min(0.5),
        Status::JointLimit { .. } | Status::Attitude { .. } | Status::NotConverged { .. } => 0.4,
        _ => 0.2,
    };
    LOST_PENALTY * share
}
