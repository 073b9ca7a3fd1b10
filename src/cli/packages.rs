//! Folders of the ROS packages whose files a URDF names.

use super::output::word;
use clap::Args;
use std::path::{Path, PathBuf};

/// Folders of ROS packages, by name.
#[derive(Args, Clone, Default)]
pub struct PackageFolders {
    /// Folder that package://NAME/... in a URDF refers to; can be given once per package
    #[arg(long = "package", value_name = "NAME=DIR", value_parser = package)]
    pub folders: Vec<(String, PathBuf)>,
}

impl PackageFolders {
    /// Returns the options as arguments for another command; a space precedes each option.
    pub fn words(&self) -> String {
        let option = |(name, folder): &(String, PathBuf)| {
            format!(" --package {}", word(&format!("{name}={}", folder.display())))
        };
        self.folders.iter().map(option).collect()
    }

    /// Adds the packages that a result folder keeps in its folder `inputs`. A package that is already listed
    /// keeps its folder.
    pub fn with_kept(mut self, inputs: &Path) -> Self {
        for entry in inputs.join("packages").read_dir().into_iter().flatten().flatten() {
            let name = entry.file_name().to_string_lossy().into_owned();
            if !self.folders.iter().any(|(given, _)| *given == name) {
                self.folders.push((name, entry.path()));
            }
        }
        self
    }
}

/// Parses the name and the folder of a package, written as `NAME=DIR`.
fn package(text: &str) -> Result<(String, PathBuf), String> {
    match text.split_once('=') {
        Some((name, folder)) if !name.is_empty() && !folder.is_empty() => Ok((name.into(), folder.into())),
        _ => Err("expected NAME=DIR, the name of a package and its folder".into()),
    }
}
