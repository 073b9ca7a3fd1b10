//! What the map says of a node.

use crate::cell::{Cell, JointVector, shown};
use crate::clearance::{Hit, Overlap};
use crate::reach::LimitViolation;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;

/// Why a node can or cannot be used. Different answers, never one score.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Status {
    Ok,
    /// No posture at all; so many metres are missing.
    OutOfReach {
        by: f64,
    },
    /// Every posture passes a joint limit; the least violation.
    JointLimit {
        violation: LimitViolation,
        needs: f64,
    },
    /// Every posture within the limits touches something; what the least-error one touches.
    Collision {
        hit: Hit,
    },
    /// The equipment that carries the node stands where it cannot.
    Overlap(Overlap),
}

impl Status {
    pub fn name(&self) -> &'static str {
        match self {
            Status::Ok => "ok",
            Status::OutOfReach { .. } => "out-of-reach",
            Status::JointLimit { .. } => "joint-limit",
            Status::Collision { .. } | Status::Overlap(_) => "collision",
        }
    }

    /// The reason in words, with the names of the cell; empty if the node is ok.
    pub fn reason(&self, cell: &Cell) -> String {
        match self {
            Status::Ok => String::new(),
            Status::OutOfReach { by } => format!("out of reach by {:.1} mm", mm_from_m(*by)),
            Status::JointLimit { violation, needs } => {
                let joint = &cell.robot.joints[violation.joint];
                let limit = if *needs < joint.limits.0 { joint.limits.0 } else { joint.limits.1 };
                let (needs, limit) = (deg_from_rad(*needs), deg_from_rad(limit));
                format!(
                    "joint {} needs {needs:.2} deg, its limit is {} deg",
                    shown(&joint.name),
                    rounded(limit, 6)
                )
            }
            Status::Overlap(overlap) => overlap.in_words(cell),
            Status::Collision { hit } => {
                let robot = &cell.robot.solids[hit.solid].solid.name;
                match hit.other {
                    None => format!("{robot} touches the floor"),
                    Some((e, s)) => {
                        let equipment = &cell.equipment[e];
                        format!("{robot} touches {} ({})", equipment.name, equipment.solids[s].name)
                    }
                }
            }
        }
    }
}

/// One node of the map. Joints and errors are those of the branch reported: the least error among
/// the usable ones; if the node collides, the least error within the limits; else none.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeRecord {
    pub i: usize,
    pub j: usize,
    /// TCP target, world, m.
    pub position: Vector3<f64>,
    pub status: Status,
    pub posture: Option<PostureRecord>,
}

/// The branch reported for a node, errors in the world frame (m, rad).
#[derive(Debug, Clone, PartialEq)]
pub struct PostureRecord {
    pub branch: u8,
    pub joints: JointVector,
    /// By the model of the cell.
    pub error: Vector3<f64>,
    pub rotation: Vector3<f64>,
    pub nonlinear: Vector3<f64>,
    pub linear: Vector3<f64>,
    /// `error` in the sense of the operation, m.
    pub in_sense: f64,
}

/// The map of one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationMap {
    /// Index into [`Cell::operations`].
    pub operation: usize,
    pub nodes: Vec<NodeRecord>,
    /// Index of the usable node with the least error in the sense.
    pub best: Option<usize>,
}

impl OperationMap {
    /// Marks what could be used as blocked: the surface itself stands where it cannot.
    pub fn block(&mut self, overlap: Overlap) {
        let blocked = |n: &&mut NodeRecord| matches!(n.status, Status::Ok | Status::Collision { .. });
        self.nodes.iter_mut().filter(blocked).for_each(|n| n.status = Status::Overlap(overlap));
        self.best = None;
    }

    pub fn best_node(&self) -> Option<&NodeRecord> {
        self.best.map(|k| &self.nodes[k])
    }

    /// How many nodes have this status, by its name.
    pub fn count(&self, status: &str) -> usize {
        self.nodes.iter().filter(|n| n.status.name() == status).count()
    }
}
