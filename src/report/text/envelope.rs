//! Robots and their working envelopes.

use super::table::TextTable;
use super::{fixed, mm, mm1};
use crate::assess::{Reachable, RobotDataSheet};
use crate::cell::{Convention, ErrorSet, Joint, JointKind, Robot};
use crate::files::shown;
use crate::reach::Size;
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rounded};
use nalgebra::Vector3;
use std::fmt::Write;

/// Returns the table of built-in robots and the sources of their numbers.
pub fn robots(all: &[(&str, Robot, &str)]) -> String {
    let mut table = TextTable::new(3);
    table.row(["robot", "name", "inverse kinematics", "axes", "reach mm", "error sets"]);
    for (stem, robot, family) in all {
        let (reach, axes) = (fixed(mm_from_m(robot.reach()), 0), robot.axes().to_string());
        let sets = robot.errors.len().to_string();
        table.row([stem.to_string(), shown(&robot.name), family.to_string(), axes, reach, sets]);
    }
    let mut out = format!(
        "{}reach: upper bound of the distance of the TCP from the base axis, for any tool orientation\n\nsources\n",
        table.render()
    );
    for (stem, robot, _) in all {
        let _ = writeln!(out, "  {stem}: {}", first_line(robot));
    }
    out
}

/// Returns the first line of the source of a robot's numbers.
fn first_line(robot: &Robot) -> String {
    shown(robot.source.trim().lines().next().unwrap_or_default())
}

/// Returns the data sheet of a robot.
pub fn robot(sheet: &RobotDataSheet<'_>) -> String {
    let robot = sheet.robot;
    let kept = format!("{} axes, {}", robot.axes(), sheet.family);
    let mut out = format!("{}: {kept}\n\n{}{}", shown(&robot.name), dh_table(robot), coupling(robot));
    let tool = &robot.tool;
    let _ = writeln!(
        out,
        "tool        TCP at {} mm in the last frame, {}, axis {}",
        triple(&tool.translation.map(mm_from_m)),
        if tool.rotation == nalgebra::Matrix3::identity() { "same orientation" } else { "rotated" },
        triple(&robot.tool_axis)
    );
    let axis = sheet.pose.rotation * robot.tool_axis;
    let elevation = fixed(deg_from_rad(axis.z.clamp(-1.0, 1.0).asin()), 1);
    let _ = writeln!(
        out,
        "home        joints at ({}), TCP at {} mm, tool axis at {elevation} deg",
        home(robot),
        triple(&sheet.pose.translation.map(mm_from_m)),
    );
    out += &speeds(robot);
    let _ = writeln!(out, "reach       at most {} mm from the base axis", fixed(mm_from_m(robot.reach()), 0));
    if let Some(envelope) = &sheet.envelope {
        let tilt = fixed(deg_from_rad(envelope.elevation), 1);
        let _ = writeln!(out, "envelope    with the tool at {tilt} deg: {}", size(&envelope.size));
    } else {
        let _ = writeln!(
            out,
            "envelope    `sweetspot envelope` computes the envelope; this takes a few seconds for this arm"
        );
    }
    let _ = writeln!(out, "solids      {}", solids(robot));
    for set in &robot.errors {
        let _ = writeln!(out, "errors      {}, {}", shown(set.name()), kind_of(set));
    }
    let _ = writeln!(out, "source      {}", first_line(robot));
    out
}

/// Returns the kind of an error set with an article, such as "a tolerance".
pub fn kind_of(set: &ErrorSet) -> &'static str {
    match set {
        ErrorSet::Signed(_) => "a signed sample",
        ErrorSet::Tolerance(_) => "a tolerance",
        ErrorSet::Measured(_) => "measured errors",
    }
}

fn solids(robot: &Robot) -> String {
    let names: Vec<String> = robot.solids.iter().map(|s| shown(&s.solid.name)).collect();
    if names.is_empty() { "none: the arm is not checked for collision".into() } else { names.join(", ") }
}

fn dh_table(robot: &Robot) -> String {
    let mut table = TextTable::new(2);
    table.row(["joint", "kind", "theta deg", "r mm", "l mm", "alpha deg", "from", "to", "unit"]);
    for (joint, [theta, r, l, alpha]) in robot.joints.iter().zip(robot.rows_of_file()) {
        let turns = joint.kind == JointKind::Revolute;
        let (kind, unit) = if turns { ("revolute", "deg") } else { ("prismatic", "mm") };
        let limit = |q| rounded(if turns { deg_from_rad(q) } else { mm_from_m(q) }, 3).to_string();
        let angle = |rad| rounded(deg_from_rad(rad), 6).to_string();
        let (kind, from, to) = match joint.is_passive() {
            true => ("passive", String::new(), String::new()),
            false => (kind, limit(joint.limits.0), limit(joint.limits.1)),
        };
        let numbers = [angle(theta), mm(r), mm(l), angle(alpha), from, to, unit.into()];
        table.row([shown(&joint.name), kind.into()].into_iter().chain(numbers));
    }
    let matrix = match robot.convention {
        Convention::Standard => "Rz(theta + q) Tz(r) Tx(l) Rx(alpha)",
        Convention::Modified => "Tx(l) Rx(alpha) Rz(theta + q) Tz(r)",
    };
    format!("D-H rows, {}: A = {matrix}\n{}\n", robot.convention.name(), table.render())
}

