//! One candidate: [`evaluate`] a [`Layout`]. The seam that search, what-ifs and reports share.

mod goals;
mod misplacement;
mod refine;
mod robust;
mod separate;
mod worst;

pub use goals::FAR;
pub use misplacement::Moves;
pub use refine::Refined;
pub use robust::{Corner, Ended, Largest, Lost, Robustness};
pub use separate::separated;

use crate::cell::{Cell, Interpretation, Layout, Objective, QuestionFault, Unit};
use crate::clearance::{FloorPlan, Overlap, PlacedSolids, Remember, Scene, SelfCollisionPair};
use crate::error_map::{Mapper, OperationMap, Outcome, PostureRecord, Scratch, Spot, Unjudged};
use crate::motion::{Blocked, Transfer};
use crate::reach::Inverse;
use crate::reading::{ErrorEvaluator, WorkContext};
use crate::robot::Frames;
use std::sync::Arc;

/// Added to the cost of every infeasible layout, times the weights: more than any weighted error in
/// m, so that no infeasible layout ever ranks before a feasible one.
const INFEASIBLE: f64 = 1e3;
/// The same for a layout that misses a limit: worse than every layout that keeps its limits, better than
/// every infeasible one.
const MISSES: f64 = 1e2;
/// What an operation without a spot costs at least (m): being out of reach is worse than passing a
/// joint limit, which is worse than colliding everywhere.
const COLLIDES: f64 = 0.5;
/// Of postures that touch nothing but cannot be used; of ways between spots.
const REFUSED: f64 = 0.4;
const BLOCKED: f64 = 0.25;
const UNJUDGED: f64 = 0.75;
const PASSES_LIMIT: f64 = 1.0;
const OUT_OF_REACH: f64 = 2.0;

/// A cell made ready: chain, inverse kinematics, errors, solids.
pub struct Workcell {
    pub cell: Cell,
    mapper: Mapper,
    plan: Arc<FloorPlan>,
    /// What has no overlap here has none wherever it is misplaced; of a robust search alone.
    wide: Option<Arc<FloorPlan>>,
    scene: Arc<Scene>,
}

/// What a layout is worth. A value for every layout: an infeasible one says why.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    pub overlaps: Vec<Overlap>,
    /// One per operation.
    pub outcomes: Vec<Outcome>,
    /// Between consecutive operations, if the cell asks for them and nothing else is amiss.
    pub transfers: Vec<Transfer>,
    /// The first of them that is not to be had.
    pub blocked: Option<Blocked>,
    /// Weighted values of the operations (m, rad or shares), of a robust search the worst over the
    /// placement tolerances; None if the layout is infeasible.
    pub objective: Option<f64>,
    /// Finite for every layout: the objective; if a limit is missed, 100 times the weights and more; if
    /// the layout is infeasible, 1000 times and more, falling towards feasibility.
    pub cost: f64,
}

impl Evaluation {
    /// Whether the layout is feasible and keeps every limit: what a search looks for.
    pub fn is_accepted(&self) -> bool {
        self.objective == Some(self.cost)
    }
}

/// Memory reused from layout to layout by one thread.
#[derive(Default)]
pub struct Workspace {
    overlaps: Vec<Overlap>,
    placed: PlacedSolids,
    scratch: Scratch,
}

impl Workcell {
    /// # Errors
    /// Why the robot cannot be used.
    pub fn new(cell: Cell) -> Result<Self, String> {
        Self::remembering(cell, &mut |_, compute| compute())
    }

    /// The same, with what takes long to compute kept elsewhere.
    ///
    /// # Errors
    /// Why the robot cannot be used.
    pub fn remembering(cell: Cell, remember: &mut Remember<'_>) -> Result<Self, String> {
        let mapper = Mapper::new(&cell)?;
        let plan = Arc::new(FloorPlan::new(&cell));
        let scene = Arc::new(Scene::remembering(&cell, remember));
        let wide = cell.search.robust.then(|| {
            let clearance = cell.clearance + misplacement::slack(&cell);
            Arc::new(FloorPlan::new(&Cell { clearance, ..cell.clone() }))
        });
        Ok(Self { cell, mapper, plan, wide, scene })
    }

    /// Returns this workcell under another interpretation of its errors; the solids are shared.
    ///
    /// # Errors
    /// Why the question has no answer, or why the robot cannot be used.
    pub fn interpreted(&self, interpretation: &Interpretation) -> Result<Self, String> {
        self.sharing(self.cell.asked(interpretation).map_err(|faults| first_of(&faults))?)
    }

    /// Returns this workcell under another interpretation, in which each operation is judged alone.
    ///
    /// # Errors
    /// As [`Workcell::interpreted`]; units that cannot be added up are no fault.
    pub fn interpreted_apart(&self, interpretation: &Interpretation) -> Result<Self, String> {
        self.sharing(self.cell.asked_apart(interpretation).map_err(|faults| first_of(&faults))?)
    }

