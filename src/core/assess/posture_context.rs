//! Context of one posture of an operation: all data that `budget` and `explain` need for its errors.

use super::Requirement;
use crate::cell::{Cell, JointVector, Layout, Placement, Registration};
use crate::error_map::{NodeSign, OperationMap, Status};
use crate::layout::Workcell;
use crate::reading::{ErrorEvaluator, WorkContext, WorkFrame};
use crate::robot::Frames;
use crate::safe_text::shown;
use nalgebra::Vector3;

/// Choice of a node of the grid: the best node, or the node with given indices.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NodeChoice {
    Best,
    Node(usize, usize),
}

/// Reason why a node has no posture; the text is the message for the user.
#[derive(Debug, Clone, PartialEq)]
pub enum NoPosture {
    /// The grid has no node with the given indices.
    Outside(String),
    /// The node exists but cannot be used.
    Unusable(String),
}

impl NoPosture {
    /// Returns the message for the user.
    pub fn in_words(self) -> String {
        match self {
            Self::Outside(why) | Self::Unusable(why) => why,
        }
    }
}

/// Posture of an operation with all data that its errors depend on.
pub struct PostureContext<'a> {
    pub cell: &'a Cell,
    /// Operation as an index into [`Cell::operations`].
    pub operation: usize,
    /// Placement of the robot base in the world.
    pub base: Placement,
    /// Indices (i, j) of the node; None if the posture was given as joint coordinates.
    pub node: Option<(usize, usize)>,
    /// Position of the TCP in the world, m.
    pub position: Vector3<f64>,
    pub joints: JointVector,
    pub evaluator: ErrorEvaluator,
    pub situation: WorkContext,
    pub frames: Frames,
    /// Upper bound of the value at the spot over all misplacements, m or rad.
    ///
    /// The outer `Option` is None if no certificate is demanded, or if the posture is not the posture at the
    /// spot. The inner `Option` is None if no bound is known.
    pub worst: Option<Option<f64>>,
}

impl<'a> PostureContext<'a> {
    /// Returns the posture at a node of an operation's map, with its context.
    ///
    /// # Errors
    /// Returns the reason if the node does not exist or has no usable posture.
    pub fn at(
        workcell: &'a Workcell,
        layout: &Layout,
        maps: &[OperationMap],
        operation: usize,
        at: NodeChoice,
    ) -> Result<Self, NoPosture> {
        let cell = &workcell.cell;
        let (map, name) = (&maps[operation], shown(&cell.operations[operation].name));
        let node = match at {
            NodeChoice::Best => map.best_node().ok_or_else(|| NoPosture::Unusable(no_spot(cell, map)))?,
            NodeChoice::Node(i, j) => {
                let (m, n) = cell.operations[operation].place.divisions();
                let inside = (i <= m && j <= n).then(|| map.nodes.get(j * (m + 1) + i)).flatten();
                inside.ok_or_else(|| {
                    let range = format!("i goes from 0 to {m}, j from 0 to {n}");
                    NoPosture::Outside(format!("the grid of {name} has no node ({i}, {j}): {range}"))
                })?
            }
        };
        let unusable = |why: &str| {
            NoPosture::Unusable(format!("node ({}, {}) of {name} cannot be used: {why}", node.i, node.j))
        };
        let posture = match (&node.posture, node.status) {
            (Some(posture), Status::Ok) => posture,
            _ => return Err(unusable(&node.status.reason(cell))),
        };
        let posed = workcell.posed(layout, maps, operation, posture);
        let (situation, frames) = posed.map_err(|why| unusable(why.in_words()))?;
        let is_spot = map.best_node().is_some_and(|best| (best.i, best.j) == (node.i, node.j));
        let worst = (is_spot && workcell.certifies()).then(|| {
            let certificate = workcell.certificate(layout, maps);
            let found = certificate.operations.into_iter().nth(operation).flatten();
            found.and_then(|found| found.ok()?.most)
        });
        Ok(Self {
            cell,
            operation,
            base: layout.base,
            node: Some((node.i, node.j)),
            position: node.position,
            joints: posture.joints,
            evaluator: workcell.evaluator(operation).clone(),
            situation,
            frames,
            worst,
        })
    }

