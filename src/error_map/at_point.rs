//! One operation in one layout, asked at any point of its surface, between the nodes too.

use super::mapper::Mapper;
use super::node::Status;
use super::outcome::{Spot, Unjudged};
use super::whole_map::least_violation;
use crate::cell::{JointVector, Layout, Placement};
use crate::clearance::{PlacedSolids, Scene};
use crate::reach::{Branch, Cost, Reach, ToolAttitudes};
use crate::reading::{EvaluatorScratch, WorkContext};
use crate::robot::{Frames, Posture};
use nalgebra::Vector3;

/// A point of the surface at which the operation can happen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PointSpot {
    /// In the frame of the equipment, m.
    pub at: (f64, f64),
    pub branch: u32,
    /// As [`Spot::value`].
    pub value: f64,
}

/// A posture to be kept when the layout moves a little.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kept {
    pub at: (f64, f64),
    pub branch: u32,
    /// Tell the branch of an arm whose branches have no numbers that last.
    pub joints: JointVector,
}

/// An operation in one layout, made ready to be asked point by point.
pub struct Probe<'a> {
    mapper: &'a Mapper,
    scene: &'a Scene,
    placed: &'a PlacedSolids,
    operation: usize,
    /// The equipment in the base frame, and the base in the world.
    at: Placement,
    base: Placement,
    approach: ToolAttitudes,
    situation: WorkContext,
    memory: EvaluatorScratch,
    frames: Frames,
    /// Value and branch of every posture at one point.
    postures: Vec<(f64, u32)>,
}

