//! What exists: cell, robot and equipment files to a validated [`Cell`].
//!
//! Files are TOML, lengths in mm and angles in degrees, every name with its unit. [`load`] takes a
//! function that reads a file and never touches the file system itself; it reports every fault of
//! every file in one pass, each with file, line, column, what is wrong and what to do. A [`Cell`]
//! that comes out is valid: nothing downstream checks it again.

mod arm;
mod attitude;
mod attitude_file;
mod cell_file;
mod choices;
mod constraint_file;
mod constraints;
mod coordinate_file;
mod covariance_file;
mod document;
mod equipment_file;
mod error_model;
mod error_set;
pub mod fault;
mod frame_file;
mod from;
mod goal;
mod layout;
mod mesh;
mod mesh_obj;
mod mesh_stl;
mod misplacement_file;
mod model;
mod operation_file;
mod place_file;
mod plausible;
mod question;
mod reader;
mod robot_file;
mod robot_model;
mod schema;
mod sense;
mod sense_file;
mod setting;
mod shape;
mod solid;
mod teach_file;
mod tolerance_file;
mod tool_file;
mod tree;
mod urdf;
mod value;

pub use attitude::*;
pub use choices::*;
pub use constraints::*;
pub use document::{ReadFile, Source};
pub use error_model::*;
pub use fault::{Fault, Severity, shown};
pub use goal::*;
pub use layout::*;
pub use model::*;
pub use question::{About, QuestionFault};
#[doc(hidden)]
pub use reader::keys_asked_by; // for tests/it/schema_keys.rs
pub use robot_model::*;
pub use schema::{FileKind, schema};
pub use sense::*;
pub use setting::{Choices, Setting, of_setting};
pub use shape::*;

use document::Library;
use reader::Table;
use std::collections::{HashMap, HashSet};
use tree::{Node, Value};

/// A cell with everything that was read for it.
#[derive(Debug, Clone)]
pub struct Loaded {
    pub cell: Cell,
    /// Every file read, the cell file first, in the order of reading.
    pub sources: Vec<Source>,
    pub warnings: Vec<Fault>,
}

/// Reads the cell file at `path` (relative to its own folder, so just its name) and every file it
/// refers to.
///
/// # Errors
/// All faults of all files, errors and warnings, in the order of files and lines.
pub fn load(path: &str, read: &mut ReadFile<'_>) -> Result<Loaded, Vec<Fault>> {
    load_with(path, &[], read)
}

/// [`load`] with some keys said otherwise than in the file.
///
/// # Errors
/// As [`load`]; faults of a setting name it instead of a file, at line 0.
pub fn load_with(path: &str, settings: &[Setting], read: &mut ReadFile<'_>) -> Result<Loaded, Vec<Fault>> {
    let mut lib = Library::new(read);
    let root = from::load(path, settings, &mut lib);
    let stem = path.strip_suffix(".toml").unwrap_or(path);
    let cell = root.as_ref().and_then(|root| cell_file::read(stem, root, &mut lib));
    if lib.errors() == 0
        && let (Some(cell), Some(root)) = (&cell, &root)
    {
        question::check(cell, root, &mut lib);
        plausible::warn(cell, root, &mut lib);
    }
    let mut faults = sorted(&mut lib);
    setting::put_in_words(settings, &mut faults, &mut lib.sources);
    match cell {
        Some(cell) if !faults.iter().any(Fault::is_error) => {
            Ok(Loaded { cell, sources: lib.sources, warnings: faults })
        }
        _ => Err(faults),
    }
}

/// A robot with everything that was read for it.
#[derive(Debug, Clone)]
pub struct LoadedRobot {
    pub robot: Robot,
    /// Every file read, the robot file first.
    pub sources: Vec<Source>,
    pub warnings: Vec<Fault>,
}

