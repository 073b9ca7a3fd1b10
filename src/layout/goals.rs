//! What else a feasible layout is good at, besides its errors: measured from its evaluation.

use super::{Evaluation, Workcell};
use crate::cell::{Goal, Goals, JointVector, Layout};
use crate::clearance::{PlacedSolids, footprint};
use crate::error_map::{Outcome, Scratch, Spot};
use crate::motion::{Measures, direct_travel, measures};
use crate::robot::Chain;

/// Distances from here on are as good as any, m.
pub const FAR: f64 = 0.5;

/// A layout with the postures in which it works.
struct Worked<'a> {
    workcell: &'a Workcell,
    layout: &'a Layout,
    evaluation: &'a Evaluation,
    /// At the spot of every operation.
    spots: Vec<JointVector>,
    /// Operation and joints at every node that counts.
    postures: Vec<(usize, JointVector)>,
}

impl Workcell {
    /// Values of goals (m, rad, m2 or shares) of a layout, in their order; None if it is not feasible.
    ///
    /// - error: the objective.
    /// - clearance: the least distance, at most [`FAR`], of the robot with what it holds to anything at
    ///   every node that counts, and in plan of floor spaces. What is mounted behind the last joint is not
    ///   asked against the equipment it works on (the standoff decides that), nor what only the first joint
    ///   moves against the floor, nor floor spaces of which none may move. [`FAR`] if collision is not checked.
    /// - joint limits, singularity: the least of [`measures`] at the same nodes, by the limits of the robot,
    ///   margins aside.
    /// - travel: that of the transfers; if they are not checked, of direct moves from spot to spot.
    /// - footprint: the convex hull of the floor spaces of robot base and equipment.
    pub fn goals(&self, layout: &Layout, evaluation: &Evaluation, goals: &Goals) -> Option<Vec<f64>> {
        let objective = evaluation.objective?;
        let worked = Worked::new(self, layout, evaluation)?;
        let value = |goal: Goal| match goal {
            Goal::Error => objective,
            Goal::Clearance => worked.clearance(),
            Goal::JointLimits => worked.least(|m| m.limits),
            Goal::Singularity => worked.least(|m| m.singularity),
            Goal::Travel => worked.travel(),
            Goal::Footprint => footprint(&self.cell, layout),
        };
        Some(goals.iter().map(value).collect())
    }
}

impl<'a> Worked<'a> {
    fn new(workcell: &'a Workcell, layout: &'a Layout, evaluation: &'a Evaluation) -> Option<Self> {
        let found = |outcome: &Outcome| if let Outcome::Found(spot) = outcome { Some(*spot) } else { None };
        let all: Vec<Option<Spot>> = evaluation.outcomes.iter().map(found).collect();
        let (mut spots, mut postures) = (Vec::new(), Vec::new());
        for (k, spot) in all.iter().enumerate() {
            let joints = |spot: &Spot| Some(workcell.mapper.stance(k, layout, spot)?.joints);
            spots.push(joints(spot.as_ref()?)?);
            if workcell.cell.operations[k].over.takes_all() {
                let (mut placed, mut scratch) = (PlacedSolids::default(), Scratch::default());
                workcell.scene.place(layout, &mut placed);
                let (mapper, scene) = (&workcell.mapper, &workcell.scene);
                let every = mapper.every_free(k, layout, scene, &mut placed, &all, &mut scratch).ok()?;
                postures.extend(every.iter().filter_map(|spot| Some((k, joints(spot)?))));
            } else {
                postures.extend(spots.last().map(|joints| (k, *joints)));
            }
        }
        Some(Self { workcell, layout, evaluation, spots, postures })
    }

    fn clearance(&self) -> f64 {
        let Workcell { cell, mapper, plan, scene, .. } = self.workcell;
        let mut placed = PlacedSolids::default();
        scene.place(self.layout, &mut placed);
        let in_plan = plan.spacing(cell, self.layout, FAR);
        self.postures.iter().fold(in_plan, |least, (k, joints)| {
            let (frames, equipment) = (mapper.frames(joints).links, cell.operations[*k].equipment);
            scene.distance_at_work(&placed, &frames, *k, equipment, least).distance
        })
    }

    fn least(&self, measure: fn(&Measures) -> f64) -> f64 {
        let robot = &self.workcell.cell.robot;
        let chain = Chain::new(robot);
        let of = |(_, joints): &(usize, JointVector)| measure(&measures(&chain, joints, robot.reach()));
        self.postures.iter().map(of).fold(f64::INFINITY, f64::min)
    }

    fn travel(&self) -> f64 {
        let Workcell { cell, mapper, .. } = self.workcell;
        if mapper.asks_transfers() {
            return self.evaluation.transfers.iter().map(|t| t.travel).sum();
        }
        direct_travel(mapper.chain(), &self.spots, cell.robot.reach())
    }
}
