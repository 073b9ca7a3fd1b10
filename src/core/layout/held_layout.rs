//! Held layout: a layout whose operations keep their spots while the robot base or equipment is placed
//! elsewhere.
//!
//! The node and the branch of every operation do not change, so that a drawing with the spots remains valid.
//! An operation at every node keeps no posture: at each of its nodes, the best posture of the node is used.

use super::certify::is_between_solids;
use super::ending::Ending;
use super::evaluation::{Evaluation, evaluate};
use super::held_judgement::{HeldSpot, HeldSpots, Judgement, JudgementMemory, OperationValue};
use super::workcell::Workcell;
use crate::cell::{Layout, Unit};
use crate::certificate::Misplacements;
use crate::clearance::{Overlap, PlacedSolids};
use crate::error_map::{HeldPosture, MapperWorkspace, Outcome, PlacedLayout, Spot};
use std::sync::OnceLock;

/// Layout whose operations keep their spots while the robot base or equipment is placed elsewhere.
pub struct HeldLayout<'a> {
    workcell: &'a Workcell,
    layout: &'a Layout,
    /// Objective of the layout (m, rad, share of failures, or cost of tolerances).
    pub objective: f64,
    held: HeldSpots,
    /// Posture that each operation keeps; None for an operation at every node.
    kept: Vec<Option<HeldPosture>>,
    /// Values of the operations in the layout, computed when they are first needed. The inner option is None
    /// if they cannot be computed.
    own: OnceLock<Option<Vec<OperationValue>>>,
}

/// Spot and values of every operation that is independent of a moved piece of equipment; None for any other
/// operation.
pub struct Uncarried(Vec<Option<OperationValue>>);

/// Memory that one thread reuses from judgement to judgement.
#[derive(Default)]
pub struct HeldMemory {
    overlaps: Vec<Overlap>,
    solids: PlacedSolids,
    misplacements: Misplacements,
    spots: JudgementMemory,
}

impl<'a> HeldLayout<'a> {
    /// Evaluates a layout and keeps its spots. Returns None if the layout is not feasible or misses a
    /// limit.
    pub fn new(workcell: &'a Workcell, layout: &'a Layout) -> Option<Self> {
        Self::holding(workcell, layout, &evaluate(workcell, layout))
    }

    /// Keeps the spots of an evaluated layout. Returns None if the layout is not feasible or misses a
    /// limit.
    pub fn holding(workcell: &'a Workcell, layout: &'a Layout, evaluation: &Evaluation) -> Option<Self> {
        let objective = evaluation.objective.filter(|_| evaluation.is_accepted())?;
        let found = |outcome: &Outcome| if let Outcome::Found(spot) = outcome { Some(*spot) } else { None };
        let all: Vec<Option<Spot>> = evaluation.outcomes.iter().map(found).collect();
        let placed = workcell.placed(layout);
        let held = |(k, spot): (usize, &Option<Spot>)| {
            if workcell.cell.operations[k].over.needs_every_node() {
                return Some(HeldSpot::EveryNode);
            }
            let Spot { node, branch, .. } = (*spot)?;
            let at = workcell.mapper.grid(k).local(node);
            Some(HeldSpot::Spot { node, posture: placed.hold(k, at, branch)? })
        };
        let spots = all.iter().enumerate().map(held).collect::<Option<Vec<_>>>()?;
        let posture = |spot: &HeldSpot| match spot {
            HeldSpot::Spot { posture, .. } => Some(*posture),
            HeldSpot::EveryNode => None,
        };
        let kept = spots.iter().map(posture).collect();
        let is_priced = workcell.cell.unit() == Unit::Cost;
        let price = is_priced.then(|| placed.nearby_price(&all, &mut MapperWorkspace::default())).flatten();
        let held = HeldSpots { spots, price };
        Some(Self { workcell, layout, objective, held, kept, own: OnceLock::new() })
    }

