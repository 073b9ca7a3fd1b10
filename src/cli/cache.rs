//! Cache of results that take long to compute: the convex decompositions of link meshes.
//!
//! The cache is the folder that the environment variable `SWEETSPOT_CACHE` names, otherwise the folder
//! `sweetspot` in the user's cache folder. The value `off` disables the cache. If the folder is not writable,
//! every run computes the results again.
//!
//! An entry is read only if it belongs to this user and nobody else may write to it. The hash stored in the
//! entry must match the key and the content. Other users who may write to the cache folder therefore cannot
//! change a result.

use super::loading::sha256;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Largest number of bytes read from a cached file. A larger file is never used.
const MAX_BYTES: u64 = 1 << 20;

/// Length of a SHA-256 hash in hexadecimal digits.
const HASH: usize = 64;

/// Returns the bytes cached under a key, or computes and caches them.
pub fn remember(key: &[u8], compute: &dyn Fn() -> Vec<u8>) -> Vec<u8> {
    let Some(folder) = folder() else { return compute() };
    let name = sha256(key);
    if let Some(kept) = read(&folder, &name) {
        return kept;
    }
    let made = compute();
    let _ = write(&folder, &name, &made);
    made
}

fn folder() -> Option<PathBuf> {
    let named = |name: &str| std::env::var_os(name).filter(|v| !v.is_empty()).map(PathBuf::from);
    match named("SWEETSPOT_CACHE") {
        Some(chosen) => (chosen != Path::new("off")).then_some(chosen),
        None => {
            let user = named("XDG_CACHE_HOME").or_else(|| named("LOCALAPPDATA"));
            Some(user.or_else(|| named("HOME").map(|home| home.join(".cache")))?.join("sweetspot"))
        }
    }
}

/// Returns the content of a cached file of this user. Returns None if the file is missing, cannot be trusted,
/// or does not match the hash at its start.
fn read(folder: &Path, name: &str) -> Option<Vec<u8>> {
    let path = folder.join(name);
    // Opening a named pipe would block until another program writes to it.
    if !path.symlink_metadata().ok()?.is_file() {
        return None;
    }
    let file = std::fs::File::open(&path).ok()?;
    if !is_ours(&file.metadata().ok()?) {
        return None;
    }
    let mut bytes = Vec::new();
    file.take(MAX_BYTES).read_to_end(&mut bytes).ok()?;
    let content = bytes.get(HASH..)?.to_vec();
    (seal(name, &content).as_bytes() == &bytes[..HASH]).then_some(content)
}

/// Returns whether a file belongs to this user and nobody else may write to it.
#[cfg(unix)]
fn is_ours(about: &std::fs::Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    about.uid() == rustix::process::geteuid().as_raw() && about.mode() & 0o022 == 0
}

/// Returns true, so the cache may use the file. Outside Unix, the cache folder counts as private to the user.
#[cfg(not(unix))]
fn is_ours(_about: &std::fs::Metadata) -> bool {
    true
}

/// Returns the hash of the name and content of an entry. The name is included so that one entry cannot
/// replace another.
fn seal(name: &str, content: &[u8]) -> String {
    sha256(&[name.as_bytes(), b"\n", content].concat())
}

/// Writes a cached file atomically.
fn write(folder: &Path, name: &str, content: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(seal(name, content).as_bytes())?;
    file.write_all(content)?;
    file.persist(folder.join(name))?;
    Ok(())
}