/// Reads the robot file at `path` (relative to its own folder) and every file it refers to.
///
/// # Errors
/// As [`load`].
pub fn load_robot(path: &str, read: &mut ReadFile<'_>) -> Result<LoadedRobot, Vec<Fault>> {
    let mut lib = Library::new(read);
    let root = from::load(path, &[], &mut lib);
    let robot = root.and_then(|root| Table::read(&root, "a robot", &mut lib, robot_file::read));
    let faults = sorted(&mut lib);
    match robot {
        Some(robot) if !faults.iter().any(Fault::is_error) => {
            Ok(LoadedRobot { robot, sources: lib.sources, warnings: faults })
        }
        _ => Err(faults),
    }
}

/// Whether the file at `path` says, itself or through its `from`, that it is the file of a robot.
pub fn is_robot(path: &str, read: &mut ReadFile<'_>) -> bool {
    let root = from::load(path, &[], &mut Library::new(read));
    let schema = root.as_ref().and_then(|root| root.value.get("schema"));
    schema.is_some_and(|node| matches!(&node.value, Value::Text(word) if word == "sweetspot/robot/1"))
}

/// The faults in the order of files and lines; those of a file that is named twice once.
fn sorted(lib: &mut Library<'_>) -> Vec<Fault> {
    let mut faults = std::mem::take(&mut lib.faults);
    let order: HashMap<_, _> = lib.sources.iter().enumerate().map(|(i, s)| (&s.path, i)).collect();
    faults.sort_by_key(|f| (order.get(&f.file), f.line, f.column));
    let mut told = HashSet::new();
    faults.retain(|f| told.insert((f.file.clone(), f.line, f.column, f.message.clone())));
    faults
}

/// `schema` and `units`, the same in every kind of file; None if it is a file of another kind, of
/// which nothing more is read. A part written inside a cell has neither: those of the cell hold.
fn header(t: &mut Table<'_>, kind: &'static str, lib: &mut Library<'_>) -> Option<()> {
    let help = "add units = { length = \"mm\", angle = \"deg\" }";
    let units = if let Some(node) = t.get("schema") {
        if !is_schema(node, t, kind, lib) {
            t.give_up();
            return None;
        }
        t.need("units", help)
    } else {
        t.get("units")
    };
    let Some(node) = units else { return Some(()) };
    Table::read(node, "`units`", lib, |t, lib| {
        for (key, want, help) in
            [("length", "mm", "add length = \"mm\""), ("angle", "deg", "add angle = \"deg\"")]
        {
            let Some(node) = t.need(key, help) else { continue };
            let Some(given) = value::text(node, key, lib).filter(|given| given != want) else { continue };
            let message = format!("`{key}` must be in \"{want}\", not in \"{}\"", shown(&given));
            lib.error(
                node.at,
                message,
                format!("convert the numbers of the file, then write {key} = \"{want}\""),
            );
        }
        Some(())
    });
    Some(())
}

/// Whether the file is of the wanted kind; if another file brought the wrong one, the fault is where
/// that file was named.
fn is_schema(node: &Node, t: &Table<'_>, kind: &str, lib: &mut Library<'_>) -> bool {
    let want = format!("sweetspot/{kind}/1");
    let Some(given) = value::text(node, "schema", lib) else { return false };
    if given == want {
        return true;
    }
    let file = shown(&lib.sources[node.at.file].path);
    let named = if node.at.file == t.at.file { node.at } else { t.at };
    let (at, message) = match KINDS.iter().find(|(k, _)| given == format!("sweetspot/{k}/1")) {
        Some((_, what)) => (named, format!("`{file}` is the file of {what}")),
        None => (node.at, format!("`{}` is no schema that is read", shown(&given))),
    };
    lib.error(at, message, format!("a file with schema = \"{want}\" is wanted here"));
    false
}

/// With the article.
const KINDS: [(&str, &str); 4] =
    [("cell", "a cell"), ("robot", "a robot"), ("tool", "a tool"), ("equipment", "an equipment")];
