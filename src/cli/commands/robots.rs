//! `robots`, `robot` and `envelope`: built-in robots and robot files.

use super::{suggest, suggest_with, unsolved};
use crate::assess::{EnvelopeQuery, Reachable, RobotDataSheet};
use crate::cell::{Attitude, Operation, Robot};
use crate::cli::arguments::{EnvelopeArguments, RobotArguments, RobotsArguments};
use crate::cli::imported_robot::{ImportQuery, import, is_importable};
use crate::cli::output::{path_word, word};
use crate::cli::packages::PackageFolders;
use crate::cli::{Exit, json_text, library, loading, lookup, output};
use crate::files::{LoadedRobot, shown};
use crate::reach::Inverse;
use crate::record::{EnvelopeDocument, RobotSheetDocument, RobotsDocument};
use crate::report;
use crate::robot::Chain;
use crate::units::{m_from_mm, rad_from_deg};
use std::path::Path;

/// Largest number of sample points of one envelope. This many points take minutes with closed-form inverse
/// kinematics.
const MAX_POINTS: u64 = 300_000_000;

/// Runs `sweetspot robots`.
pub fn robots(a: &RobotsArguments) -> Result<Exit, Exit> {
    let mut all = Vec::new();
    for (name, _) in library::ROBOTS {
        let robot = of_library(name)?.robot;
        let family = Inverse::new(&Chain::new(&robot)).family();
        all.push((name, robot, family));
    }
    if a.json {
        json_text::print(&RobotsDocument::new(&all))?;
    } else {
        output::data(&report::text::robots(&all))?;
        suggest(&format!("robot {}", library::ROBOTS[0].0));
    }
    Ok(Exit::Done)
}

/// Runs `sweetspot robot`.
pub fn robot(a: &RobotArguments) -> Result<Exit, Exit> {
    if a.toml {
        return print_file(&a.robot, &a.packages);
    }
    let robot = read_aloud(&a.robot, &a.packages)?.robot;
    let sheet = RobotDataSheet::new(&robot);
    if a.json {
        json_text::print(&RobotSheetDocument::new(&sheet))?;
    } else {
        output::data(&report::text::robot(&sheet))?;
        suggest_with(&format!("envelope {} --svg envelope.svg", path_word(&a.robot)), &a.packages);
    }
    Ok(Exit::Done)
}

/// Reads a robot as [`read`] does, and prints the warnings of the import of a URDF.
fn read_aloud(given: &Path, packages: &PackageFolders) -> Result<LoadedRobot, Exit> {
    if is_importable(given) {
        let imported = import(ImportQuery::new(given, packages))?;
        imported.tell();
        return Ok(imported.loaded);
    }
    let loaded = read(given, packages)?;
    output::import_warnings(&loaded.warnings);
    Ok(loaded)
}

fn print_file(robot: &Path, packages: &PackageFolders) -> Result<Exit, Exit> {
    let name = robot.to_string_lossy();
    match library::text(&name) {
        Some(text) => output::data(text)?,
        None => {
            let source = read(robot, packages)?.sources.into_iter().next();
            output::data(source.as_ref().map_or("", |s| s.text()))?;
        }
    }
    suggest("check CELL, with robot = { from = \"FILE\" } in it");
    Ok(Exit::Done)
}

/// Runs `sweetspot envelope`.
pub fn envelope(a: &EnvelopeArguments) -> Result<Exit, Exit> {
    if is_robot(&a.of, &a.packages) {
        if a.operation.is_some() {
            output::error("--operation needs a cell file, but the argument is a robot");
            output::talk("  help: state the elevation of the tool with --bend DEG");
            return Err(Exit::BadInput);
        }
        let robot = read(&a.of, &a.packages)?.robot;
        let inverse = Inverse::new(&Chain::new(&robot));
        let down = inverse.fixed_elevation().unwrap_or(-std::f64::consts::FRAC_PI_2);
        let attitude = Attitude::elevation(a.bend.map_or(down, rad_from_deg));
        return drawn(a, &robot, &inverse, (None, attitude, 0.0, None));
    }
    let cell = loading::load(&a.of, &a.packages)?.cell;
    let k = match (&a.operation, &cell.operations[..]) {
        (Some(name), _) => lookup::operation(&cell, name)?,
        (None, [first, others @ ..]) => {
            let others: Vec<String> = others.iter().map(|o| shown(&o.name)).collect();
            if !others.is_empty() {
                let (first, others) = (shown(&first.name), others.join(", "));
                output::talk(&format!("note: showing {first}; choose another with --operation: {others}"));
            }
            0
        }
        (None, []) => 0,
    };
    let operation = &cell.operations[k];
    let start = cell.start();
    let at = start.placements[operation.equipment].seen_from(&start.base);
    let mut attitude = operation.attitude.clone();
    attitude.elevation = a.bend.map_or(attitude.elevation, rad_from_deg);
    let height = at.z + operation.standoff;
    let inverse = Inverse::new(&Chain::new(&cell.robot));
    drawn(a, &cell.robot, &inverse, (Some(operation), attitude, at.yaw, Some(height)))
}

