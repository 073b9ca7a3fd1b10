//! Reading of tables of measured positions into sessions. Prints the units and conventions that are
//! assumed.

use crate::calibration::{
    DataReading, MeasuredPosition, MeasuringSession, RotationReading, SuspectRows, explain,
    explain_rotations, still_joints, unit_name,
};
use crate::cell::{Joint, JointKind, Robot};
use crate::cli::output::path_word;
use crate::cli::{Exit, loading, output};
use crate::files::measured::{
    ColumnNames, JointTable, MeasuredTable, StatedUnit, decode, read as read_table,
};
use crate::files::{Fault, FileContent, shown};
use crate::robot::Chain;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use std::collections::HashSet;
use std::path::Path;

/// Columns of the tables of measured positions, as the command line states them.
pub struct TableOptions<'a> {
    pub columns: &'a ColumnNames,
    /// Table with the joint coordinates of the postures, if the tables of positions contain none.
    pub joints: Option<&'a Path>,
}

/// Reads a table, finds its units and conventions, and prints them.
pub fn session(
    path: &Path,
    robot: &Robot,
    chain: &Chain,
    options: &TableOptions<'_>,
) -> Result<MeasuringSession, Exit> {
    let name = path_word(path);
    let mut table = table(path, &robot.joints, options)?;
    let suspect = SuspectRows::new(&table.rows);
    let left_out = suspect.all();
    let positions = table.rows.len();
    table.rows.retain(|row| !left_out.contains(&row.numbers.row));
    let reading = explain(chain, &table.rows, robot.reach());
    let Some(reading) = reading.filter(|reading| reading.is_plausible(robot.reach())) else {
        let rms = reading.map_or("none".into(), |r| in_mm(r.rms));
        output::error(&format!("{name}: the positions do not fit the arm {}", shown(&robot.name)));
        table.notes.iter().for_each(|note| output::talk(&format!("  note: {note}")));
        warn_of_suspects(&name, &suspect);
        output::talk(&format!(
            "  help: check the robot, the columns and the joint zeros; the units mm, m and inch, deg and rad, and \
             every sign, order, zero and coupling of the joints were tried, and the smallest rms distance of \
             measured from nominal positions is {rms}"
        ));
        if robot.joints.iter().any(|joint| joint.kind == JointKind::Prismatic) {
            output::talk(
                "  help: prismatic joints and positions are assumed to have one unit; state other units in the column \
                 heads, such as `q1 [m]` and `x [mm]`",
            );
        }
        return Err(Exit::BadInput);
    };
    let rotation = explain_rotations(chain, &reading, &table.rows);
    output::talk(&in_words(&name, positions, &table, &reading));
    for said in remarks(&table, &reading, rotation.as_ref(), &robot.joints) {
        output::talk(&format!("note: {name}: {said}"));
    }
    for said in warnings(&table, &reading, rotation.as_ref()) {
        output::talk(&format!("warning: {name}: {said}"));
    }
    let rotation = rotation.filter(RotationReading::is_plausible);
    let measured = table.rows.iter().map(|raw| MeasuredPosition {
        rotation: raw.rotation.and_then(|raw| rotation?.applied(&raw)),
        ..reading.applied(chain, raw)
    });
    let measured: Vec<_> = measured.collect();
    warn_of_suspects(&name, &suspect);
    let still = still_joints(chain, &measured);
    let still: Vec<_> = still.iter().map(|&k| shown(&robot.joints[k].name)).collect();
    if !still.is_empty() {
        output::talk(&format!(
            "warning: {name}: joints that never move: {}; their errors cannot be distinguished from the \
             errors of the neighbouring joints",
            still.join(", ")
        ));
    }
    Ok(MeasuringSession {
        name: path.file_name().map_or(name, |f| f.to_string_lossy().into_owned()),
        measured,
    })
}

/// Reads the table of a file. A table may leave out the passive joints of the arm.
fn table(path: &Path, joints: &[Joint], options: &TableOptions<'_>) -> Result<MeasuredTable, Exit> {
    let text = text(path)?;
    let other = options.joints.map(|path| Ok((path.to_string_lossy().into_owned(), self::text(path)?)));
    let other = other.transpose()?;
    let other = other.as_ref().map(|(file, text)| JointTable { file, text });
    let read = |joints: &[&Joint]| {
        let names: Vec<_> = joints.iter().map(|joint| joint.name.as_str()).collect();
        read_table(&path.to_string_lossy(), &text, &names, options.columns, other)
    };
    let whole = read(&joints.iter().collect::<Vec<_>>());
    let active: Vec<usize> = (0..joints.len()).filter(|&i| !joints[i].is_passive()).collect();
    let holds_passive = |table: &MeasuredTable| {
        let moves = |i: usize| {
            let all = table.rows.iter().map(|row| row.numbers.joints[i].to_bits());
            all.collect::<HashSet<_>>().len() > 1
        };
        !(0..joints.len()).any(|i| joints[i].is_passive() && moves(i))
    };
    if active.len() < joints.len() && !whole.as_ref().is_ok_and(holds_passive) {
        let own: Vec<_> = active.iter().map(|&i| &joints[i]).collect();
        if let Ok(table) = read(&own) {
            return Ok(table.with_joints_at(&active, joints.len()));
        }
    }
    whole.map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })
}

