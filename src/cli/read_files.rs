//! Files that this process has read. An output must not replace one of them.

use super::mutex::locked;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

static READ: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Notes that a file is read.
pub fn note(path: &Path) {
    let Ok(real) = path.canonicalize() else { return };
    let mut read = locked(&READ);
    if !read.contains(&real) {
        read.push(real);
    }
}

/// Returns whether this process has read a file.
pub fn contains(path: &Path) -> bool {
    path.canonicalize().is_ok_and(|real| locked(&READ).contains(&real))
}
