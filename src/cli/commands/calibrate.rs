//! `calibrate`: identifies the kinematic errors of a robot from measured positions.

use super::assumed::assumed;
use super::measurements::{TableOptions, session};
use super::measuring_plan::{choose, measuring_plan};
use super::robots::read;
use super::stated::{calibrate_as_stated, is_urdf, robot_of_urdf, states_calibration};
use super::suggest;
use crate::calibration::{
    Accuracy, Deformed, MeasuringSession, aligned, calibrate as fitted, drawn, expected_harmonic, harmonics,
};
use crate::cli::arguments::CalibrateArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, json_text, output};
use crate::record::{AccuracyEntry, CalibratedFile, CalibrationDocument, OutlierRow, TestedFile};
use crate::report;
use crate::robot::Chain;
use std::time::Instant;

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
        // Every file is read before the first fault ends the command.
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
    if let Some(orders) = a.harmonics.map(usize::from) {
        unknowns.extend(harmonics(&chain, orders));
        priors.resize(unknowns.len(), expected_harmonic(orders));
    }
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
            outliers: OutlierRow::of(fitted),
        })
    });
    let tested = tests.iter().filter_map(|session| {
        let (fitted, coverage_95) = calibration.tested(&session.measured)?;
        Some(TestedFile {
            file: session.name.clone(),
            poses: session.measured.len(),
            before: nominal(&chain, session)?,
            outliers: OutlierRow::of(&fitted),
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
        if a.harmonics.is_some() {
            output::talk(
                "note: a cell has no periodic errors; the table states them as misfit of the joints",
            );
        }
        suggest(&format!("check CELL, with this table in a copy of {}", path_word(&a.robot)));
    } else {
        output::data(&report::text::calibration(&document))?;
        let files: Vec<_> = a.data.iter().map(|path| path_word(path)).collect();
        suggest(&format!("calibrate {} {} --toml", path_word(&a.robot), files.join(" ")));
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
