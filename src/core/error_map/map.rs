//! Map of an operation: every node with its posture and errors, or the reason why the node cannot be used.

use super::candidate::{ArmContact, Certainty, PostureCandidate};
use super::node_ranking::NodeRanking;
use super::node_record::{NodeRecord, OperationMap, PostureRecord, Status};
use super::outcome::Spot;
use super::placed_layout::PlacedLayout;
use super::walk::{OperationQuery, PostureVisitor};
use super::workspace::PostureMemory;
use crate::cell::NodeAggregation;
use crate::kinematic_error::deviation;
use crate::pose::Displacement;
use crate::reach::Gap;
use crate::reading::WorkContext;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::collections::BinaryHeap;

/// Least number of nodes that one thread maps with the same memory.
const MIN_NODES: usize = 8;

/// Visitor that collects the candidates of one node.
///
/// `BOUNDS` states whether candidates may carry a lower bound of their value.
struct MappedNode<'c, const BOUNDS: bool> {
    candidates: &'c mut Vec<PostureCandidate>,
    missed: Option<Gap>,
}

impl<const BOUNDS: bool> PostureVisitor for MappedNode<'_, BOUNDS> {
    const JUDGES_TOUCHED: bool = true;
    const TAKES_BOUNDS: bool = BOUNDS;

    fn candidate(&mut self, candidate: PostureCandidate) {
        self.candidates.push(candidate);
    }

    fn end_of_node(&mut self, missed: Option<Gap>) {
        self.missed = missed;
    }
}

/// Memory that one thread reuses from node to node.
struct MapMemory {
    postures: PostureMemory,
    candidates: Vec<PostureCandidate>,
}

impl PlacedLayout<'_> {
    /// Maps an operation. `spots` holds the spots of the earlier operations.
    pub fn map(&self, operation: usize, spots: &[Option<Spot>]) -> OperationMap {
        let query = OperationQuery::new(self, operation, spots);
        let nodes = query.nodes(true);
        let usable = |n: &NodeRecord| {
            let posture = n.posture.as_ref().filter(|p| n.status == Status::Ok && !p.touched);
            posture.map(|p| p.value)
        };
        let values: Vec<_> = nodes.iter().enumerate().filter_map(|(k, n)| Some((k, usable(n)?))).collect();
        let all_usable = nodes.iter().all(|n| n.status == Status::Ok);
        let (best, value) = chosen(query.setup.over, &values, all_usable);
        OperationMap { operation, senses: query.setup.evaluator.reported.clone(), nodes, best, value }
    }

    /// Replaces postures in a map. The node of each spot in `chosen` receives the posture of this spot.
    ///
    /// A spot need not have the least-error posture of its node, for example if a search requires a
    /// certificate.
    pub fn show(&self, map: &mut OperationMap, spots: &[Option<Spot>], chosen: &[Spot]) {
        let query = OperationQuery::new(self, map.operation, spots);
        let Ok(context) = &query.context else { return };
        let mut memory = PostureMemory::new(self.mapper, map.operation);
        for spot in chosen {
            let node = &mut map.nodes[spot.node];
            if node.posture.as_ref().is_some_and(|posture| posture.branch != spot.branch) {
                let target = query.setup.grid.target(&query.at, spot.node);
                let candidate = PostureCandidate {
                    spot: *spot,
                    target,
                    contact: ArmContact::Unknown,
                    certainty: Certainty::Value,
                    first: None,
                };
                node.posture = query.record(context, &candidate, &mut memory);
            }
        }
    }

    /// Maps only the status of every node, without postures, values or spot. This function is many times
    /// faster than [`PlacedLayout::map`].
    pub fn statuses(&self, operation: usize, spots: &[Option<Spot>]) -> OperationMap {
        let nodes = OperationQuery::new(self, operation, spots).nodes(false);
        OperationMap { operation, senses: Vec::new(), nodes, best: None, value: None }
    }
}

