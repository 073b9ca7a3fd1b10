//! Checkpoint of the search of one combination of a sweep. Any worker can continue the search from this file.
//!
//! The file name begins with [`UNFINISHED`], so the file is removed together with the unfinished files of
//! killed programs. The last key of the file, `sha256`, is the hash of the text before this key. A file that
//! is damaged or does not fit the search is ignored, and the search begins again.

use super::json_text::{DAMAGED, sealed, unsealed};
use super::loading::{UNFINISHED, read_inside, replace};
use super::{output, sweep};
use crate::cli::mutex::locked;
use crate::layout::Workcell;
use crate::search::{Checkpoint, Moment, SearchSpace, Stopping};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Least time between two checkpoints. It limits the load on file servers.
const LEAST_PERIOD: Duration = Duration::from_secs(2);

/// Least time between two checkpoints, as a multiple of the time that it takes to write a checkpoint. Writing
/// thus takes at most 2 % of the run time.
const PERIOD_PER_WRITE: u32 = 50;

/// State of a search, and the proven lower bound of its objective. The stored bound saves a second proof.
#[derive(Serialize, Deserialize)]
pub struct StoredSearch<S = Checkpoint> {
    pub bound: Option<f64>,
    pub state: S,
}

/// Checkpoint of the search of one combination.
pub struct CombinationCheckpoint<'f> {
    folder: &'f Path,
    index: usize,
    /// Time at which the next checkpoint is due; None after a failed write.
    due: Mutex<Option<Instant>>,
}

impl<'f> CombinationCheckpoint<'f> {
    /// Describes the checkpoint of combination `index` in the folder of a sweep.
    pub fn new(folder: &'f Path, index: usize) -> Self {
        Self { folder, index, due: Mutex::new(Instant::now().checked_add(LEAST_PERIOD)) }
    }

    fn name(&self) -> String {
        format!("{UNFINISHED}{}.checkpoint", sweep::number(self.index))
    }

    fn path(&self) -> PathBuf {
        self.folder.join(self.name())
    }

    /// Reads the state from which the search continues. Returns None if the checkpoint is missing, damaged or
    /// from another search.
    ///
    /// `bound` is None if the caller has not proven a lower bound, and Some(None) if the proof found no
    /// bound.
    pub fn read(&self, workcell: &Workcell, bound: Option<Option<f64>>) -> Option<StoredSearch> {
        if !self.path().is_file() {
            return None;
        }
        let stored = self.stored(workcell, bound);
        match &stored {
            Ok(stored) => output::talk(&format!(
                "note: combination {} continues after {} layouts",
                self.index,
                stored.state.evaluations()
            )),
            Err(why) => self.tell_useless(why),
        }
        stored.ok()
    }

    fn stored(&self, workcell: &Workcell, bound: Option<Option<f64>>) -> Result<StoredSearch, String> {
        let bytes = read_inside(self.folder, &self.name(), "the sweep")?;
        let text = unsealed(&bytes).ok_or(DAMAGED)?;
        let mut stored: StoredSearch = serde_json::from_slice(&text).map_err(|e| e.to_string())?;
        stored.bound = bound.unwrap_or(stored.bound);
        let rules = Stopping::new(&workcell.cell.search, stored.bound);
        let fit = stored.state.check(SearchSpace::new(&workcell.cell).dimensions(), &rules);
        fit.map_err(|_| "it is from another search".to_string())?;
        Ok(stored)
    }

    /// Prints a note that the search begins again, because the checkpoint cannot be used. `why` is the
    /// reason.
    pub fn tell_useless(&self, why: &str) {
        let (index, path) = (self.index, output::path_word(&self.path()));
        output::talk(&format!(
            "note: combination {index} begins again, because {path} cannot be used: {why}"
        ));
    }

    /// Writes the state if a checkpoint is due. A checkpoint only saves time, so a failed write is ignored
    /// here. If the cause persists, the writing of the results reports it later.
    pub fn keep(&self, state: &StoredSearch<&Checkpoint>, moment: Moment) {
        let mut due = locked(&self.due);
        let now = Instant::now();
        let is_due = match moment {
            Moment::Begun => false,
            Moment::Going => due.is_some_and(|due| now >= due),
            Moment::Stopped => due.is_some(),
        };
        if is_due {
            let written = sealed(state).is_ok_and(|bytes| replace(&self.path(), &bytes).is_ok());
            let period = LEAST_PERIOD.max(now.elapsed() * PERIOD_PER_WRITE);
            *due = Instant::now().checked_add(period).filter(|_| written);
        }
    }

    /// Removes the checkpoint of a finished combination.
    pub fn remove(&self) {
        let _ = std::fs::remove_file(self.path());
    }
}
