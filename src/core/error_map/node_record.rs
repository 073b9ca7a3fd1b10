//! Records of an error map: status, posture and errors of every node.

use super::node_sign::NodeSign;
use super::outcome::{Spot, Unjudged};
use crate::cell::{Cell, JointKind, JointVector, Model, Sense};
use crate::clearance::{Hit, Overlap};
use crate::motion::PostureRefusal;
use crate::reach::LimitViolation;
use crate::reading::Figures;
use crate::safe_text::shown;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;

/// Status of a node: usable, or the reason why the node cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Status {
    Ok,
    /// No posture reaches the node. `by` is the distance of the node from the nearest reachable point, m.
    OutOfReach {
        by: f64,
    },
    /// The node is in reach, but the attitude is missed by the angle `by` (rad). `joint` is the joint at
    /// its limit, if any.
    Attitude {
        by: f64,
        joint: Option<usize>,
    },
    /// The numeric inverse kinematics found no posture for the node, but one may still exist.
    ///
    /// `position` (m) and `angle` (rad) are the errors of the best attempt.
    NotConverged {
        position: f64,
        angle: f64,
    },
    /// Every posture exceeds a joint limit. `violation` is the least violation among all postures. In the
    /// posture with this violation, the joint beyond its limit has the coordinate `needs` (rad or m).
    JointLimit {
        violation: LimitViolation,
        needs: f64,
    },
    /// No posture within the joint limits can be used. The least-error posture has the contact `hit`.
    Collision {
        hit: Hit,
    },
    /// No posture within the joint limits can be used. The motion rules refuse the least-error posture.
    Refused(PostureRefusal),
    /// The equipment that carries the node overlaps other equipment, the robot base, a keep-out space, the
    /// floor or the fence.
    Overlap(Overlap),
    /// The node can be reached, but its error cannot be computed.
    Unjudged(Unjudged),
}

impl Status {
    /// Returns the class of the status, without the details that the status holds.
    pub fn sign(&self) -> NodeSign {
        match self {
            Self::Ok => NodeSign::Usable,
            Self::OutOfReach { .. } => NodeSign::OutOfReach,
            Self::Attitude { .. } => NodeSign::Attitude,
            Self::NotConverged { .. } => NodeSign::NotConverged,
            Self::JointLimit { .. } => NodeSign::JointLimit,
            Self::Collision { .. } | Self::Overlap(_) => NodeSign::Collision,
            Self::Refused(PostureRefusal::Singular { .. }) => NodeSign::Singular,
            Self::Refused(PostureRefusal::Approach(_)) => NodeSign::ApproachBlocked,
            Self::Refused(PostureRefusal::Retract(_)) => NodeSign::RetractBlocked,
            Self::Unjudged(_) => NodeSign::Unjudged,
        }
    }

    /// Returns the name of this status as it appears in documents, for example `joint-limit`.
    pub fn name(&self) -> &'static str {
        self.sign().name()
    }

    /// Describes in words why the node cannot be used, with the names of joints and solids in the cell.
    ///
    /// The text is empty if the node is usable.
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
                    "joint {name} needs {needs:.2} {unit}, but its limit is {} {unit}{less}",
                    rounded(limit, 6)
                )
            }
            Status::Attitude { by, joint } => {
                let at =
                    joint.map(|j| format!(" with joint {} at its limit", shown(&cell.robot.joints[j].name)));
                format!("the attitude is missed by {:.2} deg{}", deg_from_rad(*by), at.unwrap_or_default())
            }
            Status::NotConverged { position, angle } => format!(
                "no posture was found, but one may exist: the best attempt is off by {:.3} mm and {:.3} deg",
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

/// One node of a map.
///
/// `posture` is the least-error usable posture. If no posture is usable, `posture` is the least-error posture
/// within the joint limits.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeRecord {
    pub i: usize,
    pub j: usize,
    /// Target position of the TCP, in the world frame, m.
    pub position: Vector3<f64>,
    pub status: Status,
    pub posture: Option<PostureRecord>,
}

impl NodeRecord {
    /// Returns the posture if the node is usable; None otherwise, even if a colliding posture is recorded.
    pub fn usable_posture(&self) -> Option<&PostureRecord> {
        self.posture.as_ref().filter(|_| self.status.sign().is_usable())
    }
}

