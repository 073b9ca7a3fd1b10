//! Folders that commands write their results to.

use super::folder_lock::FolderLock;
pub use super::folder_lock::Sharing;
use super::loading::{CHECKPOINT, UNFINISHED, reason, sweep};
use super::{Exit, output};
use crate::files::shown;
use std::ops::Deref;
use std::path::{Path, PathBuf};

/// Result folder that is locked as long as this value lives.
pub struct OutputFolder {
    path: PathBuf,
    lock: FolderLock,
}

impl OutputFolder {
    /// Locks a folder that exists.
    pub fn existing(path: &Path, sharing: Sharing) -> Result<Self, Exit> {
        Ok(Self { path: path.to_path_buf(), lock: FolderLock::take(path, sharing)? })
    }

    /// Makes the last program that uses the folder remove unfinished files of killed programs.
    pub fn sweep_when_last(&mut self) {
        self.lock.sweep_when_last();
    }
}

impl Deref for OutputFolder {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.path
    }
}

/// Refuses the result folder `asked` if it exists and is in use or not empty. Commands with long computations
/// call this function before they begin.
pub fn require_new(asked: Option<&Path>, sharing: Sharing) -> Result<(), Exit> {
    let Some((path, Ok(entries))) = asked.map(|path| (path, path.read_dir())) else { return Ok(()) };
    let _folder = OutputFolder::existing(path, sharing)?;
    refuse_results(path, entries)
}

/// Refuses a folder whose `entries` are not all unfinished files of killed programs.
fn refuse_results(path: &Path, mut entries: std::fs::ReadDir) -> Result<(), Exit> {
    let unfinished = |e: std::fs::DirEntry| e.file_name().to_string_lossy().starts_with(UNFINISHED);
    if entries.all(|e| e.is_ok_and(unfinished)) {
        return Ok(());
    }
    let folder = output::path_word(path);
    if path.join(CHECKPOINT).is_file() {
        output::error(&format!("{folder} contains a stopped search"));
        output::talk(&format!("  help: resume it with sweetspot search --resume {folder}"));
    } else {
        let why = "is not empty, and nothing is overwritten; choose a new folder with --out";
        output::error(&format!("{folder} {why}"));
    }
    Err(Exit::BadInput)
}

/// Makes and locks the result folder `asked`, which must be new or empty. If `asked` is None, makes and locks
/// the first free folder `results/STEM-NNN`.
pub fn new_folder(asked: Option<&Path>, stem: &str, sharing: Sharing) -> Result<OutputFolder, Exit> {
    let cannot = |path: &Path, e: &std::io::Error| {
        output::error(&format!("cannot create the folder {}: {}", shown(&path.to_string_lossy()), reason(e)));
        Exit::Io
    };
    if let Some(path) = asked {
        std::fs::create_dir_all(path).map_err(|e| cannot(path, &e))?;
        let folder = OutputFolder::existing(path, sharing)?;
        refuse_results(path, path.read_dir().map_err(|e| cannot(path, &e))?)?;
        // With `WithOthers`, an unfinished file may belong to another running array job.
        if sharing == Sharing::Alone {
            sweep(path);
        }
        return Ok(folder);
    }
    let results = Path::new("results");
    std::fs::create_dir_all(results).map_err(|e| cannot(results, &e))?;
    for number in 1..1000 {
        let path = results.join(format!("{stem}-{number:03}"));
        match std::fs::create_dir(&path) {
            Ok(()) => return OutputFolder::existing(&path, sharing),
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(cannot(&path, &e)),
        }
    }
    output::error(&format!("results/{stem}-001 to -999 all exist; choose a folder with --out"));
    Err(Exit::BadInput)
}
