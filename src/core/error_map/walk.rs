//! Walk over all nodes: every branch of every node is judged, and the best usable posture is found.
//!
//! An [`OperationQuery`] is one operation in one placed layout. The function [`OperationQuery::walk`] solves
//! the inverse kinematics of each node. For each posture within the joint limits, the function computes the
//! value that the search minimizes. Posture and value are passed to a [`PostureVisitor`].
//! [`OperationQuery::first_free`] then checks candidates, best first, until a candidate is collision-free and
//! allowed by the motion rules. Search, map and probe all use these functions, so that all three apply the
//! same rules.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::held_posture::HeldPosture;
use super::node_record::Status;
use super::operation_setup::OperationSetup;
use super::outcome::{Spot, Unjudged};
use super::placed_layout::{PlacedLayout, PlacedSurface};
use super::workspace::PostureMemory;
use crate::cell::Placement;
use crate::reach::{Branch, FamilyReach, Gap, Reach, ToolAttitudes};
use crate::reading::WorkContext;
use crate::robot::{Frames, Posture};
use nalgebra::Vector3;

/// One operation in one placed layout, ready to judge postures.
pub struct OperationQuery<'a> {
    pub placed: &'a PlacedLayout<'a>,
    pub setup: &'a OperationSetup,
    pub operation: usize,
    /// Pose of the equipment in the robot base frame.
    pub at: Placement,
    /// Sine and cosine of the yaw of the equipment.
    heading: (f64, f64),
    /// Attitudes of the tool over the surface.
    pub attitudes: ToolAttitudes,
    /// Data, other than the posture, from which the errors are computed, or the reason why the errors
    /// cannot be computed.
    pub context: Result<WorkContext, Unjudged>,
    /// Posture at which the numeric solver starts if a candidate has the branch index
    /// [`crate::reach::CONTINUED`].
    pub kept: Option<HeldPosture>,
}

/// Visitor that receives the postures that [`OperationQuery::walk`] judges at the nodes.
pub trait PostureVisitor {
    /// Whether the nodes that the robot touches to teach the frame are also judged. Such a node cannot be
    /// the spot.
    const JUDGES_TOUCHED: bool = false;

    /// Whether the gap of [`Self::end_of_node`] is needed for a redundant arm. Without the gap, an unreached
    /// node takes much less time.
    const NEEDS_GAP: bool = true;

    /// Whether candidates may carry a lower bound of their value. A bound replaces the value only if the
    /// value takes much longer to compute.
    const TAKES_BOUNDS: bool = false;

    /// Receives a posture within the joint limits.
    fn candidate(&mut self, candidate: PostureCandidate);

    /// Handles the end of a node, after all of its candidates were received.
    ///
    /// `missed` is a measure of how far the node is from having a posture within the joint limits. It is None
    /// if the node has such a posture.
    fn end_of_node(&mut self, _missed: Option<Gap>) {}
}

impl PostureVisitor for Vec<PostureCandidate> {
    const NEEDS_GAP: bool = false;

    fn candidate(&mut self, candidate: PostureCandidate) {
        self.push(candidate);
    }
}

impl PostureVisitor for std::collections::BinaryHeap<PostureCandidate> {
    const NEEDS_GAP: bool = false;

    fn candidate(&mut self, candidate: PostureCandidate) {
        self.push(candidate);
    }
}

impl<'a> OperationQuery<'a> {
    /// Prepares an operation. `spots` holds the spots of the earlier operations.
    pub fn new(placed: &'a PlacedLayout<'a>, operation: usize, spots: &[Option<Spot>]) -> Self {
        Self::reusing(placed, &placed.surface(operation), spots, ToolAttitudes::default())
    }

    /// Prepares the operation that happens on `surface`, reusing the memory of `attitudes`.
    pub fn reusing(
        placed: &'a PlacedLayout<'a>,
        surface: &PlacedSurface<'_>,
        spots: &[Option<Spot>],
        mut attitudes: ToolAttitudes,
    ) -> Self {
        let (mapper, operation, at) = (placed.mapper, surface.operation, surface.at);
        mapper.arm.inverse.set_attitudes(&mut attitudes, surface.attitude, at.yaw);
        let context = placed.work_context(operation, spots);
        let kept = placed.kept_posture(operation);
        let (setup, heading) = (&mapper.setups[operation], at.yaw.sin_cos());
        Self { placed, setup, operation, at, heading, attitudes, context, kept }
    }

    /// Returns the TCP target of a node, in the base frame, m.
    pub(super) fn node_target(&self, node: usize) -> Vector3<f64> {
        let grid = &self.setup.grid;
        grid.headed_point(&self.at, self.heading, grid.local(node))
    }

    /// Visits every node, in the order of the grid.
    #[inline]
    pub fn walk<V: PostureVisitor>(&self, memory: &mut PostureMemory, visitor: &mut V) {
        self.setup.grid.targets(&self.at, |node, target| self.visit(node, target, memory, visitor));
    }

    /// Visits one node and judges every branch within the joint limits.
    #[inline]
    pub fn visit<V: PostureVisitor>(
        &self,
        node: usize,
        target: Vector3<f64>,
        memory: &mut PostureMemory,
        visitor: &mut V,
    ) {
        self.visit_branches(FamilyReach::Complete, node, target, memory, visitor);
    }

