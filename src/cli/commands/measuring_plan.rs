//! `calibrate --plan` and `calibrate --choose`: the measuring poses that best determine the errors at the
//! operations.

use super::assumed::assumed;
use super::{suggest_with, workcell};
use crate::calibration::{
    IntendedCalibration, MeasuredPosition, MeasuringSession, PlanProblem, Unknown, UnmodelledError,
};
use crate::cell::{Cell, JointVector, Layout};
use crate::cli::arguments::CalibrateArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, json_text, loading, output};
use crate::files::{Source, shown};
use crate::layout::{MeasurablePoses, Sightline, Workcell};
use crate::record::{
    ExpectedEntry, MEASURING_PLAN_SCHEMA, MeasuringPlanDocument, PlannedPoseEntry, TriedEntry, position_mm,
};
use crate::report;
use crate::robot::Chain;
use crate::units::{MILLIMETRE, m_from_mm, rad_from_deg};
use nalgebra::Vector3;
use std::path::Path;

/// Runs `sweetspot calibrate --plan`.
pub fn measuring_plan(a: &CalibrateArguments, count: usize) -> Result<Exit, Exit> {
    let loaded = loading::load(&a.robot, &a.packages)?;
    let robot_file = robot_file(a, &loaded.sources);
    let workcell = workcell(loaded.cell, &a.robot)?;
    let (cell, layout) = (&workcell.cell, workcell.cell.start());
    let chain = Chain::new(&cell.robot);
    let (unknowns, priors) = assumed(&cell.robot, &chain, a)?;
    let intended = intended(a, &chain, &unknowns, &priors);
    enough(&intended, count)?;
    let sightline = sightline(a, &workcell, &layout)?;
    let task = task(&workcell, &layout)?;
    let found = candidates(a, &workcell, &layout, &intended.reflector, sightline.as_ref());
    if found.joints.len() < count {
        return Err(too_few(&found, count));
    }
    let problem = PlanProblem::new(&intended, &found.joints, &task);
    let chosen = best(&problem, count)?;
    let evenly: Vec<_> = (0..count).collect();
    let errors = [problem.before(), problem.after(&chosen), problem.after(&evenly)];
    let poses = chosen.iter().enumerate().map(|(k, &i)| {
        let at = workcell.reflector_at(&layout, &found.joints[i], &intended.reflector);
        PlannedPoseEntry::new(cell, k + 1, &found.joints[i], &at)
    });
    let document = MeasuringPlanDocument {
        schema: MEASURING_PLAN_SCHEMA.into(),
        cell: cell.name.clone(),
        robot: cell.robot.name.clone(),
        poses: poses.collect(),
        expected: ExpectedEntry::new(task.len(), errors, intended.error),
        tried: TriedEntry::new(&found),
        unknowns: intended.unknowns_with_set_up(),
        reflector_mm: position_mm(&intended.reflector),
        tracker_mm: sightline.map(|sightline| position_mm(&sightline.instrument)),
        seed: a.seed,
    };
    written(a, cell, &document, &robot_file)
}

/// Prints the plan, and writes the table to be filled in.
fn written(
    a: &CalibrateArguments,
    cell: &Cell,
    document: &MeasuringPlanDocument,
    robot_file: &str,
) -> Result<Exit, Exit> {
    let table = report::measuring_plan::csv(cell, document).map_err(|why| {
        output::error(&format!("cannot write the table: {why}"));
        Exit::Io
    })?;
    let is_stdout = |path: &Path| path.as_os_str() == "-";
    let csv = a.planning.csv.as_deref();
    let text = || report::text::measuring_plan(&cell.robot, document);
    match csv {
        Some(path) if is_stdout(path) && !a.json => {
            output::talk(&text());
            output::data(&String::from_utf8_lossy(&table))?;
        }
        _ if a.json => json_text::print(document)?,
        _ => output::data(&text())?,
    }
    if let Some(path) = csv.filter(|path| !is_stdout(path)) {
        loading::write_output(path, &table)?;
        output::talk(&format!("wrote {}", path_word(path)));
    }
    if a.json {
        return Ok(Exit::Done);
    }
    output::talk("note: the moves between the poses are not checked for collisions");
    match csv {
        Some(path) => {
            let path = if is_stdout(path) { "plan.csv".into() } else { path_word(path) };
            output::talk(&format!(
                "measure the poses, and fill in the columns x, y and z of {path} before the next command"
            ));
            suggest_with(&format!("calibrate {robot_file} {path}{}", elastic(a)), &a.packages);
        }
        None => {
            let count = document.poses.len();
            let cell = path_word(&a.robot);
            let next = format!("calibrate --plan {count} {cell}{} --csv plan.csv", elastic(a));
            suggest_with(&next, &a.packages);
        }
    }
    Ok(Exit::Done)
}

