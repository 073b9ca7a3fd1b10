//! The batch system Slurm: script and lists of array jobs, their submission, and their state in the
//! queue.

use super::arguments::EngineFlags;
use super::output::path_word;
use super::{Exit, loading, output};
use crate::files::shown;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder with the scripts, lists and logs of the jobs, inside the folder of a sweep.
pub const SLURM: &str = "slurm";

/// Name of the script of all jobs of a sweep.
const SCRIPT: &str = "job.sh";

/// Options of the array jobs of a sweep.
#[derive(Clone, Copy)]
pub struct ArrayOptions<'a> {
    pub flags: &'a EngineFlags,
    /// Time limit of a task in the notation of Slurm.
    pub time: Option<&'a str>,
}

/// Returns the script of all jobs of a sweep. The argument of the script is the path of the list of an
/// [`ArrayJob`].
fn script(folder: &Path, options: ArrayOptions<'_>) -> Result<String, Exit> {
    let ArrayOptions { flags, time } = options;
    let EngineFlags { cpus, lease, .. } = flags;
    let mut options = vec!["--job-name=sweetspot".to_string(), format!("--cpus-per-task={cpus}")];
    options.extend(flags.partition.as_ref().map(|partition| format!("--partition={partition}")));
    options.extend(time.map(|time| format!("--time={time}")));
    let options: String = options.iter().map(|option| format!("#SBATCH {option}\n")).collect();
    let (program, folder) = (path_word(&absolute(std::env::current_exe())?), path_word(folder));
    Ok(format!(
        "#!/bin/sh\n{options}\n\
         # Each line of the list \"$1\" holds the combinations of one task.\n\
         only=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" \"$1\")\n\
         exec {program} sweep --claim {folder} --only \"$only\" --jobs {cpus} --lease {lease}\n"
    ))
}

/// Writes the script of a sweep and returns it. If `anew` is false, keeps an existing script, which the user
/// may have edited.
pub fn write_script(folder: &Path, options: ArrayOptions<'_>, anew: bool) -> Result<String, Exit> {
    let folder = absolute(folder.canonicalize())?.join(SLURM);
    loading::make_folder(&folder)?;
    let path = folder.join(SCRIPT);
    let script = script(folder.parent().unwrap_or(&folder), options)?;
    match std::fs::read_to_string(&path) {
        Ok(kept) if !anew => {
            if kept != script {
                let path = path_word(&path);
                output::talk(&format!(
                    "note: {path} is kept; remove it to have it written again from the options"
                ));
            }
            Ok(kept)
        }
        _ => loading::write_whole(&path, script.as_bytes()).map(|()| script),
    }
}

/// Array job. Each of its tasks processes the combinations of one line of a list.
pub struct ArrayJob {
    /// Absolute path of the folder of the job.
    folder: PathBuf,
    /// Number of the submission, counted from 1.
    round: usize,
}

impl ArrayJob {
    /// Returns the next job to submit for the sweep in `folder`.
    pub fn next(folder: &Path) -> Result<Self, Exit> {
        let folder = absolute(folder.canonicalize())?.join(SLURM);
        let round = (1..).find(|round| Self { folder: folder.clone(), round: *round }.id().is_none());
        Ok(Self { folder, round: round.unwrap_or(1) })
    }

    /// Returns the number that Slurm gave to the previous job; None if no job has been submitted.
    pub fn id_of_previous(&self) -> Option<String> {
        Self { folder: self.folder.clone(), round: self.round.checked_sub(1)? }.id()
    }

    /// Writes the list of the combinations of each task, and returns the command that submits the job.
    pub fn write(&self, chunks: &[Vec<usize>]) -> Result<Vec<String>, Exit> {
        let list: String = chunks.iter().map(|chunk| ranges(chunk) + "\n").collect();
        loading::write_whole(&self.file("txt"), list.as_bytes())?;
        let text = |path: PathBuf| path.to_string_lossy().into_owned();
        Ok(vec![
            "sbatch".into(),
            "--parsable".into(),
            format!("--array=0-{}", chunks.len().saturating_sub(1)),
            format!("--output={}", text(self.folder.join(format!("round-{}-%a.log", self.round)))),
            text(self.folder.join(SCRIPT)),
            text(self.file("txt")),
        ])
    }

    /// Submits the job. Stores and returns the number that Slurm gives to the job.
    pub fn submit(&self, command: &[String]) -> Result<String, Exit> {
        let id = run(command).map_err(|why| {
            output::error(&format!("cannot submit a job: {why}"));
            output::talk(
                "  help: run this command where sbatch works, or start workers yourself with \
            sweep --claim",
            );
            Exit::Io
        })?;
        // sbatch prints NUMBER;CLUSTER if it submits to a named cluster.
        let id = id.trim().split(';').next().unwrap_or_default().to_string();
        loading::write_whole(&self.file("job"), id.as_bytes())?;
        Ok(id)
    }

    fn id(&self) -> Option<String> {
        std::fs::read_to_string(self.file("job")).ok()
    }

    fn file(&self, extension: &str) -> PathBuf {
        self.folder.join(format!("round-{}.{extension}", self.round))
    }
}

fn absolute(path: std::io::Result<PathBuf>) -> Result<PathBuf, Exit> {
    path.map_err(|e| {
        output::error(&format!("cannot find the program or the folder: {}", loading::reason(&e)));
        Exit::Io
    })
}

/// State of the tasks of a job in the queue of Slurm.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum QueueState {
    /// A task waits or runs.
    Queued,
    /// Slurm has put all remaining tasks on hold, because a node failed to start them. They do not run unless
    /// a user releases them.
    Held,
    Gone,
}

/// Asks Slurm for the state of a job. Fails with the reason if Slurm does not answer.
pub fn queue_state(id: &str) -> Result<QueueState, String> {
    // Slurm forgets finished jobs, so a query for this job alone may fail.
    let list = run(&["squeue", "--noheader", "--me", "--format=%F %r"].map(String::from))?;
    let tasks = list.lines().filter_map(|line| line.trim().split_once(' ')).filter(|(job, _)| *job == id);
    let is_held: Vec<bool> = tasks.map(|(_, reason)| reason.contains("launch failed")).collect();
    Ok(match is_held.contains(&false) {
        true => QueueState::Queued,
        false if is_held.is_empty() => QueueState::Gone,
        false => QueueState::Held,
    })
}

/// Removes a job from the queue.
pub fn cancel(id: &str) -> Result<(), String> {
    run(&["scancel", id].map(String::from)).map(drop)
}

/// Runs a command and returns its output. Fails with the reason if the command fails.
fn run(words: &[String]) -> Result<String, String> {
    let Some((name, arguments)) = words.split_first() else { return Ok(String::new()) };
    let ran = Command::new(name).args(arguments).output();
    let ran = ran.map_err(|e| format!("{name}: {}", loading::reason(&e)))?;
    if ran.status.success() {
        return Ok(String::from_utf8_lossy(&ran.stdout).into_owned());
    }
    Err(format!("{name}: {}", shown(String::from_utf8_lossy(&ran.stderr).trim())))
}

/// Returns ascending indices in the notation of `--only`, such as `0-9,17`.
fn ranges(indices: &[usize]) -> String {
    let runs = indices.chunk_by(|a, b| a + 1 == *b);
    let words: Vec<String> = runs
        .filter_map(|run| match (run.first()?, run.last()?) {
            (first, last) if first == last => Some(first.to_string()),
            (first, last) => Some(format!("{first}-{last}")),
        })
        .collect();
    words.join(",")
}
