//! What a layout may be good at: goals of a search for more than one.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Layouts that may be kept, at most.
pub const MAX_KEPT: usize = 100;

/// One thing that a layout may be good at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Goal {
    /// The objective: m, rad or a share; small.
    Error,
    /// How far the robot at its spots and the floor spaces stay from everything, m; large.
    Clearance,
    /// How far a joint stays from its nearer limit, as a share of half its range; large.
    JointLimits,
    /// The least singular value of the Jacobian, lengths in arm reaches; large.
    Singularity,
    /// How far the joints go from operation to operation, rad; small.
    Travel,
    /// Floor space, m2; small.
    Footprint,
}

impl Goal {
    pub const ALL: [Goal; 6] =
        [Goal::Error, Goal::Clearance, Goal::JointLimits, Goal::Singularity, Goal::Travel, Goal::Footprint];

    pub fn name(self) -> &'static str {
        match self {
            Goal::Error => "error",
            Goal::Clearance => "clearance",
            Goal::JointLimits => "joint-limits",
            Goal::Singularity => "singularity",
            Goal::Travel => "travel",
            Goal::Footprint => "footprint",
        }
    }

    /// Whether more of it is better.
    pub fn is_gain(self) -> bool {
        matches!(self, Goal::Clearance | Goal::JointLimits | Goal::Singularity)
    }

    /// Returns the value to minimize: a gain is negated.
    pub fn loss(self, value: f64) -> f64 {
        if self.is_gain() { -value } else { value }
    }
}

/// Some goals, each once, in the order in which they were named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Goals([Option<Goal>; Goal::ALL.len()]);

impl Goals {
    /// No goal: the search is for the least error alone.
    pub const NONE: Self = Self([None; Goal::ALL.len()]);

    /// None if one is named twice.
    pub fn of(named: &[Goal]) -> Option<Self> {
        let mut goals = Self::default();
        for (k, goal) in named.iter().enumerate() {
            if goals.iter().any(|g| g == *goal) {
                return None;
            }
            goals.0[k] = Some(*goal);
        }
        Some(goals)
    }

    pub fn all() -> Self {
        Self(Goal::ALL.map(Some))
    }

    pub fn iter(&self) -> impl Iterator<Item = Goal> + '_ {
        self.0.iter().flatten().copied()
    }

    pub fn count(&self) -> usize {
        self.iter().count()
    }

    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }
}
