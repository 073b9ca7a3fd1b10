//! Pool of working memory for the evaluating threads.

use crate::layout::Workspace;
use std::sync::Mutex;

/// Working memory that one thread borrows while it evaluates.
pub(super) struct Lease<'a> {
    free: &'a Mutex<Vec<Workspace>>,
    pub(super) workspace: Workspace,
}

impl<'a> Lease<'a> {
    /// Takes working memory from the pool, or creates it if the pool is empty.
    pub(super) fn new(free: &'a Mutex<Vec<Workspace>>) -> Self {
        let workspace = locked(free).pop().unwrap_or_default();
        Self { free, workspace }
    }
}

impl Drop for Lease<'_> {
    fn drop(&mut self) {
        locked(self.free).push(std::mem::take(&mut self.workspace));
    }
}

/// Locks a mutex even if it is poisoned. This is safe, because a thread that panics leaves no half-written
/// data.
pub(super) fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}
