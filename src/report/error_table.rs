//! Table of an error set for the robot file, made from tolerances.

use crate::cell::{COMPONENTS, Convention, Distribution, JointKind, PER_FRAME, Parameter, Robot, Spread};
use crate::files::toml_string;
use crate::units::{deg_from_rad, mm_from_m};
use std::fmt::Write;

/// Keys of the rows of an error set, each with its key in the table `distribution`.
const ROWS: [(&str, &str); 6] = [
    ("dq_deg", "dq"),
    ("dq_mm", "dq"),
    ("dr_mm", "dr"),
    ("dl_mm", "dl"),
    ("dalpha_deg", "dalpha"),
    ("dbeta_deg", "dbeta"),
];

/// Keys that a robot file must have.
const REQUIRED: [&str; 3] = ["dr_mm", "dl_mm", "dalpha_deg"];

/// Place of a parameter in the error set of a robot file.
enum FilePlace {
    /// Index into [`ROWS`], and index of the row, counted from 0.
    Row(usize, usize),
    Base(usize),
    Tool(usize),
    /// Index of the joint, counted from 0, and component of its frame.
    Joint(usize, usize),
    /// Indices of a joint and of a link that this joint carries, counted from 0.
    Elastic(usize, usize),
    /// Index of the joint, counted from 0.
    Compliance(usize),
}

/// Returns the table `[errors.NAME]` with the tolerances in `spreads`. The order of the tolerances is the
/// order of [`Parameter::of_robot`].
///
/// Joint and link numbers in the table start at 1 and refer to the rows of the robot file.
pub fn table(robot: &Robot, name: &str, source: &str, spreads: &[Spread]) -> String {
    let axes = robot.axes();
    let none = Spread { plus_minus: 0.0, distribution: Distribution::Normal, sigmas: Spread::SIGMAS };
    let mut rows = [(); ROWS.len()].map(|()| vec![none; axes]);
    let (mut base, mut tool) = ([none; PER_FRAME], [none; PER_FRAME]);
    let mut joints = vec![[none; PER_FRAME]; axes];
    let (mut elastic, mut compliance) = (Vec::new(), vec![none; axes]);
    for (parameter, spread) in Parameter::of_robot(axes).zip(spreads).filter(|(_, s)| s.plus_minus > 0.0) {
        match place(robot, parameter) {
            Some(FilePlace::Row(key, row)) if row < axes => rows[key][row] = *spread,
            Some(FilePlace::Base(c)) => base[c] = *spread,
            Some(FilePlace::Tool(c)) => tool[c] = *spread,
            Some(FilePlace::Joint(i, c)) => joints[i][c] = *spread,
            Some(FilePlace::Elastic(joint, link)) => elastic.push((joint, link, *spread)),
            Some(FilePlace::Compliance(joint)) => compliance[joint] = *spread,
            _ => {}
        }
    }
    let mut out = format!("[errors.{name}]\nkind = \"tolerance\"\nsource = {}\n", toml_string(source));
    // Writing to a String cannot fail.
    for ((key, _), row) in ROWS.iter().zip(&rows) {
        if REQUIRED.contains(key) || row.iter().any(is_given) {
            let values = row.iter().map(|s| number(s, key.ends_with("_deg")));
            let _ = writeln!(out, "{key} = [{}]", values.collect::<Vec<_>>().join(", "));
        }
    }
    for (key, frame) in [("base", &base), ("tool", &tool)] {
        if frame.iter().any(is_given) {
            let _ = writeln!(out, "{key} = {{ {} }}", frame_values(frame));
        }
    }
    let given = joints.iter().enumerate().filter(|(_, frame)| frame.iter().any(is_given));
    let given: Vec<_> = given.map(|(i, f)| format!("{{ joint = {}, {} }}", i + 1, frame_values(f))).collect();
    if !given.is_empty() {
        let _ = writeln!(out, "joints = [{}]", given.join(", "));
    }
    let terms = elastic.iter().map(|(joint, link, spread)| {
        format!("{{ joint = {}, link = {}, deg_per_m = {} }}", joint + 1, link + 1, number(spread, true))
    });
    if !elastic.is_empty() {
        let _ = writeln!(out, "elastic = [{}]", terms.collect::<Vec<_>>().join(", "));
    }
    if compliance.iter().any(is_given) {
        let values: Vec<_> = compliance.iter().map(|s| number(s, true)).collect();
        let _ = writeln!(out, "compliance_deg_per_Nm = [{}]", values.join(", "));
    }
    let frames = FrameSpreads { base: &base, tool: &tool, joints: &joints };
    let deflections = (elastic.first().map(|(.., spread)| *spread), &compliance[..]);
    let _ = writeln!(out, "distribution = {}", distributions(&rows, &frames, deflections));
    let normal = spreads.iter().find(|s| is_given(s) && s.distribution == Distribution::Normal);
    let _ = writeln!(out, "sigmas = {}", normal.map_or(Spread::SIGMAS, |s| s.sigmas));
    out
}

