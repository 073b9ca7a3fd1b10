//! Search for the folders of the ROS packages that a URDF names.

use crate::cli::packages::PackageFolders;
use std::path::{Path, PathBuf};

/// Number of folders that are searched for packages, from the folder of the URDF upwards.
const MAX_ABOVE: usize = 6;

/// Largest size of a package.xml that is read, bytes.
const MAX_MANIFEST: u64 = 1 << 20;

/// Returns the folder of a package: the given folder, a folder above or beside `near`, or a folder in the
/// search paths of ROS. Returns None if the package is not found.
pub fn folder_of(name: &str, near: &Path, given: &PackageFolders) -> Option<PathBuf> {
    let stated = given.folders.iter().find(|(known, _)| known == name).map(|(_, folder)| folder.clone());
    let above = || {
        folders_above(near).find_map(|folder| {
            let beside = folder.join(name);
            if is_package(&folder, name) { Some(folder) } else { Some(beside).filter(|f| f.is_dir()) }
        })
    };
    stated.or_else(above).or_else(|| of_ros(name))
}

/// Returns the nearest folder at or above `near` that is a ROS package; None if there is none.
pub fn package_above(near: &Path) -> Option<PathBuf> {
    folders_above(near).find(|folder| folder.join("package.xml").is_file())
}

fn folders_above(near: &Path) -> impl Iterator<Item = PathBuf> {
    let near = near.canonicalize().unwrap_or_else(|_| near.to_path_buf());
    near.ancestors().take(MAX_ABOVE).map(Path::to_path_buf).collect::<Vec<_>>().into_iter()
}

/// Returns whether a folder is the package `name`. The name in package.xml decides. If package.xml states no
/// name, the name of the folder decides.
fn is_package(folder: &Path, name: &str) -> bool {
    let manifest = folder.join("package.xml");
    let small = manifest.metadata().is_ok_and(|about| about.is_file() && about.len() <= MAX_MANIFEST);
    let text = if small { std::fs::read_to_string(&manifest).unwrap_or_default() } else { String::new() };
    let stated = text
        .split_once("<name>")
        .and_then(|(_, rest)| rest.split_once("</name>"))
        .map(|(name, _)| name.trim());
    let own = folder.file_name().is_some_and(|own| own.to_string_lossy() == name);
    stated.map_or(own, |stated| stated == name)
}

/// Returns the folder of a package in the search paths of ROS. Environment variables state these paths.
/// Returns None if the package is not found.
fn of_ros(name: &str) -> Option<PathBuf> {
    let all = |variable: &str| std::env::var_os(variable).unwrap_or_default();
    let (ros1, ros2) = (all("ROS_PACKAGE_PATH"), all("AMENT_PREFIX_PATH"));
    let of_ros1 = std::env::split_paths(&ros1).flat_map(|path| {
        let below = path.read_dir().into_iter().flatten().flatten().map(|entry| entry.path().join(name));
        let own = Some(path.clone()).filter(|path| is_package(path, name));
        own.into_iter().chain([path.join(name)]).chain(below).collect::<Vec<_>>()
    });
    let of_ros2 = std::env::split_paths(&ros2).map(|prefix| prefix.join("share").join(name));
    of_ros1.chain(of_ros2).find(|folder| folder.is_dir())
}
