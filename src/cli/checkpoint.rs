//! The file from which a stopped search goes on.
//!
//! Two lines of JSON: what it is, with the hash of the second; then the command, the hashes of the
//! inputs and the state. A file whose hash is wrong is never trusted.

use super::arguments::SearchArguments;
use super::loading::CHECKPOINT;
use super::output::path_word;
use super::search_request::SearchRequest;
use super::{Exit, loading, output};
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
struct Header {
    schema: String,
    version: String,
    /// Of the second line.
    sha256: String,
}

/// A file that was read: its path as the cell names it, and its hash.
pub type Input = (String, String);

pub fn inputs(sources: &[Source]) -> Vec<Input> {
    sources.iter().map(|s| (s.path.clone(), loading::sha256(&s.bytes))).collect()
}

#[derive(Serialize, Deserialize)]
struct Content<S> {
    request: SearchRequest,
    inputs: Vec<Input>,
    state: S,
}

/// Writes checkpoints when they are due.
pub struct Keeper {
    path: PathBuf,
    request: SearchRequest,
    inputs: Vec<Input>,
    period: Duration,
    /// When one was written last, or why that failed.
    last: Mutex<Result<Instant, Exit>>,
}

impl Keeper {
    pub fn new(folder: &Path, request: &SearchRequest, inputs: Vec<Input>, seconds: f64) -> Self {
        // No period is one that never ends.
        let period = if seconds > 0.0 { Duration::from_secs_f64(seconds) } else { Duration::MAX };
        let last = Mutex::new(Ok(Instant::now()));
        Self { path: folder.join(CHECKPOINT), request: request.clone(), inputs, period, last }
    }

    /// Writes the state if it is time to; false if that failed, now or before.
    pub fn keep(&self, state: &search::Checkpoint, moment: Moment) -> bool {
        let mut last = self.last.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        if last.is_ok_and(|at| moment != Moment::Going || at.elapsed() >= self.period) {
            *last = self.write(state).map(|()| Instant::now());
        }
        last.is_ok()
    }

    fn write(&self, state: &search::Checkpoint) -> Result<(), Exit> {
        let content = Content { request: self.request.clone(), inputs: self.inputs.clone(), state };
        let content = super::results::line(&content)?;
        let version = env!("CARGO_PKG_VERSION").into();
        let header = Header { schema: SCHEMA.into(), version, sha256: loading::sha256(content.as_bytes()) };
        loading::write_whole(&self.path, (super::results::line(&header)? + &content).as_bytes())
    }

    /// Says what keeps the search from having a result.
    pub fn verdict(&self, record: &SearchRecord) -> Result<(), Exit> {
        let last = *self.last.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let folder = path_word(self.path.parent().unwrap_or(Path::new(".")));
        if let Err(exit) = last {
            if self.path.is_file() {
                output::talk(&format!(
                    "  help: the checkpoint before it stands; make room, then sweetspot search --resume {folder}"
                ));
            }
            return Err(exit);
        }
        if record.ended == SearchEnd::Diverged {
            output::error(&format!(
                "{}: this program does not meet its own steps again: the checkpoint is of another build or machine",
                path_word(&self.path)
            ));
            output::talk("  help: resume it there, or start again in another folder with --out");
            return Err(Exit::BadInput);
        }
        Ok(())
    }

    /// The search has its result: there is nothing to go on with.
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

/// A checkpoint that was read, and the search it belongs to.
pub struct Kept {
    pub folder: PathBuf,
    /// The request of the search, with the stopping rules of the command line at hand.
    pub request: SearchRequest,
    content: Content<search::Checkpoint>,
}

impl Kept {
    /// Reads the checkpoint of a folder, to be resumed as `asked`.
    pub fn read(folder: &Path, asked: &SearchArguments) -> Result<Self, Exit> {
        let path = folder.join(CHECKPOINT);
        if !path.is_file() {
            let folder = path_word(folder);
            output::error(&format!("{folder} holds no {CHECKPOINT}: there is nothing to resume"));
            output::talk("  help: a search that has ended has none; start one with sweetspot search CELL");
            return Err(Exit::BadInput);
        }
        let bytes = std::fs::read(&path).map_err(|e| {
            output::error(&format!("cannot read {}: {e}", path_word(&path)));
            Exit::Io
        })?;
        let content = understood(&bytes).map_err(|(line, why)| refused(&path, line, &why))?;
        let request = content.request.clone().resumed(asked)?;
        loading::sweep(folder);
        Ok(Self { folder: folder.to_path_buf(), request, content })
    }

