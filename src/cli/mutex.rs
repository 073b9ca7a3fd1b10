//! Locks of mutexes.

use std::sync::{Mutex, MutexGuard};

/// Locks a mutex even if another thread panicked while it held the lock. No panic leaves the data half
/// written.
pub fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
}