    /// Returns the posture with given joint coordinates, with its context in the layout of the cell file.
    ///
    /// `workcell` is the prepared workcell, or the reason why it cannot be prepared. The workcell is needed
    /// only if the surface frame is taught, or if the operation places a picked part. Both cases need the
    /// inverse kinematics for further postures.
    ///
    /// # Errors
    /// Returns the reason if the taught frame cannot be computed. If the operation places a picked part, also
    /// returns the reason if the posture at the pick cannot be computed.
    pub fn of_joints(
        cell: &'a Cell,
        workcell: Result<&Workcell, &str>,
        operation: usize,
        joints: JointVector,
    ) -> Result<Self, String> {
        let evaluator = ErrorEvaluator::new(cell, &cell.operations[operation]);
        let chain = evaluator.propagation().chain;
        let frames = chain.frames(&chain.posture(&joints));
        let layout = cell.start();
        let depends =
            cell.registration == Registration::Taught || cell.operations[operation].relative_to.is_some();
        let situation = if depends {
            situation_elsewhere(cell, workcell, operation, &layout)?
        } else {
            let equipment = cell.operations[operation].equipment;
            let work = layout.base.pose().inverse() * layout.placements[equipment].pose();
            let world = layout.base.from_world();
            WorkContext { site: WorkFrame { equipment, work, world, taught: None }, reference: None }
        };
        let position = layout.base.pose().transform(&frames.tcp.translation);
        let base = layout.base;
        let worst = None;
        Ok(Self { cell, operation, base, node: None, position, joints, evaluator, situation, frames, worst })
    }
}

impl PostureContext<'_> {
    /// Returns the limit of the operation and its margin; `value` is the error under the reading, m or rad.
    ///
    /// The margin is the limit minus `value`. If [`Self::worst`] holds a larger upper bound, this bound
    /// replaces `value`.
    ///
    /// Returns None without a limit. Also returns None if the quantity is the yield, whose definition
    /// already contains the limit.
    pub fn requirement(&self, value: f64) -> Option<Requirement> {
        let limit = self.evaluator.limit.filter(|_| !self.cell.is_yield())?;
        let (worst, known) = match self.worst {
            None => (value, true),
            Some(None) => (value, false),
            Some(Some(worst)) => (worst.max(value), true),
        };
        Some(Requirement { limit, margin: limit - worst, drawn: limit - value, known })
    }
}

/// Returns the [`WorkContext`] of an operation that uses a taught frame or places a picked part. This context
/// depends on further postures: the postures that teach the frame, or the posture that picked the part.
fn situation_elsewhere(
    cell: &Cell,
    workcell: Result<&Workcell, &str>,
    operation: usize,
    layout: &Layout,
) -> Result<WorkContext, String> {
    let name = shown(&cell.operations[operation].name);
    let what = match cell.registration {
        Registration::Taught => "a taught frame",
        _ => "the pick of a placed part",
    };
    let workcell =
        workcell.map_err(|why| format!("{what} needs the inverse kinematics of the robot: {why}"))?;
    let maps = workcell.maps(layout);
    let Some(any) = maps[operation].nodes.iter().find_map(|n| n.posture.as_ref()) else {
        return Err(no_usable_node(cell, &maps[operation]));
    };
    let posed = workcell.posed(layout, &maps, operation, any);
    posed.map(|(situation, _)| situation).map_err(|why| format!("{name}: {}", why.in_words()))
}

/// Returns, in words, why a map has no best node.
pub fn no_usable_node(cell: &Cell, map: &OperationMap) -> String {
    let operation = &cell.operations[map.operation];
    let name = shown(&operation.name);
    let first =
        map.nodes.iter().find(|n| n.status != Status::Ok).filter(|_| operation.over.needs_every_node());
    if let Some(node) = first {
        let (failing, all) = (map.nodes.len() - map.count(NodeSign::Usable), map.nodes.len());
        let why = node.status.reason(cell);
        return format!(
            "{name} happens at all of its {all} nodes, but {failing} of these cannot be used; the first unusable node is ({}, {}): {why}",
            node.i, node.j
        );
    }
    let occurs = |sign: &NodeSign| !sign.is_usable() && map.count(*sign) > 0;
    let counts = NodeSign::ALL.into_iter().filter(occurs);
    let counts: Vec<String> = counts.map(|sign| format!("{} {}", map.count(sign), sign.label())).collect();
    let unjudged = map.nodes.iter().find_map(|n| match n.status {
        Status::Unjudged(why) => Some(format!("; {}", why.in_words())),
        _ => None,
    });
    format!("{name} has no usable node: {}{}", counts.join(", "), unjudged.unwrap_or_default())
}

/// Returns, in words, why a map has no best node. If an overlap of the equipment blocks nodes, the text also
/// describes this overlap.
pub fn no_spot(cell: &Cell, map: &OperationMap) -> String {
    let blocked = map.nodes.iter().find(|n| matches!(n.status, Status::Overlap(_)));
    let overlap = blocked.map_or(String::new(), |n| format!("; {}", n.status.reason(cell)));
    no_usable_node(cell, map) + &overlap
}
