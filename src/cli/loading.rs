//! Reading of files inside the folder of the cell, and atomic writing of files.

use super::packages::PackageFolders;
use super::{Exit, output, read_files};
use crate::cli::mutex::locked;
use crate::files;
use crate::files::{Fault, FaultKind, FileContent, Loaded, LoadedRobot, Setting, shown};
use flate2::read::GzDecoder;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Prefix of the names of unfinished files.
pub const UNFINISHED: &str = ".sweetspot-";

/// Name of the lock file that a result folder contains while a command writes to the folder.
pub const LOCK: &str = ".sweetspot-lock";

/// Name of the checkpoint in the folder of a search.
pub const CHECKPOINT: &str = "checkpoint.jsonl";

/// Largest size of an input file, bytes; a binary STL file of a million triangles has 50 MB.
const MAX_BYTES: u64 = 128 << 20;

/// Reads a cell and everything it refers to, and prints faults and warnings. Does not print the warnings
/// of the import of a URDF.
pub fn load(path: &Path, packages: &PackageFolders) -> Result<Loaded, Exit> {
    load_with(path, packages, &[])
}

/// Loads a cell as [`load`] does; `settings` override keys of the cell file.
pub fn load_with(path: &Path, packages: &PackageFolders, settings: &[Setting]) -> Result<Loaded, Exit> {
    let loaded = read_cell_with(path, packages, settings, &FileSnapshot::default()).map_err(|faults| {
        output::faults(&faults);
        exit_of(&faults)
    })?;
    output::faults(&without_import(&loaded.warnings));
    Ok(loaded)
}

/// Returns the warnings, except warnings about the import of a URDF. Only `check`, `robot` and `init` print
/// the import warnings.
pub fn without_import(warnings: &[Fault]) -> Vec<Fault> {
    warnings.iter().filter(|fault| fault.kind != FaultKind::Import).cloned().collect()
}

/// Returns the kind of a file whose content shows that it is not a TOML file. Returns None for any other
/// file, and for a file that cannot be read.
pub fn content(path: &Path) -> Option<FileContent> {
    let about = path.metadata().ok().filter(|about| about.is_file() && about.len() <= MAX_BYTES)?;
    let mut head = Vec::new();
    std::fs::File::open(path).ok()?.take(about.len()).read_to_end(&mut head).ok()?;
    FileContent::of(&head)
}

/// Returns the exit code for a list of faults: I/O error if a file cannot be read, otherwise bad input.
pub fn exit_of(faults: &[Fault]) -> Exit {
    let is_unreadable = faults.iter().any(|fault| fault.kind == FaultKind::Unreadable);
    if is_unreadable { Exit::Io } else { Exit::BadInput }
}

/// Reads a cell and everything it refers to.
pub fn read_cell(path: &Path, packages: &PackageFolders) -> Result<Loaded, Vec<Fault>> {
    read_cell_with(path, packages, &[], &FileSnapshot::default())
}

/// Snapshot of files. Each file is read from disk once, so every combination of a sweep gets the same bytes.
#[derive(Default)]
pub struct FileSnapshot {
    files: Mutex<HashMap<String, Result<Vec<u8>, String>>>,
    /// Whether the snapshot refuses files that it does not contain, instead of reading them from disk.
    is_closed: bool,
}

impl FileSnapshot {
    /// Returns a snapshot that contains these files, which need not exist on disk. Other files are read
    /// from disk.
    pub fn with(files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Self {
        let files = files.into_iter().map(|(name, bytes)| (name, Ok(bytes))).collect();
        Self { files: Mutex::new(files), is_closed: false }
    }

    /// Returns a snapshot that contains these files and refuses all others.
    pub fn closed(files: impl IntoIterator<Item = (String, Vec<u8>)>) -> Self {
        Self { is_closed: true, ..Self::with(files) }
    }

    fn get(&self, name: &str, read: impl FnOnce() -> Result<Vec<u8>, String>) -> Result<Vec<u8>, String> {
        let mut files = locked(&self.files);
        if self.is_closed && !files.contains_key(name) {
            return Err("it is not among the inputs of the plan".into());
        }
        files.entry(name.to_string()).or_insert_with(read).clone()
    }
}

/// Reads a cell and everything it refers to. `settings` override keys of the cell file. Files in the
/// snapshot `kept` are not read again.
pub fn read_cell_with(
    path: &Path,
    packages: &PackageFolders,
    settings: &[Setting],
    kept: &FileSnapshot,
) -> Result<Loaded, Vec<Fault>> {
    let (folder, name) = parted(path);
    let mut read = |inside: &str| kept.get(inside, || read_named(&folder, packages, inside));
    let mut loaded = files::load_with(&name, settings, &mut read).map_err(|faults| named(path, faults))?;
    loaded.warnings = named(path, loaded.warnings);
    Ok(loaded)
}

/// Reads a robot and everything it refers to, and prints faults and warnings.
pub fn load_robot(path: &Path, packages: &PackageFolders) -> Result<LoadedRobot, Exit> {
    let loaded = read_robot(path, packages).map_err(|faults| {
        output::faults(&faults);
        exit_of(&faults)
    })?;
    output::faults(&without_import(&loaded.warnings));
    Ok(loaded)
}

/// Reads a robot and everything it refers to.
pub fn read_robot(path: &Path, packages: &PackageFolders) -> Result<LoadedRobot, Vec<Fault>> {
    let (folder, name) = parted(path);
    let mut read = |inside: &str| read_named(&folder, packages, inside);
    let mut loaded = files::load_robot(&name, &mut read).map_err(|faults| named(path, faults))?;
    loaded.warnings = named(path, loaded.warnings);
    Ok(loaded)
}

/// Returns whether a file describes a robot.
pub fn is_robot(path: &Path, packages: &PackageFolders) -> bool {
    let (folder, name) = parted(path);
    files::is_robot(&name, &mut |inside| read_named(&folder, packages, inside))
}

/// Splits a path into folder and file name.
fn parted(path: &Path) -> (PathBuf, String) {
    let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => (parent.to_path_buf(), name),
        _ => (PathBuf::from("."), name),
    }
}

