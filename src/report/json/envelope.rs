//! `robots --json`, `robot --json` and `envelope --json`.

use super::{length, lengths};
use crate::assess::{Reachable, RobotDataSheet};
use crate::cell::{ErrorSet, Joint, JointKind, Robot};
use crate::reach::{EnvelopeSection, Outline, Size};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use serde_json::{Value, json};

/// The document of `robots --json`.
pub fn robots(all: &[(&str, Robot, &str)]) -> Value {
    let one = |(stem, robot, family): &(&str, Robot, &str)| {
        json!({
            "robot": stem,
            "name": robot.name,
            "axes": robot.axes(),
            "family": family,
            "reach_mm": length(mm_from_m(robot.reach())),
            "error_sets": robot.errors.len(),
            "source": robot.source,
        })
    };
    json!({ "schema": "sweetspot/robots/1", "robots": all.iter().map(one).collect::<Vec<_>>() })
}

/// The document of `robot --json`.
pub fn robot(sheet: &RobotDataSheet<'_>) -> Value {
    let robot = sheet.robot;
    let rows = robot.joints.iter().zip(robot.rows_of_file());
    let in_unit = |(joint, q): (&Joint, &f64)| match joint.kind {
        JointKind::Revolute => rounded(deg_from_rad(*q), 9),
        JointKind::Prismatic => length(mm_from_m(*q)),
    };
    let home: Vec<f64> = robot.joints.iter().zip(&robot.home).map(in_unit).collect();
    let axis: [f64; 3] = robot.tool_axis.map(|v| rounded(v, 12)).into();
    let kind = |set: &ErrorSet| if matches!(set, ErrorSet::Signed(_)) { "signed" } else { "tolerance" };
    json!({
        "schema": "sweetspot/robot-sheet/1",
        "name": robot.name,
        "source": robot.source,
        "family": sheet.family,
        "convention": robot.convention.name(),
        "joints": rows.map(|(joint, row)| joint_row(joint, row)).collect::<Vec<_>>(),
        "coupling": robot.coupling,
        "tool": {
            "position_mm": lengths(&robot.tool.translation),
            "axis": axis,
        },
        "reach_mm": length(mm_from_m(robot.reach())),
        "home": home,
        "home_position_mm": lengths(&sheet.pose.translation),
        "solids": robot.solids.iter().map(|s| s.solid.name.as_str()).collect::<Vec<_>>(),
        "errors": robot.errors.iter().map(|e| json!({ "name": e.name(), "kind": kind(e) })).collect::<Vec<_>>(),
        "envelope": {
            "bend_deg": length(deg_from_rad(sheet.elevation)),
            "step_mm": length(mm_from_m(sheet.step)),
            "size": size(&sheet.size),
        },
    })
}

fn joint_row(joint: &Joint, [theta, r, l, alpha]: [f64; 4]) -> Value {
    let turns = joint.kind == JointKind::Revolute;
    let limits =
        [joint.limits.0, joint.limits.1].map(|q| length(if turns { deg_from_rad(q) } else { mm_from_m(q) }));
    let kind = match (joint.is_passive(), turns) {
        (true, _) => "passive",
        (_, true) => "revolute",
        (_, false) => "prismatic",
    };
    json!({
        "name": joint.name,
        "kind": kind,
        "theta_deg": length(deg_from_rad(theta)),
        "r_mm": length(mm_from_m(r)),
        "l_mm": length(mm_from_m(l)),
        "alpha_deg": length(deg_from_rad(alpha)),
        "limits": limits,
        "unit": if turns { "deg" } else { "mm" },
    })
}

/// The document of `envelope --json`: all in the base frame of the robot.
pub fn envelope(envelope: &Reachable<'_>) -> Value {
    let plan = |(height, plan): &(f64, EnvelopeSection)| {
        json!({
            "height_mm": length(mm_from_m(*height)),
            "area_m2": rounded(plan.area(), 9),
            "outlines": outlines(plan, ["x_mm", "y_mm"]),
        })
    };
    json!({
        "schema": "sweetspot/envelope/1",
        "robot": envelope.robot.name,
        "family": envelope.family,
        "operation": envelope.operation.map(|o| &o.name),
        "frame": "base",
        "bend_deg": length(deg_from_rad(envelope.attitude.elevation)),
        "step_mm": length(mm_from_m(envelope.step)),
        "size": size(&envelope.size),
        "section": {
            "azimuth_deg": length(deg_from_rad(envelope.azimuth)),
            "area_m2": rounded(envelope.section.area(), 9),
            "outlines": outlines(&envelope.section, ["r_mm", "z_mm"]),
        },
        "plans": envelope.plans.iter().map(plan).collect::<Vec<_>>(),
    })
}

/// Closed lines, counterclockwise outside and clockwise round holes.
fn outlines(region: &EnvelopeSection, [first, second]: [&str; 2]) -> Vec<Value> {
    let axis =
        |o: &Outline, k: usize| o.points.iter().map(|p| rounded(mm_from_m(p[k]), 3)).collect::<Vec<_>>();
    let one = |o: &Outline| json!({ "hole": o.is_hole(), first: axis(o, 0), second: axis(o, 1) });
    region.outlines.iter().map(one).collect()
}

fn size(size: &Size) -> Value {
    let pair = |(low, high): (f64, f64)| json!([low, high].map(|v| length(mm_from_m(v))));
    json!({
        "volume_m3": rounded(size.volume, 9),
        "volume_error_m3": rounded(size.error, 9),
        "rotationally_symmetric": size.symmetric,
        "radius_mm": size.extent.map(|e| pair(e.radius)),
        "height_mm": size.extent.map(|e| pair(e.height)),
        "extent_within_mm": size.extent.map(|e| length(mm_from_m(e.within))),
    })
}