fn elastic(a: &CalibrateArguments) -> &'static str {
    if a.elastic { " --elastic" } else { "" }
}

/// Returns the path of the robot file of a cell, quoted for a shell. Returns the word ROBOT if the cell file
/// contains the robot.
fn robot_file(a: &CalibrateArguments, sources: &[Source]) -> String {
    let folder = a.robot.parent().unwrap_or(Path::new(""));
    let mut files = sources.iter().skip(1).map(|source| folder.join(&source.path));
    files.find(|file| loading::is_robot(file, &a.packages)).map_or("ROBOT".into(), |file| path_word(&file))
}

/// Returns the calibration for which poses are chosen. The reflector is at the TCP unless --reflector states
/// its position.
fn intended<'a>(
    a: &CalibrateArguments,
    chain: &'a Chain,
    unknowns: &'a [Unknown],
    priors: &'a [f64],
) -> IntendedCalibration<'a> {
    let reflector = a.planning.reflector.map_or(chain.tool.translation, metres);
    if reflector.norm() < MILLIMETRE {
        output::talk(
            "note: the reflector is assumed to be at the flange; state its position with --reflector X,Y,Z",
        );
    }
    IntendedCalibration { chain, unknowns, priors, reflector, error: UnmodelledError::default() }
}

fn metres(mm: [f64; 3]) -> Vector3<f64> {
    Vector3::from(mm.map(m_from_mm))
}

/// Refuses a plan with fewer poses than the number of unknowns requires.
fn enough(intended: &IntendedCalibration<'_>, count: usize) -> Result<(), Exit> {
    let (least, unknowns) = (intended.least_poses(), intended.unknowns_with_set_up());
    if count >= least {
        return Ok(());
    }
    output::error(&format!("{count} poses give {} coordinates for {unknowns} unknowns", 3 * count));
    output::talk(&format!("  help: use at least {least} poses"));
    Err(Exit::BadInput)
}

/// Returns the position of the tracker and the opening of the reflector; None without --tracker. Refuses a
/// tracker inside a solid, and an opening of length 0.
fn sightline(
    a: &CalibrateArguments,
    workcell: &Workcell,
    layout: &Layout,
) -> Result<Option<Sightline>, Exit> {
    let Some(tracker) = a.planning.tracker else { return Ok(None) };
    let instrument = metres(tracker);
    if let Some(solid) = workcell.solid_at(layout, &instrument) {
        let solid = shown(&solid.in_words(&workcell.cell));
        output::error(&format!("the tracker is inside {solid}"));
        output::talk("  help: --tracker states x, y and z in the world frame, in mm");
        return Err(Exit::BadInput);
    }
    let opening =
        a.planning.opening.map(|axis| (Vector3::from(axis), rad_from_deg(a.planning.opening_angle)));
    if opening.is_some_and(|(axis, _)| axis.norm() == 0.0) {
        output::error("the direction of --opening has length 0");
        output::talk(
            "  help: write the direction in the frame of the mechanical interface, for example 1,0,0",
        );
        return Err(Exit::BadInput);
    }
    Ok(Some(Sightline { instrument, opening }))
}

