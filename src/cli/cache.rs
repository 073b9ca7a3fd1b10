//! Cache of results that take long to compute: the convex decompositions of link meshes.
//!
//! The cache is the folder that the environment variable `SWEETSPOT_CACHE` names, otherwise the cache folder
//! of the user. The value `off` disables it. If the folder cannot be written, the results are computed again.

use super::loading::sha256;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Largest cached file, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Length of a hash in hexadecimal.
const HASH: usize = 64;

/// Returns the bytes cached under a key, or computes and caches them.
pub fn remember(key: &[u8], compute: &dyn Fn() -> Vec<u8>) -> Vec<u8> {
    let Some(folder) = folder() else { return compute() };
    let path = folder.join(sha256(key));
    if let Some(kept) = read(&path) {
        return kept;
    }
    let made = compute();
    let _ = write(&folder, &path, &made);
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

/// Returns the content of a cached file if it matches the hash at the start of the file.
fn read(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(MAX_BYTES).read_to_end(&mut bytes).ok()?;
    let content = bytes.get(HASH..)?.to_vec();
    (sha256(&content).as_bytes() == &bytes[..HASH]).then_some(content)
}

/// Writes a cached file as a whole or not at all.
fn write(folder: &Path, path: &Path, content: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(sha256(content).as_bytes())?;
    file.write_all(content)?;
    file.persist(path)?;
    Ok(())
}
