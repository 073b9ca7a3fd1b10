//! Checkpoint file from which a stopped search resumes.
//!
//! The file has two lines of JSON. Line 1 contains the schema, the version and the hash of line 2. Line 2
//! contains the request of the search, the hashes of the inputs and the state of the search. A file whose
//! hash does not match is refused.

use super::arguments::SearchArguments;
use super::loading::CHECKPOINT;
use super::output::path_word;
use super::output_folder::{OutputFolder, Sharing};
use super::search_request::SearchRequest;
use super::{Exit, loading, output};
use crate::cli::mutex::locked;
use crate::files::{Source, shown};
use crate::layout::Workcell;
use crate::search;
use crate::search::{Moment, SearchEnd, SearchRecord, SearchSpace, Stopping, Unfit};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::{Duration, Instant};

const SCHEMA: &str = "sweetspot/checkpoint/1";

#[derive(Serialize, Deserialize)]
struct CheckpointHeader {
    schema: String,
    version: String,
    /// Hash of the second line.
    sha256: String,
}

/// Path of an input file, as the cell file states it, and the SHA-256 hash of the input file.
pub type InputHash = (String, String);

pub fn inputs(sources: &[Source]) -> Vec<InputHash> {
    sources.iter().map(|s| (s.path.clone(), loading::sha256(&s.bytes))).collect()
}

#[derive(Serialize, Deserialize)]
struct CheckpointContent<S> {
    request: SearchRequest,
    inputs: Vec<InputHash>,
    state: S,
}

/// Writer of periodic checkpoints.
pub struct CheckpointWriter {
    path: PathBuf,
    request: SearchRequest,
    inputs: Vec<InputHash>,
    period: Duration,
    /// Time of the last checkpoint, or the exit code if a checkpoint could not be written.
    last: Mutex<Result<Instant, Exit>>,
}

impl CheckpointWriter {
    pub fn new(folder: &Path, request: &SearchRequest, inputs: Vec<InputHash>, seconds: f64) -> Self {
        // If the period is 0, no checkpoint is due while the search runs.
        let period = if seconds > 0.0 { Duration::from_secs_f64(seconds) } else { Duration::MAX };
        let last = Mutex::new(Ok(Instant::now()));
        Self { path: folder.join(CHECKPOINT), request: request.clone(), inputs, period, last }
    }

    /// Writes the state if a checkpoint is due. Returns false if this write or an earlier one failed.
    pub fn keep(&self, state: &search::Checkpoint, moment: Moment) -> bool {
        let mut last = locked(&self.last);
        if last.is_ok_and(|at| moment != Moment::Going || at.elapsed() >= self.period) {
            *last = self.write(state).map(|()| Instant::now());
        }
        last.is_ok()
    }

    fn write(&self, state: &search::Checkpoint) -> Result<(), Exit> {
        let content = CheckpointContent { request: self.request.clone(), inputs: self.inputs.clone(), state };
        let content = super::json_text::line(&content)?;
        let version = env!("CARGO_PKG_VERSION").into();
        let header =
            CheckpointHeader { schema: SCHEMA.into(), version, sha256: loading::sha256(content.as_bytes()) };
        loading::write_whole(&self.path, (super::json_text::line(&header)? + &content).as_bytes())
    }

    /// Fails if a checkpoint could not be written, or if the resumed search did not repeat the steps of the
    /// stopped search. Prints the reason.
    pub fn verdict(&self, record: &SearchRecord) -> Result<(), Exit> {
        let last = *locked(&self.last);
        let folder = path_word(self.path.parent().unwrap_or(Path::new(".")));
        if let Err(exit) = last {
            if self.path.is_file() {
                output::talk(&format!(
                    "  help: the previous checkpoint is intact; free some disk space, then run \
                     sweetspot search --resume {folder}"
                ));
            }
            return Err(exit);
        }
        if record.ended == SearchEnd::Diverged {
            output::error(&format!(
                "{}: this program does not reproduce the steps of the search: \
                 the checkpoint is from another build or machine",
                path_word(&self.path)
            ));
            output::talk(
                "  help: resume with the build and on the machine that wrote the checkpoint, or start again in \
                 another folder with --out",
            );
            return Err(Exit::BadInput);
        }
        Ok(())
    }

    /// Removes the checkpoint of a finished search.
    pub fn remove(&self) -> Result<(), Exit> {
        match std::fs::remove_file(&self.path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                output::error(&format!("cannot remove {}: {e}", path_word(&self.path)));
                Err(Exit::Io)
            }
            _ => Ok(()),
        }
    }
}

/// Stopped search, as read from its checkpoint.
pub struct StoppedSearch {
    pub folder: OutputFolder,
    /// Request of the search, with the stopping rules of the current command line.
    pub request: SearchRequest,
    content: CheckpointContent<search::Checkpoint>,
}

impl StoppedSearch {
    /// Locks a folder, reads its checkpoint and applies the stopping rules of the command line `asked`.
    pub fn read(folder: &Path, asked: &SearchArguments) -> Result<Self, Exit> {
        let path = folder.join(CHECKPOINT);
        if !path.is_file() {
            let folder = path_word(folder);
            output::error(&format!("{folder} has no {CHECKPOINT}: there is nothing to resume"));
            output::talk(
                "  help: a finished search has no checkpoint; start a new search with sweetspot search CELL",
            );
            return Err(Exit::BadInput);
        }
        let folder = OutputFolder::existing(folder, Sharing::Alone)?;
        let bytes = stored(&folder)?;
        let content = understood(&bytes).map_err(|(line, why)| refused(&path, line, &why))?;
        let request = content.request.clone().resumed(asked)?;
        loading::sweep(&folder);
        Ok(Self { folder, request, content })
    }