impl<'a> Probe<'a> {
    /// `spots` are those of the operations before it, at their nodes.
    ///
    /// # Errors
    /// What is missing to judge any point.
    pub fn new(
        (mapper, scene, placed): (&'a Mapper, &'a Scene, &'a PlacedSolids),
        operation: usize,
        layout: &Layout,
        spots: &[Option<Spot>],
    ) -> Result<Self, Unjudged> {
        let situation = mapper.situation(operation, layout, scene, placed, spots)?;
        let stand = mapper.stand(operation, layout);
        let approach = stand.approach(&mapper.arm);
        let memory = mapper.stations[operation].gauge.memory();
        let (at, base, frames, postures) = (stand.at, layout.base, Frames::default(), Vec::new());
        Ok(Self { mapper, scene, placed, operation, at, base, approach, situation, memory, frames, postures })
    }

    /// The TCP over a point of the surface, base frame, m.
    fn target(&self, at: (f64, f64)) -> Vector3<f64> {
        self.mapper.stations[self.operation].grid.point(&self.at, at)
    }

    /// The TCP over a point of the surface, world frame, m.
    pub fn position(&self, at: (f64, f64)) -> Vector3<f64> {
        self.base.pose().transform(&self.target(at))
    }

    /// Distance from the nearest point touched to teach the frame, m; infinite if none was.
    pub fn from_touched(&self, at: (f64, f64)) -> f64 {
        self.situation.from_touched(&self.target(at))
    }

    /// The least-error posture at a point that touches nothing, judged as at a node.
    ///
    /// # Errors
    /// Why the point cannot be used.
    pub fn best(&mut self, at: (f64, f64)) -> Result<PointSpot, Status> {
        let target = self.target(at);
        if self.situation.touches(&target) {
            return Err(Status::Unjudged(Unjudged::OnlyTouched));
        }
        let Self { mapper, situation, approach, memory, frames, postures, .. } = self;
        let (arm, gauge) = (&mapper.arm, &mapper.stations[self.operation].gauge);
        postures.clear();
        arm.inverse.visit(&target, approach, &mut arm.inverse.scratch(), |branch, posture| {
            arm.chain.place(posture, frames);
            postures.push((gauge.value(situation, frames, memory), branch));
        });
        if postures.is_empty() {
            return Err(self.missing(&target));
        }
        postures.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut first = None;
        for &(value, branch) in postures.iter() {
            let Some(posture) = arm.inverse.posture(&target, approach, branch) else { continue };
            arm.chain.place(&posture, frames);
            let hit = self.scene.hit(self.placed, &frames.links, Some(self.operation));
            let of = (self.operation, &*approach);
            let refused = || mapper.refusal(of, (&target, branch), self.scene, self.placed);
            match hit.map(|hit| Status::Collision { hit }).or_else(|| refused().map(Status::Refused)) {
                None => return Ok(PointSpot { at, branch, value }),
                Some(trouble) => first = first.or(Some(trouble)),
            }
        }
        Err(first.unwrap_or_else(|| self.missing(&target)))
    }

    /// The value with a posture kept, of which the joints follow the surface. An arm of numeric inverse
    /// kinematics takes the posture nearest to it, for its branches have no lasting numbers.
    ///
    /// # Errors
    /// Why it cannot be kept.
    pub fn keeping(&mut self, kept: &Kept) -> Result<f64, Status> {
        let target = self.target(kept.at);
        let inverse = &self.mapper.arm.inverse;
        let posture = match inverse.cost() {
            Cost::Numeric => self.branch_near(kept).map(|b| b.posture),
            _ => inverse.usable(&target, &self.approach, kept.branch),
        };
        let Some(posture) = posture else { return Err(self.lost(&target, kept.branch)) };
        let value = self.value(&posture);
        if let Some(hit) = self.scene.hit(self.placed, &self.frames.links, Some(self.operation)) {
            return Err(Status::Collision { hit });
        }
        let of = (self.operation, &self.approach);
        match self.mapper.refusal(of, (&target, kept.branch), self.scene, self.placed) {
            Some(refusal) => Err(Status::Refused(refusal)),
            None => Ok(value),
        }
    }

    /// The same, whatever it touches and whichever joint limit it passes.
    pub fn beyond_limits(&mut self, kept: &Kept) -> Option<f64> {
        let branch = self.branch_near(kept)?;
        Some(self.value(&branch.posture))
    }

    fn branch_near(&self, kept: &Kept) -> Option<Branch> {
        let inverse = &self.mapper.arm.inverse;
        let Reach::Branches(all) = inverse.branches(&self.target(kept.at), &self.approach) else {
            return None;
        };
        match inverse.cost() {
            Cost::Numeric => nearest(&all, &kept.joints).copied(),
            _ => all.into_iter().find(|b| b.index == kept.branch),
        }
    }

    fn value(&mut self, posture: &Posture) -> f64 {
        self.mapper.arm.chain.place(posture, &mut self.frames);
        let gauge = &self.mapper.stations[self.operation].gauge;
        gauge.value(&self.situation, &self.frames, &mut self.memory)
    }

    /// The joints of a branch at a point.
    pub fn joints(&self, at: (f64, f64), branch: u32) -> Option<JointVector> {
        let Reach::Branches(all) = self.mapper.arm.inverse.branches(&self.target(at), &self.approach) else {
            return None;
        };
        all.iter().find(|b| b.index == branch).map(|b| b.joints)
    }

    /// Why no posture can be used.
    fn missing(&self, target: &Vector3<f64>) -> Status {
        match unreached(self.mapper.arm.inverse.branches(target, &self.approach)) {
            Err(status) => status,
            Ok(branches) => least_violation(&branches),
        }
    }

    /// Why one posture cannot be used.
    fn lost(&self, target: &Vector3<f64>, branch: u32) -> Status {
        match unreached(self.mapper.arm.inverse.branches(target, &self.approach)) {
            Err(status) => status,
            Ok(branches) => {
                let own: Vec<_> = branches.iter().filter(|b| b.index == branch).copied().collect();
                least_violation(&own)
            }
        }
    }
}

/// The branches of a target, or why there is none.
pub(super) fn unreached(reach: Reach) -> Result<Vec<Branch>, Status> {
    match reach {
        Reach::OutOfReach { by } => Err(Status::OutOfReach { by }),
        Reach::Attitude { by, joint } => Err(Status::Attitude { by, joint }),
        Reach::NotConverged { position, angle } => Err(Status::NotConverged { position, angle }),
        Reach::Branches(branches) => Ok(branches),
    }
}

/// Of the usable branches that with the least largest turn of a joint.
fn nearest<'b>(branches: &'b [Branch], joints: &JointVector) -> Option<&'b Branch> {
    let off = |b: &Branch| b.joints.iter().zip(joints).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    branches.iter().filter(|b| b.is_usable()).min_by(|a, b| off(a).total_cmp(&off(b)))
}

impl Mapper {
    /// A node of an operation in the frame of its equipment, m.
    pub fn local(&self, operation: usize, node: usize) -> (f64, f64) {
        self.stations[operation].grid.local(node)
    }
}
