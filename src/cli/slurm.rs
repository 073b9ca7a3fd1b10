//! The batch system Slurm: the script of an array job, its submission, and whether it is still queued.

use super::arguments::EngineFlags;
use super::output::{path_word, word};
use super::{Exit, loading, output};
use crate::files::shown;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder with the scripts, lists and logs of the jobs, inside the folder of a sweep.
pub const SLURM: &str = "slurm";

/// Array job, whose tasks process the combinations of one line of a list each.
pub struct ArrayJob {
    folder: PathBuf,
    /// Number of the submission, counted from 1.
    round: usize,
}

impl ArrayJob {
    /// Returns the job of a round of the sweep in `folder`.
    pub fn new(folder: &Path, round: usize) -> Self {
        Self { folder: folder.to_path_buf(), round }
    }

    /// Returns the last job that was prepared for a sweep.
    pub fn last(folder: &Path) -> Option<Self> {
        let rounds = (1..).map(|round| Self::new(folder, round));
        rounds.take_while(|job| job.file("sh").is_file()).last()
    }

    /// Returns the job after this one.
    pub fn next(&self) -> Self {
        Self::new(&self.folder, self.round + 1)
    }

    /// Writes the list of the combinations and the script, and returns the script.
    pub fn write(&self, chunks: &[Vec<usize>], flags: &EngineFlags, lease: u16) -> Result<String, Exit> {
        loading::make_folder(&self.folder.join(SLURM))?;
        let list: String = chunks.iter().map(|chunk| ranges(chunk) + "\n").collect();
        loading::write_whole(&self.file("txt"), list.as_bytes())?;
        let script = self.script(chunks.len(), flags, lease)?;
        loading::write_whole(&self.file("sh"), script.as_bytes())?;
        Ok(script)
    }

    fn script(&self, tasks: usize, flags: &EngineFlags, lease: u16) -> Result<String, Exit> {
        let absolute = |path: std::io::Result<PathBuf>| {
            path.map_err(|e| {
                output::error(&format!("cannot find the program or the folder: {}", loading::reason(&e)));
                Exit::Io
            })
        };
        let program = path_word(&absolute(std::env::current_exe())?);
        let folder = absolute(self.folder.canonicalize())?;
        let log = folder.join(SLURM).join(format!("round-{}-%a.log", self.round));
        let list = path_word(&folder.join(SLURM).join(format!("round-{}.txt", self.round)));
        let mut options = vec![
            "--job-name=sweetspot".to_string(),
            format!("--array=0-{}", tasks.saturating_sub(1)),
            format!("--cpus-per-task={}", flags.cpus),
            format!("--output={}", word(&log.to_string_lossy())),
        ];
        options.extend(flags.partition.as_ref().map(|partition| format!("--partition={partition}")));
        options.extend(flags.time.as_ref().map(|time| format!("--time={time}")));
        let options: String = options.iter().map(|option| format!("#SBATCH {option}\n")).collect();
        Ok(format!(
            "#!/bin/sh\n{options}\n\
             # Every line of the list holds the combinations of one task.\n\
             only=$(sed -n \"$((SLURM_ARRAY_TASK_ID + 1))p\" {list})\n\
             exec {program} sweep --claim {} --only \"$only\" --jobs {} --lease {lease}\n",
            path_word(&folder),
            flags.cpus
        ))
    }

    /// Submits the job and keeps its number in a file.
    pub fn submit(&self) -> Result<String, Exit> {
        let script = self.file("sh");
        let id = run("sbatch", Command::new("sbatch").arg("--parsable").arg(&script)).map_err(|why| {
            output::error(&format!("cannot submit {}: {why}", path_word(&script)));
            output::talk("  help: run it where sbatch works, or start workers yourself with sweep --claim");
            Exit::Io
        })?;
        // A cluster with several controllers answers NUMBER;CLUSTER.
        let id = id.trim().split(';').next().unwrap_or_default().to_string();
        loading::write_whole(&self.file("job"), id.as_bytes())?;
        Ok(id)
    }

    /// Returns the number of the job, if it was submitted.
    pub fn id(&self) -> Option<String> {
        std::fs::read_to_string(self.file("job")).ok()
    }

    pub fn script_path(&self) -> PathBuf {
        self.file("sh")
    }

    fn file(&self, extension: &str) -> PathBuf {
        self.folder.join(SLURM).join(format!("round-{}.{extension}", self.round))
    }
}

/// Returns whether a task of the job waits or runs, or why Slurm does not say so.
pub fn is_queued(id: &str) -> Result<bool, String> {
    // Slurm forgets finished jobs, so that a question about this job alone may fail.
    let list = run("squeue", Command::new("squeue").args(["--noheader", "--me", "--format=%F"]))?;
    Ok(list.split_whitespace().any(|word| word == id))
}

/// Runs a command and returns its output, or why it failed.
fn run(name: &str, command: &mut Command) -> Result<String, String> {
    let ran = command.output().map_err(|e| format!("{name}: {}", loading::reason(&e)))?;
    if ran.status.success() {
        return Ok(String::from_utf8_lossy(&ran.stdout).into_owned());
    }
    Err(format!("{name}: {}", shown(String::from_utf8_lossy(&ran.stderr).trim())))
}

/// Returns ascending indices as `--only` reads them: `0-9,17`.
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
