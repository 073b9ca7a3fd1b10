//! `init` for a robot of the user: a cell around a URDF, a xacro file or a folder of a ROS package.

use super::{schema, suggest};
use crate::cell::{ErrorSet, Robot};
use crate::cli::arguments::InitArguments;
use crate::cli::first_cells::{OwnCell, TABLE, TablePlace, table_places};
use crate::cli::imported_robot::{GUESS, ImportQuery, ImportedRobot, import, stem};
use crate::cli::output::{path_word, word};
use crate::cli::output_folder::{Sharing, new_folder};
use crate::cli::{Exit, loading, output};
use crate::error_map::Status;
use crate::files;
use crate::files::{FileContent, LoadedRobot, shown};
use crate::layout::Workcell;
use crate::reach::{Cost, Inverse};
use crate::robot::Chain;
use crate::units::rad_from_deg;
use std::path::{Path, PathBuf};

const CELL: &str = "cell.toml";

/// Least share of usable nodes that makes a place of the table acceptable. The first such place ends the
/// trials.
const GOOD: f64 = 0.95;

/// Attitudes to try: elevation of the tool axis, degrees, and height of the TCP above the table, mm.
const ATTITUDES: [(f64, i32); 4] = [(-90.0, 100), (-90.0, 200), (0.0, 100), (0.0, 200)];

/// Largest depth of the folders in which robots are searched for. The package itself has depth 0.
const MAX_DEPTH: usize = 4;

/// Largest number of robots of a package that are listed.
const MAX_LISTED: usize = 30;

/// Returns whether the argument of `init` is a path and not the name of a first cell.
pub fn is_path(name: &str) -> bool {
    let path = Path::new(name);
    path.exists() || path.extension().is_some() || path.components().count() > 1
}

/// Robot of the user, with the files that describe it in the folder of a cell.
struct OwnRobot {
    robot: Robot,
    /// Path of the robot file in the folder of the cell.
    file: String,
    files: Vec<(String, Vec<u8>)>,
    /// Name of the error set that the cell uses.
    errors: String,
    /// Comment on the error set in the cell file.
    about_errors: String,
    /// Whether the error set contains the signed errors of one robot.
    is_signed: bool,
    /// Whether a part of the robot file is guessed.
    is_guessed: bool,
}

impl From<ImportedRobot> for OwnRobot {
    fn from(imported: ImportedRobot) -> Self {
        let about_errors = format!(
            "# GUESS: the preset {} of `sweetspot errors --presets`, not measured. Until you state your own tolerances under\n\
             # [errors.NAME] in the file of the robot, use the errors only to compare layouts.",
            imported.preset
        );
        let ImportedRobot { loaded, file, files, .. } = imported;
        Self {
            robot: loaded.robot,
            file,
            files,
            errors: GUESS.into(),
            about_errors,
            is_signed: false,
            is_guessed: true,
        }
    }
}

/// Runs `sweetspot init` for a path.
pub fn init_own(given: &Path, a: &InitArguments) -> Result<Exit, Exit> {
    let path = if given.is_dir() { robot_of_folder(given, a)? } else { given.to_path_buf() };
    let own = match loading::content(&path).is_none() && loading::is_robot(&path, &a.packages) {
        true => of_robot_file(&path, a)?,
        false => {
            refuse_other_files(&path)?;
            let (packages, tip) = (&a.packages, a.tip.as_deref());
            let imported = import(ImportQuery { path: &path, packages, tip, arguments: &a.arguments })?;
            imported.tell();
            imported.into()
        }
    };
    let command = format!(
        "sweetspot init {}",
        word(&path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned()))
    );
    let robot = &own.robot;
    let bar = output::spinner("placing the table");
    let found = placed(&own, &command);
    bar.finish_and_clear();
    let Some(found) = found else {
        output::error(&format!("no place was found where the arm {} can reach a table", shown(&robot.name)));
        output::talk(&format!(
            "  help: look at the reach of the arm with sweetspot envelope {}, or name the link of the tool \
             with --tip LINK",
            path_word(&path)
        ));
        return Err(Exit::AnswerIsNo);
    };
    let beside = path.with_file_name(format!("{}-cell", stem(&path)));
    let folder = new_folder(Some(a.out.as_deref().unwrap_or(&beside)), "", Sharing::Alone)?;
    let schemas =
        schema::of_files()?.into_iter().map(|(name, text)| (format!("schemas/{name}"), text.into_bytes()));
    let table = (TABLE.to_string(), found.place.table().into_bytes());
    // The cell file is written last, so that every file it refers to exists before it.
    let all =
        own.files.iter().cloned().chain(schemas).chain([table, (CELL.to_string(), found.cell.into_bytes())]);
    let mut count = 0;
    for (name, bytes) in all {
        let path = folder.join(name);
        path.parent().map_or(Ok(()), loading::make_folder)?;
        loading::write_whole(&path, &bytes)?;
        count += 1;
    }
    let cell = path_word(&folder.join(CELL));
    let TablePlace { top, radius, .. } = found.place;
    output::talk(&format!(
        "wrote {cell}: a table {radius} mm from the base axis, {top} mm above the floor; the arm can use {} of {} nodes as drawn",
        found.usable, found.nodes
    ));
    let robot_file = path_word(&folder.join(&own.file));
    let replace =
        if own.is_guessed { format!(": replace the guesses in {robot_file}") } else { String::new() };
    output::talk(&format!("robot, table and schemas are beside it, {count} files in all{replace}"));
    suggest(&format!("map {cell} --svg map.svg"));
    Ok(Exit::Done)
}

