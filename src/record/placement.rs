//! Layouts in documents: placements under the names of the equipment, free angles under the names of the
//! operations.

use super::numbers::{degrees, millimetres};
use crate::cell::{Cell, Layout, Placement, Role, Slot};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Values by name, in the order of the cell file.
pub type ByName<T> = IndexMap<String, T>;

/// Pose of a piece of equipment or of the robot base in the world frame, mm and degrees.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacementEntry {
    pub x_mm: f64,
    pub y_mm: f64,
    pub z_mm: f64,
    pub yaw_deg: f64,
}

impl PlacementEntry {
    pub fn new(at: &Placement) -> Self {
        let [x_mm, y_mm, z_mm] = [at.x, at.y, at.z].map(millimetres);
        Self { x_mm, y_mm, z_mm, yaw_deg: degrees(at.yaw) }
    }
}

/// Angles of a tool attitude that the search may change, degrees.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AttitudeEntry {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bend_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub azimuth_deg: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spin_deg: Option<f64>,
}

/// Returns the placements by the name of the equipment. Obstacles are left out, because a layout does not
/// place them.
pub fn placements(cell: &Cell, layout: &Layout) -> ByName<PlacementEntry> {
    let placed = cell.equipment.iter().zip(&layout.placements).filter(|(e, _)| e.role == Role::Equipment);
    placed.map(|(e, at)| (e.name.clone(), PlacementEntry::new(at))).collect()
}

/// Returns the angles that the search may change, by the name of the operation.
pub fn attitudes(cell: &Cell, layout: &Layout) -> ByName<AttitudeEntry> {
    let mut all: ByName<AttitudeEntry> = ByName::new();
    for (slot, _) in cell.free() {
        let Slot::Attitude(k, angle) = slot else { continue };
        let entry = all.entry(cell.operations[k].name.clone()).or_default();
        let value = Some(degrees(layout.value(cell, slot)));
        match angle {
            0 => entry.bend_deg = value,
            1 => entry.azimuth_deg = value,
            _ => entry.spin_deg = value,
        }
    }
    all
}