/// Reads the text of a data file in any usual encoding. Refuses a file with content of another kind, such as
/// a mesh, JSON or a cell file.
pub fn text(path: &Path) -> Result<String, Exit> {
    let refuse = |why: String, help: String| {
        output::faults(&[Fault::of_file(&path.to_string_lossy(), why, help)]);
        Exit::BadInput
    };
    let bytes = loading::read_data(path)?;
    if let Some(content) = FileContent::of(&bytes).filter(|c| c.is_shape() || *c == FileContent::Json) {
        let why = format!("it is {}, not a table of data", content.in_words());
        return Err(refuse(why, content.next_step(&path_word(path))));
    }
    let text = decode(&bytes).map_err(|why| refuse(why, "export the table as CSV or text".into()))?;
    if text.lines().any(|line| line.starts_with("schema = \"sweetspot/")) {
        let why = "it is a cell, robot, tool or equipment file, not a table of data".into();
        return Err(refuse(why, format!("look at it with sweetspot check {}", path_word(path))));
    }
    Ok(text)
}

fn in_mm(length: f64) -> String {
    format!("{} mm", rounded(mm_from_m(length), 2))
}

fn angles_in_words(degrees: bool) -> &'static str {
    if degrees { "deg" } else { "rad" }
}

/// Returns a description of the columns of a table and their units.
fn in_words(name: &str, positions: usize, table: &MeasuredTable, reading: &DataReading) -> String {
    let listed = |names: &[String]| {
        let stated = names.iter().filter(|name| !name.is_empty());
        stated.map(|name| shown(name)).collect::<Vec<_>>().join(", ")
    };
    let mut said = format!(
        "{name}: {} positions; joints {} in {}; position {} in {}",
        positions,
        listed(&table.joints),
        angles_in_words(reading.degrees),
        listed(&table.position),
        unit_name(reading.unit)
    );
    if table.reflectors.len() > 1 {
        said += &format!("; reflectors {}", listed(&table.reflectors));
    }
    if let Some((columns, k)) = &table.uncertainty {
        said += &format!("; uncertainty {} ({k} standard deviations)", listed(columns));
    }
    said
}

/// Returns remarks for the user: rows left out, orientations, the frame of the positions.
fn remarks(
    table: &MeasuredTable,
    reading: &DataReading,
    rotation: Option<&RotationReading>,
    joints: &[Joint],
) -> Vec<String> {
    let mut said = table.notes.clone();
    if let Some(of) = rotation.filter(|of| of.is_plausible()) {
        let names: Vec<_> = table.rotation.iter().map(|name| shown(name)).collect();
        let is_angle = names.len() == 3;
        let unit = if is_angle { format!(" in {}", angles_in_words(of.degrees)) } else { String::new() };
        said.push(format!(
            "orientation {}{unit}: {}; the orientations of the nominal arm differ from the measured ones by {} deg rms",
            names.join(", "),
            of.convention.name(),
            rounded(deg_from_rad(of.rms), 3)
        ));
    }
    // The origin of a distant tracker cannot be this near to the robot base. The positions are therefore in
    // the base frame of the robot.
    if reading.base.translation.norm() < NEAR_BASE {
        let axis = reading.base.rotation.column(0).into_owned();
        let is_turned = axis.x < -UPRIGHT;
        let about = if is_turned { ", rotated by 180 deg about its z axis" } else { "" };
        if reading.base.rotation[(2, 2)] > UPRIGHT {
            said.push(format!(
                "the positions are in the base frame of the robot{about}; a base frame is nevertheless fitted to them"
            ));
        }
    }
    said.extend(assumptions(reading, &table.joints, joints));
    said
}

/// Threshold of the distance, m, between the robot base and the origin of the measured positions. Below this
/// distance, the positions count as measured in the base frame.
const NEAR_BASE: f64 = 0.03;