    /// Visits one node, and judges every branch within the joint limits. The branches of a redundant arm at
    /// the sampled values of the redundant joint are left out if `known` states that none of them is usable.
    /// The gap of the node is then not computed.
    #[inline]
    pub fn visit_branches<V: PostureVisitor>(
        &self,
        known: FamilyReach,
        node: usize,
        target: Vector3<f64>,
        memory: &mut PostureMemory,
        visitor: &mut V,
    ) {
        let arm = &self.placed.mapper.arm;
        let PostureMemory { scratch, frames, posture, counts, .. } = memory;
        counts.nodes += 1;
        let context = self.context.as_ref().ok();
        let context = context.filter(|s| V::JUDGES_TOUCHED || !s.touches(&target));
        let mut reached = false;
        let takes_bounds = V::TAKES_BOUNDS && self.placed.mapper.has_bounds(self.operation);
        let certainty = if takes_bounds { Certainty::RoughBound } else { Certainty::Value };
        let mut before = None;
        let mut judge = |branch: u64, posture: &Posture| {
            reached = true;
            if let Some(context) = context {
                counts.postures += 1;
                arm.chain.place(posture, frames);
                let value = match before {
                    Some((spun, value)) if self.differs_in_spin(&spun, frames) => value,
                    _ if takes_bounds => self.setup.bound(Certainty::RoughBound, context, frames, scratch),
                    _ => self.setup.value(context, frames, scratch),
                };
                before = self.setup.evaluator.ignores_spin().then_some((*frames, value));
                let (spot, contact) = (Spot { node, branch, value }, ArmContact::Unknown);
                visitor.candidate(PostureCandidate { spot, target, contact, certainty, first: None });
            }
        };
        let (inverse, attitudes) = (&arm.inverse, &self.attitudes);
        let gap = match known {
            FamilyReach::Complete => inverse.visit(&target, attitudes, posture, &mut judge),
            FamilyReach::OnlyBetweenSamples { is_solved } => {
                inverse.visit_between_samples(&target, attitudes, is_solved, &mut judge);
                Gap::ALL
            }
        };
        visitor.end_of_node((!reached).then_some(gap));
    }

    /// Replaces the bound of a candidate by a sharper bound or by the value. A bound above `enough` (m or rad)
    /// need not be sharpened further. Returns None if the branch does not exist, or if the errors cannot be
    /// computed.
    pub fn sharpened(
        &self,
        candidate: &PostureCandidate,
        enough: f64,
        memory: &mut PostureMemory,
    ) -> Option<PostureCandidate> {
        let PostureMemory { frames, scratch, .. } = memory;
        let (arm, context) = (&self.placed.mapper.arm, self.context.as_ref().ok()?);
        let posture = arm.inverse.posture(&candidate.target, &self.attitudes, candidate.spot.branch)?;
        arm.chain.place(&posture, frames);
        let (value, certainty) = self.setup.sharpened(candidate.certainty, context, frames, enough, scratch);
        let value = if certainty == Certainty::Value { value } else { value.max(candidate.spot.value) };
        Some(PostureCandidate { spot: Spot { value, ..candidate.spot }, certainty, ..*candidate })
    }

    /// Returns whether two postures have the same frames, bit for bit, except for the rotation of the tool.
    #[inline]
    pub(super) fn differs_in_spin(&self, a: &Frames, b: &Frames) -> bool {
        let last = self.placed.mapper.arm.chain.axes();
        a.links[..last] == b.links[..last] && a.tcp.translation == b.tcp.translation
    }

    /// Returns the posture with the index `branch` at a target (base frame, m); None if this branch does not
    /// exist there.
    pub fn branch_at(&self, target: &Vector3<f64>, branch: u64) -> Option<Branch> {
        self.placed.mapper.branch_at(target, &self.attitudes, branch, self.kept.as_ref())
    }

    /// Returns the reason why no branch reaches a target within the joint limits.
    pub fn why_unreached(&self, target: &Vector3<f64>) -> Status {
        match self.placed.mapper.arm.inverse.branches(target, &self.attitudes) {
            Reach::OutOfReach { by } => Status::OutOfReach { by },
            Reach::Attitude { by, joint } => Status::Attitude { by, joint },
            Reach::NotConverged { position, angle } => Status::NotConverged { position, angle },
            Reach::Branches(branches) => least_violation(&branches),
        }
    }
}

/// Returns the status of a target from its branches. The status holds the least attitude error of the
/// branches within the joint limits.
///
/// If no branch stays within the limits, the status is the least violation of a joint limit. Without
/// branches, the status is [`Status::OutOfReach`] with the distance 0.
pub fn least_violation(branches: &[Branch]) -> Status {
    let passed = branches.iter().filter_map(|b| b.violation.map(|v| (v, b.joints[v.joint])));
    let least = passed.min_by(|a, b| a.0.by.total_cmp(&b.0.by));
    let off = branches.iter().filter(|b| b.violation.is_none()).map(|b| b.off).reduce(f64::min);
    match (off, least) {
        (Some(by), _) => Status::Attitude { by, joint: None },
        (None, Some((violation, needs))) => Status::JointLimit { violation, needs },
        (None, None) => Status::OutOfReach { by: 0.0 },
    }
}
