//! Readers that turn cell, robot, equipment and tool files into a validated [`Cell`].
//!
//! Files are TOML. Lengths are in mm and angles in degrees. The name of a key with a unit ends with that
//! unit. [`load`] never touches the file system: the caller passes a function that reads a file. [`load`]
//! reports every fault of every file in one pass, each with file, line, column, message and help.

mod content;
#[doc(hidden)] // open for tests/it
pub mod dxf;
pub mod fault;
mod keys;
pub mod measured;
mod mesh;
pub(crate) mod polygon;
mod read;
mod schema;
pub mod stated;
pub mod targets;
mod toml;
mod urdf;

pub use content::{FileContent, conversion};
pub use fault::{Fault, FaultKind, Severity, shown};
pub use keys::key::NumberRange;
pub use keys::operation::MAX_BEND;
pub use schema::{FileKind, reference, schema};
pub use toml::{Choices, ReadFile, Setting, Source, of_setting, toml_string};
pub use urdf::{UrdfOutline, lean as lean_urdf};

use crate::cell::*;
use keys::robot::robot;
use read::{cell as cell_file, plausible, question, robot as robot_file};
use std::collections::{HashMap, HashSet};
use toml::document::Library;
use toml::reader::Table;
use toml::tree::Value;
use toml::{from, setting};

/// Cell, with all files from which it was read.
#[derive(Debug, Clone)]
pub struct Loaded {
    pub cell: Cell,
    /// All files in the order of reading; the cell file is the first.
    pub sources: Vec<Source>,
    pub warnings: Vec<Fault>,
    /// Whether the kind of the error sets in use determines the reading, because neither a file nor a flag
    /// states a reading.
    pub follows_errors: bool,
}

/// Reads a cell file and every file that it refers to.
///
/// The argument `path` is the name of the cell file without its folder. The function calls `read` with paths
/// relative to the folder of the cell file.
///
/// # Errors
///
/// Returns all faults of all files, errors and warnings, in the order of files and lines.
pub fn load(path: &str, read: &mut ReadFile<'_>) -> Result<Loaded, Vec<Fault>> {
    load_with(path, &[], read)
}

/// Reads a cell as [`load`] does. The keys in `settings` come from the command line and override the file.
///
/// # Errors
/// Returns faults as [`load`] does. If a setting causes a fault, the fault states the flag in place of a
/// file, and the line is 0.
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
    let follows_errors = root.is_some_and(|root| root.value.get("reading").is_none());
    let mut faults = sorted(&mut lib);
    setting::put_in_words(settings, &mut faults, &mut lib.sources);
    match cell {
        Some(cell) if !faults.iter().any(Fault::is_error) => {
            Ok(Loaded { cell, sources: lib.sources, warnings: faults, follows_errors })
        }
        _ => Err(faults),
    }
}

/// Robot, with all files from which it was read.
#[derive(Debug, Clone)]
pub struct LoadedRobot {
    pub robot: Robot,
    /// All files in the order of reading; the robot file is the first.
    pub sources: Vec<Source>,
    pub warnings: Vec<Fault>,
}

/// Reads a robot file and every file that it refers to.
///
/// `path` is the path of the robot file. The function passes this path to `read`.
///
/// # Errors
///
/// Returns faults as [`load`] does.
pub fn load_robot(path: &str, read: &mut ReadFile<'_>) -> Result<LoadedRobot, Vec<Fault>> {
    let mut lib = Library::new(read);
    let root = from::load(path, &[], &mut lib);
    let robot = root
        .and_then(|root| Table::read(&root, robot::TABLE.what, &robot::TABLE, &mut lib, robot_file::read));
    let faults = sorted(&mut lib);
    match robot {
        Some(robot) if !faults.iter().any(Fault::is_error) => {
            Ok(LoadedRobot { robot, sources: lib.sources, warnings: faults })
        }
        _ => Err(faults),
    }
}

/// Reads the outline of a URDF file, and the warnings about the file. Neither a robot file nor meshes are
/// read. `tip` names the link that carries the tool; if it is None, the link is guessed.
///
/// # Errors
///
/// Returns faults as [`load`] does.
pub fn urdf_outline(
    path: &str,
    text: &str,
    tip: Option<&str>,
) -> Result<(UrdfOutline, Vec<Fault>), Vec<Fault>> {
    let read: &mut ReadFile<'_> = &mut |_| Ok(text.as_bytes().to_vec());
    let mut lib = Library::new(read);
    let outline = urdf::outline(path, tip, &mut lib);
    lib.mark_import(0);
    let faults = sorted(&mut lib);
    outline
        .filter(|_| !faults.iter().any(Fault::is_error))
        .map(|outline| (outline, faults.clone()))
        .ok_or(faults)
}

/// Returns whether the file at `path` is a robot file. The key `schema` of a file states the kind of the
/// file. A file without this key takes `schema` from the file that its key `from` names.
pub fn is_robot(path: &str, read: &mut ReadFile<'_>) -> bool {
    let root = from::load(path, &[], &mut Library::new(read));
    let schema = root.as_ref().and_then(|root| root.value.get("schema"));
    schema.is_some_and(|node| matches!(&node.value, Value::Text(word) if word == "sweetspot/robot/1"))
}

/// Returns the faults in the order of files and lines. If faults have the same place and message, the result
/// contains only the first one. A file that is named twice can cause such faults.
fn sorted(lib: &mut Library<'_>) -> Vec<Fault> {
    let mut faults = std::mem::take(&mut lib.faults);
    let order: HashMap<_, _> = lib.sources.iter().enumerate().map(|(i, s)| (&s.path, i)).collect();
    faults.sort_by_key(|f| (order.get(&f.file), f.line, f.column));
    let mut told = HashSet::new();
    faults.retain(|f| told.insert((f.file.clone(), f.line, f.column, f.message.clone())));
    faults
}
