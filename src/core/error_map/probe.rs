//! One operation in one placed layout, judged at any point of its surface, including points between the
//! nodes.

use super::candidate::PostureCandidate;
use super::demand::Demand;
use super::held_posture::{HeldPosture, PointSpot};
use super::node_record::Status;
use super::outcome::{Spot, Unjudged};
use super::placed_layout::PlacedLayout;
use super::walk::OperationQuery;
use super::workspace::{MapperWorkspace, WalkMemory};
use crate::cell::JointVector;
use crate::certificate::{NoValueBound, NotCertified, ValueBound};
use crate::reach::{Inverse, RedundantCoordinate};
use crate::reading::WorkContext;
use nalgebra::Vector3;

/// One operation in one placed layout, ready to be judged point by point.
pub struct Probe<'a> {
    query: OperationQuery<'a>,
    memory: WalkMemory<'a>,
}

impl<'a> Probe<'a> {
    /// Prepares an operation. `spots` holds the spots of the earlier operations.
    ///
    /// # Errors
    /// Returns the reason if the errors of the operation cannot be computed.
    pub fn new(
        placed: &'a PlacedLayout<'a>,
        operation: usize,
        spots: &[Option<Spot>],
        workspace: &'a mut MapperWorkspace,
    ) -> Result<Self, Unjudged> {
        let query = OperationQuery::new(placed, operation, spots);
        query.context.as_ref().map_err(|why| *why)?;
        Ok(Self { query, memory: workspace.of(placed.mapper, operation) })
    }

    /// Returns the TCP target over a point of the surface, in the base frame, m.
    fn target(&self, at: (f64, f64)) -> Vector3<f64> {
        self.query.target(at)
    }

    /// Returns the TCP target over a point of the surface, in the world frame, m.
    pub fn position(&self, at: (f64, f64)) -> Vector3<f64> {
        self.query.placed.layout.base.pose().transform(&self.target(at))
    }

    fn context(&self) -> Result<&WorkContext, Status> {
        self.query.context.as_ref().map_err(|why| Status::Unjudged(*why))
    }

    /// Returns the distance (m) of a point of the surface from the nearest point that the robot touches to
    /// teach the frame. The distance is infinite if no point is touched.
    pub fn distance_from_touched(&self, at: (f64, f64)) -> f64 {
        self.context().map_or(f64::INFINITY, |context| context.distance_from_touched(&self.target(at)))
    }

    /// Finds the least-error usable posture at a point, by the rules that apply to nodes.
    ///
    /// # Errors
    /// Returns the status of the point if the point cannot be used.
    pub fn best(&mut self, at: (f64, f64)) -> Result<PointSpot, Status> {
        let target = self.target(at);
        if self.context()?.touches(&target) {
            return Err(Status::Unjudged(Unjudged::OnlyTouched));
        }
        let Self { query, memory: WalkMemory { postures: memory, candidates, .. } } = self;
        candidates.clear();
        query.visit(0, target, memory, *candidates);
        candidates.sort_by(|a, b| b.cmp(a));
        let mut next = candidates.iter().copied();
        let found = query.first_free(memory, |_| next.next());
        match found.free {
            Some(PostureCandidate { spot: Spot { branch, value, .. }, .. }) => {
                let posture = query.hold(at, branch).ok_or(Status::OutOfReach { by: 0.0 })?;
                Ok(PointSpot { posture, value })
            }
            None => Err(query.why_none(&target, &found, memory)),
        }
    }

