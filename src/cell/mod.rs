//! What exists: cell, robot and equipment files to a validated [`Cell`].
//!
//! Files are TOML, lengths in mm and angles in degrees, every name with its unit. [`load`] takes a
//! function that reads a file and never touches the file system itself; it reports every fault of
//! every file in one pass, each with file, line, column, what is wrong and what to do. A [`Cell`]
//! that comes out is valid: nothing downstream checks it again.

mod cell_file;
pub mod document;
mod equipment_file;
pub mod fault;
mod mesh;
mod model;
mod plausible;
mod reader;
mod robot_file;
mod solid;

pub use document::{ReadFile, Source};
pub use fault::{Fault, Severity, shown};
pub use model::*;
pub use solid::extent;

use document::{At, Library, Node, Value};
use reader::Table;

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
    let mut lib = Library::new(read);
    let root = lib.load(path);
    let stem = path.strip_suffix(".toml").unwrap_or(path);
    let cell = root.as_ref().and_then(|root| cell_file::read(stem, root, &mut lib));
    if let (Some(cell), Some(root)) = (&cell, &root) {
        plausible::warn(cell, |name| place_of(root, name), &mut lib);
    }
    let mut faults = std::mem::take(&mut lib.faults);
    let order = |f: &Fault| lib.sources.iter().position(|s| s.path == f.file);
    faults.sort_by_key(|f| (order(f), f.line, f.column));
    faults.dedup();
    match cell {
        Some(cell) if !faults.iter().any(Fault::is_error) => {
            Ok(Loaded { cell, sources: lib.sources, warnings: faults })
        }
        _ => Err(faults),
    }
}

/// Where an equipment or obstacle is named.
fn place_of(root: &Node, name: &str) -> At {
    let Value::Table(top) = &root.value else { return root.at };
    let groups = top.iter().filter(|(k, ..)| k == "equipment" || k == "obstacle");
    let entries = groups.flat_map(|(.., node)| match &node.value {
        Value::Table(entries) => entries.as_slice(),
        _ => &[],
    });
    entries.into_iter().find(|(k, ..)| k == name).map_or(root.at, |(_, at, _)| *at)
}

/// `schema` and `units`, the same in every kind of file. A part written inside a cell has neither:
/// those of the cell hold.
fn header(t: &mut Table<'_>, kind: &str, lib: &mut Library<'_>) {
    let want = format!("sweetspot/{kind}/1");
    let schema = t.get("schema");
    if let Some(node) = schema
        && let Some(given) = reader::text(node, "schema", lib)
        && given != want
    {
        let message = format!("this is a `{}` where a `{want}` is wanted", shown(&given));
        lib.error(node.at, message, "refer to a file of the right kind");
    }
    let units = if schema.is_some() { t.need("units", lib) } else { t.get("units") };
    let Some(node) = units else { return };
    let Some(mut units) = Table::of(node, "`units`", lib) else { return };
    for (key, want) in [("length", "mm"), ("angle", "deg")] {
        if let Some(node) = units.need(key, lib)
            && let Some(given) = reader::text(node, key, lib)
            && given != want
        {
            let message = format!("{key} in `{}` is not read", shown(&given));
            lib.error(node.at, message, format!("convert the file to {key} = \"{want}\""));
        }
    }
    units.finish(lib);
}

fn duplicate_solid(name: &str, at: At, lib: &mut Library<'_>) {
    lib.error(
        at,
        format!("two solids are named `{}`", shown(name)),
        "reasons name solids: give each its own name",
    );
}
