//! `calibrate`: identifies the kinematic errors of a robot from measured positions.

use super::assumed::assumed;
use super::measuring_plan::{choose, measuring_plan};
use super::robots::read;
use super::suggest;
use crate::calibration::{
    Accuracy, DataReading, Deformed, MeasuredPosition, MeasuringSession, aligned, calibrate as fitted, drawn,
    explain, unit_name,
};
use crate::cell::Robot;
use crate::cli::arguments::CalibrateArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, json_text, loading, output};
use crate::files::measured::{MeasuredTable, read as read_table};
use crate::record::{AccuracyEntry, CalibratedFile, CalibrationDocument, TestedFile};
use crate::report;
use crate::robot::Chain;
use crate::units::{mm_from_m, rounded};
use std::path::Path;
use std::time::Instant;

/// Runs `sweetspot calibrate`.
pub fn calibrate(a: &CalibrateArguments) -> Result<Exit, Exit> {
    if let Some(count) = a.planning.plan {
        return measuring_plan(a, count as usize);
    }
    let robot = read(&a.robot, &a.packages)?.robot;
    let chain = Chain::new(&robot);
    let read_all = |paths: &[std::path::PathBuf]| -> Result<Vec<MeasuringSession>, Exit> {
        // Every file is read before the first fault ends the command.
        let sessions: Vec<_> = paths.iter().map(|path| session(path, &robot, &chain, a)).collect();
        sessions.into_iter().collect()
    };
    let (sessions, tests) = (read_all(&a.data), read_all(&a.test));
    let (mut sessions, tests) = (sessions?, tests?);
    if let Some(count) = a.poses {
        for session in &mut sessions {
            session.measured = drawn(&session.measured, count, a.seed);
        }
    }
    if let Some(count) = a.planning.choose {
        choose(&mut sessions, count as usize, a, &chain, assumed(&robot, &chain, a)?)?;
    }
    let begun = Instant::now();
    let (unknowns, priors) = assumed(&robot, &chain, a)?;
    let calibration = fitted(&chain, &sessions, &unknowns, &priors).map_err(|why| {
        output::error(&format!("cannot calibrate {}: {why}", path_word(&a.robot)));
        output::talk("  help: measure more postures, with every joint in several positions");
        Exit::BadInput
    })?;
    let seconds = begun.elapsed().as_secs_f64();
    let calibrated = sessions.iter().zip(&calibration.sessions).filter_map(|(session, fitted)| {
        Some(CalibratedFile {
            file: session.name.clone(),
            poses: session.measured.len(),
            before: nominal(&chain, session)?,
            after: AccuracyEntry::new(&Accuracy::of(fitted.distances.clone())?),
        })
    });
    let tested = tests.iter().filter_map(|session| {
        let (fitted, coverage_95) = calibration.tested(&session.measured)?;
        Some(TestedFile {
            file: session.name.clone(),
            poses: session.measured.len(),
            before: nominal(&chain, session)?,
            after: AccuracyEntry::new(&Accuracy::of(fitted.distances)?),
            coverage_95,
        })
    });
    let (calibrated, tested) = (calibrated.collect(), tested.collect());
    let document = CalibrationDocument::new(&robot, &calibration, calibrated, tested, seconds);
    if a.json {
        json_text::print(&document)?;
    } else if a.toml {
        output::data(&report::measured_errors::table(&robot, &calibration, &document))?;
        suggest(&format!("check CELL, with this table in a copy of {}", path_word(&a.robot)));
    } else {
        output::data(&report::text::calibration(&document))?;
        let files: Vec<_> = a.data.iter().map(|path| path_word(path)).collect();
        suggest(&format!("calibrate {} {} --toml", path_word(&a.robot), files.join(" ")));
    }
    if a.elastic && !a.json {
        output::talk("note: the error model of a cell has no elastic terms yet; maps use the rows alone");
    }
    Ok(Exit::Done)
}