    /// Computes the value of the operation ([`Spot::value`]) in the layout of this probe, at the point of
    /// `held`.
    ///
    /// The posture is found by the rules of [`HeldPosture`]. The posture must be collision-free and allowed
    /// by the motion rules.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn holding(&mut self, held: &HeldPosture) -> Result<f64, Status> {
        self.query.holding(held, self.memory.postures)
    }

    /// Checks that a held posture is collision-free and allowed by the motion rules in the layout of this
    /// probe.
    ///
    /// # Errors
    /// Returns the status of the point if the posture cannot be held.
    pub fn keeps_free(&mut self, held: &HeldPosture) -> Result<(), Status> {
        self.query.keeps_free(held, self.memory.postures)
    }

    /// Returns the reason for the status of a held posture, which may name a joint at its limit.
    pub fn reason(&self, held: &HeldPosture, status: Status) -> Status {
        self.query.reason(held, status)
    }

    /// Computes the value of the operation ([`Spot::value`]) in a held posture, even if this posture
    /// collides.
    ///
    /// The posture may exceed joint limits, unless the arm has only a numeric solver. Returns None if no branch
    /// in this layout corresponds to the posture, or if the errors cannot be computed.
    pub fn beyond_limits(&mut self, held: &HeldPosture) -> Option<f64> {
        let branch = self.query.branch_beyond_limits(held)?;
        self.query.value(&branch.posture, self.memory.postures).ok()
    }

    /// Returns the posture of a branch at a point of the surface, so that the operation can keep it while the
    /// layout changes. Returns None if the branch does not exist at the point.
    pub fn hold(&self, at: (f64, f64), branch: u64) -> Option<HeldPosture> {
        self.query.hold(at, branch)
    }

    /// Returns a held posture at another point of the surface, in the same branch. Returns None if the branch
    /// does not exist there.
    ///
    /// The result keeps the value of a redundant joint that the branch index states.
    pub fn moved(&self, held: &HeldPosture, at: (f64, f64)) -> Option<HeldPosture> {
        let inverse = self.inverse();
        match inverse.continues_postures() && inverse.keeps_branches() {
            true => self.hold(at, held.branch),
            false => Some(held.at_point(at)),
        }
    }

    /// Returns up to four postures at the point of `held`, with a redundant coordinate moved in either
    /// direction ([`RedundantCoordinate`]).
    ///
    /// The coordinate moves by the distance between its sampled values, multiplied by `share`. Redundant
    /// coordinates along which the search does not refine postures are left out.
    pub fn beside(&self, held: &HeldPosture, share: f64) -> impl Iterator<Item = HeldPosture> + use<> {
        let moved = [RedundantCoordinate::Joint, RedundantCoordinate::Spin].map(|coordinate| {
            let is_refined = self.query.refines(coordinate);
            [-share, share].map(|share| {
                let inverse = self.inverse();
                let branch = inverse.moved(held.branch, coordinate, share, &self.query.attitudes);
                self.hold(held.at, branch.filter(|_| is_refined)?)
            })
        });
        moved.into_iter().flatten().flatten()
    }

    /// Certifies a held posture if the layout demands certificates. Returns an upper bound of the value over
    /// all misplacements. The bound is None if the layout demands no certificate, if `value` asks for no
    /// bound, or if no bound is known.
    ///
    /// # Errors
    /// Returns the reason if the posture is not certified.
    pub fn certificate(
        &mut self,
        held: &HeldPosture,
        value: Option<&Result<ValueBound, NoValueBound>>,
    ) -> Result<Option<f64>, NotCertified> {
        let Some(demand) = self.query.placed.demand else { return Ok(None) };
        self.query.kept = Some(*held);
        let (target, branch) = (self.target(held.at), held.branch_elsewhere(self.inverse()));
        let branch = self.query.branch_at(&target, branch);
        self.query.certify(&target, branch, &Demand { value, ..demand }, self.memory.postures)
    }

    /// Computes the joint coordinates of a held posture in the layout of this probe, at the point of `held`.
    /// Returns None if no branch in this layout corresponds to the posture.
    pub fn joints(&mut self, held: &HeldPosture) -> Option<JointVector> {
        self.query.kept = Some(*held);
        let branch = held.branch_elsewhere(self.inverse());
        Some(self.query.branch_at(&self.target(held.at), branch)?.joints)
    }

    fn inverse(&self) -> &Inverse {
        &self.query.placed.mapper.arm.inverse
    }
}
