//! Arguments of `sweep` and `search` about workers that share the work, and about batch systems.

use clap::{Args, ValueEnum};

/// Batch system that runs the combinations of a sweep or the islands of a search.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BatchEngine {
    Slurm,
}

/// Number of combinations or islands of one task.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ChunkSize {
    /// Number of combinations or islands that take about a minute.
    #[default]
    Auto,
    Combinations(usize),
}

#[derive(Args, Default)]
pub struct EngineFlags {
    /// Let other workers take over the combinations (sweep) or islands (search) of this worker if it gives no
    /// sign of life (heartbeat) for this many seconds
    #[arg(
        long,
        value_name = "LEASE",
        default_value_t = 60,
        value_parser = clap::value_parser!(u16).range(1..=3600),
        requires = "shared"
    )]
    pub lease: u16,
    /// Submit the combinations (sweep) or islands (search) to this batch system, wait for them, and write the
    /// result
    #[arg(long, value_name = "ENGINE")]
    pub on: Option<BatchEngine>,
    /// Partition of the cluster [default: the partition that the cluster chooses]
    #[arg(long, value_name = "NAME", value_parser = partition, requires = "on")]
    pub partition: Option<String>,
    /// Number of cores per task; a task processes this many combinations (sweep) or islands (search) in
    /// parallel
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024), requires = "on")]
    pub cpus: u16,
    /// Number of combinations (sweep) or islands (search) per task; auto measures their time, and makes tasks
    /// of about a minute
    #[arg(long, value_name = "CHUNK", default_value = "auto", value_parser = chunk, requires = "on")]
    pub chunk: ChunkSize,
    /// Largest number of tasks of an array job
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(1..=1_000_000), requires = "on")]
    pub max_array: u32,
    /// Write the plan and the script of the job, show the script, and submit nothing
    #[arg(long, requires = "on")]
    pub dry_run: bool,
}

fn partition(text: &str) -> Result<String, String> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.,".contains(c);
    if !text.is_empty() && text.chars().all(is_plain) {
        Ok(text.into())
    } else {
        Err("the name of a partition may contain only letters, digits and the characters '_', '-', '.' and ','".into())
    }
}

/// Parses a time limit in the notation of Slurm.
pub fn slurm_time(text: &str) -> Result<String, String> {
    let is_time = |c: char| c.is_ascii_digit() || ":-".contains(c);
    if text.starts_with(|c: char| c.is_ascii_digit()) && text.chars().all(is_time) {
        Ok(text.into())
    } else {
        Err("expected minutes, or a time such as 2:00:00 (2 hours) or 1-12 (1 day and 12 hours)".into())
    }
}

fn chunk(text: &str) -> Result<ChunkSize, String> {
    match text.parse() {
        _ if text == "auto" => Ok(ChunkSize::Auto),
        Ok(count) if count > 0 => Ok(ChunkSize::Combinations(count)),
        _ => Err("expected auto, or a whole number of at least 1".into()),
    }
}