/// Tolerances of the frames of a robot.
struct FrameSpreads<'a> {
    base: &'a [Spread; PER_FRAME],
    tool: &'a [Spread; PER_FRAME],
    joints: &'a [[Spread; PER_FRAME]],
}

fn is_given(spread: &Spread) -> bool {
    spread.plus_minus > 0.0
}

/// Returns the place of a parameter in the robot file. This place depends on the D-H convention of the file.
/// Returns None if the robot file cannot state the parameter.
fn place(robot: &Robot, parameter: Parameter) -> Option<FilePlace> {
    let modified = robot.convention == Convention::Modified;
    // The common normal at the end of a standard row is at the beginning of the next modified row.
    let shift = usize::from(modified);
    Some(match parameter {
        Parameter::Dq(i) => FilePlace::Row(usize::from(robot.joints[i].kind == JointKind::Prismatic), i),
        Parameter::Dr(i) => FilePlace::Row(2, i),
        Parameter::Dl(i) => FilePlace::Row(3, i + shift),
        Parameter::Dalpha(i) => FilePlace::Row(4, i + shift),
        Parameter::Dbeta(i) => FilePlace::Row(5, i + shift),
        Parameter::Joint(0, 0) if modified => FilePlace::Row(3, 0),
        Parameter::Base(3) if modified => FilePlace::Row(4, 0),
        Parameter::Joint(0, 4) if modified => FilePlace::Row(5, 0),
        Parameter::Base(c) => FilePlace::Base(c),
        Parameter::Tool(c) => FilePlace::Tool(c),
        Parameter::Joint(i, c) => FilePlace::Joint(i, c),
        Parameter::Elastic(joint, link) => FilePlace::Elastic(joint, link),
        Parameter::Compliance(joint) => FilePlace::Compliance(joint),
        Parameter::Periodic(_) | Parameter::Equipment(..) => return None,
    })
}

/// Returns a half width in mm or degrees with seven significant digits.
pub fn number(spread: &Spread, is_angle: bool) -> String {
    let value = if is_angle { deg_from_rad(spread.plus_minus) } else { mm_from_m(spread.plus_minus) };
    format!("{value:.6e}").parse::<f64>().unwrap_or(value).to_string()
}

fn frame_values(frame: &[Spread; PER_FRAME]) -> String {
    let half = COMPONENTS.len() / 2;
    let list =
        |part: &[Spread], is_angle| part.iter().map(|s| number(s, is_angle)).collect::<Vec<_>>().join(", ");
    let (position, rotation) = (list(&frame[..half], false), list(&frame[half..], true));
    format!("position_mm = [{position}], rotation_deg = [{rotation}]")
}

/// Returns the value of `distribution`: one word if all tolerances have the same distribution, otherwise a
/// table.
fn distributions(
    rows: &[Vec<Spread>; ROWS.len()],
    FrameSpreads { base, tool, joints }: &FrameSpreads<'_>,
    (elastic, compliance): (Option<Spread>, &[Spread]),
) -> String {
    let frames = base.iter().chain(*tool).chain(joints.iter().flatten());
    let all = rows.iter().flatten().chain(frames).chain(&elastic).chain(compliance);
    let used: Vec<_> = all.filter(|s| is_given(s)).collect();
    let first = used.first().map_or(Distribution::Normal, |s| s.distribution);
    let word = |d: Distribution| format!("\"{}\"", d.name());
    if used.iter().all(|s| s.distribution == first) {
        return word(first);
    }
    let list =
        |spreads: &[Spread]| spreads.iter().map(|s| word(s.distribution)).collect::<Vec<_>>().join(", ");
    // The tolerance of a joint is in dq_deg if the joint is revolute, and in dq_mm if it is prismatic.
    let dq: Vec<_> = rows[0].iter().zip(&rows[1]).map(|(a, b)| if is_given(a) { *a } else { *b }).collect();
    let mut parts = vec![format!("dq = [{}]", list(&dq))];
    parts.extend(ROWS.iter().zip(rows).skip(2).map(|((_, key), row)| format!("{key} = [{}]", list(row))));
    parts.extend([("base", *base), ("tool", *tool)].map(|(key, frame)| format!("{key} = [{}]", list(frame))));
    let joint = joints.iter().find(|frame| frame.iter().any(is_given));
    parts.extend(joint.map(|frame| format!("joints = [{}]", list(frame))));
    parts.extend(elastic.map(|spread| format!("elastic = {}", word(spread.distribution))));
    if compliance.iter().any(is_given) {
        parts.push(format!("compliance = [{}]", list(compliance)));
    }
    format!("{{ {} }}", parts.join(", "))
}