/// Prefixes the file name of every fault with the folder of `path`, so that an editor can open the file.
fn named(path: &Path, mut faults: Vec<Fault>) -> Vec<Fault> {
    let prefix = path.parent().unwrap_or(Path::new(""));
    // A fault without a line is in a setting, not in a file.
    for fault in faults.iter_mut().filter(|f| f.line > 0) {
        fault.file = prefix.join(&fault.file).to_string_lossy().into_owned();
        if let FaultKind::Foreign(content) = fault.kind {
            fault.help = content.next_step(&output::path_word(Path::new(&fault.file)));
        }
    }
    faults
}

/// Reads the file `package://NAME/PATH` from the folder of the package NAME. Reads any other file from the
/// folder of the cell.
fn read_named(folder: &Path, packages: &PackageFolders, name: &str) -> Result<Vec<u8>, String> {
    let Some((package, inside)) = name.strip_prefix("package://").and_then(|rest| rest.split_once('/'))
    else {
        return read_inside(folder, name, "the cell file");
    };
    match packages.folders.iter().find(|(name, _)| name == package) {
        Some((_, folder)) => read_inside(folder, inside, "its package"),
        None => Err(format!("the folder of the package is unknown: add --package {package}=DIR")),
    }
}

/// Reads a file that must be inside `folder` after symbolic links are followed. `whose` names the owner of
/// the folder in the error message.
pub fn read_inside(folder: &Path, inside: &str, whose: &str) -> Result<Vec<u8>, String> {
    let path = folder.join(inside);
    let real = path.canonicalize().map_err(|e| reason(&e))?;
    let home = folder.canonicalize().map_err(|e| reason(&e))?;
    if !real.starts_with(&home) {
        return Err(format!("it is outside the folder of {whose}"));
    }
    file_bytes(&real)
}

/// Reads a file of at most `MAX_BYTES`. Fails with the reason if the file is larger or cannot be read.
pub fn file_bytes(real: &Path) -> Result<Vec<u8>, String> {
    let about = real.metadata().map_err(|e| reason(&e))?;
    if !about.is_file() {
        return Err("it is not a file".into());
    }
    if about.len() > MAX_BYTES {
        return Err(format!("its size is {} MB, more than {} MB", about.len() >> 20, MAX_BYTES >> 20));
    }
    read_files::note(real);
    std::fs::read(real).map_err(|e| reason(&e))
}

/// Reads the bytes of a data file that the user names; a gzip file is decompressed.
///
/// Prints a message if the file cannot be read, or if its text is larger than `MAX_BYTES`.
pub fn read_data(path: &Path) -> Result<Vec<u8>, Exit> {
    read_unpacked(path).map_err(|why| {
        output::error(&format!("cannot read {}: {why}", output::path_word(path)));
        Exit::Io
    })
}

/// Reads the bytes of a data file that the user names, without decompressing a gzip file. Prints a message if
/// the file cannot be read.
pub fn read_packed(path: &Path) -> Result<Vec<u8>, Exit> {
    read_files::note(path);
    std::fs::read(path).map_err(|e| {
        output::error(&format!("cannot read {}: {}", output::path_word(path), reason(&e)));
        Exit::Io
    })
}

fn read_unpacked(path: &Path) -> Result<Vec<u8>, String> {
    read_files::note(path);
    let file = std::fs::File::open(path).map_err(|e| reason(&e))?;
    if !file.metadata().map_err(|e| reason(&e))?.is_file() {
        return Err("it is not a file".into());
    }
    let is_packed = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("gz"));
    let file: Box<dyn Read> = if is_packed { Box::new(GzDecoder::new(file)) } else { Box::new(file) };
    let mut bytes = Vec::new();
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(|e| reason(&e))?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(format!("its text is larger than {} MB", MAX_BYTES >> 20));
    }
    Ok(bytes)
}

