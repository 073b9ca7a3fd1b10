//! Classes of nodes: usable, or the reason why a node cannot be used, without details.
//!
//! Documents, tables, legends and pictures all classify nodes by one enum, so that they cannot contradict
//! each other.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Class of a node of the error map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NodeSign {
    #[serde(rename = "ok")]
    Usable,
    /// The inverse kinematics has no solution at the position.
    OutOfReach,
    /// Every solution violates a joint limit.
    JointLimit,
    /// The position is in reach, but the orientation of the tool is not.
    Attitude,
    /// The numeric inverse kinematics found no solution, but did not prove that there is none.
    NotConverged,
    /// No posture can be used, and the least-error posture collides. Nodes whose equipment overlaps something
    /// also belong to this class.
    Collision,
    /// No posture can be used. The least-error posture is collision-free. This posture, or another posture on
    /// its approach or retract line, is too near to a singular posture.
    Singular,
    /// The straight line to the node is blocked.
    #[serde(rename = "approach")]
    ApproachBlocked,
    /// The straight line away from the node is blocked.
    #[serde(rename = "retract")]
    RetractBlocked,
    /// The node can be reached, but its error cannot be computed.
    Unjudged,
}

impl NodeSign {
    /// All classes of nodes.
    pub const ALL: [Self; 10] = [
        Self::Usable,
        Self::OutOfReach,
        Self::JointLimit,
        Self::Attitude,
        Self::NotConverged,
        Self::Collision,
        Self::Singular,
        Self::ApproachBlocked,
        Self::RetractBlocked,
        Self::Unjudged,
    ];

    /// Returns the name of this class as it appears in documents (JSON, CSV, Parquet), for example
    /// `joint-limit`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Usable => "ok",
            Self::OutOfReach => "out-of-reach",
            Self::JointLimit => "joint-limit",
            Self::Attitude => "attitude",
            Self::NotConverged => "not-converged",
            Self::Collision => "collision",
            Self::Singular => "singular",
            Self::ApproachBlocked => "approach",
            Self::RetractBlocked => "retract",
            Self::Unjudged => "unjudged",
        }
    }

    /// Returns the class in words that suit both a legend and a count of nodes: "12 in collision".
    pub fn label(self) -> &'static str {
        match self {
            Self::Usable => "usable",
            Self::OutOfReach => "out of reach",
            Self::JointLimit => "beyond a joint limit",
            Self::Attitude => "orientation out of reach",
            Self::NotConverged => "not converged",
            Self::Collision => "in collision",
            Self::Singular => "nearly singular",
            Self::ApproachBlocked => "with a blocked approach",
            Self::RetractBlocked => "with a blocked retract",
            Self::Unjudged => "without a computable error",
        }
    }

    /// Returns whether the operation can happen at the node.
    pub fn is_usable(self) -> bool {
        self == Self::Usable
    }
}
