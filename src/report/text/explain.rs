//! The error calculation of one posture, step by step.

use super::check::{requirement_line, samples_line};
use super::table::TextTable;
use super::{fixed, no_tolerances, percent, place_words};
use crate::assess::{Explanation, MotionFrame, ParameterEffect, ParameterMotion};
use crate::cell::{Convention, Frame, JointKind, Reading, Registration};
use crate::pose::Displacement;
use crate::record::parameter_names::{self as names, frame_name};
use crate::record::{ParameterUnit, reading_word};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;
use std::fmt::Write;

/// Returns all steps of an explanation in the order of the calculation.
pub fn explanation(e: &Explanation<'_>) -> String {
    [place(e), dh_table(e), frames(e), motions(e), effects(e), models(e), sense(e), risk(e)].concat()
}

fn place(e: &Explanation<'_>) -> String {
    let (context, cell) = (&e.context, e.context.cell);
    let mut out = place_words(context);
    let base = &context.base;
    let tool = context.situation.site.world.transpose() * context.frames.tcp.rotation * cell.robot.tool_axis;
    let tip = context.position;
    let _ = writeln!(out, "  TCP, world: {} mm", triple(&tip, 4, mm_from_m));
    let _ = writeln!(
        out,
        "  tool axis, world: {}, elevation {} deg",
        triple(&tool, 4, |v| v),
        fixed(deg_from_rad(tool.z.clamp(-1.0, 1.0).asin()), 3)
    );
    let _ = writeln!(
        out,
        "  robot base, world: {} mm, yaw {} deg; all vectors below are in base axes unless marked \"world\"",
        triple(&Vector3::new(base.x, base.y, base.z), 3, mm_from_m),
        fixed(deg_from_rad(base.yaw), 3)
    );
    out
}

fn dh_table(e: &Explanation<'_>) -> String {
    let mut table = TextTable::indented(1);
    table.row(["row", "q", "theta deg", "r mm", "l mm", "alpha deg", ""]);
    for (k, row) in e.rows.iter().enumerate() {
        let q = match row.kind {
            JointKind::Revolute => format!("{} deg", fixed(deg_from_rad(row.q), 4)),
            JointKind::Prismatic => format!("{} mm", fixed(mm_from_m(row.q), 4)),
        };
        table.row([
            format!("A{}", k + 1),
            q,
            fixed(deg_from_rad(row.theta), 4),
            fixed(mm_from_m(row.r), 4),
            fixed(mm_from_m(row.l), 4),
            fixed(deg_from_rad(row.alpha), 4),
            if row.allowed { "" } else { "outside its limits" }.to_string(),
        ]);
    }
    let cut = match e.context.cell.robot.convention {
        Convention::Standard => "",
        Convention::Modified => {
            "   The file has modified rows, Tx(l) Rx(alpha) Rz(theta) Tz(r); this table has standard rows.\n   \
             Row k has l and alpha of row k + 1 of the file, and frame 0 has l and alpha of row 1.\n   \
             dl, dalpha and dbeta are numbered as in the file.\n"
        }
    };
    format!("\n1. Links: A = Rz(theta) Tz(r) Tx(l) Rx(alpha)\n{cut}{}", table.render())
}

fn frames(e: &Explanation<'_>) -> String {
    let mut table = TextTable::indented(1);
    table.row(["frame", "origin mm", "x axis", "z axis"]);
    let frames = &e.context.frames;
    let links = frames.links[..=e.rows.len()].iter().enumerate();
    let named = links.map(|(k, pose)| (frame_name(MotionFrame::Link(k)), pose));
    for (name, pose) in named.chain([(frame_name(MotionFrame::Tcp), &frames.tcp)]) {
        table.row([
            name,
            triple(&pose.translation, 4, mm_from_m),
            triple(&pose.rotation.column(0).into_owned(), 5, |v| v),
            triple(&pose.rotation.column(2).into_owned(), 5, |v| v),
        ]);
    }
    format!("\n2. Frames: A1, A1 A2, ... and the tool\n{}", table.render())
}