    /// Returns a workcell of the same solids and placements as this one.
    fn sharing(&self, cell: Cell) -> Result<Self, String> {
        let mapper = Mapper::new(&cell)?;
        Ok(Self { cell, mapper, plan: self.plan.clone(), wide: self.wide.clone(), scene: self.scene.clone() })
    }

    /// The same cell with every node judged one by one, to compare with: slower, and the same bits.
    #[must_use]
    pub fn unranked(mut self) -> Self {
        self.mapper.forget_ranks();
        self
    }

    /// The same cell whose maps tell of the own sense of every operation alone: several times faster.
    #[must_use]
    pub fn in_own_senses(mut self) -> Self {
        self.mapper.report_own_senses();
        self
    }

    /// Whether the nodes of every operation are ranked before they are judged.
    pub fn is_ranked(&self) -> bool {
        self.mapper.is_ranked()
    }

    /// Every pair of solids of the robot, and why it may touch; none if it is not checked.
    pub fn self_collision_pairs(&self) -> &[SelfCollisionPair] {
        self.scene.self_collision_pairs()
    }

    /// What the weights multiply errors by in the objective: their sum, or the largest of them.
    pub fn weight(&self) -> f64 {
        let weights = self.cell.operations.iter().map(|o| o.weight);
        match self.cell.search.objective {
            Objective::WeightedSum => weights.sum(),
            Objective::WeightedMaximum => weights.fold(0.0, f64::max),
            Objective::Lexicographic => 1.0,
        }
    }

    /// What a feasible layout costs with these values of its operations: its objective, or more than that
    /// of any layout that keeps its limits.
    fn priced(&self, objective: f64, values: &[f64]) -> f64 {
        let limited = self.cell.operations.iter().zip(values).filter(|_| self.cell.unit() != Unit::Share);
        let excess = limited.filter_map(|(o, value)| o.limit.map(|limit| (value - limit).max(0.0)));
        match excess.sum::<f64>() {
            excess if excess > 0.0 => self.weight() * (MISSES + excess),
            _ => objective,
        }
    }

    pub fn inverse(&self) -> &Inverse {
        self.mapper.inverse()
    }

    /// How an operation judges postures.
    pub fn gauge(&self, operation: usize) -> &ErrorEvaluator {
        self.mapper.gauge(operation)
    }

    /// A posture of a map, with what its errors depend on in that layout.
    ///
    /// # Errors
    /// What is missing.
    pub fn posed(
        &self,
        layout: &Layout,
        maps: &[OperationMap],
        operation: usize,
        posture: &PostureRecord,
    ) -> Result<(WorkContext, Frames), Unjudged> {
        let mut placed = PlacedSolids::default();
        self.scene.place(layout, &mut placed);
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let situation = self.mapper.situation(operation, layout, &self.scene, &placed, &spots)?;
        Ok((situation, self.mapper.frames(&posture.joints)))
    }

    /// The error map of every operation. Nodes on equipment that overlaps something are blocked.
    pub fn maps(&self, layout: &Layout) -> Vec<OperationMap> {
        let mut placed = PlacedSolids::default();
        self.scene.place(layout, &mut placed);
        let mut overlaps = Vec::new();
        self.plan.overlaps(layout, &mut overlaps);
        let hardened = if self.cell.search.robust { evaluate(self, layout).outcomes } else { Vec::new() };
        let mut maps: Vec<OperationMap> = Vec::new();
        for (k, operation) in self.cell.operations.iter().enumerate() {
            let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
            let mut map = self.mapper.map(k, layout, &self.scene, &placed, &spots);
            if let Some(overlap) = overlaps.iter().find(|o| o.concerns(operation.equipment)) {
                map.block(*overlap);
            }
            // A robust search chooses otherwise.
            if let (Some(_), Some(Outcome::Found(spot))) = (map.best, hardened.get(k)) {
                (map.best, map.value) = (Some(spot.node), Some(spot.value));
            }
            maps.push(map);
        }
        maps
    }
}

/// Evaluates one layout: overlaps, reach, limits, errors, collisions. Pure and total: the same
/// layout gives the same bits, and every layout gives a value.
pub fn evaluate(workcell: &Workcell, layout: &Layout) -> Evaluation {
    evaluate_in(workcell, layout, &mut Workspace::default())
}