/// Returns the accuracy of the nominal robot after a fit of base and reflector.
fn nominal(chain: &Chain, session: &MeasuringSession) -> Option<AccuracyEntry> {
    let poses: Vec<_> = session.measured.iter().map(|m| Deformed::new(chain, &m.joints, &[], &[])).collect();
    let frames = aligned(&poses, &session.measured)?;
    let distances = poses.iter().zip(&session.measured);
    let distances = distances.map(|(pose, m)| frames.residual(&pose.interface, m).norm()).collect();
    Accuracy::of(distances).as_ref().map(AccuracyEntry::new)
}

/// Reads a table, finds its units and joint signs, and states them.
fn session(
    path: &Path,
    robot: &Robot,
    chain: &Chain,
    a: &CalibrateArguments,
) -> Result<MeasuringSession, Exit> {
    let name = path_word(path);
    let text = loading::read_text(path)?;
    let joints: Vec<_> = robot.joints.iter().map(|joint| joint.name.as_str()).collect();
    let table = read_table(&path.to_string_lossy(), &text, &joints, &a.column).map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })?;
    let reading = explain(chain, &table.rows, robot.reach());
    let Some(reading) = reading.filter(|reading| reading.is_plausible(robot.reach())) else {
        let rms = reading.map_or("none".into(), |r| format!("{} mm", rounded(mm_from_m(r.rms), 1)));
        let robot = path_word(&a.robot);
        output::error(&format!("{name}: the positions do not fit the arm {robot}"));
        output::talk(&format!(
            "  help: check the robot, the columns and the joint zeros; every unit and joint sign was tried, and \
             the smallest rms distance is {rms}"
        ));
        return Err(Exit::BadInput);
    };
    output::talk(&in_words(&name, &table, &reading, chain.axes()));
    let measured = table.rows.iter().map(|raw| reading.applied(chain, raw)).collect::<Vec<_>>();
    let stuck = stuck(&measured);
    if !stuck.is_empty() {
        let rows: Vec<_> = stuck.iter().take(10).map(ToString::to_string).collect();
        let rows = rows.join(", ");
        output::talk(&format!(
            "warning: {name}: {} rows repeat the position of another posture and are left out (rows {rows})",
            stuck.len()
        ));
    }
    let measured = measured.into_iter().filter(|m| !stuck.contains(&m.row)).collect();
    Ok(MeasuringSession {
        name: path.file_name().map_or(name, |f| f.to_string_lossy().into_owned()),
        measured,
    })
}

/// Distance of a joint coordinate, rad or m, from which two postures differ.
const OTHER_POSTURE: f64 = 0.01;

/// Returns the rows whose position equals that of the row before, although the arm has moved.
fn stuck(measured: &[MeasuredPosition]) -> Vec<usize> {
    let pairs = measured.windows(2).filter(|pair| {
        let moved = pair[0].joints.iter().zip(pair[1].joints).any(|(a, b)| (a - b).abs() > OTHER_POSTURE);
        moved && pair[0].position == pair[1].position && pair[0].reflector == pair[1].reflector
    });
    pairs.map(|pair| pair[1].row).collect()
}

/// Returns which columns of a table mean what, and in which units.
fn in_words(name: &str, table: &MeasuredTable, reading: &DataReading, axes: usize) -> String {
    let angles = if reading.degrees { "deg" } else { "rad" };
    let [x, y, z] = &table.position;
    let mut said = format!(
        "{name}: {} positions; joints {} in {angles}; position {x}, {y}, {z} in {}",
        table.rows.len(),
        table.joints.join(", "),
        unit_name(reading.unit)
    );
    if table.reflectors.len() > 1 {
        said += &format!("; reflectors {}", table.reflectors.join(", "));
    }
    if reading.has_flipped_signs() {
        let flipped = (0..axes).filter(|&i| reading.signs[i] < 0.0).map(|i| table.joints[i].clone());
        let flipped: Vec<_> = flipped.collect();
        said += &format!("\nwarning: {name}: the sign of {} is reversed", flipped.join(", "));
    }
    said
}
