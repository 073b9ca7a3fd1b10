//! What the map says of a node.

use super::node_sign::NodeSign;
use super::outcome::{Spot, Unjudged};
use crate::cell::{Cell, JointKind, JointVector, Model, Sense};
use crate::clearance::{Hit, Overlap};
use crate::files::shown;
use crate::motion::PostureRefusal;
use crate::reach::LimitViolation;
use crate::reading::Figures;
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
    /// In reach, but so much of the attitude is missing (rad), with this joint at its limit.
    Attitude {
        by: f64,
        joint: Option<usize>,
    },
    /// The numeric inverse kinematics came no nearer than this (m, rad): there may be a posture.
    NotConverged {
        position: f64,
        angle: f64,
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
    /// Every posture within the limits touches something or is refused for its motion; why the
    /// least-error one is.
    Refused(PostureRefusal),
    /// The equipment that carries the node stands where it cannot.
    Overlap(Overlap),
    /// It can be reached, but its error depends on something that is missing.
    Unjudged(Unjudged),
}

impl Status {
    /// Returns the name of its class in documents.
    pub fn name(&self) -> &'static str {
        self.sign().name()
    }

    /// The reason in words, with the names of the cell; empty if the node is ok.
    pub fn reason(&self, cell: &Cell) -> String {
        match self {
            Status::Ok => String::new(),
            Status::OutOfReach { by } => format!("out of reach by {:.1} mm", mm_from_m(*by)),
            Status::JointLimit { violation, needs } => {
                let joint = &cell.robot.joints[violation.joint];
                let limit = if *needs < cell.margins.kept(joint).0 { joint.limits.0 } else { joint.limits.1 };
                let (needs, limit, unit) = match joint.kind {
                    JointKind::Revolute => (deg_from_rad(*needs), deg_from_rad(limit), "deg"),
                    JointKind::Prismatic => (mm_from_m(*needs), mm_from_m(limit), "mm"),
                };
                let name = shown(&joint.name);
                let less = match (cell.margins.of(joint), joint.kind) {
                    (0.0, _) => String::new(),
                    (margin, JointKind::Revolute) => {
                        format!(" less a margin of {} {unit}", rounded(deg_from_rad(margin), 6))
                    }
                    (margin, JointKind::Prismatic) => {
                        format!(" less a margin of {} {unit}", rounded(mm_from_m(margin), 6))
                    }
                };
                format!(
                    "joint {name} needs {needs:.2} {unit}, its limit is {} {unit}{less}",
                    rounded(limit, 6)
                )
            }
            Status::Attitude { by, joint } => {
                let at =
                    joint.map(|j| format!(" with joint {} at its limit", shown(&cell.robot.joints[j].name)));
                format!("the attitude is missed by {:.2} deg{}", deg_from_rad(*by), at.unwrap_or_default())
            }
            Status::NotConverged { position, angle } => format!(
                "no posture found, and none ruled out: the nearest is off by {:.3} mm and {:.3} deg",
                mm_from_m(*position),
                deg_from_rad(*angle)
            ),
            Status::Refused(refusal) => refusal.in_words(cell),
            Status::Overlap(overlap) => overlap.in_words(cell),
            Status::Unjudged(why) => why.in_words().into(),
            Status::Collision { hit } => hit.in_words(cell),
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

impl NodeRecord {
    /// Returns the posture if the node is usable: a colliding node has a posture, too.
    pub fn usable_posture(&self) -> Option<&PostureRecord> {
        self.posture.as_ref().filter(|_| self.status.sign().is_usable())
    }
}

/// The branch reported for a node, errors in the world frame (m, rad): those of the signed sample,
/// or, of a tolerance, those of the corner that is worst in the sense of the operation.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureRecord {
    pub branch: u32,
    pub joints: JointVector,
    /// By the model of the cell.
    pub error: Vector3<f64>,
    pub rotation: Vector3<f64>,
    pub nonlinear: Vector3<f64>,
    pub linear: Vector3<f64>,
    /// How far these models are from the nonlinear one, as a share of its resultant.
    pub linear_off: f64,
    pub second_order_off: f64,
    /// Whether the node was touched to teach the frame: it cannot be the spot.
    pub touched: bool,
    /// What the reading makes small: m, rad or a share of failures.
    pub value: f64,
    /// One per sense of [`OperationMap::senses`].
    pub figures: Vec<Figures>,
    /// P(|error| <= limit), of an operation with a limit.
    pub success: Option<f64>,
}

impl PostureRecord {
    /// How far a model is from the nonlinear one.
    pub fn off(&self, model: Model) -> f64 {
        match model {
            Model::Nonlinear => 0.0,
            Model::Linear => self.linear_off,
            Model::SecondOrder => self.second_order_off,
        }
    }
}

/// The map of one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationMap {
    /// Index into [`Cell::operations`].
    pub operation: usize,
    /// The senses in which every node is reported: the paper's, and the operation's own.
    pub senses: Vec<Sense>,
    pub nodes: Vec<NodeRecord>,
    /// Index of the usable node with the least value; of an operation that happens at every node, of
    /// the one with the greatest, if all are usable.
    pub best: Option<usize>,
    /// What the operation is worth: the value of that node, or that of all nodes together.
    pub value: Option<f64>,
}

impl OperationMap {
    /// Marks what could be used as blocked: the surface itself stands where it cannot.
    pub fn block(&mut self, overlap: Overlap) {
        let blocked = |n: &&mut NodeRecord| {
            matches!(
                n.status,
                Status::Ok | Status::Collision { .. } | Status::Refused(_) | Status::Unjudged(_)
            )
        };
        self.nodes.iter_mut().filter(blocked).for_each(|n| n.status = Status::Overlap(overlap));
        (self.best, self.value) = (None, None);
    }

    /// Returns the usable nodes with their numbers and postures.
    pub fn usable(&self) -> impl Iterator<Item = (usize, &NodeRecord, &PostureRecord)> {
        self.nodes.iter().enumerate().filter_map(|(k, node)| Some((k, node, node.usable_posture()?)))
    }

    pub fn best_node(&self) -> Option<&NodeRecord> {
        self.best.map(|k| &self.nodes[k])
    }

    /// The spot of the operation.
    pub fn spot(&self) -> Option<Spot> {
        let posture = self.best_node()?.posture.as_ref()?;
        Some(Spot { node: self.best?, branch: posture.branch, value: self.value? })
    }

    /// Place of a sense among the reported ones, by its name.
    pub fn sense(&self, name: &str) -> Option<usize> {
        self.senses.iter().position(|s| s.name == name)
    }

    /// How far a model is from the nonlinear one over the usable nodes: the most (a share of the
    /// resultant), at how many nodes it is more than `guard`, and of how many.
    pub fn off(&self, model: Model, guard: f64) -> (f64, usize, usize) {
        self.usable().map(|(_, _, p)| p.off(model)).fold((0.0, 0, 0), |(most, above, all), off| {
            (f64::max(most, off), above + usize::from(off > guard), all + 1)
        })
    }

    /// Returns the number of nodes with this sign.
    pub fn count(&self, sign: NodeSign) -> usize {
        self.nodes.iter().filter(|n| n.status.sign() == sign).count()
    }
}