/// Returns the reason, in plain words, why an operation on a file has failed.
pub fn reason(e: &std::io::Error) -> String {
    match e.kind() {
        std::io::ErrorKind::NotFound => "no such file".into(),
        std::io::ErrorKind::PermissionDenied => "permission denied".into(),
        std::io::ErrorKind::ReadOnlyFilesystem => "the file system is mounted read-only".into(),
        std::io::ErrorKind::StorageFull => "the disk is full".into(),
        std::io::ErrorKind::QuotaExceeded => "the disk quota is used up".into(),
        std::io::ErrorKind::StaleNetworkFileHandle => {
            "another host has replaced it on the network share; try again".into()
        }
        _ => e.to_string(),
    }
}

/// Writes a file atomically: writes a temporary file in the same folder, syncs it and renames it.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), Exit> {
    replace(path, bytes).map_err(|e| cannot_write(path, &e))
}

/// Writes a file that the user names, atomically. Refuses a name of something else than a file, and of a file
/// that this command has read.
pub fn write_output(path: &Path, bytes: &[u8]) -> Result<(), Exit> {
    let (why, exit) = match path.metadata() {
        Ok(about) if !about.is_file() => ("it exists and is not a file", Exit::Io),
        Ok(_) if read_files::contains(path) => {
            ("this command reads the file, and the output would replace it", Exit::BadInput)
        }
        _ => return write_whole(path, bytes),
    };
    output::error(&format!("cannot write {}: {why}", output::path_word(path)));
    output::talk("  help: choose another name for the output");
    Err(exit)
}

/// Writes a file atomically, and prints nothing.
///
/// # Errors
/// Fails if the file cannot be written.
pub fn replace(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    unfinished(path, bytes)?.persist(path).map_err(|e| e.error)?;
    sync(folder_of(path))
}

/// Writes a file atomically unless it exists. Returns whether the file is new. If several programs call this
/// function at the same time, only one of them writes the file.
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<bool, Exit> {
    let write = || match unfinished(path, bytes)?.persist_noclobber(path) {
        Ok(_) => sync(folder_of(path)).map(|()| true),
        Err(e) if e.error.kind() == std::io::ErrorKind::AlreadyExists => Ok(false),
        Err(e) => Err(e.error),
    };
    write().map_err(|e| cannot_write(path, &e))
}

/// Writes a file atomically, unless it already contains exactly these bytes. Such a file is kept. If a file
/// on NFS is replaced, hosts that have it open can no longer read it.
pub fn write_changed(path: &Path, bytes: &[u8]) -> Result<(), Exit> {
    let is_same = std::fs::read(path).is_ok_and(|present| present == bytes);
    if is_same { Ok(()) } else { write_whole(path, bytes) }
}

/// Reports that a file cannot be written.
pub fn cannot_write(path: &Path, e: &std::io::Error) -> Exit {
    output::error(&format!("cannot write {}: {}", shown(&path.to_string_lossy()), reason(e)));
    Exit::Io
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|parent| !parent.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes and syncs a temporary file in the folder of `path`.
fn unfinished(path: &Path, bytes: &[u8]) -> std::io::Result<tempfile::NamedTempFile> {
    let mut file = tempfile::Builder::new().prefix(UNFINISHED).tempfile_in(folder_of(path))?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    share(&file)?;
    Ok(file)
}

/// Syncs a folder. A renamed file is safe on the disk only after its folder is synced.
#[cfg(unix)]
fn sync(folder: &Path) -> std::io::Result<()> {
    std::fs::File::open(folder)?.sync_all()
}

#[cfg(not(unix))]
fn sync(_folder: &Path) -> std::io::Result<()> {
    Ok(())
}

/// Removes unfinished files, which killed processes have left, from a folder and its subfolders.
pub fn sweep(folder: &Path) {
    for entry in folder.read_dir().into_iter().flatten().flatten() {
        let path = entry.path();
        if entry.file_type().is_ok_and(|t| t.is_dir()) {
            sweep(&path);
        } else if entry.file_name().to_string_lossy().starts_with(UNFINISHED) && entry.file_name() != LOCK {
            let _ = std::fs::remove_file(path);
        }
    }
}

/// Makes a temporary file readable for all users who may read its folder. Temporary files are created with
/// access for the owner alone.
#[cfg(unix)]
fn share(file: &tempfile::NamedTempFile) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.as_file().set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn share(_file: &tempfile::NamedTempFile) -> std::io::Result<()> {
    Ok(())
}

/// Makes a folder unless it exists.
pub fn make_folder(path: &Path) -> Result<(), Exit> {
    std::fs::create_dir_all(path).map_err(|e| {
        output::error(&format!(
            "cannot create the folder {}: {}",
            shown(&path.to_string_lossy()),
            reason(&e)
        ));
        Exit::Io
    })
}

/// Returns the SHA-256 hash in hexadecimal, as `sha256sum` prints it.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}
