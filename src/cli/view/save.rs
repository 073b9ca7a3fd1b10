//! Saving of the layout on the page as a cell file, in the folder of the cell file that the page shows.

use super::values::LayoutValues;
use crate::cell::Cell;
use crate::cli::loading;
use crate::cli::loading::FileSnapshot;
use crate::cli::packages::PackageFolders;
use crate::files::shown;
use crate::report;
use std::path::{Path, PathBuf};

/// Largest length of a file name with its extension, bytes.
const MAX_NAME: usize = 100;
/// Names that Windows reserves for devices, with any extension.
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];

/// Reason why a layout was not saved.
pub enum Unsaved {
    /// The file exists. The page may repeat the request with the permission to overwrite the file.
    FileExists,
    /// The request is refused. The text is the reason that the page shows.
    Refused(String),
    /// The file cannot be written.
    Io,
}

/// Returns the requested file name with the extension `.toml`, which is added if missing.
///
/// # Errors
/// Fails with the reason if the name is refused.
pub fn file_name(asked: &str) -> Result<String, String> {
    let stem = asked.trim();
    let stem = stem.strip_suffix(".toml").unwrap_or(stem);
    let is_plain = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
    if stem.is_empty() {
        return Err("the file needs a name".into());
    }
    if !stem.chars().all(is_plain) || stem.starts_with(['.', '-', ' ']) || stem.ends_with(['.', ' ']) {
        return Err(
            "a file name may contain only letters, digits, spaces, '-', '_' and '.', and no folder; it must not begin with '-' or '.', and must not end with '.'"
                .into(),
        );
    }
    let first = stem.split('.').next().unwrap_or(stem).trim_end().to_ascii_uppercase();
    let port = first.strip_prefix("COM").or_else(|| first.strip_prefix("LPT"));
    let is_port = port.is_some_and(|n| n.chars().count() == 1 && n.chars().all(char::is_numeric));
    if DEVICES.contains(&first.as_str()) || is_port {
        return Err(format!("`{first}` is a device name on Windows"));
    }
    let name = format!("{stem}.toml");
    if name.len() > MAX_NAME {
        return Err(format!("a file name has at most {MAX_NAME} bytes"));
    }
    Ok(name)
}

/// Cell file shown on the page, and all files that were read for it.
pub struct Origin {
    pub file: PathBuf,
    pub packages: PackageFolders,
    pub sources: Vec<PathBuf>,
}

impl Origin {
    fn folder(&self) -> &Path {
        self.file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// Writes the layout `values`, with the evaluation settings of `cell`, to the file named `asked`.
    /// Returns the path of the file.
    ///
    /// # Errors
    /// Returns the reason if nothing was written.
    pub fn save(
        &self,
        asked: &str,
        overwrite: bool,
        cell: &Cell,
        values: &LayoutValues,
    ) -> Result<PathBuf, Unsaved> {
        let name = file_name(asked).map_err(Unsaved::Refused)?;
        let path = self.folder().join(&name);
        // Two names can denote the same file: through a link, or on a file system that ignores case.
        if let Ok(real) = path.canonicalize()
            && self.sources.iter().any(|s| s.canonicalize().is_ok_and(|s| s == real))
        {
            return Err(Unsaved::Refused(format!("this layout is made from `{name}`: choose another name")));
        }
        if path.symlink_metadata().is_ok_and(|m| !m.is_file()) {
            return Err(Unsaved::Refused(format!("`{name}` exists and is not a file")));
        }
        if path.symlink_metadata().is_ok() && !overwrite {
            return Err(Unsaved::FileExists);
        }
        let from = self.file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let comment = format!("A layout of {} made by hand in sweetspot view", shown(&from));
        let cell = values.starting(cell, true);
        let text = report::toml::fixed(&from, &comment, &cell, &values.layout(&cell));
        self.check(&path, &name, &text)?;
        loading::write_whole(&path, text.as_bytes()).map_err(|_| Unsaved::Io)?;
        Ok(path)
    }

    /// Validates a cell file before it is written, so that every saved file is valid.
    fn check(&self, path: &Path, name: &str, text: &str) -> Result<(), Unsaved> {
        let kept = FileSnapshot::with([(name.to_string(), text.as_bytes().to_vec())]);
        match loading::read_cell_with(path, &self.packages, &[], &kept) {
            Ok(_) => Ok(()),
            Err(faults) => {
                let first =
                    faults.iter().find(|f| f.is_error()).map(|f| format!("{}; {}", f.message, f.help));
                Err(Unsaved::Refused(format!(
                    "the layout is not a valid cell: {}",
                    first.unwrap_or_default()
                )))
            }
        }
    }
}
