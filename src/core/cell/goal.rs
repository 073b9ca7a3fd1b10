//! Goals of a layout, for a search with several goals (Pareto search).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest number of layouts that a search may be asked to report.
pub const MAX_KEPT: usize = 100;

/// Goal of a layout, which a search minimizes or maximizes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Goal {
    /// Error, minimized: objective that combines the values of the operations. The objective is a length in
    /// m, an angle in rad, a share of failures or a cost.
    Error,
    /// Clearance, m, maximized: the smallest distance. Two kinds of distance count. The first kind is between
    /// the robot and other objects at the operations. The second kind is between floor spaces, or between a
    /// floor space and the fence.
    Clearance,
    /// Distance from joint limits, maximized: least distance of a joint from its nearer limit. The distance
    /// is a share of half the range of the joint.
    JointLimits,
    /// Distance from singular postures, maximized: least singular value of the Jacobian, with lengths divided
    /// by the arm reach.
    Singularity,
    /// Travel, rad, minimized: joint travel from operation to operation.
    Travel,
    /// Footprint, m^2, minimized: area of the convex hull of all floor spaces (robot base and equipment).
    Footprint,
    /// Cycle time, s, minimized: least time of the operations and of the motions between them.
    Time,
    /// Cost, minimized: cost of the cheapest tolerances with which every operation stays within its limit.
    Cost,
}

impl Goal {
    /// All goals.
    pub const ALL: [Goal; 8] = [
        Goal::Error,
        Goal::Clearance,
        Goal::JointLimits,
        Goal::Singularity,
        Goal::Travel,
        Goal::Footprint,
        Goal::Time,
        Goal::Cost,
    ];

    /// Returns the name of this goal as it is written in files, for example `joint-limits`.
    pub fn name(self) -> &'static str {
        match self {
            Goal::Error => "error",
            Goal::Clearance => "clearance",
            Goal::JointLimits => "joint-limits",
            Goal::Singularity => "singularity",
            Goal::Travel => "travel",
            Goal::Footprint => "footprint",
            Goal::Time => "time",
            Goal::Cost => "cost",
        }
    }

    /// Returns whether a greater value is better.
    pub fn is_gain(self) -> bool {
        matches!(self, Goal::Clearance | Goal::JointLimits | Goal::Singularity)
    }

    /// Returns the value to minimize: `value` itself, or `-value` if the goal is maximized.
    pub fn loss(self, value: f64) -> f64 {
        if self.is_gain() { -value } else { value }
    }
}

/// List of distinct goals, in the order in which they were named.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct Goals([Option<Goal>; Goal::ALL.len()]);

impl Goals {
    /// No goals: the search minimizes the error alone.
    pub const NONE: Self = Self([None; Goal::ALL.len()]);

    /// Returns the list of the named goals; None if a goal is named twice.
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

    /// Returns the list of all goals.
    pub fn all() -> Self {
        Self(Goal::ALL.map(Some))
    }

    /// Returns the goals in their order.
    pub fn iter(&self) -> impl Iterator<Item = Goal> + '_ {
        self.0.iter().flatten().copied()
    }

    /// Returns the number of goals.
    pub fn count(&self) -> usize {
        self.iter().count()
    }

    /// Returns whether the list has no goals.
    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }
}
