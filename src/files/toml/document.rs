//! All files of a cell as they are read, and the faults found in them.

use super::tree::{At, Entry, parse, path_to};
use crate::files::content::{FileContent, not_needed};
use crate::files::fault::{Fault, FaultKind, Severity, shown};
use std::cmp::Ordering;
use std::collections::HashMap;

/// Largest number of errors, and of warnings, that are listed.
const MAX_FAULTS: usize = 500;

/// Largest size of a TOML file, bytes.
const MAX_TOML: usize = 4_000_000;

/// Largest total size, bytes, of the cell file and all files that it names directly or indirectly. A file
/// named twice counts twice.
const MAX_NAMED: usize = 100_000_000;

const PACKAGE: &str = "give the folder of the package: --package NAME=DIR";

const NAMING: &str = "write a path relative to the folder of the file that contains this key";

const TOML_FILE: &str = "a cell or robot file in TOML";

const ENCODING: &str = "save it as UTF-8 in a text editor";

/// File as it was read: its path and bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Path of the file relative to the folder of the cell file, with forward slashes.
    pub path: String,
    pub bytes: Vec<u8>,
}

impl Source {
    /// Returns the text of the file; empty if it is not UTF-8 (a binary mesh).
    pub fn text(&self) -> &str {
        std::str::from_utf8(&self.bytes).unwrap_or("")
    }
}

/// Function that returns the bytes of the file at a path, or says why it cannot.
///
/// The path is relative to the folder of the cell and never leads out of that folder. For a file in a ROS
/// package whose folder the robot file does not state, the path is `package://NAME/PATH`.
pub type ReadFile<'a> = dyn FnMut(&str) -> Result<Vec<u8>, String> + 'a;

/// All files read so far and all faults found so far.
pub struct Library<'a> {
    read: &'a mut ReadFile<'a>,
    pub sources: Vec<Source>,
    pub faults: Vec<Fault>,
    /// Number of errors and number of warnings among the faults. The numbers are stored, because a
    /// malicious file can make the reader query the number of errors a million times.
    found: [usize; 2],
    /// Index of the source that holds the settings, and one truth value per setting; None without settings.
    ///
    /// The value is true if a flag other than `--set` states the setting, and false if `--set` states it. The
    /// source has one setting per line, in the order of the values.
    pub flags: Option<(usize, Vec<bool>)>,
    parsed: HashMap<usize, Option<Vec<Entry>>>,
    /// Total size, bytes, of the cell file and of the files named so far.
    named: usize,
}

impl<'a> Library<'a> {
    pub fn new(read: &'a mut ReadFile<'a>) -> Self {
        Self {
            read,
            sources: Vec::new(),
            faults: Vec::new(),
            found: [0; 2],
            flags: None,
            parsed: HashMap::new(),
            named: 0,
        }
    }

    /// Returns whether the value at a place comes from a flag of the command line other than `--set`.
    pub fn is_flag(&self, at: At) -> bool {
        let Some((file, flags)) = self.flags.as_ref().filter(|(file, _)| *file == at.file) else {
            return false;
        };
        let before = self.sources[*file].bytes.iter().take(at.offset);
        flags.get(before.filter(|b| **b == b'\n').count()).copied().unwrap_or(false)
    }

    /// Records a fault at a place.
    pub fn fault(&mut self, at: At, severity: Severity, message: String, help: impl Into<String>) {
        let found = &mut self.found[usize::from(severity == Severity::Warning)];
        let (message, help) = match (*found).cmp(&MAX_FAULTS) {
            Ordering::Less => (message, help.into()),
            Ordering::Equal => {
                (format!("more than {MAX_FAULTS} faults"), "correct the listed faults first".into())
            }
            Ordering::Greater => return,
        };
        *found += 1;
        let source = &self.sources[at.file];
        let fault = Fault::in_text(&source.path, source.text(), at.offset, message, help);
        self.faults.push(Fault { severity, ..fault });
    }

    pub fn error(&mut self, at: At, message: String, help: impl Into<String>) {
        self.fault(at, Severity::Error, message, help);
    }

    /// Marks all warnings from index `start` on as warnings from the import of a URDF.
    pub fn mark_import(&mut self, start: usize) {
        let warnings = self.faults.iter_mut().skip(start).filter(|fault| !fault.is_error());
        warnings.for_each(|fault| fault.kind = FaultKind::Import);
    }

    /// Returns the number of errors found so far.
    pub fn errors(&self) -> usize {
        self.found[0]
    }

    /// Reads a text file, unless it has been read, and returns its index among the sources.
    ///
    /// A file that is not UTF-8 is a fault at the place that names the file. Nothing names the cell file, so
    /// its fault is at the first byte that is not UTF-8.
    pub fn text(&mut self, path: &str, at: Option<At>) -> Option<usize> {
        let file = self.file(path, at)?;
        let bytes = &self.sources[file].bytes;
        let Some(text) = bytes.utf8_chunks().next().filter(|chunk| !chunk.invalid().is_empty()) else {
            return Some(file);
        };
        let (text, wrong) = (text.valid(), "it is not UTF-8 text");
        match at {
            Some(at) => self.error(at, format!("cannot read `{}`: {wrong}", shown(path)), ENCODING),
            None => {
                let fault = Fault::in_text(path, text, text.len(), wrong.into(), ENCODING.into());
                self.faults.push(fault);
            }
        }
        None
    }

