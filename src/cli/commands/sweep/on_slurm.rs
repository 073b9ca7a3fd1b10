//! `sweep --on slurm`: submits the combinations, waits for their files, and submits missing combinations
//! again.

use super::combination::CheckedSweep;
use super::status::state;
use super::worker::run_shared;
use crate::cli::arguments::ChunkSize;
use crate::cli::output::{counted, path_word, word};
use crate::cli::slurm::{ArrayJob, ArrayOptions, QueueState, cancel, queue_state, write_script};
use crate::cli::sweep::{StoredRow, continuing, row};
use crate::cli::{Exit, output};
use crate::record::SweepStatus;
use crate::report;
use indicatif::ProgressBar;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Number of times that missing combinations are submitted again.
const RETRIES: usize = 3;

/// Time that a task should take, s. The scheduling of a task costs about one second.
const TASK_SECONDS: f64 = 60.0;

/// Time between two checks of the files.
const LOOK: Duration = Duration::from_millis(500);

/// Shortest and longest time between two queries to Slurm; the time doubles after each query.
const ASK: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(4)];

/// Writes the script of all jobs and the task list of the next job. Prints the script, and submits nothing.
pub fn show_script(sweep: &CheckedSweep, missing: Vec<usize>, options: ArrayOptions<'_>) -> Result<(), Exit> {
    let run = ClusterRun::new(sweep, missing, options)?;
    output::data(&write_script(&sweep.folder, options, true)?)?;
    let command = ArrayJob::next(&sweep.folder)?.write(&run.chunks())?;
    let words: Vec<String> = command.iter().map(|part| word(part)).collect();
    output::talk(&format!("nothing is submitted; the job would be: {}", words.join(" ")));
    Ok(())
}

/// Submits the missing combinations and waits for their files. Repeats this at most `RETRIES` times for the
/// combinations that are still missing after the job.
///
/// Returns early if a signal stops this program; the job continues.
pub fn run_on_slurm(
    sweep: &CheckedSweep,
    missing: Vec<usize>,
    options: ArrayOptions<'_>,
) -> Result<(), Exit> {
    let mut run = ClusterRun::new(sweep, missing, options)?;
    write_script(&sweep.folder, options, false)?;
    if let Some(id) = ArrayJob::next(&sweep.folder)?.id_of_previous()
        && queue_state(&id) == Ok(QueueState::Queued)
    {
        output::talk(&format!("job {id} of an earlier command continues"));
        run.follow(&id);
    }
    for _ in 0..=RETRIES {
        if run.look() == 0 || run.is_stopped() {
            break;
        }
        let (job, chunks) = (ArrayJob::next(&sweep.folder)?, run.chunks());
        let id = job.submit(&job.write(&chunks)?)?;
        let (tasks, combinations) =
            (counted(chunks.len(), "task"), counted(run.missing.len(), "combination"));
        output::talk(&format!("submitted job {id}: {combinations} in {tasks}"));
        run.follow(&id);
    }
    run.bar.finish_and_clear();
    let status = state(&sweep.folder, sweep.plan.combinations);
    if run.is_stopped() {
        output::talk("note: the job continues; scancel ends it");
        return Ok(());
    }
    if run.missing.is_empty() {
        output::talk(report::text::sweep_status(&status).trim_end());
        return Ok(());
    }
    Err(run.refuse(&status))
}

/// Submission of a sweep to a cluster.
struct ClusterRun<'s> {
    sweep: &'s CheckedSweep,
    /// Combinations whose files are not complete.
    missing: Vec<usize>,
    /// Number of combinations that were missing at the start.
    total: usize,
    chunk: usize,
    bar: ProgressBar,
}

