//! Goals of a layout in the units of documents.

use super::numbers::nine_digits;
use crate::cell::{Cell, Goal, Goals, Unit};
use crate::search::SearchRecord;
use crate::units::{
    deg_from_rad, m_from_mm, mm_from_m, percent_from_share, rad_from_deg, share_from_percent,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Value of every goal of a layout.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GoalsEntry {
    /// Objective, in the unit of the document.
    pub error: f64,
    pub clearance_mm: f64,
    /// Least distance of a joint from its nearer limit, in percent of half the range of the joint.
    pub joint_limits_percent: f64,
    /// Least singular value of the Jacobian, with lengths divided by the arm's reach.
    pub singularity: f64,
    pub travel_deg: f64,
    pub footprint_m2: f64,
    /// Least time of the motions and the operations; absent if the maximum speed of a joint is not given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_s: Option<f64>,
    /// Cost of the cheapest tolerances that meet every limit; absent if the search does not price tolerances.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cost: Option<f64>,
}

impl GoalsEntry {
    /// Makes the entry from SI values in the order of [`Goal::ALL`].
    pub fn new(cell: &Cell, values: &[f64]) -> Self {
        let of = |goal: Goal| {
            let place = Goal::ALL.iter().position(|g| *g == goal);
            let si = place.and_then(|k| values.get(k)).copied().unwrap_or_default();
            nine_digits(value(cell, goal, si))
        };
        Self {
            error: of(Goal::Error),
            clearance_mm: of(Goal::Clearance),
            joint_limits_percent: of(Goal::JointLimits),
            singularity: of(Goal::Singularity),
            travel_deg: of(Goal::Travel),
            footprint_m2: of(Goal::Footprint),
            time_s: Some(of(Goal::Time)).filter(|time| time.is_finite() && cell.has_speeds()),
            cost: Some(of(Goal::Cost)).filter(|cost| cost.is_finite() && cell.search.prices_tolerances()),
        }
    }

    /// Returns the value of one goal.
    pub fn get(&self, goal: Goal) -> f64 {
        match goal {
            Goal::Error => self.error,
            Goal::Clearance => self.clearance_mm,
            Goal::JointLimits => self.joint_limits_percent,
            Goal::Singularity => self.singularity,
            Goal::Travel => self.travel_deg,
            Goal::Footprint => self.footprint_m2,
            Goal::Time => self.time_s.unwrap_or(f64::NAN),
            Goal::Cost => self.cost.unwrap_or(f64::NAN),
        }
    }
}

/// Converts the value of a goal from SI to the unit that [`word`] names.
pub fn value(cell: &Cell, goal: Goal, si: f64) -> f64 {
    match goal {
        Goal::Error => cell.unit().from_si(si),
        Goal::Clearance => mm_from_m(si),
        Goal::JointLimits => percent_from_share(si),
        Goal::Travel => deg_from_rad(si),
        Goal::Singularity | Goal::Footprint | Goal::Time | Goal::Cost => si,
    }
}

/// Converts the value of a goal to SI from the unit that [`word`] names.
pub fn si(cell: &Cell, goal: Goal, value: f64) -> f64 {
    match goal {
        Goal::Error if cell.unit() == Unit::Angle => rad_from_deg(value),
        Goal::Error if matches!(cell.unit(), Unit::Share | Unit::Cost) => value,
        Goal::Error | Goal::Clearance => m_from_mm(value),
        Goal::JointLimits => share_from_percent(value),
        Goal::Travel => rad_from_deg(value),
        Goal::Singularity | Goal::Footprint | Goal::Time | Goal::Cost => value,
    }
}

/// Returns the unit of a goal; the text is empty if the value of the goal has no unit.
pub fn word(cell: &Cell, goal: Goal) -> &'static str {
    match goal {
        Goal::Error => cell.unit().word(),
        Goal::Clearance => "mm",
        Goal::JointLimits => "%",
        Goal::Singularity => "",
        Goal::Travel => "deg",
        Goal::Footprint => "m2",
        Goal::Time => "s",
        Goal::Cost => "",
    }
}

/// Returns the heading of a goal's column: the name and the unit of the goal.
pub fn head(cell: &Cell, goal: Goal) -> String {
    format!("{} {}", goal.name(), word(cell, goal)).trim_end().to_string()
}

/// Returns the key of a goal in documents. The key `error` names no unit, because the unit of the error
/// depends on the cell.
pub fn key(goal: Goal) -> &'static str {
    match goal {
        Goal::Error => "error",
        Goal::Clearance => "clearance_mm",
        Goal::JointLimits => "joint_limits_percent",
        Goal::Singularity => "singularity",
        Goal::Travel => "travel_deg",
        Goal::Footprint => "footprint_m2",
        Goal::Time => "time_s",
        Goal::Cost => "cost",
    }
}

/// Returns a description of the Pareto front or of the shortlist of layouts.
pub fn in_words(goals: &Goals, record: &SearchRecord) -> String {
    let count = record.alternatives.len();
    match goals.is_empty() {
        true => format!("the {count} best layouts that differ clearly from each other"),
        false => {
            let names: Vec<_> = goals.iter().map(Goal::name).collect();
            format!("Pareto front of {count} layouts for the goals {}", names.join(", "))
        }
    }
}

/// Returns the file name of one of `count` alternative layouts. The rank of this layout is `place`, counted
/// from 0.
pub fn file_name(place: usize, count: usize) -> String {
    let digits = count.to_string().len().max(2);
    format!("layout-{:0digits$}.toml", place + 1)
}
