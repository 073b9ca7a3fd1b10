//! Robots that the user gives as a URDF or xacro file, without a robot file.

mod meshes;
mod robot_file;
mod ros_packages;
mod xacro;

pub use meshes::LeftOutMesh;

use super::output::path_word;
use super::packages::PackageFolders;
use super::{Exit, loading, output};
use crate::cell::Robot;
use crate::files;
use crate::files::fault::listed;
use crate::files::{Fault, FileContent, LoadedRobot, Severity, UrdfOutline, lean_urdf, shown};
use crate::pose_accuracy::PRESETS;
use crate::reach::Inverse;
use crate::report::error_table;
use crate::robot::Chain;
use crate::units::{mm_from_m, rounded};
use indexmap::IndexMap;
use meshes::MeshFiles;
use std::collections::HashMap;
use std::path::Path;

/// Name of the guessed error set.
pub const GUESS: &str = "guess";

/// Width of a guessed footprint, as a share of the reach.
const FOOTPRINT: f64 = 0.15;

/// Robot read from a URDF, and the files that describe it in the folder of a cell.
pub struct ImportedRobot {
    pub outline: UrdfOutline,
    pub loaded: LoadedRobot,
    /// Path of the robot file in the folder of a cell.
    pub file: String,
    /// Robot file and every file that it names: path in the folder of a cell, and bytes.
    pub files: Vec<(String, Vec<u8>)>,
    /// Name of the preset from which the error set is guessed.
    pub preset: &'static str,
    pub left_out: Vec<LeftOutMesh>,
    /// Number of imported collision shapes, and number of all collision shapes in the URDF.
    pub shapes: (usize, usize),
    pub warnings: Vec<Fault>,
}

/// Options of the import of a URDF or xacro file.
#[derive(Clone, Copy)]
pub struct ImportQuery<'a> {
    pub path: &'a Path,
    pub packages: &'a PackageFolders,
    /// Link that carries the tool; with None, the link is guessed.
    pub tip: Option<&'a str>,
    /// Arguments of a xacro file.
    pub arguments: &'a [String],
}

impl<'a> ImportQuery<'a> {
    /// Returns the options for a file without xacro arguments. The link that carries the tool is guessed.
    pub fn new(path: &'a Path, packages: &'a PackageFolders) -> Self {
        Self { path, packages, tip: None, arguments: &[] }
    }
}

/// Returns whether a file is a URDF or a xacro file.
pub fn is_importable(path: &Path) -> bool {
    matches!(loading::content(path), Some(FileContent::Urdf | FileContent::Xacro))
}

/// Imports a URDF or xacro file. Prints its faults if it has errors.
pub fn import(query: ImportQuery<'_>) -> Result<ImportedRobot, Exit> {
    let text = urdf_text(query)?;
    imported(query, &text).map_err(|faults| {
        output::faults(&faults);
        loading::exit_of(&faults)
    })
}

/// Reads a robot file or a URDF, and everything that it refers to, without printing.
///
/// The warnings about a URDF state the guessed error set, and the collision shapes that are left out.
///
/// # Errors
/// Returns the faults of the files.
pub fn read_robot_or_urdf(path: &Path, packages: &PackageFolders) -> Result<LoadedRobot, Vec<Fault>> {
    if loading::content(path) != Some(FileContent::Urdf) {
        let loaded = loading::read_robot(path, packages)?;
        return Ok(LoadedRobot { warnings: loading::without_import(&loaded.warnings), ..loaded });
    }
    let given = path.to_string_lossy();
    let unreadable = |why: String| vec![Fault::unreadable(&given, why, "check the path and its permissions")];
    let bytes = loading::file_bytes(path).map_err(unreadable)?;
    let text = String::from_utf8(bytes).map_err(|_| unreadable("it is not UTF-8 text".into()))?;
    let imported = imported(ImportQuery::new(path, packages), &text)?;
    let warnings = imported.told(&given);
    Ok(LoadedRobot { warnings, ..imported.loaded })
}

