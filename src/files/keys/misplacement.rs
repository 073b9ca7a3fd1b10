//! How exactly things are placed: `placement_tolerance` of an equipment, `base_tolerance` of the robot.

use crate::cell::{PlacementTolerance, Role};
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Node;
use crate::files::toml::value::Must;
use crate::units;

/// Plus-or-minus x, y, z and yaw; what is missing is exact.
pub fn read(node: &Node, what: &str, role: Role, lib: &mut Library<'_>) -> Option<PlacementTolerance> {
    if role == Role::Obstacle {
        let help = "make it an [equipment.NAME] if it can be misplaced, or remove it";
        lib.error(node.at, format!("an obstacle has no {what}"), help);
        return None;
    }
    Table::read(node, what, lib, |t, lib| {
        let lengths = ["x_mm", "y_mm", "z_mm"].map(|key| t.number_or(key, 0.0, Must::NotBeNegative, lib));
        let yaw = t.number_or("yaw_deg", 0.0, Must::NotBeNegative, lib);
        let [x, y, z] = lengths.map(|v| v.map(units::m_from_mm));
        Some(PlacementTolerance([x?, y?, z?, units::rad_from_deg(yaw?)]))
    })
}
