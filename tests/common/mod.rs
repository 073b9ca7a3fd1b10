//! Helpers that the tests share: shipped cells read from disk, and reference data.
#![allow(dead_code, clippy::unwrap_used, clippy::panic)] // tests/allocation.rs uses a part of it

pub mod brute;
pub mod random_cells;
pub mod ur;

use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use sweetspot::cell::{Cell, ErrorSet, Robot, SignedErrors};
use sweetspot::files;
use sweetspot::files::{Fault, Loaded, Setting};
use sweetspot::layout::Workcell;
use toml::de::{DeTable, DeValue};

/// Returns the folder of the project, in the tests of either package.
pub fn root() -> PathBuf {
    let mut folders = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    folders.find(|folder| folder.join("cells").is_dir()).unwrap().to_path_buf()
}

/// Returns the number of cases of a random sweep: `default`, or `full` if the environment variable
/// `SWEETSPOT_TEST_CASES` is `full`. Full sweeps take minutes. Short sweeps still fail if the tested code is
/// broken.
pub fn cases(default: usize, full: usize) -> usize {
    match std::env::var("SWEETSPOT_TEST_CASES") {
        Ok(word) if word == "full" => full,
        Ok(word) => panic!("SWEETSPOT_TEST_CASES is {word:?}: set it to full, or unset it"),
        Err(_) => default,
    }
}

/// Loads a cell file from a folder, with shipped robots and equipment beside it.
pub fn load_from(folder: &Path, name: &str) -> Result<Loaded, Vec<Fault>> {
    load_with(folder, name, &[])
}

fn load_with(folder: &Path, name: &str, settings: &[Setting]) -> Result<Loaded, Vec<Fault>> {
    let cells = root().join("cells");
    files::load_with(name, settings, &mut |path: &str| {
        let here = folder.join(path);
        let file = if here.exists() { here } else { cells.join(path) };
        std::fs::read(file).map_err(|_| "no such file".to_string())
    })
}

/// Returns a shipped cell for ideal layouts: nothing is assumed, and placement tolerances are ignored.
pub fn shipped(name: &str) -> Cell {
    load_with(&root().join("cells"), name, &[ideal()]).unwrap_or_else(|f| panic!("{name}: {f:#?}")).cell
}

/// Returns a shipped cell as its file states it, with all assumed values.
pub fn buildable(name: &str) -> Cell {
    load_from(&root().join("cells"), name).unwrap_or_else(|f| panic!("{name}: {f:#?}")).cell
}

fn ideal() -> Setting {
    Setting::new("search.ideal", "true")
}

pub fn workcell(name: &str) -> Workcell {
    Workcell::new(shipped(name)).unwrap()
}

/// Writes a picture or a page into the folder that the environment variable SWEETSPOT_CHARTS names, for
/// inspection. Writes nothing if the variable is not set.
pub fn keep_to_look_at(name: &str, text: &str) {
    if let Some(folder) = std::env::var_os("SWEETSPOT_CHARTS") {
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(Path::new(&folder).join(name), text).unwrap();
    }
}

/// Returns the signed sample that a cell uses.
pub fn signed(cell: &Cell) -> &SignedErrors {
    match cell.error_set() {
        ErrorSet::Signed(errors) => errors,
        _ => panic!("{} is not a signed sample", cell.error_set().name()),
    }
}

/// Loads a cell from text, with shipped robots and equipment. If the text has neither a placement tolerance
/// nor a robust search, the cell is for ideal layouts.
pub fn from_text(text: &str) -> Result<Loaded, Vec<Fault>> {
    from_text_with(
        text,
        if text.contains("tolerance = {") || text.contains("robust") { Vec::new() } else { vec![ideal()] },
    )
}

/// Loads a cell from text for layouts that can be built, with all assumed values.
pub fn from_text_to_build(text: &str) -> Result<Loaded, Vec<Fault>> {
    from_text_with(text, Vec::new())
}

fn from_text_with(text: &str, settings: Vec<Setting>) -> Result<Loaded, Vec<Fault>> {
    let cells = root().join("cells");
    files::load_with("test.toml", &settings, &mut |path: &str| {
        if path == "test.toml" {
            return Ok(text.as_bytes().to_vec());
        }
        std::fs::read(cells.join(path)).map_err(|_| "no such file".to_string())
    })
}

/// Returns the little-endian f64 values of a file in tests/data.
pub fn data(name: &str) -> Vec<f64> {
    let bytes = std::fs::read(root().join("tests/data").join(name)).unwrap();
    bytes.chunks_exact(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect()
}

/// Returns the text of a cell for a robot file of the library, with one table, one operation and the first
/// error set.
pub fn cell_of_robot(stem: &str) -> String {
    let text = std::fs::read_to_string(root().join(format!("cells/robots/{stem}.toml"))).unwrap();
    let set = text.lines().find_map(|line| line.strip_prefix("[errors.")?.split([']', '.']).next());
    format!(
        "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"{}\"\n\
         [robot]\nfrom = \"robots/{stem}.toml\"\n\
         [equipment.table]\nsurface = {{ size_mm = [500, 500] }}\n\
         placement = {{ x_mm = 600, y_mm = 0, z_mm = 100 }}\n\
         [operation.work]\non = \"table\"\ngrid = [2, 2]\nbend_deg = -90\nsense = \"xyz\"\n",
        set.unwrap_or("table-2") // those of the file it is made from
    )
}

/// Returns every robot of the library by the name of its file.
pub fn robots() -> Vec<(String, Robot)> {
    let files = std::fs::read_dir(root().join("cells/robots")).unwrap();
    let paths = files.map(|file| file.unwrap().path()).filter(|p| p.extension().is_some_and(|e| e == "toml"));
    let mut stems: Vec<_> = paths.map(|p| p.file_stem().unwrap().to_string_lossy().into_owned()).collect();
    stems.sort();
    let robot = |stem: String| {
        let cell = from_text(&cell_of_robot(&stem)).unwrap_or_else(|f| panic!("{stem}: {f:#?}")).cell;
        (stem, cell.robot)
    };
    stems.into_iter().map(robot).collect()
}

/// Converts TOML to JSON. A date becomes a string, and a number that is not finite becomes null.
pub fn document(text: &str) -> Option<Value> {
    fn value(v: &DeValue<'_>) -> Value {
        match v {
            DeValue::String(s) => json!(s),
            DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
                Ok(n) => json!(n),
                Err(_) => json!(i.as_str().parse::<f64>().unwrap()),
            },
            DeValue::Float(f) => json!(f.as_str().parse::<f64>().unwrap()),
            DeValue::Boolean(b) => json!(b),
            DeValue::Datetime(d) => json!(d.to_string()),
            DeValue::Array(items) => items.iter().map(|v| value(v.get_ref())).collect(),
            DeValue::Table(t) => table(t),
        }
    }
    fn table(t: &DeTable<'_>) -> Value {
        Value::Object(t.iter().map(|(k, v)| (k.get_ref().to_string(), value(v.get_ref()))).collect())
    }
    DeTable::parse(text).ok().map(|t| table(t.get_ref()))
}