fn motions(e: &Explanation<'_>) -> String {
    let mut table = TextTable::indented(2);
    table.row(["parameter", "motion", "axis w", "lever p - o mm"]);
    for line in &e.lines {
        for motion in &line.motions {
            table.row([
                names::parameter(e.context.cell, line.source.parameter),
                motion_words(motion),
                triple(&motion.direction, 5, |v| v),
                triple(&motion.lever, 4, mm_from_m),
            ]);
        }
    }
    format!(
        "\n3. Each error is a small motion of everything beyond its frame, up to the TCP\n{}",
        table.render()
    )
}

fn motion_words(motion: &ParameterMotion) -> String {
    let axis = ["x", "y", "z"][motion.axis];
    let how = if motion.turns { "turn about" } else { "slide along" };
    let factor =
        if motion.factor == 1.0 { String::new() } else { format!(", times {}", rounded(motion.factor, 6)) };
    format!("{how} {axis} of {}{factor}", frame_name(motion.place))
}

fn effects(e: &Explanation<'_>) -> String {
    let mut table = TextTable::indented(1);
    let takes_off = e.takes_off();
    let (mut head, sample) = (vec!["parameter", "value", "effect g, mm per unit"], sample_word(e));
    if takes_off {
        head.push("subtracted from g");
    }
    table.row(head.into_iter().chain(["linear term mm"]));
    let cell = e.context.cell;
    for line in &e.lines {
        let unit = ParameterUnit::new(cell, line.source.parameter);
        let mut row = vec![
            names::parameter(cell, line.source.parameter),
            format!("{} {}", rounded(unit.from_si(line.value), 6), unit.word()),
            triple(&unit.effect_mm(&line.alone.position), 5, |v| v),
        ];
        if takes_off {
            row.push(triple(&unit.effect_mm(&(line.alone - line.left).position), 5, |v| v));
        }
        row.push(triple(&line.term().position, 5, mm_from_m));
        table.row(row);
    }
    let is_elastic = e.lines.iter().any(|line| line.source.parameter.is_elastic());
    let elastic = if is_elastic { ", for an elastic error 1 deg/m or 1 deg/Nm" } else { "" };
    let mut sum = vec!["sum".to_string(), String::new(), String::new()];
    if takes_off {
        sum.push(String::new());
    }
    sum.push(triple(&e.lines.iter().map(|l: &ParameterEffect| l.term().position).sum(), 5, mm_from_m));
    table.row(sum);
    format!(
        "\n4. Effect on the TCP: g = w x (p - o) for a rotation, g = w for a translation; unit 1 deg or 1 mm{elastic}; {sample}\n{}",
        table.render()
    )
}