/// Describes the maximum speeds and accelerations of the joints; empty if the robot file states none.
fn speeds(robot: &Robot) -> String {
    let known = robot.joints.iter().filter_map(|joint| {
        let (unit, shown_value): (_, fn(f64) -> f64) = match joint.kind {
            JointKind::Revolute => ("deg", deg_from_rad),
            JointKind::Prismatic => ("mm", mm_from_m),
        };
        let value = |v: f64| rounded(shown_value(v), 1);
        let speed = joint.rates.velocity.map(|v| format!("{} {unit}/s", value(v)));
        let acceleration = joint.rates.acceleration.map(|a| format!("{} {unit}/s^2", value(a)));
        let limits: Vec<String> = speed.into_iter().chain(acceleration).collect();
        (!limits.is_empty()).then(|| format!("{} {}", shown(&joint.name), limits.join(", ")))
    });
    let known: Vec<String> = known.collect();
    if known.is_empty() { String::new() } else { format!("speeds      {}\n", known.join("; ")) }
}

/// Describes how joints are coupled to the actuators of other joints; empty for a serial arm.
fn coupling(robot: &Robot) -> String {
    let mut out = String::new();
    for (i, row) in robot.coupling.iter().enumerate() {
        let others = row.iter().enumerate().filter(|(j, factor)| *j != i && **factor != 0.0);
        let others: Vec<String> =
            others.map(|(j, factor)| format!("{factor:+} {}", shown(&robot.joints[j].name))).collect();
        if !others.is_empty() {
            let own = if robot.joints[i].is_passive() { "follows" } else { "also follows" };
            let _ = writeln!(out, "coupling    {} {own} {}", shown(&robot.joints[i].name), others.join(" "));
        }
    }
    out
}

fn triple(v: &Vector3<f64>) -> String {
    let [x, y, z] = [v.x, v.y, v.z].map(|v| rounded(v, 3));
    format!("({x}, {y}, {z})")
}

/// Returns volume and extent of a working envelope in one line.
pub fn size(size: &Size) -> String {
    let Some(extent) = &size.extent else { return "no reachable point found".into() };
    format!(
        "{:.4} +- {:.4} m^3, {} to {} mm from the base axis, {} to {} mm high",
        size.volume,
        size.error,
        mm1(extent.radius.0),
        mm1(extent.radius.1),
        mm1(extent.height.0),
        mm1(extent.height.1)
    )
}

/// Returns the title of an envelope: robot, operation and elevation of the tool axis.
pub fn envelope_title(envelope: &Reachable<'_>) -> String {
    let elevation = rounded(deg_from_rad(envelope.attitude.elevation), 3);
    let of = envelope.operation.map_or(String::new(), |o| format!(" of {}", shown(&o.name)));
    format!("{}: working envelope{of}, tool at {elevation} deg", shown(&envelope.robot.name))
}

/// Returns the section, the plans and the size of an envelope as text.
pub fn envelope(envelope: &Reachable<'_>) -> String {
    let size_of = &envelope.size;
    let mut out = format!("{}\n{}\n\n", envelope_title(envelope), envelope.family);
    let mut table = TextTable::new(1);
    let azimuth = fixed(deg_from_rad(envelope.azimuth), 1);
    let square = |area: f64| format!("{area:.4} m^2");
    let pieces = |count: usize| format!("{count} outline{}", if count == 1 { "" } else { "s" });
    let section = &envelope.section;
    table.row([
        format!("section at azimuth {azimuth} deg"),
        square(section.area()),
        pieces(section.outlines.len()),
    ]);
    for (height, plan) in &envelope.plans {
        table.row([format!("plan at {} mm", mm1(*height)), square(plan.area()), pieces(plan.outlines.len())]);
    }
    let _ = write!(out, "{}", table.render());
    let share = percent_from_share(size_of.error / size_of.volume.max(f64::MIN_POSITIVE));
    let _ = writeln!(out, "size: {}", size(size_of));
    let how = if size_of.symmetric {
        "computed from the section by symmetry about the base axis"
    } else {
        "sampled in x, y and z"
    };
    let _ = writeln!(
        out,
        "{how}; +- is the difference from the volume at twice the step ({share:.1} %); step {} mm: \
         narrower gaps may be missed",
        mm(envelope.step)
    );
    let _ = writeln!(
        out,
        "in the base frame of the robot; joint limits are respected, collisions are not checked"
    );
    out
}

/// Returns the joint coordinates at home, deg or mm, without passive joints.
fn home(robot: &Robot) -> String {
    let value = |(joint, q): (&Joint, &f64)| match joint.kind {
        JointKind::Revolute => rounded(deg_from_rad(*q), 3).to_string(),
        JointKind::Prismatic => format!("{} mm", rounded(mm_from_m(*q), 3)),
    };
    let active = robot.joints.iter().zip(&robot.home).filter(|(joint, _)| !joint.is_passive());
    active.map(value).collect::<Vec<_>>().join(", ")
}