/// First cell with the place of its table, the number of nodes that the arm can use, and the number of all
/// nodes.
struct FoundCell {
    cell: String,
    place: TablePlace,
    usable: usize,
    nodes: usize,
}

/// Reads a robot file of the user.
fn of_robot_file(path: &Path, a: &InitArguments) -> Result<OwnRobot, Exit> {
    let LoadedRobot { robot, sources, .. } = loading::load_robot(path, &a.packages)?;
    let refuse = |why: &str, help: &str| {
        output::error(&format!("{}: {why}", path_word(path)));
        output::talk(&format!("  help: {help}"));
        Exit::BadInput
    };
    if a.tip.is_some() || !a.arguments.is_empty() {
        return Err(refuse(
            "--tip and arguments of xacro apply only to a URDF or xacro file",
            "state tip_link in the robot file",
        ));
    }
    if sources.iter().any(|source| source.path.starts_with("package://")) {
        return Err(refuse("its URDF is in a ROS package", "give the URDF itself to sweetspot init"));
    }
    let tolerance = robot.errors.iter().find(|set| matches!(set, ErrorSet::Tolerance(_)));
    let Some(errors) = tolerance.or(robot.errors.first()) else {
        return Err(refuse("it has no error set", "add [errors.NAME]"));
    };
    let (errors, is_signed) = (errors.name().to_string(), tolerance.is_none());
    let files: Vec<_> =
        sources.into_iter().map(|source| (format!("robots/{}", source.path), source.bytes)).collect();
    let file = files.first().map_or(String::new(), |(name, _)| name.clone());
    let about_errors = "# The first set of tolerances in the robot file, or else its first error set.".into();
    Ok(OwnRobot { robot, file, files, errors, about_errors, is_signed, is_guessed: false })
}

/// Returns the cell with the table at the first place that gives a good map, or else at the best place.
/// Returns None if the arm can use no node at any place.
fn placed(own: &OwnRobot, command: &str) -> Option<FoundCell> {
    let robot = &own.robot;
    let inverse = Inverse::new(&Chain::new(robot));
    let attitudes = match inverse.fixed_elevation() {
        Some(bend) => vec![(bend, 100), (bend, 200)],
        None => ATTITUDES.map(|(bend, standoff)| (rad_from_deg(bend), standoff)).to_vec(),
    };
    let mut best: Option<FoundCell> = None;
    for (bend, standoff) in attitudes {
        for place in table_places(robot, &inverse, bend, standoff) {
            let cell = OwnCell {
                command,
                name: &format!("First cell: {}", robot.name),
                robot: &own.file,
                errors: &own.errors,
                about_errors: &own.about_errors,
                is_signed: own.is_signed,
                few_spins: matches!(inverse.cost(), Cost::High | Cost::Numeric),
                place,
            };
            let Some(found) = mapped(own, cell.text(), place) else { continue };
            let is_good = found.usable as f64 >= GOOD * found.nodes as f64;
            if best.as_ref().is_none_or(|best| found.usable > best.usable) {
                best = Some(found);
            }
            if is_good {
                return best;
            }
        }
        // The first attitudes let the tool point down. Later attitudes are tried only if at most half of the
        // nodes are usable so far.
        if best.as_ref().is_some_and(|best| 2 * best.usable > best.nodes) {
            break;
        }
    }
    best.filter(|best| best.usable > 0)
}