impl OperationQuery<'_> {
    /// Records every node, on all threads. If `has_postures` is true, the posture of each node and its errors
    /// are also recorded. This takes most of the time of a map.
    fn nodes(&self, has_postures: bool) -> Vec<NodeRecord> {
        let mut targets = Vec::with_capacity(self.setup.grid.count());
        self.setup.grid.targets(&self.at, |node, target| targets.push((node, target)));
        let memory = || MapMemory {
            postures: PostureMemory::new(self.placed.mapper, self.operation),
            candidates: Vec::new(),
        };
        let record = |memory: &mut MapMemory, at| self.node_record(at, has_postures, memory);
        targets.into_par_iter().with_min_len(MIN_NODES).map_init(memory, record).collect()
    }

    /// Records one node: its index, and the target position of the TCP (base frame, m).
    fn node_record(
        &self,
        (node, target): (usize, Vector3<f64>),
        has_postures: bool,
        MapMemory { postures, candidates }: &mut MapMemory,
    ) -> NodeRecord {
        candidates.clear();
        // A map also shows values of unusable postures. The search for the cheapest tolerances does not
        // compute all of these values.
        let missed = match self.setup.is_priced {
            true => self.collected::<false>((node, target), candidates, postures),
            false => self.collected::<true>((node, target), candidates, postures),
        };
        let (status, shown) = self.judge(&target, missed, candidates, postures);
        let posture = shown.filter(|_| has_postures);
        let posture = posture.and_then(|(context, candidate)| self.record(context, &candidate, postures));
        let (i, j) = self.setup.grid.index(node);
        let position = self.placed.layout.base.pose().transform(&target);
        NodeRecord { i, j, position, status, posture }
    }

    /// Collects the candidates of one node. Returns how far the node is from having a posture within the
    /// joint limits; None if the node has such a posture.
    fn collected<const BOUNDS: bool>(
        &self,
        (node, target): (usize, Vector3<f64>),
        candidates: &mut Vec<PostureCandidate>,
        memory: &mut PostureMemory,
    ) -> Option<Gap> {
        let mut mapped = MappedNode::<BOUNDS> { candidates, missed: None };
        self.visit(node, target, memory, &mut mapped);
        mapped.missed
    }

    /// Judges one node by its candidates, or by its gap if no posture is within the joint limits.
    ///
    /// Returns the status of the node, then the [`WorkContext`] for its errors and the candidate to record.
    /// Context and candidate are None if the node has no candidate.
    fn judge(
        &self,
        target: &Vector3<f64>,
        missed: Option<Gap>,
        candidates: &mut Vec<PostureCandidate>,
        memory: &mut PostureMemory,
    ) -> (Status, Option<(&WorkContext, PostureCandidate)>) {
        let context = match (&self.context, missed) {
            (_, Some(_)) => return (self.why_unreached(target), None),
            (Err(why), None) => return (Status::Unjudged(*why), None),
            (Ok(context), None) => context,
        };
        let mut heap = BinaryHeap::from(std::mem::take(candidates));
        let found = self.first_free_of_bounds(&mut heap, &mut NodeRanking::default(), memory);
        *candidates = heap.into_vec();
        let (status, shown) = match found.free {
            Some(free) => (Status::Ok, Some(free)),
            None => (self.why_none(target, &found, memory), found.nearest),
        };
        (status, shown.map(|candidate| (context, candidate)))
    }

    /// Records the posture of a candidate with its errors under every model and in every reported sense.
    fn record(
        &self,
        context: &WorkContext,
        candidate: &PostureCandidate,
        memory: &mut PostureMemory,
    ) -> Option<PostureRecord> {
        let (arm, PostureMemory { scratch, frames, .. }) = (&self.placed.mapper.arm, memory);
        let branch = arm.inverse.branch_at(&candidate.target, &self.attitudes, candidate.spot.branch)?;
        arm.chain.place(&branch.posture, frames);
        let judged = self.setup.evaluator.judge(context, frames, &mut scratch.evaluator);
        let to_world = context.site.world.transpose();
        let world = |d: &Displacement| d.turned(&to_world);
        let off = |model: &Displacement| deviation(&judged.nonlinear.position, &model.position);
        let error = world(&judged.error);
        Some(PostureRecord {
            branch: branch.index,
            joints: branch.joints,
            error: error.position,
            rotation: error.rotation,
            nonlinear: world(&judged.nonlinear).position,
            linear: world(&judged.linear).position,
            linear_off: off(&judged.linear),
            second_order_off: off(&judged.second_order),
            touched: context.touches(&candidate.target),
            value: if self.setup.is_priced { candidate.spot.value } else { judged.value },
            figures: judged.figures,
            success: judged.success,
        })
    }
}

/// Returns the index of the node shown as the spot, and the value of the operation. Both are None if there is
/// no spot.
///
/// `values` holds the index and the value of every usable node.
fn chosen(over: NodeAggregation, values: &[(usize, f64)], all_usable: bool) -> (Option<usize>, Option<f64>) {
    let by_value = |a: &&(usize, f64), b: &&(usize, f64)| a.1.total_cmp(&b.1);
    if !over.needs_every_node() {
        let best = values.iter().min_by(by_value);
        return (best.map(|b| b.0), best.map(|b| b.1));
    }
    // If several nodes are equally bad, the first of them is the spot.
    let worst = values.iter().rev().max_by(by_value).filter(|_| all_usable);
    let mut all: Vec<f64> = values.iter().map(|v| v.1).collect();
    (worst.map(|w| w.0), worst.map(|_| over.of(&mut all)))
}
