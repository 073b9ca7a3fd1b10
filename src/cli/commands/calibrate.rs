//! `calibrate`: identifies the kinematic errors of a robot from measured positions.

use super::assumed::assumed;
use super::measurements::{TableOptions, session};
use super::measuring_plan::{choose, measuring_plan};
use super::robots::read;
use super::stated::{calibrate_as_stated, is_urdf, robot_of_urdf, states_calibration};
use super::{suggest, suggest_with};
use crate::calibration::{
    GrossError, GrossErrors, LEAST_POSITIONS, MeasuringSession, Unknown, calibrate as fitted, drawn,
    gross_errors, harmonics,
};
use crate::cli::arguments::CalibrateArguments;
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, json_text, loading, output};
use crate::files::shown;
use crate::record::{CalibratedFile, CalibrationDocument, TestedFile};
use crate::report;
use crate::robot::Chain;
use crate::units::{mm_from_m, rounded};
use std::time::Instant;

/// Least rms error, mm, of a calibrated arm at which a warning compares the arm with the nominal arm.
const POOR_MM: f64 = 1.0;
/// Share of the nominal rms error above which a calibrated arm is hardly better than the nominal arm.
const HARDLY: f64 = 0.7;

/// Runs `sweetspot calibrate`.
pub fn calibrate(a: &CalibrateArguments) -> Result<Exit, Exit> {
    if let Some(count) = a.planning.plan {
        return measuring_plan(a, count as usize);
    }
    let robot = match is_urdf(&a.robot) {
        true => robot_of_urdf(&a.robot, None)?.robot,
        false => read(&a.robot, &a.packages)?.robot,
    };
    if let Some(stated) = a.data.iter().find(|path| states_calibration(path)) {
        return calibrate_as_stated(&robot, stated, a);
    }
    let chain = Chain::new(&robot);
    let options = TableOptions { columns: &a.column, joints: a.joints.as_deref() };
    let read_all = |paths: &[std::path::PathBuf]| -> Result<Vec<MeasuringSession>, Exit> {
        // Every file is read even if an earlier one is faulty, so that the faults of all files are printed.
        let sessions: Vec<_> = paths.iter().map(|path| session(path, &robot, &chain, &options)).collect();
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
    let (mut unknowns, mut priors) = assumed(&robot, &chain, a)?;
    leave_out_gross_errors(&chain, &mut sessions, &unknowns, &priors);
    if let Some(orders) = a.harmonics.map(usize::from) {
        unknowns.extend(harmonics(&chain, orders));
        priors.extend(unknowns[priors.len()..].iter().map(|u| u.default_prior(&chain)));
    }
    let bar = output::spinner("identifying the errors");
    let calibration = fitted(&chain, &sessions, &unknowns, &priors);
    bar.finish_and_clear();
    let calibration = calibration.map_err(|why| {
        output::error(&format!("cannot calibrate {}: {why}", path_word(&a.robot)));
        output::talk("  help: measure more postures, with every joint in several positions");
        Exit::BadInput
    })?;
    let seconds = begun.elapsed().as_secs_f64();
    let calibrated = sessions.iter().zip(&calibration.sessions);
    let calibrated = calibrated.filter_map(|(session, fitted)| CalibratedFile::new(&chain, session, fitted));
    let tested = tests.iter().filter_map(|session| TestedFile::new(&chain, session, &calibration));
    let (calibrated, tested) = (calibrated.collect(), tested.collect());
    let document = CalibrationDocument::new(&robot, &calibration, calibrated, tested, seconds);
    if let Some(warning) = hardly_better(&document.sessions) {
        output::talk(&warning);
    }
    if let Some(path) = &a.svg {
        let drawn = report::chart::joint_residuals(&robot, &sessions, &calibration.sessions);
        loading::write_output(path, drawn.as_bytes())?;
        output::talk(&format!("wrote {}", path_word(path)));
    }
    if a.json {
        json_text::print(&document)?;
    } else if a.toml {
        output::data(&report::measured_errors::table(&robot, &calibration, &document))?;
        if a.harmonics.is_some() && calibration.is_coupled() {
            output::talk(
                "note: the joints of this arm are coupled, so the table states no periodic errors; the misfit \
                 includes them",
            );
        }
        suggest(&format!("check CELL, with this table in a copy of {}", path_word(&a.robot)));
    } else {
        output::data(&report::text::calibration(&document))?;
        suggest_with(&format!("calibrate {} {} --toml", path_word(&a.robot), words(a)), &a.packages);
    }
    Ok(Exit::Done)
}

/// Leaves out measured positions with gross errors, and warns of each.
fn leave_out_gross_errors(
    chain: &Chain,
    sessions: &mut [MeasuringSession],
    unknowns: &[Unknown],
    priors: &[f64],
) {
    let all = gross_errors(chain, sessions, unknowns, priors);
    for (session, GrossErrors { errors, too_many }) in sessions.iter_mut().zip(all) {
        let name = shown(&session.name);
        if session.measured.len() < LEAST_POSITIONS {
            output::talk(&format!(
                "note: {name}: gross errors are not sought among fewer than {LEAST_POSITIONS} positions"
            ));
        }
        if too_many {
            let lines: Vec<_> = errors.iter().take(10).map(|error| error.row.to_string()).collect();
            let dots = if errors.len() > lines.len() { ", ..." } else { "" };
            output::talk(&format!(
                "warning: {name}: {} of {} positions look like gross errors (lines {}{dots}); these are too many to \
                 leave out, so correct or delete them",
                errors.len(),
                session.measured.len(),
                lines.join(", ")
            ));
            continue;
        }
        let has_several = session.measured.iter().any(|m| m.reflector > 0);
        session.measured.retain(|m| !errors.iter().any(|error| error.is_at(m)));
        for GrossError { row, reflector, distance } in errors {
            let of = if has_several { format!(", reflector {},", reflector + 1) } else { String::new() };
            output::talk(&format!(
                "warning: {name}: line {row}{of} is {} mm from its prediction, far more than the other positions; it \
                 is left out of the fit",
                rounded(mm_from_m(distance), 3)
            ));
        }
    }
}

/// Returns a warning if the calibrated arm explains the positions hardly better than the nominal arm.
fn hardly_better(files: &[CalibratedFile]) -> Option<String> {
    let poor = files
        .iter()
        .find(|file| file.after.rms_mm > POOR_MM && file.after.rms_mm > HARDLY * file.before.rms_mm)?;
    Some(format!(
        "warning: {}: the calibrated arm (rms {} mm) predicts the positions hardly better than the nominal arm \
         (rms {} mm); check the signs, zeros and order of the joint columns, and the robot file",
        shown(&poor.file),
        rounded(poor.after.rms_mm, 3),
        rounded(poor.before.rms_mm, 3)
    ))
}

/// Returns the tables and the options of the fit as typed on a command line.
fn words(a: &CalibrateArguments) -> String {
    let mut words: Vec<String> = a.data.iter().map(|path| path_word(path)).collect();
    words.extend(a.elastic.then(|| "--elastic".into()));
    words.extend(a.harmonics.map(|orders| format!("--harmonics {orders}")));
    words.extend(a.prior.as_ref().map(|set| format!("--prior {}", word(set))));
    words.extend(a.joints.as_ref().map(|path| format!("--joints {}", path_word(path))));
    let columns = a.column.iter();
    words.extend(columns.map(|(of, name)| format!("--column {}", word(&format!("{of}={name}")))));
    words.extend(a.poses.map(|count| format!("--poses {count} --seed {}", a.seed)));
    words.extend(a.planning.choose.map(|count| format!("--choose {count}")));
    words.extend(a.planning.task.as_ref().map(|cell| format!("--for {}", path_word(cell))));
    words.join(" ")
}