/// Posture reported for a node, with its errors in the world frame.
///
/// In the signed reading, these are the errors of the signed sample. In the other readings, these are the
/// errors at one corner of the tolerance box. At this corner, the error component that matters to the
/// operation (its sense) is largest.
#[derive(Debug, Clone, PartialEq)]
pub struct PostureRecord {
    pub branch: u64,
    pub joints: JointVector,
    /// Position error under the model of the cell, m.
    pub error: Vector3<f64>,
    /// Rotation error under the model of the cell, as a rotation vector, rad.
    pub rotation: Vector3<f64>,
    /// Position error under the nonlinear model, m.
    pub nonlinear: Vector3<f64>,
    /// Position error under the linear model, m.
    pub linear: Vector3<f64>,
    /// Deviation of the linear model: `|linear - nonlinear| / |nonlinear|`.
    pub linear_off: f64,
    /// Deviation of the second-order model, defined like [`Self::linear_off`].
    pub second_order_off: f64,
    /// Whether the robot touches the node to teach the surface frame. Such a node cannot be the spot.
    pub touched: bool,
    /// Value that the search minimizes: an error (m or rad), a share of failures, or a cost of tolerances.
    pub value: f64,
    /// Figures of the error in each sense of [`OperationMap::senses`], in the same order.
    pub figures: Vec<Figures>,
    /// Probability that the error is within the limit of the operation. None without a limit, or if the
    /// errors are not tolerances.
    pub success: Option<f64>,
}

impl PostureRecord {
    /// Returns the deviation of a model: [`Self::linear_off`], [`Self::second_order_off`], or 0 for the
    /// nonlinear model.
    pub fn off(&self, model: Model) -> f64 {
        match model {
            Model::Nonlinear => 0.0,
            Model::Linear => self.linear_off,
            Model::SecondOrder => self.second_order_off,
        }
    }
}

/// Error map of one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct OperationMap {
    /// Mapped operation, as an index into [`Cell::operations`].
    pub operation: usize,
    /// Senses in which every node is reported: x, y, z, xy, xyz and the operation's own sense.
    pub senses: Vec<Sense>,
    pub nodes: Vec<NodeRecord>,
    /// Index of the node shown as the spot: the usable node with the least value. None if no node is usable.
    ///
    /// If the operation happens at every node, this is the node with the greatest value. In this case, the
    /// index is None if any node is unusable.
    pub best: Option<usize>,
    /// Value of the operation: the value of its spot. If the operation happens at every node, this is the
    /// combined value of all nodes. None if there is no spot.
    pub value: Option<f64>,
}

impl OperationMap {
    /// Marks every reachable node as blocked by `overlap`, an overlap of the equipment of the operation. The
    /// map then has no spot and no value.
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

    /// Returns the usable nodes with their indices and postures.
    pub fn usable(&self) -> impl Iterator<Item = (usize, &NodeRecord, &PostureRecord)> {
        self.nodes.iter().enumerate().filter_map(|(k, node)| Some((k, node, node.usable_posture()?)))
    }

    /// Returns the node shown as the spot.
    pub fn best_node(&self) -> Option<&NodeRecord> {
        self.best.map(|k| &self.nodes[k])
    }

    /// Returns the spot of the operation.
    pub fn spot(&self) -> Option<Spot> {
        let posture = self.best_node()?.posture.as_ref()?;
        Some(Spot { node: self.best?, branch: posture.branch, value: self.value? })
    }

    /// Returns the index of a reported sense by its name.
    pub fn sense(&self, name: &str) -> Option<usize> {
        self.senses.iter().position(|s| s.name == name)
    }

    /// Compares a model with the nonlinear model over the usable nodes.
    ///
    /// Returns the largest deviation ([`PostureRecord::off`]), the number of nodes whose deviation exceeds
    /// `guard`, and the number of usable nodes.
    pub fn off(&self, model: Model, guard: f64) -> (f64, usize, usize) {
        self.usable().map(|(_, _, p)| p.off(model)).fold((0.0, 0, 0), |(most, above, all), off| {
            (f64::max(most, off), above + usize::from(off > guard), all + 1)
        })
    }

    /// Returns the number of nodes in the class `sign`.
    pub fn count(&self, sign: NodeSign) -> usize {
        self.nodes.iter().filter(|n| n.status.sign() == sign).count()
    }
}
