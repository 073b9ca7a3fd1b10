//! Long work that runs without the interpreter lock and that Ctrl-C ends.

use pyo3::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

/// Time between two checks for a signal such as Ctrl-C.
const PAUSE: Duration = Duration::from_millis(50);

/// Result of work that could be interrupted.
pub struct Worked<T> {
    pub result: T,
    /// The exception that ended the work early, such as KeyboardInterrupt.
    pub interrupted: Option<PyErr>,
}

/// Runs `work` in another thread without the interpreter lock. If a signal such as Ctrl-C arrives, the flag
/// that `work` receives is set, so that `work` can end early. `tick` runs with the lock after each check for
/// a signal; an exception of `tick` also sets the flag.
pub fn interruptible<T: Send>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> T + Send,
    mut tick: impl FnMut(Python<'_>) -> PyResult<()>,
) -> Worked<T> {
    let stop = AtomicBool::new(false);
    let (done, mut wait) = channel::<()>();
    let mut interrupted = None;
    let result = std::thread::scope(|scope| {
        let stop = &stop;
        let thread = scope.spawn(move || {
            // The thread drops the channel when it ends, even by a panic.
            let _done = done;
            work(stop)
        });
        let mut pause = || {
            let wait = &mut wait;
            py.detach(move || wait.recv_timeout(PAUSE))
        };
        while pause() == Err(RecvTimeoutError::Timeout) {
            if let Err(why) = py.check_signals().and_then(|()| tick(py)) {
                stop.store(true, Ordering::Relaxed);
                interrupted.get_or_insert(why);
            }
        }
        thread.join()
    });
    let result = result.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
    Worked { result, interrupted }
}

/// Runs `work` as [`interruptible`] does; if the work is interrupted, returns the exception instead of the
/// result.
pub fn all_or_nothing<T: Send>(py: Python<'_>, work: impl FnOnce(&AtomicBool) -> T + Send) -> PyResult<T> {
    let Worked { result, interrupted } = interruptible(py, work, |_| Ok(()));
    interrupted.map_or(Ok(result), Err)
}