/// Operation, orientation of the tool, yaw of the surface (rad) and height of the plan (m) of an envelope.
type EnvelopeSubject<'a> = (Option<&'a Operation>, Attitude, f64, Option<f64>);

fn drawn(
    a: &EnvelopeArguments,
    robot: &Robot,
    inverse: &Inverse,
    about: EnvelopeSubject<'_>,
) -> Result<Exit, Exit> {
    let (operation, attitude, yaw, height) = about;
    if let Some(why) = inverse.refusal(&attitude) {
        return Err(unsolved(&robot.name, &a.of, &why));
    }
    let mut heights: Vec<f64> = a.height.iter().copied().map(m_from_mm).collect();
    if heights.is_empty() {
        heights.extend(height);
    }
    let asked = EnvelopeQuery { operation, attitude, yaw, heights, step: a.step.map(m_from_mm) };
    let work = asked.work(robot, inverse);
    if work > MAX_POINTS {
        output::error(&format!("the envelope needs {work} sample points, more than {MAX_POINTS}"));
        output::talk("  help: use a larger --step, or give --height fewer times");
        return Err(Exit::BadInput);
    }
    let bar = output::points_bar();
    let envelope = Reachable::new(robot, inverse, asked, &|count, of| output::advance(&bar, count, of));
    bar.finish_and_clear();
    if let Some(path) = &a.svg {
        loading::write_output(path, report::chart::envelope(&envelope).as_bytes())?;
    }
    if a.json {
        json_text::print(&EnvelopeDocument::new(&envelope))?;
    } else {
        output::data(&report::text::envelope(&envelope))?;
    }
    if let Some(path) = &a.svg {
        output::talk(&format!("wrote {}", path_word(path)));
    }
    if envelope.size.extent.is_none() {
        output::talk("warning: the robot reaches no point with the tool at this elevation");
    }
    if !a.json {
        let of = path_word(&a.of);
        let next = match (operation, &a.svg) {
            (Some(_), _) => format!("map {of} --svg map.svg"),
            (None, None) => format!("envelope {of} --svg envelope.svg"),
            (None, Some(_)) if is_importable(&a.of) => format!("init {of}"),
            (None, Some(_)) => format!("robot {of}"),
        };
        suggest_with(&next, &a.packages);
    }
    Ok(Exit::Done)
}

/// Returns whether the argument denotes a robot: a built-in robot, a robot file, a URDF, or a word that is
/// not a path.
fn is_robot(given: &Path, packages: &PackageFolders) -> bool {
    let name = given.to_string_lossy();
    library::text(&name).is_some()
        || is_bare(given)
        || is_importable(given)
        || loading::is_robot(given, packages)
}

/// Returns whether the argument is a word and not a path.
fn is_bare(given: &Path) -> bool {
    given.extension().is_none() && given.components().count() == 1 && !given.exists()
}

/// Reads a built-in robot by its name, a robot file, or a URDF or xacro file.
pub fn read(given: &Path, packages: &PackageFolders) -> Result<LoadedRobot, Exit> {
    let name = given.to_string_lossy();
    if library::text(&name).is_some() {
        return of_library(&name);
    }
    if is_importable(given) {
        return Ok(import(ImportQuery::new(given, packages))?.loaded);
    }
    if is_bare(given) {
        let names = library::ROBOTS.iter().map(|(name, _)| *name);
        let what = format!("unknown robot `{}`", shown(&name));
        let exit = lookup::unknown(&what, &name, names);
        output::talk(&format!("  help: to read your own file, add its extension: {}.toml", word(&name)));
        return Err(exit);
    }
    loading::load_robot(given, packages)
}

fn of_library(name: &str) -> Result<LoadedRobot, Exit> {
    let loaded = library::robot(name).unwrap_or_else(|| Err(Vec::new()));
    loaded.map_err(|faults| {
        output::faults(&faults);
        Exit::BadInput
    })
}
