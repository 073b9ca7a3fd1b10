//! What takes long to compute, kept between runs: convex parts of link meshes.
//!
//! In the folder that `SWEETSPOT_CACHE` names (`off`: nowhere), else in the user's cache folder. A
//! folder that cannot be written is no fault: it is computed again.

use super::loading::sha256;
use std::io::{Read, Write};
use std::path::{Path, PathBuf};

/// Largest file kept, bytes.
const MAX_BYTES: u64 = 1 << 20;

/// Length of a hash in hexadecimal.
const HASH: usize = 64;

/// The bytes kept under a key, or those that `compute` makes, which are then kept.
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

/// The content of a file whose hash in front is right.
fn read(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    std::fs::File::open(path).ok()?.take(MAX_BYTES).read_to_end(&mut bytes).ok()?;
    let content = bytes.get(HASH..)?.to_vec();
    (sha256(&content).as_bytes() == &bytes[..HASH]).then_some(content)
}

/// Writes it whole or not at all.
fn write(folder: &Path, path: &Path, content: &[u8]) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(sha256(content).as_bytes())?;
    file.write_all(content)?;
    file.persist(path)?;
    Ok(())
}
