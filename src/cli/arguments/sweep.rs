//! Arguments of `sweep`.

use super::engine::{EngineFlags, slurm_time};
use super::index_ranges::IndexRanges;
use super::question::word;
use super::search::whole;
use crate::cell::Solver;
use crate::cli::packages::PackageFolders;
use crate::files::Setting;
use clap::builder::PossibleValuesParser;
use clap::{ArgGroup, Args};
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(group = ArgGroup::new("shared").args(["claim", "on"]))]
pub struct SweepArguments {
    /// Cell file (TOML)
    #[arg(required_unless_present_any = ["resume", "claim", "status"], conflicts_with_all = ["resume", "status"])]
    pub cell: Option<PathBuf>,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Set a key of the cell file to each of these values; can be given several times. Text needs no quotes,
    /// and commas inside brackets do not separate values
    #[arg(
        long = "set",
        value_name = "PATH=A,B,...",
        required_unless_present_any = ["resume", "claim", "status"],
        conflicts_with_all = ["resume", "status"],
        requires = "cell"
    )]
    pub sets: Vec<String>,
    /// Instead of searching, map the layout as drawn for every combination
    #[arg(long, conflicts_with = "resume", requires = "cell")]
    pub map: bool,
    /// Seed of all random numbers of every combination [default: the seed of the cell]
    #[arg(long, conflicts_with = "resume", requires = "cell")]
    pub seed: Option<u64>,
    /// Number of layout evaluations per combination
    #[arg(long, value_name = "N", conflicts_with = "resume", requires = "cell")]
    pub budget: Option<u64>,
    /// Global solver
    #[arg(
        long,
        value_parser = PossibleValuesParser::new(Solver::ALL.map(Solver::name)),
        conflicts_with = "resume",
        requires = "cell"
    )]
    pub solver: Option<String>,
    /// Number of combinations to process in parallel; the result does not depend on it [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with = "on")]
    pub jobs: Option<u16>,
    /// Write to this folder, which must be new or belong to this sweep; a sweep that has begun is resumed
    /// [default: results/CELL-NNN]
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    pub out: Option<PathBuf>,
    /// Resume the sweep in this folder
    #[arg(long, value_name = "DIR")]
    pub resume: Option<PathBuf>,
    /// Process only these combinations (numbered from 0), for example 0-9,17; a later run with --resume
    /// writes the table
    #[arg(long, value_name = "INDICES", value_parser = IndexRanges::parse, conflicts_with = "on")]
    pub only: Option<IndexRanges>,
    /// Write the plan and its inputs to --out and process nothing, so that workers can begin with --claim
    #[arg(long, requires = "out", conflicts_with_all = ["only", "claim", "on", "json"])]
    pub plan_only: bool,
    /// Process the sweep in this folder as one of several workers (running copies of sweetspot); CELL and
    /// --set are needed only if the folder has no plan yet
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "resume"])]
    pub claim: Option<PathBuf>,
    #[command(flatten)]
    pub engine: EngineFlags,
    /// Time limit of a task in the notation of Slurm, for example 30 (minutes), 2:00:00 (2 hours) or 1-12
    /// (1 day and 12 hours) [default: the limit of the partition]
    #[arg(long, value_name = "TIME", value_parser = slurm_time, requires = "on")]
    pub time: Option<String>,
    /// Show the state of the sweep in this folder: which combinations are done, running (and where) or
    /// failed, and the time left
    #[arg(long, value_name = "DIR", conflicts_with_all = ["out", "resume", "claim", "only", "on", "jobs"])]
    pub status: Option<PathBuf>,
    /// Print the table, or the status, as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

impl SweepArguments {
    /// Returns the folder of the sweep, if the command line names it.
    pub fn folder(&self) -> Option<&Path> {
        [&self.resume, &self.claim, &self.out].into_iter().flatten().next().map(PathBuf::as_path)
    }
}

/// Returns the settings that apply to every combination of a sweep.
pub fn common_settings(seed: Option<u64>, budget: Option<u64>, solver: Option<&String>) -> Vec<Setting> {
    let seed = whole("seed", "search.seed", seed);
    let budget = whole("budget", "search.budget", budget);
    seed.into_iter().chain(budget).chain(word("solver", "search.solver", solver)).collect()
}
