//! Advisory lock that keeps a second program out of a result folder. Only array jobs and workers of one sweep
//! share the lock ([`Sharing::WithOthers`]).
//!
//! The operating system releases the lock when the process that holds it ends, even if that process crashes.

use super::loading::{LOCK, reason, sweep};
use super::output::path_word;
use super::{Exit, arguments, output};
use crate::files::shown;
use std::fs::{File, TryLockError};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Largest number of bytes read from a lock file. The file describes the program that holds the lock.
const MAX_OWNER: u64 = 300;

/// Sharing of a result folder: one program or several programs may write to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sharing {
    Alone,
    /// Several array jobs or workers of one sweep write different files to the folder.
    WithOthers,
}

/// Lock of a folder, held until it is dropped.
pub struct FolderLock {
    path: PathBuf,
    /// Open file that holds the lock; None if the file system does not support locks.
    file: Option<File>,
    /// Whether the last program that holds the lock removes unfinished files from the folder.
    sweeps: bool,
}

impl FolderLock {
    /// Makes the last program that holds the lock remove unfinished files, which killed programs have left.
    pub fn sweep_when_last(&mut self) {
        self.sweeps = true;
    }

    /// Locks a folder; refuses a folder that another program uses, and names that program.
    pub fn take(folder: &Path, sharing: Sharing) -> Result<Self, Exit> {
        let path = folder.join(LOCK);
        loop {
            if path.symlink_metadata().is_ok_and(|about| !about.is_file()) {
                output::error(&format!("{} is not a file: remove it", path_word(&path)));
                return Err(Exit::Io);
            }
            let open = File::options().read(true).write(true).create(true).truncate(false).open(&path);
            let mut file = open.map_err(|e| {
                output::error(&format!("cannot lock the folder {}: {}", path_word(folder), reason(&e)));
                Exit::Io
            })?;
            let locked = match sharing {
                Sharing::Alone => file.try_lock(),
                Sharing::WithOthers => file.try_lock_shared(),
            };
            match locked {
                Ok(()) if !is_at(&file, &path) => continue,
                Ok(()) => {
                    // A failure is ignored: the lock works even if the file does not name its owner.
                    let _ = file.set_len(0).and_then(|()| file.write_all(owner().as_bytes()));
                    return Ok(Self { path, file: Some(file), sweeps: false });
                }
                Err(TryLockError::WouldBlock) => return Err(in_use(folder, file)),
                Err(TryLockError::Error(e)) => {
                    let folder = path_word(folder);
                    output::talk(&format!(
                        "note: {folder} is not locked, because its file system refuses the lock: {e}"
                    ));
                    return Ok(Self { path, file: None, sweeps: false });
                }
            }
        }
    }
}

impl Drop for FolderLock {
    /// Unlocks the folder. The last program that holds the lock removes the lock file.
    fn drop(&mut self) {
        drop(self.file.take());
        if let Ok(file) = File::options().read(true).write(true).open(&self.path)
            && file.try_lock().is_ok()
            && is_at(&file, &self.path)
        {
            if let Some(folder) = self.path.parent().filter(|_| self.sweeps) {
                sweep(folder);
            }
            let _ = std::fs::remove_file(&self.path);
        }
    }
}

/// Reports which program uses a folder.
fn in_use(folder: &Path, file: File) -> Exit {
    let mut owner = Vec::new();
    let _ = file.take(MAX_OWNER).read_to_end(&mut owner);
    let owner = String::from_utf8_lossy(&owner);
    // `shown` truncates a long text, so each word is passed to it separately.
    let owner = owner.split_whitespace().map(shown).collect::<Vec<_>>().join(" ");
    let owner = if owner.is_empty() { "another program" } else { &owner };
    output::error(&format!("the folder {} is in use by {owner}", path_word(folder)));
    output::talk("  help: wait until that program ends, or choose another folder with --out");
    Exit::Io
}

/// Returns the content of the lock file: the process and the command of this program.
fn owner() -> String {
    format!("process {}: sweetspot {}", std::process::id(), arguments::typed().join(" "))
}

/// Returns whether the path still names this open file. The previous owner of the lock may have deleted
/// the file.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let same = |a: std::fs::Metadata, b: std::fs::Metadata| (a.dev(), a.ino()) == (b.dev(), b.ino());
    file.metadata().ok().zip(path.metadata().ok()).is_some_and(|(a, b)| same(a, b))
}

/// Returns true: on a system other than Unix, the path is assumed to still name this open file.
#[cfg(not(unix))]
fn is_at(_file: &File, _path: &Path) -> bool {
    true
}
