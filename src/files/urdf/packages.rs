//! Folders of ROS packages, for paths of the form `package://NAME/PATH`.

use super::model::Named;
use crate::files::fault::shown;
use crate::files::toml::document::Library;

const SCHEME: &str = "package://";

/// Names of ROS packages with their folders, which lie inside the folder of the cell.
#[derive(Default)]
pub struct RosPackages(pub Vec<(String, String)>);

impl RosPackages {
    /// Returns the path of a file that a URDF names.
    ///
    /// The path is relative to the folder of the cell. If the robot file does not give the folder of the
    /// package, the path remains `package://NAME/PATH`.
    pub fn path(&self, file: &Named, lib: &mut Library<'_>) -> Option<String> {
        let naming =
            lib.sources[file.at.file].path.strip_prefix(SCHEME).and_then(|path| path.rsplit_once('/'));
        let whole = match (file.name.strip_prefix(SCHEME), naming) {
            (Some(rest), _) => rest.to_string(),
            // The URDF itself is in a package, and the path is relative to the folder of the URDF.
            (None, Some((folder, _))) if !file.name.starts_with('/') => format!("{folder}/{}", file.name),
            _ => return lib.relative(&file.name, file.at),
        };
        let inside = whole.split_once('/').and_then(|(name, path)| Some((name, normal(path)?)));
        let Some((name, path)) = inside.filter(|(name, _)| is_package(name)) else {
            let message = format!("`{}` does not name a file of a package", shown(&file.name));
            lib.error(file.at, message, "write package://NAME/PATH, with a path that stays in the package");
            return None;
        };
        Some(match self.0.iter().find(|(n, _)| n == name) {
            Some((_, folder)) => format!("{folder}/{path}"),
            None => format!("{SCHEME}{name}/{path}"),
        })
    }
}

/// Returns whether a package name consists of letters, digits, `_` and `-`. Such a name cannot lead out of a
/// folder.
fn is_package(name: &str) -> bool {
    !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-')
}

/// Returns a path with `.` and `..` resolved; None if the path leaves its folder or does not name a file.
fn normal(path: &str) -> Option<String> {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match part {
            "" | "." => {}
            ".." => drop(parts.pop()?),
            _ => parts.push(part),
        }
    }
    let odd = path.starts_with('/') || path.ends_with('/') || path.contains(['\\', ':', '\0']);
    (!odd && !parts.is_empty()).then(|| parts.join("/"))
}