/// Imports a URDF with the text `text`.
///
/// # Errors
/// Fails with all errors of the files, without the warnings.
fn imported(query: ImportQuery<'_>, text: &str) -> Result<ImportedRobot, Vec<Fault>> {
    let refuse = |mut faults: Vec<Fault>| {
        // Warnings of an import that fails would hide its errors.
        faults.retain(Fault::is_error);
        faults
    };
    let given = query.path.to_string_lossy();
    let (outline, mut warnings) = files::urdf_outline(&given, text, query.tip).map_err(refuse)?;
    let source = UrdfSource { path: query.path, text, outline: &outline };
    let bare = source.robot(&MeshFiles::default(), &Guesses::none()).map_err(refuse)?;
    let (preset, guesses) = guesses(&bare.robot);
    let names = outline.shapes.iter().filter_map(|(_, mesh)| mesh.as_ref());
    let mut meshes = MeshFiles::read(names, query.path, query.packages);
    let mut loaded = source.robot(&meshes, &guesses);
    if loaded.as_ref().is_err_and(|faults| meshes.leave_out(faults)) {
        loaded = source.robot(&meshes, &guesses);
    }
    let loaded = loaded.map_err(refuse)?;
    // The outline has already issued all warnings except the warnings about meshes.
    let own = loaded.warnings.iter().filter(|own| !warnings.iter().any(|known| known.message == own.message));
    warnings.extend(own.cloned().collect::<Vec<_>>());
    let file = file_path(query.path);
    let files = loaded.sources.iter().map(|source| (source.path.clone(), source.bytes.clone())).collect();
    let kept = outline.shapes.iter().filter(|(_, mesh)| meshes.has(mesh.as_ref())).count();
    let shapes = (kept, outline.shapes.len());
    Ok(ImportedRobot { outline, loaded, file, files, preset, left_out: meshes.left_out, shapes, warnings })
}

impl ImportedRobot {
    /// Prints the warnings, the guesses, and the collision shapes that are left out.
    pub fn tell(&self) {
        output::import_warnings(&self.warnings);
        let UrdfOutline { tip_link, last_joint, direction, joints, joints_off, .. } = &self.outline;
        let d = direction.map(|v| rounded(v, 3));
        let tip = match self.outline.is_guessed {
            true => format!(
                "the tool is guessed: {} is the last link of the longest chain, which has {joints} joints",
                shown(tip_link)
            ),
            false => format!("the tool is at {}, after {joints} joints", shown(tip_link)),
        };
        output::talk(&format!(
            "note: {tip}; the tool points along ({}, {}, {}), the axis of {}",
            d.x,
            d.y,
            d.z,
            shown(last_joint)
        ));
        if !joints_off.is_empty() {
            output::talk(&format!(
                "note: these joints are not on the chain to the tool; they stand still, and their links have no solids: {}",
                listed(joints_off.iter().map(String::as_str))
            ));
        }
        output::talk(&format!(
            "note: the errors are guessed: the set `{GUESS}` is the preset {}",
            self.preset
        ));
        self.tell_left_out();
    }

    /// Returns the messages of [`Self::tell`] as warnings. `file` is the path of the URDF.
    fn told(&self, file: &str) -> Vec<Fault> {
        let warning = |message: String, help: &str| Fault {
            severity: Severity::Warning,
            line: 0,
            ..Fault::of_file(file, message, help)
        };
        let mut warnings = output::grouped_by_help(&self.warnings);
        warnings.push(warning(
            format!("the errors are guessed: the set `{GUESS}` is the preset {}", self.preset),
            "identify them from measured positions, or state your own error set in a robot file",
        ));
        let (kept, all) = self.shapes;
        if all == 0 {
            let message = "the URDF has no collision shapes, so collisions of the arm go unseen";
            warnings.push(warning(message.into(), "add solids in a robot file: sweetspot init writes one"));
        }
        warnings.extend(self.left_out.iter().map(|LeftOutMesh { name, why, remedy }| {
            let name = shown(name);
            warning(
                format!("the mesh {name}, one of {all} collision shapes, is left out: {}", shown(why)),
                remedy,
            )
        }));
        if kept < all && self.left_out.is_empty() {
            let message = format!("{} of {all} collision shapes are left out", all - kept);
            warnings.push(warning(message, "run sweetspot check on this file"));
        }
        warnings
    }

    fn tell_left_out(&self) {
        let (kept, all) = self.shapes;
        if all == 0 {
            return output::talk(
                "warning: the URDF has no collision shapes, so collisions of the arm go unseen",
            );
        } else if kept == all {
            return;
        }
        output::talk(&format!(
            "warning: {} of {all} collision shapes are left out, and their collisions go unseen:",
            all - kept
        ));
        let mut reasons: IndexMap<&str, Vec<&LeftOutMesh>> = IndexMap::new();
        for mesh in &self.left_out {
            reasons.entry(&mesh.why).or_default().push(mesh);
        }
        for (why, all) in reasons {
            let names = listed(all.iter().map(|mesh| mesh.name.rsplit('/').next().unwrap_or(&mesh.name)));
            output::talk(&format!("  {names}: {}", shown(why)));
            let mut remedies: Vec<_> = all.iter().map(|mesh| &mesh.remedy).collect();
            remedies.dedup();
            remedies.iter().for_each(|remedy| output::talk(&format!("    {remedy}")));
        }
    }
}