fn sample_word(e: &Explanation<'_>) -> &'static str {
    match e.context.evaluator.reading {
        Reading::Signed => "values of the signed sample",
        _ => "values of the worst corner",
    }
}

fn models(e: &Explanation<'_>) -> String {
    let judged = &e.judged;
    let world = |d: &Displacement| d.turned(&e.context.situation.site.world.transpose());
    let mut table = TextTable::indented(1);
    table.row(["model", "position mm", "size mm", "rotation deg", "difference from nonlinear"]);
    let mut row = |name: &str, d: &Displacement, off: Option<f64>| {
        let d = world(d);
        table.row([
            name.to_string(),
            triple(&d.position, 5, mm_from_m),
            fixed(mm_from_m(d.position.norm()), 5),
            triple(&d.rotation, 5, deg_from_rad),
            off.map_or(String::new(), percent),
        ]);
    };
    row("linear, the sum above", &judged.linear, Some(e.linear_off));
    row("second-order correction", &(judged.second_order - judged.linear), None);
    row("second-order", &judged.second_order, Some(e.second_order_off));
    row("nonlinear", &judged.nonlinear, Some(0.0));
    if e.takes_off() {
        row("the robot alone, nonlinear", &e.robot, None);
        row("subtracted from it", &(e.robot - judged.nonlinear), None);
    }
    let mut out = format!("\n5. Models, world axes\n{}", table.render());
    let model = e.context.evaluator.model.name();
    let guard = percent(e.context.cell.guard);
    let _ = match e.trusted() {
        true if e.off() == 0.0 => writeln!(out, "  the {model} model is exact"),
        true => {
            writeln!(out, "  the {model} model can be trusted here: its error is within the guard of {guard}")
        }
        false => {
            writeln!(out, "  do NOT trust the {model} model here: its error exceeds the guard of {guard}")
        }
    };
    if e.takes_off() {
        let _ = writeln!(out, "  subtracted: {}", taken_words(e));
    }
    out
}

/// Returns the names of the terms that are subtracted from the error of the robot alone.
fn taken_words(e: &Explanation<'_>) -> String {
    let registration = match e.context.cell.registration {
        Registration::None => None,
        Registration::BestFit => Some("the best-fitted base frame"),
        Registration::Taught => Some("the taught surface frame"),
    };
    let reference = e.context.situation.reference.as_ref().map(|_| "the error of the pick");
    let moved = |l: &ParameterEffect| matches!(l.source.parameter, crate::cell::Parameter::Equipment(..));
    let moved = e.lines.iter().any(moved).then_some("the error of the equipment's own frame");
    [registration, moved, reference].into_iter().flatten().collect::<Vec<_>>().join(", ")
}

fn sense(e: &Explanation<'_>) -> String {
    let evaluator = &e.context.evaluator;
    let (sense, unit) = (&evaluator.sense, evaluator.sense.unit);
    let axes = match sense.frame {
        Frame::World => "world axes",
        Frame::Surface => "axes of the surface",
        Frame::Tool => "axes of the tool",
    };
    let point = match sense.point == Vector3::zeros() {
        true => "the TCP".to_string(),
        false => format!("the point {} mm from the TCP", triple(&sense.point, 3, mm_from_m)),
    };
    let mut out =
        format!("\n6. Sense {}, at {point}, in {axes}, {} model\n", sense.name, evaluator.model.name());
    for (row, given) in e.sense.iter().zip(sense.rows()) {
        let how = if row.turns { "about" } else { "along" };
        let axis = triple(&given.direction, 4, |v| v);
        let _ = writeln!(out, "  {how} {axis}: {} {}", fixed(unit.from_si(row.value), 5), unit.word());
    }
    let size = fixed(unit.from_si(e.figures().error), 5);
    let _ = writeln!(out, "  size, the root of the sum of squares (RSS): {size} {}", unit.word());
    out
}

fn risk(e: &Explanation<'_>) -> String {
    let evaluator = &e.context.evaluator;
    let unit = evaluator.sense.unit;
    let f = e.figures();
    let [worst_linear, worst, rms, mean, p95, p99] =
        [f.worst_linear, f.worst, f.rms, f.mean, f.p95, f.p99].map(|v| fixed(unit.from_si(v), 5));
    let sign = |s: f64| if s < 0.0 { "-" } else { "+" };
    let corner = e.worst.iter().flat_map(|worst| e.lines.iter().zip(worst.corner.signs()));
    let corner: Vec<String> = corner
        .map(|(l, s)| format!("{}{}", sign(s), names::parameter(e.context.cell, l.source.parameter)))
        .collect();
    let word = unit.word();
    let by = if e.check.as_ref().is_some_and(|c| !c.confirmed) { "by samples" } else { "to first order" };
    let figures = format!(
        "  worst case: {worst_linear} {word} by the linear model, {worst} {word} by the {} model, at\n    \
         {}\n  rms {rms}, mean {mean}, p95 {p95}, p99 {p99} {word}, {by}\n",
        evaluator.model.name(),
        corner.join(" ")
    );
    let figures = e.worst.map_or_else(|| format!("  {}\n", no_tolerances()), |_| figures);
    let mut out = format!("\n7. As plus-or-minus tolerances\n{figures}");
    if let Some(success) = e.judged.success {
        let _ = writeln!(out, "  yield {success:.6}");
    }
    let limit = e.context.requirement(e.judged.value).map(|r| requirement_line(r, unit));
    let check = e.check.as_ref().map(|c| samples_line(&c.samples, unit, c.confirmed));
    for line in limit.into_iter().chain(check) {
        let _ = writeln!(out, "  {line}");
    }
    let value = fixed(e.unit().from_si(e.judged.value), 6);
    let _ = writeln!(
        out,
        "\n{} reading: {} {value} {}",
        evaluator.reading.name(),
        reading_word(e.context.cell),
        e.unit().word()
    );
    out
}

/// Returns a vector in parentheses; `outside` converts its components from SI to the unit of the text.
fn triple(v: &Vector3<f64>, digits: usize, outside: fn(f64) -> f64) -> String {
    let [x, y, z] = [v.x, v.y, v.z].map(|c| fixed(outside(c), digits));
    format!("({x}, {y}, {z})")
}
