//! `budget --json` and `explain --json`: one posture.

use super::{joints, length, lengths};
use crate::assess::{
    Account, DhRow, Explanation, MotionFrame, ParameterEffect, ParameterMotion, PostureContext, Tighter,
};
use crate::cell::{Cell, JointKind, Unit};
use crate::pose::{Displacement, Pose};
use crate::reading::{Figures, PostureErrors, Share, WorstCase};
use crate::report::names;
use crate::report::text::{frame_name, value_word};
use crate::units::{deg_from_rad, mm_from_m, percent_from_share, rad_from_deg, rounded};
use nalgebra::Vector3;
use serde_json::{Map, Value, json};

/// The document of `budget --json`.
pub fn budget(cell: &Cell, accounts: &[Account<'_>]) -> Value {
    let one = |a: &Account<'_>| {
        let gauge = &a.stance.gauge;
        let mut document = place(&a.stance);
        document.insert("worst_linear_exact".into(), json!(a.worst.exact));
        document.insert("total".into(), total(&a.stance, &a.judged));
        document.insert(
            "parameters".into(),
            a.budget.shares.iter().map(|s| share(a, s)).collect::<Vec<_>>().into(),
        );
        let tighter = |t: &Tighter| {
            json!({
                "halved": t.parameters.iter().map(|p| names::parameter(cell, *p)).collect::<Vec<_>>(),
                "of": length(a.unit().from_si(a.figure)),
                "to": length(a.unit().from_si(t.figure)),
                "unit": a.unit().word(),
                "cut_percent": length(percent_from_share(a.cut(t))),
            })
        };
        document.insert("tighten".into(), a.tighter.iter().map(tighter).collect::<Vec<_>>().into());
        document.insert("linear_worst".into(), json!(length(gauge.sense.unit.from_si(a.budget.worst))));
        document.insert("linear_rms".into(), json!(length(gauge.sense.unit.from_si(a.budget.deviation))));
        Value::Object(document)
    };
    let mut document = question("sweetspot/budget/1", cell);
    document.insert("operations".into(), accounts.iter().map(one).collect::<Vec<_>>().into());
    Value::Object(document)
}

fn share(a: &Account<'_>, s: &Share) -> Value {
    let unit = names::unit(a.stance.cell, s.parameter);
    json!({
        "parameter": names::parameter(a.stance.cell, s.parameter),
        "unit": unit.word(),
        "signed": length(unit.from_si(s.signed)),
        "plus_minus": length(unit.from_si(s.plus_minus)),
        "linear_term_mm": lengths(&s.term),
        "alone": length(a.stance.gauge.sense.unit.from_si(s.alone)),
        "share_of_worst": rounded(s.of_worst, 12),
        "share_of_variance": rounded(s.of_variance, 12),
    })
}

/// The document of `explain --json`.
pub fn explain(e: &Explanation<'_>) -> Value {
    let stance = &e.stance;
    let mut document = question("sweetspot/explain/1", stance.cell);
    document.extend(place(stance));
    let base = &stance.base;
    let tool =
        stance.situation.site.world.transpose() * stance.frames.tcp.rotation * stance.cell.robot.tool_axis;
    let world = |d: &Displacement| displacement(&d.turned(&stance.situation.site.world.transpose()));
    let parts = [
        (
            "base",
            json!({
                "x_mm": length(mm_from_m(base.x)), "y_mm": length(mm_from_m(base.y)),
                "z_mm": length(mm_from_m(base.z)), "yaw_deg": length(deg_from_rad(base.yaw)),
            }),
        ),
        ("tool_axis_world", json!(plain(&tool))),
        ("tool_elevation_deg", json!(length(deg_from_rad(tool.z.clamp(-1.0, 1.0).asin())))),
        ("dh", e.rows.iter().map(dh_row).collect::<Vec<_>>().into()),
        ("frames", frames(e)),
        ("parameters", e.lines.iter().map(|l| parameter(e, l)).collect::<Vec<_>>().into()),
        ("linear", world(&e.judged.linear)),
        ("second_order_correction", world(&(e.judged.second_order - e.judged.linear))),
        ("second_order", world(&e.judged.second_order)),
        ("nonlinear", world(&e.judged.nonlinear)),
        ("robot_alone_nonlinear", world(&e.robot)),
        ("taken_off_nonlinear", world(&(e.robot - e.judged.nonlinear))),
        ("guard", guard(e)),
        ("sense_rows", sense_rows(e)),
        ("worst_corner", corner(e, &e.worst)),
        ("total", total(stance, &e.judged)),
        ("value", json!(length(e.unit().from_si(e.judged.value)))),
        ("unit", json!(e.unit().word())),
    ];
    document.extend(parts.map(|(key, value)| (key.to_string(), value)));
    Value::Object(document)
}

/// What was asked, common to the documents.
fn question(schema: &str, cell: &Cell) -> Map<String, Value> {
    let words = [
        ("schema", schema),
        ("cell", &cell.name),
        ("robot", &cell.robot.name),
        ("errors", cell.error_set().name()),
        ("model", cell.model.name()),
        ("reading", cell.reading.name()),
        ("quantity", value_word(cell)),
        ("registration", cell.registration.name()),
    ];
    words.into_iter().map(|(key, word)| (key.to_string(), json!(word))).collect()
}

fn place(stance: &PostureContext<'_>) -> Map<String, Value> {
    let operation = &stance.cell.operations[stance.operation];
    let sense = &operation.sense;
    let pairs = [
        ("name", json!(operation.name)),
        ("equipment", json!(stance.cell.equipment[operation.equipment].name)),
        ("sense", json!(sense.name)),
        ("limit", json!(operation.limit.map(|l| length(sense.unit.from_si(l))))),
        ("node", json!(stance.node.map(|(i, j)| [i, j]))),
        ("position_mm", json!(lengths(&stance.position))),
        ("joints_deg", json!(joints(stance.cell, &stance.joints))),
    ];
    pairs.into_iter().map(|(key, value)| (key.to_string(), value)).collect()
}