/// Returns the postures of the usable nodes of all operations.
fn task(workcell: &Workcell, layout: &Layout) -> Result<Vec<JointVector>, Exit> {
    let maps = workcell.maps(layout);
    let nodes = maps.iter().flat_map(|map| map.usable().map(|(_, _, posture)| posture.joints));
    let nodes: Vec<_> = nodes.collect();
    if nodes.is_empty() {
        output::error("the robot reaches no node of the operations in the layout as drawn");
        output::talk("  help: find a layout first, with `sweetspot search`");
        return Err(Exit::AnswerIsNo);
    }
    Ok(nodes)
}

fn candidates(
    a: &CalibrateArguments,
    workcell: &Workcell,
    layout: &Layout,
    reflector: &Vector3<f64>,
    sightline: Option<&Sightline>,
) -> MeasurablePoses {
    let wanted = a.planning.candidates as usize;
    let bar = output::points_bar();
    let mut progress = |_| output::advance(&bar, 1, wanted as u64);
    let found = workcell.measurable_poses(layout, reflector, sightline, (wanted, a.seed), &mut progress);
    bar.finish_and_clear();
    found
}

fn too_few(found: &MeasurablePoses, count: usize) -> Exit {
    let MeasurablePoses { joints, colliding, hidden } = found;
    output::error(&format!(
        "only {} postures can be measured, fewer than {count}: {colliding} others collide, and at {hidden} \
         others the tracker does not see the reflector",
        joints.len()
    ));
    output::talk("  help: use more --candidates, move --tracker, or plan fewer poses");
    if *hidden == 0 && *colliding == 0 { Exit::BadInput } else { Exit::AnswerIsNo }
}

/// Returns the indices of the `count` most informative candidates, and shows a progress bar.
fn best(problem: &PlanProblem, count: usize) -> Result<Vec<usize>, Exit> {
    let bar = output::points_bar();
    let mut last = 0;
    let chosen = problem.best(count, &mut |done, of| {
        output::advance(&bar, (done - last) as u64, of as u64);
        last = done;
    });
    bar.finish_and_clear();
    chosen.ok_or_else(|| {
        output::error("the plan cannot be computed: its covariances are not finite");
        output::talk("  help: check the standard deviations of --prior");
        Exit::BadInput
    })
}

/// Keeps the `count` most informative rows of every session. The choice uses only the joint coordinates.
pub fn choose(
    sessions: &mut [MeasuringSession],
    count: usize,
    a: &CalibrateArguments,
    chain: &Chain,
    (unknowns, priors): (Vec<Unknown>, Vec<f64>),
) -> Result<(), Exit> {
    let intended = intended(a, chain, &unknowns, &priors);
    enough(&intended, count)?;
    let of_cell = match &a.planning.task {
        Some(cell) => {
            let workcell = workcell(loading::load(cell, &a.packages)?.cell, cell)?;
            if workcell.cell.robot.axes() != chain.axes() {
                output::error(&format!(
                    "{}: its robot and the measured robot have different numbers of joints",
                    path_word(cell)
                ));
                output::talk("  help: state a cell of the measured robot with --for");
                return Err(Exit::BadInput);
            }
            Some(task(&workcell, &workcell.cell.start())?)
        }
        None => None,
    };
    for session in sessions {
        let mut rows: Vec<&MeasuredPosition> = session.measured.iter().collect();
        // Several reflectors may be measured at one posture, so several positions may belong to one row.
        rows.dedup_by_key(|m| m.row);
        let candidates: Vec<_> = rows.iter().map(|m| m.joints).collect();
        if candidates.len() < count {
            let (name, rows) = (shown(&session.name), candidates.len());
            output::error(&format!("{name} has {rows} rows, fewer than {count}"));
            output::talk("  help: choose fewer rows, or leave out --choose");
            return Err(Exit::BadInput);
        }
        let problem = PlanProblem::new(&intended, &candidates, of_cell.as_ref().unwrap_or(&candidates));
        let chosen: Vec<_> = best(&problem, count)?.into_iter().map(|i| rows[i].row).collect();
        session.measured.retain(|m| chosen.contains(&m.row));
    }
    Ok(())
}