    pub fn state(&self) -> &search::Checkpoint {
        &self.content.state
    }

    pub fn evaluations(&self) -> u64 {
        self.content.state.evaluations()
    }

    /// Refuses to go on with other inputs or impossible rules, and says which.
    pub fn check(&self, inputs: &[Input], workcell: &Workcell, bound: Option<f64>) -> Result<(), Exit> {
        let changes = changes(&self.content.inputs, inputs);
        changes.iter().for_each(|change| output::error(change));
        if !changes.is_empty() {
            output::talk(
                "  help: put back what the search began with, or start again in another folder with --out",
            );
            return Err(Exit::BadInput);
        }
        let rules = Stopping::new(&workcell.cell.search, bound);
        let fit = self.content.state.check(SearchSpace::new(&workcell.cell).dimensions(), &rules);
        fit.map_err(|unfit| {
            let why = match unfit {
                Unfit::Dimensions { has, needs } => format!("it has {has} variables, the cell {needs}"),
                Unfit::Budget { used } => format!("{used} layouts are evaluated, more than --budget"),
                Unfit::Kept => "it was searched for other goals, or kept another number of layouts".into(),
                Unfit::Ended(ended) => {
                    format!("with these rules the search would have ended before: {}", ended.in_words())
                }
            };
            output::error(&format!("{}: {why}", path_word(&self.folder)));
            output::talk(
                "  help: resume with the rules it began with, or start again in another folder with --out",
            );
            Exit::BadInput
        })
    }
}

/// Returns the request and the inputs with which the search of a folder began.
pub fn begun(folder: &Path) -> Result<(SearchRequest, Vec<Input>), Exit> {
    let path = folder.join(CHECKPOINT);
    let bytes = std::fs::read(&path).map_err(|e| {
        output::error(&format!("cannot read {}: {e}", path_word(&path)));
        Exit::Io
    })?;
    let content = understood(&bytes).map_err(|(line, why)| refused(&path, line, &why))?;
    Ok((content.request, content.inputs))
}

fn refused(path: &Path, line: usize, why: &str) -> Exit {
    output::error(&format!("{}:{line}: {why}", path_word(path)));
    output::talk("  help: it cannot be resumed: start again in another folder with --out");
    Exit::BadInput
}

/// The content of a checkpoint, or the line and what is wrong with it.
fn understood(bytes: &[u8]) -> Result<Content<search::Checkpoint>, (usize, String)> {
    let split = bytes.iter().position(|&b| b == b'\n').map_or(bytes.len(), |end| end + 1);
    let (first, second) = bytes.split_at(split);
    let header: Header = serde_json::from_slice(first)
        .map_err(|_| (1, "this is no checkpoint, or a damaged one".to_string()))?;
    if header.schema != SCHEMA {
        return Err((1, format!("the schema is {}, this program reads {SCHEMA}", shown(&header.schema))));
    }
    if header.version != env!("CARGO_PKG_VERSION") {
        let (theirs, ours) = (shown(&header.version), env!("CARGO_PKG_VERSION"));
        return Err((1, format!("it was written by sweetspot {theirs}, this is {ours}: steps may differ")));
    }
    if loading::sha256(second) != header.sha256 {
        return Err((2, "the checkpoint is damaged: its hash is not the one in line 1".into()));
    }
    serde_json::from_slice(second).map_err(|e| (2, format!("the checkpoint cannot be read: {e}")))
}

/// What differs between the inputs then and now.
fn changes(then: &[Input], now: &[Input]) -> Vec<String> {
    let mut said = Vec::new();
    for (path, hash) in then {
        let path = shown(path);
        match now.iter().find(|(p, _)| shown(p) == path) {
            Some((_, same)) if same == hash => {}
            Some(_) => said.push(format!("{path} has changed since the search began")),
            None => said.push(format!("{path} is no longer read, the search began with it")),
        }
    }
    let new = now.iter().filter(|(path, _)| !then.iter().any(|(p, _)| p == path));
    said.extend(new.map(|(path, _)| format!("{} is read now, the search began without it", shown(path))));
    said
}
