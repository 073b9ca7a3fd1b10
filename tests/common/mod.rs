//! Shared by the tests: shipped cells read from disk, reference data.
#![allow(dead_code, clippy::unwrap_used, clippy::panic)] // every test file uses a part of it

use std::path::{Path, PathBuf};
use sweetspot::cell::{self, Cell, ErrorSet, Fault, Loaded, SignedErrors};

pub fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Loads a cell file from a folder, with shipped robots and equipment beside it.
pub fn load_from(folder: &Path, name: &str) -> Result<Loaded, Vec<Fault>> {
    let cells = root().join("cells");
    cell::load(name, &mut |path: &str| {
        let here = folder.join(path);
        let file = if here.exists() { here } else { cells.join(path) };
        std::fs::read(file).map_err(|_| "no such file".to_string())
    })
}

pub fn shipped(name: &str) -> Cell {
    load_from(&root().join("cells"), name).unwrap_or_else(|f| panic!("{name}: {f:#?}")).cell
}

/// The chosen sample of a cell.
pub fn signed(cell: &Cell) -> &SignedErrors {
    match cell.error_set() {
        ErrorSet::Signed(errors) => errors,
        ErrorSet::Tolerance(t) => panic!("{} is a tolerance", t.name),
    }
}

/// A cell from text, with shipped robots and equipment.
pub fn from_text(text: &str) -> Result<Loaded, Vec<Fault>> {
    let cells = root().join("cells");
    cell::load("test.toml", &mut |path: &str| {
        if path == "test.toml" {
            return Ok(text.as_bytes().to_vec());
        }
        std::fs::read(cells.join(path)).map_err(|_| "no such file".to_string())
    })
}

/// Little-endian f64 values of a file in tests/data.
pub fn data(name: &str) -> Vec<f64> {
    let bytes = std::fs::read(root().join("tests/data").join(name)).unwrap();
    bytes.chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect()
}