/// Returns the text of the URDF, expanded if it is a xacro file.
fn urdf_text(query: ImportQuery<'_>) -> Result<String, Exit> {
    if loading::content(query.path) == Some(FileContent::Xacro) {
        return xacro::expanded(query.path, query.arguments);
    }
    String::from_utf8(loading::read_data(query.path)?).map_err(|_| {
        output::error(&format!("{}: it is not UTF-8 text", path_word(query.path)));
        Exit::BadInput
    })
}

/// Returns the name of a file without its folder and its extensions. Replaces every character other than
/// ASCII letters, digits, `-` and `_` with `_`.
pub fn stem(path: &Path) -> String {
    let name = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let stem = name.split('.').next().unwrap_or("");
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_".contains(c) { c } else { '_' };
    let stem: String = stem.chars().map(plain).collect();
    if stem.is_empty() { "robot".into() } else { stem }
}

fn file_path(path: &Path) -> String {
    format!("robots/{}.toml", stem(path))
}

/// Guessed parts of a robot file.
struct Guesses {
    /// Table of an error set.
    errors: String,
    /// Side of the footprint, if the base has no solids, mm.
    footprint_mm: f64,
}

impl Guesses {
    /// Returns placeholder guesses for a first pass, which reads only the kinematics.
    fn none() -> Self {
        let errors = "[errors.none]\nkind = \"signed\"\nsource = \"none\"\njoints = []\n".to_string();
        Self { errors, footprint_mm: 100.0 }
    }
}

/// Returns the name of the guessed preset, and the guesses from this preset and from the reach.
fn guesses(robot: &Robot) -> (&'static str, Guesses) {
    let chain = Chain::new(robot);
    let name = robot_file::guessed_preset(robot, &Inverse::new(&chain));
    let preset = PRESETS.iter().find(|preset| preset.name == name).unwrap_or(&PRESETS[0]);
    let source =
        format!("GUESS, not measured: the preset {} ({}; {})", preset.name, preset.class, preset.source);
    let errors = error_table::table(robot, GUESS, &source, &preset.spreads(robot, &chain));
    let side = mm_from_m(FOOTPRINT * robot_file::own_reach(robot));
    (preset.name, Guesses { errors, footprint_mm: ((side / 10.0).round() * 10.0).max(100.0) })
}

/// Text of a URDF, with the [`UrdfOutline`] that was read from it.
struct UrdfSource<'a> {
    path: &'a Path,
    text: &'a str,
    outline: &'a UrdfOutline,
}

impl UrdfSource<'_> {
    /// Reads the robot with these meshes, and with guesses for values that the URDF does not state.
    fn robot(&self, meshes: &MeshFiles, guesses: &Guesses) -> Result<LoadedRobot, Vec<Fault>> {
        let given = self.path.file_name().map_or(String::new(), |name| shown(&name.to_string_lossy()));
        let (stem, file) = (stem(self.path), file_path(self.path));
        let paths: HashMap<_, _> =
            meshes.kept.iter().map(|(name, (file, _))| (name.clone(), format!("meshes/{file}"))).collect();
        let about = format!(
            "Lean copy of {given}, written by sweetspot: only the links and joints that sweetspot reads."
        );
        let urdf = lean_urdf(self.text, self.outline, &paths, &about).unwrap_or_default();
        let kept: HashMap<_, _> =
            meshes.kept.values().map(|(file, bytes)| (format!("robots/meshes/{file}"), bytes)).collect();
        let has_base =
            self.outline.shapes.iter().any(|(frame, mesh)| *frame == 0 && meshes.has(mesh.as_ref()));
        let side = (!has_base).then_some(guesses.footprint_mm);
        let robot = robot_file::text(&stem, &given, self.outline, side) + &guesses.errors;
        files::load_robot(&file, &mut |asked| {
            if asked == file {
                Ok(robot.clone().into_bytes())
            } else if asked == format!("robots/{stem}.urdf") {
                Ok(urdf.clone().into_bytes())
            } else {
                kept.get(asked).map(|bytes| (*bytes).clone()).ok_or_else(|| "no such file".into())
            }
        })
    }
}
