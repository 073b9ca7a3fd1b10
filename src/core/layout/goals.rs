//! Goals of a Pareto search, measured from the evaluation of a layout.

use super::evaluation::Evaluation;
use super::workcell::Workcell;
use crate::cell::{Goal, Goals, JointVector, Layout, Unit};
use crate::clearance::footprint;
use crate::error_map::{MapperWorkspace, Outcome, PlacedLayout, Spot};
use crate::motion::{Measures, direct_travel, measures};
use crate::robot::Chain;

/// Upper bound of the clearance goal, m. Larger distances count as this value.
pub const MAX_CLEARANCE: f64 = 0.5;

/// Feasible layout with the postures in which its operations happen.
struct WorkingPostures<'a> {
    workcell: &'a Workcell,
    placed: PlacedLayout<'a>,
    evaluation: &'a Evaluation,
    found: Vec<Option<Spot>>,
    /// Joint coordinates at the spot of every operation.
    spots: Vec<JointVector>,
    /// Joint coordinates at every node at which an operation happens, each with the index of the operation.
    postures: Vec<(usize, JointVector)>,
}

impl Workcell {
    /// Computes the value of each goal for a layout; None if the layout is not feasible.
    ///
    /// - error: the objective (m, rad, share of failures, or cost of tolerances).
    /// - clearance: the least distance (m) of the robot and its held parts from floor, equipment and fence.
    ///   The minimum is taken over all nodes at which an operation happens. Distances between floor spaces
    ///   also count, as the root sum square of the horizontal and the vertical distance. Horizontal distances
    ///   between floor spaces and the fence also count. The value is at most [`MAX_CLEARANCE`], which is also
    ///   the value if collisions are not checked. Four kinds of distances are left out. The first is between
    ///   a solid after the last joint and the equipment of the operation, because the standoff sets this
    ///   distance. The second is between the floor and a solid that only the first joint moves. The third is
    ///   between two floor spaces, or a floor space and the fence, if neither can move. The fourth is between
    ///   the floor spaces of two pieces of equipment if one carries the other.
    /// - joint limits: the least value of [`Measures::limits`], a number without unit, at the nodes at which
    ///   an operation happens. The joint limits are those of the robot file, without margins.
    /// - singularity: the least value of [`Measures::singularity`], a number without unit, at the same nodes.
    /// - travel: the joint travel (rad) of the transfers. If transfers are not checked, direct moves from
    ///   spot to spot replace the transfers.
    /// - footprint: the area (m^2) of the convex hull of the floor spaces of robot base and equipment.
    /// - time: the least time (s) of the motions and operations ([`crate::cycle_time`]). The time is NaN if
    ///   the maximum speed of a joint is not known, or if the arm cannot follow an approach or a retract.
    /// - cost: the cost of the cheapest tolerances with which every operation stays within its limit at its
    ///   spot. The cost is NaN if the search ignores the cost of tolerances.
    pub fn goals(&self, layout: &Layout, evaluation: &Evaluation, goals: &Goals) -> Option<Vec<f64>> {
        let objective = evaluation.objective.filter(|_| self.cell.misfit(layout).is_none())?;
        let worked = WorkingPostures::new(self, layout, evaluation)?;
        let value = |goal: Goal| match goal {
            Goal::Error => objective,
            Goal::Clearance => worked.clearance(),
            Goal::JointLimits => worked.least(|m| m.limits),
            Goal::Singularity => worked.least(|m| m.singularity),
            Goal::Travel => worked.travel(),
            Goal::Footprint => footprint(&self.cell, layout),
            Goal::Time => worked.time(),
            Goal::Cost => worked.cost(),
        };
        Some(goals.iter().map(value).collect())
    }
}

impl<'a> WorkingPostures<'a> {
    fn new(workcell: &'a Workcell, layout: &'a Layout, evaluation: &'a Evaluation) -> Option<Self> {
        let found = |outcome: &Outcome| if let Outcome::Found(spot) = outcome { Some(*spot) } else { None };
        let all: Vec<Option<Spot>> = evaluation.outcomes.iter().map(found).collect();
        let (placed, mut memory) = (workcell.placed(layout), MapperWorkspace::default());
        let (mut spots, mut postures) = (Vec::new(), Vec::new());
        for (k, spot) in all.iter().enumerate() {
            let joints = |spot: &Spot| Some(placed.operation_posture(k, spot)?.joints);
            spots.push(joints(spot.as_ref()?)?);
            if workcell.cell.operations[k].over.needs_every_node() {
                let every = match &evaluation.every_node[k] {
                    Some(every) => every.clone(),
                    None => placed.every_free(k, &all, &mut memory).ok()?,
                };
                postures.extend(every.iter().filter_map(|spot| Some((k, joints(spot)?))));
            } else {
                postures.extend(spots.last().map(|joints| (k, *joints)));
            }
        }
        Some(Self { workcell, placed, evaluation, found: all, spots, postures })
    }

    fn clearance(&self) -> f64 {
        let Workcell { cell, plan, .. } = self.workcell;
        let in_plan = plan.spacing(cell, self.placed.layout(), MAX_CLEARANCE);
        let nearest =
            |least, (k, joints): &(usize, JointVector)| self.placed.distance_at_work(*k, joints, least);
        self.postures.iter().fold(in_plan, nearest)
    }

    fn least(&self, measure: fn(&Measures) -> f64) -> f64 {
        let robot = &self.workcell.cell.robot;
        let chain = Chain::new(robot);
        let of = |(_, joints): &(usize, JointVector)| measure(&measures(&chain, joints, robot.reach()));
        self.postures.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    fn cost(&self) -> f64 {
        if self.workcell.cell.unit() == Unit::Cost {
            return self.evaluation.objective.unwrap_or(f64::NAN);
        }
        let mut memory = MapperWorkspace::default();
        self.placed.joint_price(&self.found, &mut memory).unwrap_or(f64::NAN)
    }

    fn time(&self) -> f64 {
        let cycle = self.workcell.cycle_at(&self.placed, self.evaluation, &self.found);
        cycle.map_or(f64::NAN, |cycle| cycle.total())
    }

    fn travel(&self) -> f64 {
        let Workcell { cell, mapper, .. } = self.workcell;
        if mapper.asks_transfers() {
            return self.evaluation.transfers.iter().map(|t| t.travel).sum();
        }
        direct_travel(mapper.chain(), &self.spots, cell.robot.reach())
    }
}