/// [`evaluate`] with memory that is kept from call to call.
pub fn evaluate_in(workcell: &Workcell, layout: &Layout, workspace: &mut Workspace) -> Evaluation {
    if workcell.cell.search.robust {
        return worst::evaluate(workcell, layout, workspace);
    }
    let Workcell { cell, mapper, plan, scene, .. } = workcell;
    let Workspace { overlaps: found, placed, scratch } = workspace;
    plan.overlaps(layout, found);
    scene.place(layout, placed);
    let mut outcomes = Vec::with_capacity(cell.operations.len());
    let mut spots = Vec::with_capacity(cell.operations.len());
    for k in 0..cell.operations.len() {
        let outcome = mapper.outcome(k, layout, scene, placed, &spots, scratch);
        spots.push(if let Outcome::Found(spot) = outcome { Some(spot) } else { None });
        outcomes.push(outcome);
    }
    let (transfers, blocked) = ways(mapper, found, (layout, scene, placed), &spots);
    let usable = found.is_empty() && blocked.is_none();
    let objective = if usable { objective(cell, &outcomes) } else { None };
    let cost = objective.map(|objective| workcell.priced(objective, &values(&outcomes)));
    let cost = cost.unwrap_or_else(|| {
        let apart: f64 = found.iter().map(|o| o.depth).sum();
        let blocked = if blocked.is_some() { BLOCKED } else { 0.0 };
        let short = outcomes.iter().map(|o| shortfall(cell, o)).sum::<f64>();
        workcell.weight() * (INFEASIBLE + apart + blocked + short)
    });
    Evaluation { overlaps: found.clone(), outcomes, transfers, blocked, objective, cost }
}

/// Returns the first fault in one line.
fn first_of(faults: &[QuestionFault]) -> String {
    faults.first().map_or(String::new(), |fault| format!("{}; {}", fault.message, fault.help))
}

/// The ways between the operations of a layout without overlaps, or the first that is blocked.
fn ways(
    mapper: &Mapper,
    overlaps: &[Overlap],
    (layout, scene, placed): (&Layout, &Scene, &PlacedSolids),
    spots: &[Option<Spot>],
) -> (Vec<Transfer>, Option<Blocked>) {
    if !overlaps.is_empty() {
        return (Vec::new(), None);
    }
    match mapper.transfers(layout, scene, placed, spots) {
        Ok(transfers) => (transfers, None),
        Err(blocked) => (Vec::new(), Some(blocked)),
    }
}

/// The errors of all operations as one number, None if an operation has no spot.
fn objective(cell: &Cell, outcomes: &[Outcome]) -> Option<f64> {
    let values = values(outcomes);
    (values.len() == outcomes.len()).then(|| combined(cell, &values))
}

/// Of the operations that have a spot.
fn values(outcomes: &[Outcome]) -> Vec<f64> {
    let value = |outcome: &Outcome| if let Outcome::Found(spot) = outcome { Some(spot.value) } else { None };
    outcomes.iter().filter_map(value).collect()
}

/// The values of all operations (m, rad or shares) as one: the objective of the cell. It falls when any
/// of them falls, so that the values of bounds make the value of a bound.
pub fn combined(cell: &Cell, values: &[f64]) -> f64 {
    let weighted = cell.operations.iter().zip(values).map(|(operation, value)| operation.weight * value);
    match cell.search.objective {
        Objective::WeightedSum => weighted.sum(),
        Objective::WeightedMaximum => weighted.fold(0.0, |a, b| b.max(a)),
        Objective::Lexicographic => lexicographic(values, cell.search.indifference),
    }
}

/// Values that differ by less than this are one step of [`lexicographic`] (m, rad or a share), ...
const STEP_FROM: f64 = 1e-9;
/// ... and the value at which a later operation uses up half of a step.
const HALF_STEP: f64 = 1e-3;

/// The first value, in steps that are `indifference` (a share of it) wide; within a step the second,
/// in the same way, and so on. A search sees one number, near the first value and rising with each.
fn lexicographic(values: &[f64], indifference: f64) -> f64 {
    let [first, later @ ..] = values else { return 0.0 };
    if later.is_empty() {
        return *first;
    }
    let step = (first / STEP_FROM).max(1.0).ln() / indifference.ln_1p();
    let edge = |step: f64| STEP_FROM * (1.0 + indifference).powf(step.floor());
    let (low, high) = (edge(step), edge(step + 1.0));
    let rest = lexicographic(later, indifference);
    low + (high - low) * rest / (rest + HALF_STEP)
}

/// How far an operation is from having a spot, m.
fn shortfall(cell: &Cell, outcome: &Outcome) -> f64 {
    match outcome {
        Outcome::Found(_) => 0.0,
        Outcome::AllCollide { .. } => COLLIDES,
        Outcome::Refused { .. } => REFUSED,
        Outcome::Unjudged(_) => UNJUDGED,
        Outcome::Unreachable { gap } if gap.reach > 0.0 => OUT_OF_REACH + gap.reach.min(INFEASIBLE),
        // The excess is a sum of cosines; the reach makes it a length.
        Outcome::Unreachable { gap } => {
            PASSES_LIMIT + (gap.limits.min(4.0) / 4.0) * cell.robot.reach().min(1.0)
        }
    }
}
