//! The file from which a stopped search goes on.
//!
//! Two lines of JSON: what it is, with the hash of the second; then the command, the hashes of the
//! inputs and the state. A file whose hash is wrong is never trusted.

use super::arguments::{Arguments, Command, SearchArguments};
use super::loading::CHECKPOINT;
use super::output::path_word;
use super::{Exit, loading, output};
use crate::files::{Source, shown};
use crate::layout::Workcell;
use crate::search;
use crate::search::{Moment, SearchEnd, SearchRecord, SearchSpace, Stopping, Unfit};
use clap::Parser;
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
    command: Vec<String>,
    inputs: Vec<Input>,
    state: S,
}

/// Writes checkpoints when they are due.
pub struct Keeper {
    path: PathBuf,
    command: Vec<String>,
    inputs: Vec<Input>,
    period: Duration,
    /// When one was written last, or why that failed.
    last: Mutex<Result<Instant, Exit>>,
}

impl Keeper {
    pub fn new(folder: &Path, command: &[String], inputs: Vec<Input>, seconds: f64) -> Self {
        // No period is one that never ends.
        let period = if seconds > 0.0 { Duration::from_secs_f64(seconds) } else { Duration::MAX };
        let last = Mutex::new(Ok(Instant::now()));
        Self { path: folder.join(CHECKPOINT), command: command.to_vec(), inputs, period, last }
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
        let content = Content { command: self.command.clone(), inputs: self.inputs.clone(), state };
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
    /// The command that makes this folder in one go.
    pub command: Vec<String>,
    /// That command, read.
    pub arguments: SearchArguments,
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
        let words = std::iter::once("sweetspot").chain(content.command.iter().map(String::as_str));
        let Ok(Arguments { command: Command::Search(mut arguments) }) = Arguments::try_parse_from(words)
        else {
            return Err(refused(&path, 2, "its command is no search"));
        };
        refuse_changes(&arguments, asked)?;
        let command = taken_up(&mut arguments, asked, content.command.clone());
        loading::sweep(folder);
        Ok(Self { folder: folder.to_path_buf(), command, arguments, content })
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

/// The command and the inputs with which the search of a folder began.
pub fn begun(folder: &Path) -> Result<(Vec<String>, Vec<Input>), Exit> {
    let path = folder.join(CHECKPOINT);
    let bytes = std::fs::read(&path).map_err(|e| {
        output::error(&format!("cannot read {}: {e}", path_word(&path)));
        Exit::Io
    })?;
    let content = understood(&bytes).map_err(|(line, why)| refused(&path, line, &why))?;
    Ok((content.command, content.inputs))
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

/// Options say the same as when the search began, or nothing.
fn refuse_changes(then: &SearchArguments, asked: &SearchArguments) -> Result<(), Exit> {
    let options = |a: &SearchArguments| {
        let (o, c) = (&a.question, &a.question.errors);
        [
            ("errors", c.errors.clone()),
            ("model", c.model.clone()),
            ("sense", c.sense.clone()),
            ("limit", c.limit.map(|limit| limit.to_string())),
            ("reading", o.reading.clone()),
            ("quantity", o.quantity.clone()),
            ("registration", o.registration.clone()),
            ("seed", a.seed.map(|seed| seed.to_string())),
            ("solver", a.solver.clone()),
            ("robust", a.robust.then(|| "given".to_string())),
            ("pareto", a.pareto.as_ref().map(|goals| goals.join(","))),
            ("keep", a.keep.map(|keep| keep.to_string())),
        ]
    };
    let mut changed = false;
    for ((name, was), (_, is)) in options(then).into_iter().zip(options(asked)) {
        if is.is_some() && is != was {
            let word = |value: Option<String>| value.map_or("not given".into(), |v| output::word(&v));
            output::error(&format!(
                "--{name} was {} when the search began, now it is {}",
                word(was),
                word(is)
            ));
            changed = true;
        }
    }
    if changed {
        output::talk("  help: leave it out to resume, or start another search in a folder of its own");
    }
    if changed { Err(Exit::BadInput) } else { Ok(()) }
}

/// Takes up what may be said anew, and the command that says so in one go.
fn taken_up(then: &mut SearchArguments, asked: &SearchArguments, mut command: Vec<String>) -> Vec<String> {
    // The cell may be reached by another path: its content decides.
    then.cell = asked.cell.clone().or(then.cell.take());
    if !asked.packages.folders.is_empty() {
        then.packages = asked.packages.clone();
    }
    let (rules, new) = (&mut then.rules, &asked.rules);
    if new.budget.is_some() && new.budget != rules.budget {
        rules.budget = new.budget;
        restate(&mut command, "--budget", new.budget.map(|n| n.to_string()));
    }
    if new.gap.is_some() && new.gap != rules.gap {
        rules.gap = new.gap;
        restate(&mut command, "--gap", new.gap.map(|g| g.to_string()));
    }
    if new.stagnation.is_some() && new.stagnation != rules.stagnation {
        rules.stagnation = new.stagnation;
        restate(&mut command, "--stagnation", new.stagnation.map(|n| n.to_string()));
    }
    command
}

/// Puts another value to an option of a command.
fn restate(command: &mut Vec<String>, option: &str, value: Option<String>) {
    let joined = format!("{option}=");
    if let Some(at) = command.iter().position(|word| word == option) {
        command.drain(at..(at + 2).min(command.len()));
    }
    command.retain(|word| !word.starts_with(&joined));
    command.extend(value.into_iter().flat_map(|value| [option.to_string(), value]));
}
