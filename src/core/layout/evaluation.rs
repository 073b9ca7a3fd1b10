//! Evaluation of one layout: overlaps, reach, limits, errors, collisions and the resulting cost.

use super::certify::is_between_solids;
use super::spot_choice::{SpotChoice, SpotMemory, SpotQuery, SpotValue, penalty};
use super::workcell::Workcell;
use crate::cell::{Cell, Layout, Misfit};
use crate::certificate::Misplacements;
use crate::clearance::{Overlap, PlacedSolids};
use crate::error_map::{MapperWorkspace, Outcome, PlacedLayout, Spot, Unjudged, WalkCounts};
use crate::motion::{Blocked, Transfer};

/// Penalty of every infeasible layout, as a multiple of [`Workcell::weight`].
///
/// The penalty is greater than any weighted error in m, so that no infeasible layout ranks before a
/// feasible layout.
const INFEASIBLE_PENALTY: f64 = 1e3;

// Penalties of an operation without a spot, m. Being out of reach costs more than exceeding a joint limit.
// Exceeding a joint limit costs more than colliding in every posture.
const OUT_OF_REACH_PENALTY: f64 = 2.0;
const JOINT_LIMIT_PENALTY: f64 = 1.0;
const UNJUDGED_PENALTY: f64 = 0.75;
const COLLISION_PENALTY: f64 = 0.5;
const REFUSED_PENALTY: f64 = 0.4;
/// Penalty of a blocked transfer between operations, m.
const BLOCKED_PENALTY: f64 = 0.25;

/// Evaluation of a layout: the cost, and the reasons if the layout is infeasible.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// Reason why the layout does not belong to the cell, such as a wrong number of placements. None if the
    /// layout belongs to the cell. No operation is judged in a layout that does not belong to the cell.
    pub misfit: Option<Misfit>,
    pub overlaps: Vec<Overlap>,
    /// Pairs of floor spaces that may overlap, or come nearer than the clearance, at a misplacement inside
    /// the placement tolerances.
    pub near: Vec<Overlap>,
    /// Outcome of each operation.
    pub outcomes: Vec<Outcome>,
    /// Spots of each operation that happens at every node: one spot per node, in the order of the nodes. An
    /// entry is None for any other operation, or if a node cannot be used. An entry is also None if the
    /// evaluation does not need these spots.
    pub every_node: Vec<Option<Vec<Spot>>>,
    /// Transfers between consecutive operations; empty if the cell does not ask for transfers.
    ///
    /// The list is also empty if an overlap, a missing spot or a blocked transfer prevents the transfers.
    pub transfers: Vec<Transfer>,
    /// First transfer that is blocked.
    pub blocked: Option<Blocked>,
    /// Objective computed from the values of all operations (m, rad, share of failures, or cost of
    /// tolerances); None if the layout is infeasible.
    ///
    /// In a robust search, the worst value of each operation over the placement tolerances replaces its
    /// value.
    pub objective: Option<f64>,
    /// Cost, which is finite for every layout. The cost equals the objective if the layout is feasible and
    /// within every limit.
    ///
    /// The cost is more than 100 times [`Workcell::weight`] if a limit is missed. For an infeasible layout,
    /// the cost is at least 1000 times this weight, and grows with the distance from feasibility.
    pub cost: f64,
}

impl Evaluation {
    /// Returns the evaluation of a layout that does not belong to the cell.
    fn of_misfit(workcell: &Workcell, misfit: Misfit) -> Self {
        let outcomes = vec![Outcome::Unjudged(Unjudged::NotALayout); workcell.cell.operations.len()];
        let short = (OUT_OF_REACH_PENALTY + INFEASIBLE_PENALTY) * outcomes.len() as f64;
        Self {
            misfit: Some(misfit),
            overlaps: Vec::new(),
            near: Vec::new(),
            every_node: vec![None; outcomes.len()],
            outcomes,
            transfers: Vec::new(),
            blocked: None,
            objective: None,
            cost: workcell.weight() * (INFEASIBLE_PENALTY + short),
        }
    }

    /// Returns whether the layout is feasible and within every limit, as a search requires.
    pub fn is_accepted(&self) -> bool {
        self.objective == Some(self.cost)
    }
}

/// Memory that one thread reuses from layout to layout.
#[derive(Default)]
pub struct Workspace {
    overlaps: Vec<Overlap>,
    solids: PlacedSolids,
    spots: SpotMemory,
    misplacements: Misplacements,
}

impl Workspace {
    /// Returns how many nodes, postures and contact checks all evaluations with this memory have needed so
    /// far.
    pub fn counts(&self) -> WalkCounts {
        self.spots.counts()
    }
}

/// Evaluates one layout: overlaps, reach, limits, errors and collisions.
///
/// The function is pure and total: the same layout gives the same bits, and every layout has a finite cost.
/// A layout that does not belong to the cell is infeasible, and [`Evaluation::misfit`] states the reason.
pub fn evaluate(workcell: &Workcell, layout: &Layout) -> Evaluation {
    evaluate_in(workcell, layout, &mut Workspace::default())
}

