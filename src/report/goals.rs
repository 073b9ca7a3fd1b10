//! Goals in the units of reports.

use crate::cell::{Cell, Goal, Goals, Unit};
use crate::search::SearchRecord;
use crate::units::{
    deg_from_rad, m_from_mm, mm_from_m, percent_from_share, rad_from_deg, share_from_percent,
};

/// The value of a goal (SI) in the unit of [`word`].
pub fn value(cell: &Cell, goal: Goal, si: f64) -> f64 {
    match goal {
        Goal::Error => cell.unit().from_si(si),
        Goal::Clearance => mm_from_m(si),
        Goal::JointLimits => percent_from_share(si),
        Goal::Travel => deg_from_rad(si),
        Goal::Singularity | Goal::Footprint => si,
    }
}

/// The same backwards.
pub fn si(cell: &Cell, goal: Goal, value: f64) -> f64 {
    match goal {
        Goal::Error if cell.unit() == Unit::Angle => rad_from_deg(value),
        Goal::Error if cell.unit() == Unit::Share => value,
        Goal::Error | Goal::Clearance => m_from_mm(value),
        Goal::JointLimits => share_from_percent(value),
        Goal::Travel => rad_from_deg(value),
        Goal::Singularity | Goal::Footprint => value,
    }
}

/// The unit of a goal; empty of a plain number.
pub fn word(cell: &Cell, goal: Goal) -> &'static str {
    match goal {
        Goal::Error => cell.unit().word(),
        Goal::Clearance => "mm",
        Goal::JointLimits => "%",
        Goal::Singularity => "",
        Goal::Travel => "deg",
        Goal::Footprint => "m2",
    }
}

/// Goal and unit: the head of a column.
pub fn head(cell: &Cell, goal: Goal) -> String {
    format!("{} {}", goal.name(), word(cell, goal)).trim_end().to_string()
}

/// The key in documents; of the error, its unit is that of the document.
pub fn key(goal: Goal) -> &'static str {
    match goal {
        Goal::Error => "error",
        Goal::Clearance => "clearance_mm",
        Goal::JointLimits => "joint_limits_percent",
        Goal::Singularity => "singularity",
        Goal::Travel => "travel_deg",
        Goal::Footprint => "footprint_m2",
    }
}

/// What the layouts beside the best are, in words.
pub fn in_words(goals: &Goals, record: &SearchRecord) -> String {
    let count = record.alternatives.len();
    match goals.is_empty() {
        true => format!("the {count} best layouts that really differ"),
        false => {
            let names: Vec<_> = goals.iter().map(Goal::name).collect();
            format!("front of {count} layouts in {}", names.join(", "))
        }
    }
}

/// The file of such a layout, by its place.
pub fn file_name(place: usize, count: usize) -> String {
    let digits = count.to_string().len().max(2);
    format!("layout-{:0digits$}.toml", place + 1)
}