    /// Returns the workcell of the layout.
    pub fn workcell(&self) -> &'a Workcell {
        self.workcell
    }

    /// Returns the layout whose spots are kept.
    pub fn layout(&self) -> &'a Layout {
        self.layout
    }

    /// Judges another layout whose operations keep the spots of this layout. Returns the objective of the
    /// other layout (m, rad, share of failures, or cost of tolerances). A returned objective never exceeds
    /// the argument `most`. If the objective is the cost of tolerances, the result may be an upper bound of
    /// the least cost.
    ///
    /// # Errors
    /// Returns the first reason why the layout is infeasible, misses a limit, or has an objective above
    /// `most`.
    pub fn judge(&self, layout: &Layout, most: f64, memory: &mut HeldMemory) -> Result<f64, Ending> {
        self.judged(layout, memory, |placed, memory| {
            Ok(self.judgement(placed, most, None, false).kept(memory)?.1)
        })
    }

    /// Estimates the result of [`Self::judge`] for a layout with one moved piece of equipment.
    ///
    /// `known` holds the values of the operations that are independent of this equipment. The estimate does
    /// not check whether the moved equipment obstructs these operations or the transfers.
    ///
    /// # Errors
    /// Returns the first reason against the layout, as [`Self::judge`] does.
    pub fn estimate_moved(
        &self,
        layout: &Layout,
        most: f64,
        Uncarried(known): &Uncarried,
        memory: &mut HeldMemory,
    ) -> Result<f64, Ending> {
        self.judged(layout, memory, |placed, memory| {
            Ok(self.judgement(placed, most, Some(known), true).kept(memory)?.1)
        })
    }

    /// Judges a layout with one moved piece of equipment, as [`Self::judge`] does, but faster. The judgement
    /// begins with [`Self::estimate_moved`]. If the estimate gives no reason against the layout, the
    /// judgement continues. It then checks the operations that are independent of this equipment, and the
    /// transfers.
    ///
    /// # Errors
    /// Returns the first reason against the layout, as [`Self::judge`] does.
    pub fn judge_moved(
        &self,
        layout: &Layout,
        most: f64,
        Uncarried(known): &Uncarried,
        memory: &mut HeldMemory,
    ) -> Result<f64, Ending> {
        self.judged(layout, memory, |placed, memory| {
            let estimate = self.judgement(placed, most, Some(known), true);
            let (values, _) = estimate.kept(memory)?;
            let is_carried = known.iter().map(Option::is_none);
            let carried: Vec<_> = values.into_iter().zip(is_carried).map(|(v, c)| c.then_some(v)).collect();
            let rest = Judgement { known: Some(&carried), is_estimate: false, ..estimate };
            Ok(rest.kept(memory)?.1)
        })
    }

    /// Returns the spot and the values of every operation that is independent of the equipment with the index
    /// `equipment`. The values are those in the layout whose spots are kept ([`Self::layout`]). Returns None
    /// if [`Self::judge`] refuses this layout.
    pub fn uncarried(&self, equipment: usize, memory: &mut HeldMemory) -> Option<Uncarried> {
        let cell = &self.workcell.cell;
        let own = || {
            let most = f64::INFINITY;
            let found = self.judged(self.layout, memory, |placed, memory| {
                self.judgement(placed, most, None, true).values(memory)
            });
            found.ok().map(|(values, _)| values)
        };
        let values = self.own.get_or_init(own).as_ref()?;
        let depends = |k: usize| cell.rides_on(cell.operations[k].equipment, equipment);
        let carried = |k: usize| depends(k) || cell.operations[k].relative_to.is_some_and(depends);
        Some(Uncarried(values.iter().enumerate().map(|(k, v)| (!carried(k)).then(|| v.clone())).collect()))
    }

    /// Returns the judgement of a placed layout. The arguments are fields of [`Judgement`].
    fn judgement<'j>(
        &'j self,
        placed: &'j PlacedLayout<'j>,
        most: f64,
        known: Option<&'j [Option<OperationValue>]>,
        is_estimate: bool,
    ) -> Judgement<'j> {
        Judgement { workcell: self.workcell, held: &self.held, placed, most, known, is_estimate }
    }

    /// Places a layout whose floor spaces do not overlap, and passes it to `judge`.
    ///
    /// # Errors
    /// Returns the first overlap of floor spaces, or the error of `judge`.
    fn judged<T>(
        &self,
        layout: &Layout,
        memory: &mut HeldMemory,
        judge: impl FnOnce(&PlacedLayout<'_>, &mut JudgementMemory) -> Result<T, Ending>,
    ) -> Result<T, Ending> {
        let HeldMemory { overlaps, solids, misplacements, spots } = memory;
        let workcell = self.workcell;
        if let Some(overlap) = first_overlap(workcell, layout, overlaps) {
            return Err(Ending::Overlap(overlap));
        }
        let demand = workcell.certifies().then(|| {
            misplacements.set(&workcell.cell, layout, workcell.cell.robot.reach());
            workcell.demand(misplacements)
        });
        let placed =
            PlacedLayout::reusing(&workcell.mapper, layout, std::mem::take(solids)).demanding(demand);
        let placed = placed.keeping(&self.kept);
        let found = judge(&placed, spots);
        *solids = placed.into_solids();
        found
    }
}

/// Returns the first overlap that makes a layout infeasible.
fn first_overlap(workcell: &Workcell, layout: &Layout, found: &mut Vec<Overlap>) -> Option<Overlap> {
    if workcell.certifies() {
        workcell.wide.overlaps(layout, found);
        if found.is_empty() {
            return None;
        }
        if let Some(overlap) = found.iter().find(|o| is_between_solids(o)) {
            return Some(*overlap);
        }
    }
    workcell.plan.overlaps(layout, found);
    found.first().copied()
}