/// Evaluates one layout as [`evaluate`] does, with memory that the caller keeps from call to call.
pub fn evaluate_in(workcell: &Workcell, layout: &Layout, workspace: &mut Workspace) -> Evaluation {
    if let Some(misfit) = workcell.cell.misfit(layout) {
        return Evaluation::of_misfit(workcell, misfit);
    }
    let Workspace { overlaps: found, solids, spots: memory, misplacements } = workspace;
    // If no misplacement causes an overlap, the layout without misplacements has no overlap either.
    let mut near = Vec::new();
    if workcell.certifies() {
        workcell.wide.overlaps(layout, found);
        near.extend(found.iter().filter(|o| is_between_solids(o)).copied());
    }
    if !workcell.certifies() || !found.is_empty() {
        workcell.plan.overlaps(layout, found);
    }
    let misplacements = workcell.certifies().then(|| {
        misplacements.set(&workcell.cell, layout, workcell.cell.robot.reach());
        &*misplacements
    });
    let demand = misplacements.map(|misplacements| workcell.demand(misplacements));
    let placed = PlacedLayout::reusing(&workcell.mapper, layout, std::mem::take(solids)).demanding(demand);
    let operations = Operations::evaluate(workcell, &placed, memory);
    let overlaps = found.clone();
    let (transfers, blocked) = transfers(&placed, &overlaps, &operations, memory.mapper());
    let depth = overlaps.iter().map(|o| o.depth).sum::<f64>().max(near.iter().map(|o| o.depth).sum());
    let Operations { outcomes, spots, every_node, values, most, lost } = operations;
    let is_apart = depth == 0.0;
    let is_blocked = blocked.is_some();
    let is_feasible = is_apart && !is_blocked && values.len() == outcomes.len();
    let objective = is_feasible.then(|| workcell.objective(&placed, &spots, &values, memory.mapper()));
    *solids = placed.into_solids();
    let cost = match objective {
        Some(objective) => workcell.priced(objective, &most),
        None => {
            let blocked = if is_blocked { BLOCKED_PENALTY } else { 0.0 };
            let short = outcomes.iter().map(|o| shortfall(&workcell.cell, o)).sum::<f64>();
            workcell.weight() * (INFEASIBLE_PENALTY + depth + blocked + short + lost)
        }
    };
    Evaluation { misfit: None, overlaps, near, outcomes, every_node, transfers, blocked, objective, cost }
}

/// Outcomes and values of all operations, in their order.
struct Operations {
    outcomes: Vec<Outcome>,
    spots: Vec<Option<Spot>>,
    /// Spots of all nodes of each operation ([`Evaluation::every_node`]).
    every_node: Vec<Option<Vec<Spot>>>,
    /// Values of the operations. An operation without a value is left out.
    values: Vec<f64>,
    /// Value that must be within the limit of the operation, for each entry of `values`.
    most: Vec<f64>,
    /// Sum of the penalties (m) of the spots that may fail at a misplacement ([`SpotValue::Lost`]).
    lost: f64,
}

impl Operations {
    fn evaluate(workcell: &Workcell, placed: &PlacedLayout<'_>, memory: &mut SpotMemory) -> Self {
        let count = workcell.cell.operations.len();
        let (outcomes, spots) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let (values, most) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let every_node = Vec::with_capacity(count);
        let mut all = Self { outcomes, spots, every_node, values, most, lost: 0.0 };
        for operation in 0..count {
            let query = SpotQuery { workcell, placed, operation, spots: &all.spots };
            let SpotChoice { outcome, value, every_node } = query.choose(memory);
            match value {
                Some(SpotValue::Kept { value, most }) => {
                    all.values.push(value);
                    all.most.push(most);
                }
                Some(SpotValue::Lost(loss)) => all.lost += loss.penalty(),
                None => {}
            }
            all.spots.push(if let Outcome::Found(spot) = outcome { Some(spot) } else { None });
            all.outcomes.push(outcome);
            all.every_node.push(every_node);
        }
        all
    }
}

/// Plans the transfers between the operations. Returns no transfers if the layout has overlaps or if a
/// transfer is blocked.
fn transfers(
    placed: &PlacedLayout<'_>,
    overlaps: &[Overlap],
    Operations { spots, every_node, .. }: &Operations,
    workspace: &MapperWorkspace,
) -> (Vec<Transfer>, Option<Blocked>) {
    if !overlaps.is_empty() {
        return (Vec::new(), None);
    }
    match placed.transfers(spots, every_node, workspace) {
        Ok(transfers) => (transfers, None),
        Err(blocked) => (Vec::new(), Some(blocked)),
    }
}

/// Returns the penalty of an operation without a spot, m; 0 if the operation has a spot.
fn shortfall(cell: &Cell, outcome: &Outcome) -> f64 {
    match outcome {
        Outcome::Found(_) => 0.0,
        Outcome::AllCollide { .. } => COLLISION_PENALTY,
        Outcome::Refused { .. } => REFUSED_PENALTY,
        Outcome::Uncertain { why, .. } => penalty(why),
        Outcome::Unjudged(_) => UNJUDGED_PENALTY,
        Outcome::Unreachable { gap } if gap.reach > 0.0 => {
            OUT_OF_REACH_PENALTY + gap.reach.min(INFEASIBLE_PENALTY)
        }
        // The excess of revolute joints is a sum of cosines. The factor `reach` converts this sum to a
        // length.
        Outcome::Unreachable { gap } => {
            JOINT_LIMIT_PENALTY + (gap.limits.min(4.0) / 4.0) * cell.robot.reach().min(1.0)
        }
    }
}
