//! The layout on the page as a cell file beside the one that is shown.

use super::values::LayoutValues;
use crate::cell::Cell;
use crate::cli::packages::Packages;
use crate::cli::loading;
use crate::cli::loading::Kept;
use crate::files::shown;
use crate::report;
use std::path::{Path, PathBuf};

/// Longest name, with its ending.
const LONGEST: usize = 100;
/// Names that Windows gives to devices, whatever ending they have.
const DEVICES: [&str; 6] = ["CON", "PRN", "AUX", "NUL", "CONIN$", "CONOUT$"];

/// Why a layout was not saved.
pub enum Unsaved {
    /// There is such a file; it is overwritten if asked again.
    Taken,
    /// In words for the page.
    Refused(String),
    /// It cannot be written.
    Io,
}

/// A plain file name with `.toml` at its end.
///
/// # Errors
/// Why it is none, in words.
pub fn file_name(asked: &str) -> Result<String, String> {
    let stem = asked.trim();
    let stem = stem.strip_suffix(".toml").unwrap_or(stem);
    let is_plain = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
    if stem.is_empty() {
        return Err("give the file a name".into());
    }
    if !stem.chars().all(is_plain) || stem.starts_with(['.', '-', ' ']) || stem.ends_with(['.', ' ']) {
        return Err(
            "a name has letters, digits, - and _ and begins with a letter or digit: no folders".into()
        );
    }
    let first = stem.split('.').next().unwrap_or(stem).trim_end().to_ascii_uppercase();
    let port = first.strip_prefix("COM").or_else(|| first.strip_prefix("LPT"));
    let is_port = port.is_some_and(|n| n.chars().count() == 1 && n.chars().all(char::is_numeric));
    if DEVICES.contains(&first.as_str()) || is_port {
        return Err(format!("`{first}` is the name of a device"));
    }
    let name = format!("{stem}.toml");
    if name.len() > LONGEST {
        return Err(format!("a name has at most {LONGEST} characters"));
    }
    Ok(name)
}

/// The file that is shown, and what was read for it.
pub struct Origin {
    pub file: PathBuf,
    pub packages: Packages,
    pub sources: Vec<PathBuf>,
}

impl Origin {
    fn folder(&self) -> &Path {
        self.file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
    }

    /// Writes the layout of `values`, asked as `cell` is; returns where it is.
    ///
    /// # Errors
    /// Why nothing was written.
    pub fn save(
        &self,
        asked: &str,
        overwrite: bool,
        cell: &Cell,
        values: &LayoutValues,
    ) -> Result<PathBuf, Unsaved> {
        let name = file_name(asked).map_err(Unsaved::Refused)?;
        let path = self.folder().join(&name);
        // Links and case: two names can be one file.
        if let Ok(real) = path.canonicalize()
            && self.sources.iter().any(|s| s.canonicalize().is_ok_and(|s| s == real))
        {
            return Err(Unsaved::Refused(format!(
                "`{name}` is what this layout is made from: take another name"
            )));
        }
        if path.symlink_metadata().is_ok_and(|m| !m.is_file()) {
            return Err(Unsaved::Refused(format!("`{name}` is there and is no file")));
        }
        if path.symlink_metadata().is_ok() && !overwrite {
            return Err(Unsaved::Taken);
        }
        let from = self.file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let comment = format!("A layout of {} made by hand in sweetspot view", shown(&from));
        let cell = values.starting(cell, true);
        let text = report::toml::fixed(&from, &comment, &cell, &values.layout(&cell));
        self.check(&path, &name, &text)?;
        loading::write_whole(&path, text.as_bytes()).map_err(|_| Unsaved::Io)?;
        Ok(path)
    }

    /// Reads it before it is there: nothing is written that is no cell.
    fn check(&self, path: &Path, name: &str, text: &str) -> Result<(), Unsaved> {
        let kept = Kept::with(name, text.as_bytes());
        match loading::read_cell_with(path, &self.packages, &[], &kept) {
            Ok(_) => Ok(()),
            Err(faults) => {
                let first =
                    faults.iter().find(|f| f.is_error()).map(|f| format!("{}; {}", f.message, f.help));
                Err(Unsaved::Refused(format!("no file can say that: {}", first.unwrap_or_default())))
            }
        }
    }
}