impl<'s> ClusterRun<'s> {
    /// Chooses the number of combinations of a task, so that all tasks fit into one array.
    fn new(sweep: &'s CheckedSweep, missing: Vec<usize>, options: ArrayOptions<'_>) -> Result<Self, Exit> {
        let flags = options.flags;
        let asked = match flags.chunk {
            ChunkSize::Combinations(count) => count,
            ChunkSize::Auto => {
                let seconds = measured(sweep, &missing, flags.lease)?;
                (TASK_SECONDS / seconds * f64::from(flags.cpus)).ceil() as usize
            }
        };
        let (total, bar) = (missing.len(), output::combinations_bar());
        let chunk = asked.max(total.div_ceil(flags.max_array as usize)).max(1);
        let mut run = Self { sweep, missing, total, chunk, bar };
        run.look();
        Ok(run)
    }

    fn chunks(&self) -> Vec<Vec<usize>> {
        self.missing.chunks(self.chunk).map(<[usize]>::to_vec).collect()
    }

    fn is_stopped(&self) -> bool {
        self.sweep.stop.load(Ordering::Relaxed)
    }

    /// Removes combinations with complete files from the list `missing`. Returns the number of combinations
    /// that are still missing.
    fn look(&mut self) -> usize {
        self.missing.retain(|index| !matches!(row(&self.sweep.folder, *index), StoredRow::Whole(_)));
        let done = (self.total - self.missing.len()) as u64;
        output::advance(&self.bar, done.saturating_sub(self.bar.position()), self.total as u64);
        self.missing.len()
    }

    /// Waits until no combination is missing, no task of the job can run any more, or a signal stops this
    /// program.
    fn follow(&mut self, id: &str) {
        let [mut pause, longest] = ASK;
        let (mut asked, mut is_told) = (Instant::now(), false);
        while self.look() > 0 && !self.is_stopped() {
            std::thread::sleep(LOOK);
            if asked.elapsed() < pause {
                continue;
            }
            (asked, pause) = (Instant::now(), (2 * pause).min(longest));
            match queue_state(id) {
                Ok(QueueState::Queued) => is_told = false,
                Ok(QueueState::Gone) => break,
                Ok(QueueState::Held) => {
                    output::talk(&format!(
                        "note: a compute node failed to start tasks of job {id}; these tasks are cancelled"
                    ));
                    if let Err(why) = cancel(id) {
                        output::talk(&format!("warning: {why}"));
                    }
                    break;
                }
                // The controller of Slurm may be down for a while; the jobs continue.
                Err(why) if !is_told => {
                    output::talk(&format!(
                        "note: Slurm does not answer, so only the files are checked: {why}"
                    ));
                    is_told = true;
                }
                Err(_) => {}
            }
        }
        self.look();
    }

    /// Reports which combinations are missing in the end, and why.
    fn refuse(&self, status: &SweepStatus) -> Exit {
        let missing = counted(self.missing.len(), "combination");
        output::error(&format!("{missing} still missing after {RETRIES} retries"));
        for index in &self.missing {
            let failed = status.failed.iter().find(|failed| failed.index == *index);
            let why = failed.map_or("no task has begun it", |failed| &failed.why);
            output::talk(&format!("  {index:04}: {why}"));
        }
        let folder = path_word(&self.sweep.folder);
        output::talk(&format!(
            "  help: the logs are in {folder}/slurm; sweetspot {} --on slurm tries again",
            continuing(&self.sweep.plan, &self.sweep.folder, "--resume")
        ));
        Exit::Limit
    }
}

/// Returns the mean time of a finished combination, s. If no combination is finished, processes one on this
/// machine.
fn measured(sweep: &CheckedSweep, missing: &[usize], lease: u16) -> Result<f64, Exit> {
    let mean = || state(&sweep.folder, sweep.plan.combinations).mean_seconds();
    let first = missing.first().copied();
    let Some(index) = first.filter(|_| mean().is_none()) else { return Ok(mean().unwrap_or(TASK_SECONDS)) };
    output::talk(&format!(
        "note: combination {index} is processed here to measure its time; --chunk N avoids this measurement"
    ));
    run_shared(sweep, vec![index], 1, lease)?;
    Ok(mean().unwrap_or(TASK_SECONDS))
}
