//! Thread pools of a sweep.

use crate::cli::{Exit, output};

/// Starts a pool of threads.
pub fn pool(threads: usize) -> Result<rayon::ThreadPool, Exit> {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
        output::error(&format!("cannot start threads: {e}"));
        Exit::Io
    })
}

/// Starts one pool for each combination that is processed at the same time. Each pool gets an equal number of
/// threads.
pub fn pools(threads: usize, combinations: usize) -> Result<Vec<rayon::ThreadPool>, Exit> {
    let count = threads.min(combinations).max(1);
    (0..count).map(|_| pool(threads / count)).collect()
}