    pub fn state(&self) -> &search::Checkpoint {
        &self.content.state
    }

    pub fn evaluations(&self) -> u64 {
        self.content.state.evaluations()
    }

    /// Refuses to resume with changed inputs, or with settings that do not fit the state of the stopped
    /// search.
    pub fn check(&self, inputs: &[InputHash], workcell: &Workcell, bound: Option<f64>) -> Result<(), Exit> {
        let changes = changes(&self.content.inputs, inputs);
        changes.iter().for_each(|change| output::error(change));
        if !changes.is_empty() {
            output::talk(
                "  help: restore the inputs with which the search began, or start again in another folder with --out",
            );
            return Err(Exit::BadInput);
        }
        let rules = Stopping::new(&workcell.cell.search, bound);
        let fit = self.content.state.check(SearchSpace::new(&workcell.cell).dimensions(), &rules);
        fit.map_err(|unfit| {
            let why = match unfit {
                Unfit::Dimensions { has, needs } => format!(
                    "the checkpoint has {has} search variables, \
                but the cell has {needs}"
                ),
                Unfit::Budget { used } => format!(
                    "{used} layouts have been evaluated already, more than \
                --budget"
                ),
                Unfit::Kept => "the stopped search had other goals, or kept another number of layouts".into(),
                Unfit::Ended(ended) => {
                    format!("these stopping rules would have ended the search earlier: {}", ended.in_words())
                }
            };
            output::error(&format!("{}: {why}", path_word(&self.folder)));
            output::talk(
                "  help: resume with the stopping rules with which the search began, or start again in \
                another folder with --out",
            );
            Exit::BadInput
        })
    }
}

/// Returns the original request and inputs of the search in a folder.
pub fn begun(folder: &Path) -> Result<(SearchRequest, Vec<InputHash>), Exit> {
    let path = folder.join(CHECKPOINT);
    let content = understood(&stored(folder)?).map_err(|(line, why)| refused(&path, line, &why))?;
    Ok((content.request, content.inputs))
}

/// Reads the bytes of the checkpoint of a folder.
fn stored(folder: &Path) -> Result<Vec<u8>, Exit> {
    loading::read_inside(folder, CHECKPOINT, "the search").map_err(|why| {
        output::error(&format!("cannot read {}: {why}", path_word(&folder.join(CHECKPOINT))));
        Exit::Io
    })
}

fn refused(path: &Path, line: usize, why: &str) -> Exit {
    output::error(&format!("{}:{line}: {why}", path_word(path)));
    output::talk("  help: the search cannot be resumed: start again in another folder with --out");
    Exit::BadInput
}

/// Returns the number of layouts evaluated before a checkpoint, given the bytes of the checkpoint file.
///
/// # Errors
/// Returns the number of the faulty line, and the reason why the file cannot be used.
pub fn evaluations_of_checkpoint(bytes: &[u8]) -> Result<u64, (usize, String)> {
    understood(bytes).map(|content| content.state.evaluations())
}

/// Parses a checkpoint. Returns the line number and the fault if the file cannot be used.
fn understood(bytes: &[u8]) -> Result<CheckpointContent<search::Checkpoint>, (usize, String)> {
    let split = bytes.iter().position(|&b| b == b'\n').map_or(bytes.len(), |end| end + 1);
    let (first, second) = bytes.split_at(split);
    let header: CheckpointHeader = serde_json::from_slice(first)
        .map_err(|_| (1, "this is not a checkpoint, or it is damaged".to_string()))?;
    if header.schema != SCHEMA {
        return Err((1, format!("the schema is {}, but this program reads {SCHEMA}", shown(&header.schema))));
    }
    if header.version != env!("CARGO_PKG_VERSION") {
        let (theirs, ours) = (shown(&header.version), env!("CARGO_PKG_VERSION"));
        return Err((
            1,
            format!(
                "it was written by sweetspot {theirs}, but this program is sweetspot {ours}: \
                 the steps of the search may differ"
            ),
        ));
    }
    if loading::sha256(second) != header.sha256 {
        return Err((2, "the checkpoint is damaged: its hash is not the one in line 1".into()));
    }
    serde_json::from_slice(second).map_err(|e| (2, format!("the checkpoint cannot be read: {e}")))
}

/// Returns one message for each input that has changed since the search began.
fn changes(then: &[InputHash], now: &[InputHash]) -> Vec<String> {
    let mut said = Vec::new();
    for (path, hash) in then {
        let found = now.iter().find(|(p, _)| p == path);
        let path = shown(path);
        match found {
            Some((_, same)) if same == hash => {}
            Some(_) => said.push(format!("{path} has changed since the search began")),
            None => said.push(format!("{path} is no longer read, but the search began with it")),
        }
    }
    let new = now.iter().filter(|(path, _)| !then.iter().any(|(p, _)| p == path));
    said.extend(new.map(|(path, _)| format!("{} is read now, but the search began without it", shown(path))));
    said
}
