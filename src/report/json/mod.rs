//! The machine-readable contract: field names of what `--json` prints.
//!
//! Lengths in mm, angles in degrees, rounded to 1e-9; world frame; joints in the robot's own
//! coordinates. What has no value is null, never left out.

mod envelope;
mod layouts;
mod map;
mod posture;
mod readings;
mod sweep;

pub use envelope::{envelope, robot, robots};
pub use layouts::{compare, search};
pub use map::{MapDocument, map};
pub use posture::{budget, explain};
pub use readings::readings;
pub use sweep::{row, values};

use crate::cell::{Cell, JointKind, JointVector, Layout, Role};
use crate::clearance::{Allowed, OwnPair};
use crate::layout::Workcell;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;
use serde_json::{Value, json};

/// Every pair of solids of the robot: what they are, and why they may touch (null: they may not).
pub fn own_pairs(workcell: &Workcell) -> Vec<Value> {
    let pair = |p: &OwnPair| {
        let [a, b] = [p.a, p.b].map(|id| id.in_words(&workcell.cell));
        json!({ "a": a, "b": b, "allowed": p.allowed.map(Allowed::in_words) })
    };
    workcell.own_pairs().iter().map(pair).collect()
}

/// Placements by the name of the equipment; obstacles are not the layout's to place.
fn layout(cell: &Cell, layout: &Layout) -> Value {
    let placed = cell.equipment.iter().zip(&layout.placements).filter(|(e, _)| e.role == Role::Equipment);
    let one = placed.map(|(e, p)| {
        let mm = |v| length(mm_from_m(v));
        let at = json!({
            "x_mm": mm(p.x), "y_mm": mm(p.y), "z_mm": mm(p.z), "yaw_deg": length(deg_from_rad(p.yaw)),
        });
        (e.name.clone(), at)
    });
    Value::Object(one.collect())
}

fn joints(cell: &Cell, q: &JointVector) -> Vec<f64> {
    let in_file_units = cell.robot.joints.iter().zip(q).map(|(joint, &q)| match joint.kind {
        JointKind::Revolute => length(deg_from_rad(q)),
        JointKind::Prismatic => length(mm_from_m(q)),
    });
    in_file_units.collect()
}

fn lengths(v: &Vector3<f64>) -> [f64; 3] {
    v.map(|m| length(mm_from_m(m))).into()
}

fn length(mm: f64) -> f64 {
    rounded(mm, 9)
}