/// Least cosine of the angle between two axes that both count as vertical.
const UPRIGHT: f64 = 0.9998;

/// Returns remarks on the assumed order, signs, zero offsets and coupling of the joint columns, and on
/// mirrored positions.
fn assumptions(reading: &DataReading, columns: &[String], joints: &[Joint]) -> Vec<String> {
    let map = &reading.joints;
    let name = |k: usize| shown(&joints[k].name);
    let mut said = Vec::new();
    for (k, joint) in joints.iter().enumerate() {
        let joint = shown(&joint.name);
        if map.columns[k] != k {
            said.push(format!("joint {joint} is read from column {}", shown(&columns[map.columns[k]])));
        }
        if map.signs[k] < 0.0 {
            said.push(format!("the sign of {} is reversed", shown(&columns[map.columns[k]])));
        }
        if map.offsets[k] != 0.0 {
            said.push(format!("{} deg are added to joint {joint}", rounded(deg_from_rad(map.offsets[k]), 3)));
        }
    }
    for (joint, earlier, factor) in map.couplings.iter().flatten() {
        let (joint, earlier) = (name(*joint), name(*earlier));
        let (verb, to) = if *factor > 0.0 { ("added", "to") } else { ("subtracted", "from") };
        said.push(format!("the joints are coupled: {earlier} is {verb} {to} the column of {joint}"));
    }
    if reading.mirrored {
        let what = "the position is mirrored (two of its columns are swapped, or one has the wrong sign)";
        said.push(what.into());
    }
    if !said.is_empty() {
        said.push(format!(
            "with these assumptions, the rms distance of measured from nominal positions is {}; without them, it \
             is {}",
            in_mm(reading.rms),
            if reading.plain_rms.is_finite() { in_mm(reading.plain_rms) } else { "undetermined".into() }
        ));
    }
    said
}

/// Returns warnings about units that contradict the column names, and about orientations that no convention
/// explains.
fn warnings(table: &MeasuredTable, reading: &DataReading, rotation: Option<&RotationReading>) -> Vec<String> {
    let mut said = Vec::new();
    let angle = |unit: StatedUnit| match unit {
        StatedUnit::Degree => Some("deg"),
        StatedUnit::Radian => Some("rad"),
        _ => None,
    };
    let length = |unit: StatedUnit| match unit {
        StatedUnit::Millimetre => Some("mm"),
        StatedUnit::Metre => Some("m"),
        StatedUnit::Inch => Some("inch"),
        _ => None,
    };
    let mut compare = |what: &str, stated: Option<&str>, found: &str| {
        if let Some(stated) = stated.filter(|stated| *stated != found) {
            said.push(format!("the file states {what} in {stated}, but only {found} fits the arm"));
        }
    };
    compare("joints", table.angle_unit.and_then(angle), angles_in_words(reading.degrees));
    compare("positions", table.length_unit.and_then(length), unit_name(reading.unit));
    if let Some(of) = rotation.filter(|of| of.is_plausible() && table.rotation.len() == 3) {
        compare("orientations", table.rotation_unit.and_then(angle), angles_in_words(of.degrees));
    }
    let has_rotations = table.rows.iter().any(|row| row.rotation.is_some());
    if has_rotations && !rotation.is_some_and(RotationReading::is_plausible) {
        let least = rotation.map(|of| format!(" (at best {} deg rms)", rounded(deg_from_rad(of.rms), 2)));
        said.push(format!(
            "no convention explains the orientations{}; only the positions are used",
            least.unwrap_or_default()
        ));
    }
    said
}

/// Warns of rows that are left out.
fn warn_of_suspects(name: &str, suspect: &SuspectRows) {
    let kinds = [
        (&suspect.copies, "an earlier row digit by digit", ""),
        (&suspect.stuck_positions, "the position of another posture", ""),
        (
            &suspect.stuck_joints,
            "the joint coordinates of the row before, although the reflector has moved",
            "; if the rows belong to several reflectors, name the reflectors in a column `reflector`",
        ),
    ];
    for (rows, what, help) in kinds.into_iter().filter(|(rows, _, _)| !rows.is_empty()) {
        let first: Vec<_> = rows.iter().take(10).map(ToString::to_string).collect();
        let more = if rows.len() > first.len() { ", ..." } else { "" };
        let first = first.join(", ");
        output::talk(&match rows.len() {
            1 => format!("warning: {name}: line {first} repeats {what}, and is left out{help}"),
            count => {
                format!(
                    "warning: {name}: {count} rows repeat {what}, and are left out (lines {first}{more}){help}"
                )
            }
        });
    }
}
