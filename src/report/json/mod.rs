//! The machine-readable contract: field names of what `--json` prints.
//!
//! Lengths in mm, angles in degrees, rounded to 1e-9; world frame; joints in the robot's own
//! coordinates. What has no value is null, never left out.

mod drawing;
mod envelope;
mod front;
mod layouts;
mod live;
mod map;
mod posture;
mod readings;
mod robust;
mod sweep;

pub use drawing::drawings;
pub use envelope::{envelope, robot, robots};
pub use layouts::{compare, search};
pub use live::{answer, coordinate_name, form, lens_list, numbers};
pub use map::{MapDocument, map};
pub use posture::{budget, explain};
pub use readings::readings;
pub use robust::robust;
pub use sweep::{row, values};

use crate::assess::Assessment;
use crate::cell::{Cell, JointKind, JointVector, Layout, Placement, Role, Slot};
use crate::clearance::{Allowed, SelfCollisionPair};
use crate::layout::Workcell;
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rounded};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

/// Every pair of solids of the robot: what they are, and why they may touch (null: they may not).
pub fn self_collision_pairs(workcell: &Workcell) -> Vec<Value> {
    let pair = |p: &SelfCollisionPair| {
        let [a, b] = [p.a, p.b].map(|id| id.in_words(&workcell.cell));
        json!({ "a": a, "b": b, "allowed": p.allowed.map(Allowed::in_words) })
    };
    workcell.self_collision_pairs().iter().map(pair).collect()
}

/// Placements by the name of the equipment; obstacles are not the layout's to place.
fn layout(cell: &Cell, layout: &Layout) -> Value {
    let placed = cell.equipment.iter().zip(&layout.placements).filter(|(e, _)| e.role == Role::Equipment);
    Value::Object(placed.map(|(e, at)| (e.name.clone(), placement(at))).collect())
}

fn placement(at: &Placement) -> Value {
    let mm = |v| length(mm_from_m(v));
    json!({ "x_mm": mm(at.x), "y_mm": mm(at.y), "z_mm": mm(at.z), "yaw_deg": length(deg_from_rad(at.yaw)) })
}

fn base(layout: &Layout) -> Value {
    placement(&layout.base)
}

/// The angles that the search may change, by the name of the operation.
fn attitudes(cell: &Cell, layout: &Layout) -> Value {
    let mut all = Map::new();
    for (slot, _) in cell.free() {
        let Slot::Attitude(k, angle) = slot else { continue };
        let entry = all.entry(cell.operations[k].name.clone()).or_insert_with(|| json!({}));
        entry[["bend_deg", "azimuth_deg", "spin_deg"][angle]] =
            json!(length(deg_from_rad(layout.value(cell, slot))));
    }
    Value::Object(all)
}

/// The spot between the nodes; null of an operation without a choice of it.
fn refined(a: &Assessment<'_>, operation: usize) -> Value {
    let Some(refined) = &a.refined[operation] else { return Value::Null };
    let unit = a.cell.unit();
    let on_surface = |(x, y): (f64, f64)| [length(mm_from_m(x)), length(mm_from_m(y))];
    json!({
        "position_mm": lengths(&refined.position),
        "on_surface_mm": on_surface(refined.at),
        "joints_deg": joints(a.cell, &refined.joints),
        "value": length(unit.from_si(refined.value)),
        "node_value": length(unit.from_si(refined.node_value)),
        "node_on_surface_mm": on_surface(refined.node_at),
        "gain_percent": length(percent_from_share(refined.gain())),
    })
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

/// A bound as it is written: never above what is proven.
fn rounded_down(v: f64) -> f64 {
    (v * 1e9).floor() / 1e9
}
