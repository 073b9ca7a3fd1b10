//! Collision meshes of an imported robot: search for the files, and reasons why some cannot be used.

use super::ros_packages::folder_of;
use crate::cli::loading;
use crate::cli::output::path_word;
use crate::cli::packages::PackageFolders;
use crate::files::{Fault, FileContent, conversion, shown};
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Meshes of a robot, by their names in the URDF.
#[derive(Default)]
pub struct MeshFiles {
    /// New file name and bytes of every imported mesh.
    pub kept: HashMap<String, (String, Vec<u8>)>,
    pub left_out: Vec<LeftOutMesh>,
}

/// Mesh that is left out of the collision shapes.
pub struct LeftOutMesh {
    pub name: String,
    pub why: String,
    /// Remedy that the user can apply.
    pub remedy: String,
}

impl MeshFiles {
    /// Reads the meshes with these names; `urdf` is the file that names them.
    pub fn read<'a>(names: impl Iterator<Item = &'a String>, urdf: &Path, given: &PackageFolders) -> Self {
        let mut files = Self::default();
        let mut used = HashSet::new();
        for name in names {
            if files.kept.contains_key(name) || files.left_out.iter().any(|mesh| mesh.name == *name) {
                continue;
            }
            match located(name, urdf, given).and_then(|path| taken(&path)) {
                Ok((file, bytes)) => {
                    let numbered = (2..).map(|k| format!("{k}-{file}"));
                    let free =
                        std::iter::once(file.clone()).chain(numbered).find(|name| !used.contains(name));
                    let file = free.unwrap_or(file);
                    used.insert(file.clone());
                    files.kept.insert(name.clone(), (file, bytes));
                }
                Err((why, remedy)) => files.left_out.push(LeftOutMesh { name: name.clone(), why, remedy }),
            }
        }
        files
    }

    /// Returns whether the shape with this mesh is imported; a shape without a mesh is always imported.
    pub fn has(&self, mesh: Option<&String>) -> bool {
        mesh.is_none_or(|name| self.kept.contains_key(name))
    }

    /// Leaves out every mesh in which the reader found an error. Returns whether any mesh is left out.
    pub fn leave_out(&mut self, faults: &[Fault]) -> bool {
        let concerns = |file: &str, fault: &Fault| {
            let path = format!("meshes/{file}");
            fault.is_error() && fault.mesh.as_ref().is_some_and(|mesh| mesh.ends_with(&path))
        };
        let bad = self.kept.iter().filter_map(|(name, (file, _))| {
            let fault = faults.iter().find(|fault| concerns(file, fault))?;
            Some((name.clone(), fault.message.clone(), fault.help.clone()))
        });
        let bad: Vec<_> = bad.collect();
        for (name, why, remedy) in &bad {
            self.kept.remove(name);
            self.left_out.push(LeftOutMesh { name: name.clone(), why: why.clone(), remedy: remedy.clone() });
        }
        !bad.is_empty()
    }
}

type MeshRefusal = (String, String);

/// Returns the path of the mesh that a URDF names. Fails with the reason and a remedy.
fn located(name: &str, urdf: &Path, given: &PackageFolders) -> Result<PathBuf, MeshRefusal> {
    let near = urdf.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let in_package = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://"));
    if let Some((package, inside)) = in_package.and_then(|rest| rest.split_once('/')) {
        let Some(folder) = folder_of(package, near, given) else {
            let why = format!("the folder of the package {} is unknown", shown(package));
            return Err((why, format!("add --package {}=DIR", shown(package))));
        };
        return inside_of(&folder, inside);
    }
    match name.strip_prefix("file://") {
        Some(path) => Ok(PathBuf::from(path)),
        None => Ok(near.join(name)),
    }
}

fn inside_of(folder: &Path, inside: &str) -> Result<PathBuf, MeshRefusal> {
    match inside.split('/').any(|part| part == "..") {
        true => Err(("its path leaves the package".into(), "correct the URDF".into())),
        false => Ok(folder.join(inside)),
    }
}

/// Returns the file name and the bytes of a mesh or, for a COLLADA mesh, of a converted mesh in the same
/// folder.
fn taken(path: &Path) -> Result<(String, Vec<u8>), MeshRefusal> {
    let ending = path.extension().map_or(String::new(), |e| e.to_string_lossy().to_ascii_lowercase());
    if ending == "dae" {
        let converted = ["stl", "STL", "obj"].map(|ending| path.with_extension(ending));
        return match converted.iter().find(|path| path.is_file()) {
            Some(path) => taken(path),
            None if !path.is_file() => Err(missing()),
            None => Err(("COLLADA meshes are not read".into(), conversion(&path_word(path)))),
        };
    }
    if !path.is_file() {
        return Err(missing());
    }
    if !["stl", "obj"].contains(&ending.as_str()) {
        return Err(("it is not an STL or OBJ file".into(), "export it as STL".into()));
    }
    let bytes = loading::file_bytes(path).map_err(|why| (why, "check the file".to_string()))?;
    if let Some(content) =
        FileContent::of(&bytes).filter(|c| !matches!(c, FileContent::Stl | FileContent::Obj))
    {
        return Err((format!("it is {}", content.in_words()), "export it as STL".into()));
    }
    let stem = path.file_stem().map_or(String::new(), |stem| stem.to_string_lossy().into_owned());
    let plain = |c: char| if c.is_ascii_alphanumeric() || "-_.".contains(c) { c } else { '_' };
    Ok((format!("{}.{ending}", stem.chars().map(plain).collect::<String>()), bytes))
}

fn missing() -> MeshRefusal {
    (
        "there is no such file".into(),
        "give the folder of its package with --package NAME=DIR, or export the mesh again".into(),
    )
}