    /// Reads a TOML file as [`Self::text`] does. Records a single fault if the content of the file shows that
    /// it is not TOML.
    pub fn toml(&mut self, path: &str, at: Option<At>) -> Option<usize> {
        let file = self.file(path, at)?;
        let Some(content) = FileContent::of(&self.sources[file].bytes) else { return self.text(path, at) };
        match at {
            Some(at) => {
                let message = not_needed(path, content, TOML_FILE);
                self.error(at, message, "name a robot, tool or equipment file in TOML");
            }
            None => self.faults.push(Fault::foreign(path, content, TOML_FILE)),
        }
        None
    }

    /// Reads a file, unless it has been read, and returns its index among the sources.
    ///
    /// `at` is the place that names the file; None for the cell file.
    pub fn file(&mut self, path: &str, at: Option<At>) -> Option<usize> {
        let file = match self.sources.iter().position(|s| s.path == path) {
            Some(known) => known,
            None => self.read_new(path, at)?,
        };
        self.named = self.named.saturating_add(self.sources[file].bytes.len());
        if let Some(at) = at.filter(|_| self.named > MAX_NAMED) {
            let most = MAX_NAMED / 1_000_000;
            let message = format!("the files named so far add up to more than {most} MB");
            self.error(at, message, "simplify the meshes, or name fewer files");
            return None;
        }
        Some(file)
    }

    fn read_new(&mut self, path: &str, at: Option<At>) -> Option<usize> {
        match (self.read)(path) {
            Ok(bytes) => {
                self.sources.push(Source { path: path.to_string(), bytes });
                return Some(self.sources.len() - 1);
            }
            Err(why) => self.unreadable(path, at, &why),
        }
        None
    }

    fn unreadable(&mut self, path: &str, at: Option<At>, why: &str) {
        let message = format!("cannot read `{}`: {}", shown(path), shown(why));
        match at {
            Some(at) if path.starts_with("package://") => self.error(at, message, PACKAGE),
            Some(at) => self.error(at, message, NAMING),
            None => self.faults.push(Fault::unreadable(path, message, "check the path of the cell file")),
        }
    }

    /// Returns the top-level entries of a file; None if it has faults.
    ///
    /// A file is parsed once, and its faults are recorded once.
    pub fn entries(&mut self, file: usize) -> Option<Vec<Entry>> {
        if let Some(known) = self.parsed.get(&file) {
            return known.clone();
        }
        let text = self.sources[file].text();
        let parsed = if text.len() > MAX_TOML {
            let message = format!("the file has {} MB of text", text.len() / 1_000_000);
            let help = "a TOML file may have at most 4 MB: put large shapes into mesh files";
            Err(vec![(0, message, help)])
        } else {
            parse(file, text)
        };
        let entries = parsed.map_err(|faults| {
            for (offset, message, help) in faults {
                self.error(At { file, offset }, message, help);
            }
        });
        self.parsed.insert(file, entries.ok());
        self.parsed.get(&file).cloned().flatten()
    }

    /// Returns the dotted keys that lead from the top of a file to the value at a place; None if no value is
    /// there.
    ///
    /// Also returns None if the list of errors is full, because no further help is shown.
    pub fn path(&self, at: At) -> Option<String> {
        let entries = self.parsed.get(&at.file).filter(|_| self.errors() < MAX_FAULTS)?;
        path_to(entries.as_ref()?, at)
    }

    /// Converts a path that is written at `at` to a path relative to the folder of the cell. Records a fault
    /// if the path leaves that folder or cannot be a file.
    pub fn relative(&mut self, name: &str, at: At) -> Option<String> {
        let naming = &self.sources[at.file].path;
        let mut parts: Vec<&str> = naming.split('/').collect();
        parts.pop();
        let mut leaves = false;
        for part in name.split('/') {
            match part {
                "" | "." => {}
                ".." => leaves |= parts.pop().is_none(),
                _ => parts.push(part),
            }
        }
        let (wrong, help) = if name.contains('\\') {
            ("has a backslash", "write / between folders")
        } else if name.starts_with('/') || name.contains(':') {
            ("is an absolute path", NAMING)
        } else if leaves {
            (
                "leaves the folder of the cell file",
                "put the file into the folder of the cell file, or into \
            a folder below it",
            )
        } else if parts.is_empty() || name.ends_with('/') || name.contains('\0') {
            ("is not a file", NAMING)
        } else {
            return Some(parts.join("/"));
        };
        self.error(at, format!("`{}` {wrong}", shown(name)), help);
        None
    }
}
