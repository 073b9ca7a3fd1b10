//! Entry of several documents: the spot refined between the nodes of the grid.

use super::numbers::{in_unit, joints, millimetres, percent, position_mm};
use crate::assess::Assessment;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Best spot between the nodes of the grid, mm and degrees.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RefinedEntry {
    /// Position of the TCP in the world frame.
    pub position_mm: [f64; 3],
    /// Coordinates x and y of the spot in the frame of the equipment.
    pub on_surface_mm: [f64; 2],
    /// Joint coordinates: degrees, or mm for a prismatic joint.
    pub joints_deg: Vec<f64>,
    /// Value of the operation at the refined spot, in the unit of the objective.
    pub value: f64,
    /// Certified upper bound of the value over all misplacements within the placement tolerances, in the unit
    /// of the objective. Absent if the layout need not withstand misplacements, or if no bound is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_value: Option<f64>,
    /// Value of the operation at the best node, in the unit of the objective.
    pub node_value: f64,
    pub node_on_surface_mm: [f64; 2],
    pub gain_percent: f64,
}

impl RefinedEntry {
    /// Makes the entry; None if the operation has no spot, states a list of points, or happens at every node.
    pub fn new(a: &Assessment<'_>, operation: usize) -> Option<Self> {
        let refined = a.refined[operation].as_ref()?;
        let unit = a.cell.unit();
        let on_surface = |(x, y): (f64, f64)| [millimetres(x), millimetres(y)];
        Some(Self {
            position_mm: position_mm(&refined.position),
            on_surface_mm: on_surface(refined.at),
            joints_deg: joints(a.cell, &refined.joints),
            value: in_unit(unit, refined.value),
            worst_value: refined.most.map(|most| in_unit(unit, most)),
            node_value: in_unit(unit, refined.node_value),
            node_on_surface_mm: on_surface(refined.node_at),
            gain_percent: percent(refined.gain()),
        })
    }
}