/// Maps a cell as drawn. Returns None if the cell is not valid, or if the inverse kinematics refuses the
/// attitude of the operation.
fn mapped(own: &OwnRobot, cell: String, place: TablePlace) -> Option<FoundCell> {
    let table = place.table();
    let loaded = files::load(CELL, &mut |asked| match asked {
        CELL => Ok(cell.clone().into_bytes()),
        TABLE => Ok(table.clone().into_bytes()),
        _ => {
            let file = own.files.iter().find(|(name, _)| name == asked);
            file.map(|(_, bytes)| bytes.clone()).ok_or_else(|| "not found".into())
        }
    });
    let workcell = Workcell::new(loaded.ok()?.cell).ok()?;
    let maps = workcell.maps(&workcell.cell.start());
    let nodes = maps.iter().flat_map(|map| &map.nodes);
    let usable = nodes.clone().filter(|node| node.status == Status::Ok).count();
    Some(FoundCell { nodes: nodes.count(), cell, place, usable })
}

fn refuse_other_files(path: &Path) -> Result<(), Exit> {
    match loading::content(path) {
        Some(FileContent::Urdf | FileContent::Xacro) => return Ok(()),
        Some(content) => {
            output::error(&format!("{} is {}, not a URDF", path_word(path), content.in_words()));
            output::talk(&format!("  help: {}", content.next_step(&path_word(path))));
        }
        None if path.is_file() => {
            output::error(&format!("{} is not a URDF", path_word(path)));
            output::talk(
                "  help: give a URDF, a xacro file, a robot file in TOML or the folder of a ROS package; a \
                cell file needs no init",
            );
        }
        None => {
            output::error(&format!("cannot read {}: no such file", path_word(path)));
            output::talk(
                "  help: give a URDF, a xacro file or the folder of a ROS package, or a name that sweetspot init lists",
            );
            return Err(Exit::Io);
        }
    }
    Err(Exit::BadInput)
}

/// Returns the only URDF of a folder, or else its only xacro file that is not a part of other files.
/// Fails if the folder has several such files, and prints a list of them.
fn robot_of_folder(folder: &Path, a: &InitArguments) -> Result<PathBuf, Exit> {
    let mut all = Vec::new();
    collect(folder, 0, &mut all);
    all.sort();
    let of_kind =
        |kind| all.iter().filter(move |path| loading::content(path) == Some(kind)).collect::<Vec<_>>();
    let urdfs = of_kind(FileContent::Urdf);
    let found = if urdfs.is_empty() { of_kind(FileContent::Xacro) } else { urdfs };
    match &found[..] {
        [one] => {
            output::talk(&format!("note: {} is the only robot in this folder", path_word(one)));
            Ok((*one).clone())
        }
        [] => {
            output::error(&format!("no URDF and no xacro file in {}", path_word(folder)));
            output::talk(
                "  help: give the file of the robot, or the folder of the package that describes it",
            );
            Err(Exit::BadInput)
        }
        several => {
            output::error(&format!("{} robots in {}: choose one", several.len(), path_word(folder)));
            let words = a.packages.words();
            for path in several.iter().take(MAX_LISTED) {
                output::talk(&format!("  sweetspot init {}{words}", path_word(path)));
            }
            if several.len() > MAX_LISTED {
                output::talk(&format!("  and {} more", several.len() - MAX_LISTED));
            }
            Err(Exit::BadInput)
        }
    }
}

/// Collects the robot files below a folder. A xacro file with a name such as macro or common is a part
/// of other files and is skipped.
fn collect(folder: &Path, depth: usize, all: &mut Vec<PathBuf>) {
    for entry in folder.read_dir().into_iter().flatten().flatten() {
        let (path, name) = (entry.path(), entry.file_name().to_string_lossy().to_ascii_lowercase());
        let kind = entry.file_type();
        let is_part = ["macro", "common", "material", "transmission", "gazebo", "control"]
            .iter()
            .any(|word| name.contains(word));
        if kind.as_ref().is_ok_and(|kind| kind.is_dir()) && depth < MAX_DEPTH {
            // A cell that `init` has written is not a robot.
            if !path.join(CELL).is_file() {
                collect(&path, depth + 1, all);
            }
        } else if name.ends_with(".urdf") || name.ends_with(".xacro") && !is_part {
            all.push(path);
        }
    }
}