/// Every figure in the operation's sense.
fn total(stance: &PostureContext<'_>, judged: &PostureErrors) -> Value {
    let unit = stance.gauge.sense.unit;
    let Figures { error, worst_linear, worst, rms, mean, p95, p99 } = judged.figures[stance.gauge.own()];
    let [error, worst_linear, worst, rms, mean, p95, p99] =
        [error, worst_linear, worst, rms, mean, p95, p99].map(|v| length(unit.from_si(v)));
    json!({
        "unit": unit.word(),
        "error": error,
        "worst_linear": worst_linear,
        "worst": worst,
        "rms": rms,
        "mean": mean,
        "p95": p95,
        "p99": p99,
        "yield": judged.success.map(length),
    })
}

fn dh_row(row: &DhRow) -> Value {
    let q = if row.kind == JointKind::Revolute { deg_from_rad(row.q) } else { mm_from_m(row.q) };
    json!({
        "kind": if row.kind == JointKind::Revolute { "revolute" } else { "prismatic" },
        "q": length(q),
        "within_limits": row.allowed,
        "theta_deg": length(deg_from_rad(row.theta)),
        "r_mm": length(mm_from_m(row.r)),
        "l_mm": length(mm_from_m(row.l)),
        "alpha_deg": length(deg_from_rad(row.alpha)),
    })
}

/// In the base frame.
fn frames(e: &Explanation<'_>) -> Value {
    let one = |(name, pose): (String, &Pose)| {
        let axis = |k: usize| plain(&pose.rotation.column(k).into_owned());
        json!({
            "name": name,
            "origin_mm": lengths(&pose.translation),
            "x_axis": axis(0), "y_axis": axis(1), "z_axis": axis(2),
        })
    };
    let frames = &e.stance.frames;
    let links = frames.links[..=e.rows.len()].iter().enumerate();
    let links = links.map(|(k, pose)| (frame_name(MotionFrame::Link(k)), pose));
    links.chain([(frame_name(MotionFrame::Tcp), &frames.tcp)]).map(one).collect::<Vec<_>>().into()
}

/// Motions, lever and effects in the base frame, the linear term in the world.
fn parameter(e: &Explanation<'_>, line: &ParameterEffect) -> Value {
    let unit = names::unit(e.stance.cell, line.source.parameter);
    let per_unit = |d: &Displacement| match unit {
        Unit::Angle => plain(&(d.position.map(mm_from_m) * rad_from_deg(1.0))),
        _ => plain(&d.position),
    };
    let motion = |m: &ParameterMotion| {
        let axis = ["x", "y", "z"][m.axis];
        json!({
            "kind": if m.turns { "turn" } else { "slide" },
            "axis": axis,
            "frame": frame_name(m.place),
            "factor": length(m.factor),
            "axis_base": plain(&m.direction),
            "lever_base_mm": lengths(&m.lever),
        })
    };
    let term = line.term().turned(&e.stance.situation.site.world.transpose());
    json!({
        "parameter": names::parameter(e.stance.cell, line.source.parameter),
        "unit": unit.word(),
        "value": length(unit.from_si(line.value)),
        "signed": length(unit.from_si(line.source.signed)),
        "plus_minus": length(unit.from_si(line.source.plus_minus)),
        "standard_deviation": length(unit.from_si(line.source.deviation)),
        "motions": line.motions.iter().map(motion).collect::<Vec<_>>(),
        "effect_base_mm_per_unit": per_unit(&line.alone),
        "taken_off_base_mm_per_unit": per_unit(&(line.alone - line.left)),
        "linear_term_mm": lengths(&term.position),
        "linear_term_deg": term.rotation.map(|r| length(deg_from_rad(r))).as_slice(),
    })
}

fn guard(e: &Explanation<'_>) -> Value {
    let percent = |share: f64| length(percent_from_share(share));
    json!({
        "threshold_percent": percent(e.stance.cell.guard),
        "linear_off_percent": percent(e.linear_off),
        "second_order_off_percent": percent(e.second_order_off),
        "off_percent": percent(e.off()),
        "trusted": e.trusted(),
    })
}

fn sense_rows(e: &Explanation<'_>) -> Value {
    let unit = e.stance.gauge.sense.unit;
    let rows = e.sense.iter().map(|row| {
        json!({
            "kind": if row.turns { "rotation" } else { "position" },
            "direction_base": plain(&row.direction),
            "value": length(unit.from_si(row.value)),
        })
    });
    rows.collect::<Vec<_>>().into()
}

/// The sign of every parameter at the worst corner.
fn corner(e: &Explanation<'_>, worst: &WorstCase) -> Value {
    let signs = e.lines.iter().zip(worst.corner);
    let named = signs.map(|(line, sign)| {
        (names::parameter(e.stance.cell, line.source.parameter), json!(if sign < 0.0 { -1 } else { 1 }))
    });
    Value::Object(named.collect())
}

fn displacement(d: &Displacement) -> Value {
    json!({
        "position_mm": lengths(&d.position),
        "size_mm": length(mm_from_m(d.position.norm())),
        "rotation_deg": d.rotation.map(|r| length(deg_from_rad(r))).as_slice(),
    })
}

/// A vector without a unit, or in the unit of files already.
fn plain(v: &Vector3<f64>) -> [f64; 3] {
    v.map(length).into()
}
