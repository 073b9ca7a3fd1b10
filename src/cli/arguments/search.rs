//! Arguments of `search`.

use super::engine::{EngineFlags, slurm_time};
use super::question::{QuestionFlags, toml_number, typed, word};
use super::value_parsers::{number, seconds};
use crate::cell::{Goal, Solver};
use crate::cli::packages::PackageFolders;
use crate::files::{Setting, toml_string};
use clap::builder::PossibleValuesParser;
use clap::{ArgGroup, Args};
use std::path::{Path, PathBuf};

/// Largest number of islands of one search.
const MAX_ISLANDS: i64 = 10_000;

#[derive(Args, Default)]
#[command(group = ArgGroup::new("shared").args(["claim", "on"]))]
pub struct SearchArguments {
    /// Cell file (TOML)
    #[arg(required_unless_present_any = ["resume", "claim"])]
    pub cell: Option<PathBuf>,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Seed of all random numbers; the same seed gives the same files, byte for byte
    #[arg(long)]
    pub seed: Option<u64>,
    /// Assume that everything is placed exactly, and ignore placement tolerances. A clearance or a margin
    /// that the cell file does not state is then 0
    #[arg(long)]
    pub ideal: bool,
    /// Minimize a proven upper bound of the error at all misplacements within the placement tolerances,
    /// instead of the error at the exact placements
    #[arg(long)]
    pub robust: bool,
    /// Find the Pareto front of two or more goals: error, clearance, joint-limits, singularity, travel,
    /// footprint, time, cost
    #[arg(
        long,
        value_name = "GOAL,GOAL,...",
        value_delimiter = ',',
        hide_possible_values = true,
        value_parser = PossibleValuesParser::new(Goal::ALL.map(Goal::name))
    )]
    pub pareto: Option<Vec<String>>,
    /// Number of clearly different layouts to keep, the best first; with --pareto, number of layouts of the
    /// front
    #[arg(long, value_name = "N")]
    pub keep: Option<u64>,
    /// Global solver
    #[arg(long, value_parser = PossibleValuesParser::new(Solver::ALL.map(Solver::name)))]
    pub solver: Option<String>,
    #[command(flatten)]
    pub rules: StoppingFlags,
    /// Run N searches (islands) with successive seeds, each with the whole budget, and merge their results.
    /// If the command is repeated with the same folder, it processes only the missing islands
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u16).range(1..=MAX_ISLANDS),
        requires = "cell",
        conflicts_with_all = ["resume", "time", "checkpoint", "progress"]
    )]
    pub islands: Option<u16>,
    /// Process the islands in this folder as one of several workers (running copies of sweetspot); CELL and
    /// --islands are needed only if the folder has no plan yet
    #[arg(
        long,
        value_name = "DIR",
        conflicts_with_all = ["out", "resume", "time", "checkpoint", "progress"]
    )]
    pub claim: Option<PathBuf>,
    #[command(flatten)]
    pub engine: EngineFlags,
    /// Time limit of a task in the notation of Slurm, for example 30 (minutes), 2:00:00 (2 hours) or 1-12
    /// (1 day and 12 hours) [default: the limit of the partition]
    #[arg(long, value_name = "TIME", value_parser = slurm_time, requires = "on")]
    pub task_time: Option<String>,
    /// Number of threads; the result does not depend on it [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024), conflicts_with = "on")]
    pub threads: Option<u16>,
    /// Write the result to this new folder; with --islands, the folder may already contain islands of this
    /// search [default: results/CELL-NNN]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Resume the search or the islands that were stopped in this folder
    #[arg(long, value_name = "DIR", conflicts_with = "out")]
    pub resume: Option<PathBuf>,
    /// Seconds between checkpoints; with 0, a checkpoint is written only at the start and when the search is
    /// stopped
    #[arg(long, value_name = "SECONDS", value_parser = seconds, default_value = "5", allow_hyphen_values = true)]
    pub checkpoint: f64,
    /// Form of the progress on stderr [default: a bar on a terminal, otherwise one line of JSON per second]
    #[arg(long, value_parser = PossibleValuesParser::new(["bar", "json", "none"]))]
    pub progress: Option<String>,
    /// Print the result as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Flags that decide when a search ends.
#[derive(Args, Default)]
pub struct StoppingFlags {
    /// Stop after this many layout evaluations
    #[arg(long, value_name = "N")]
    pub budget: Option<u64>,
    /// Stop when the best layout is within this relative gap of the proven lower bound: 0.01 is 1 %
    #[arg(long, value_name = "SHARE", value_parser = number, allow_hyphen_values = true)]
    pub gap: Option<f64>,
    /// Stop after this many evaluations without a better layout
    #[arg(long, value_name = "N")]
    pub stagnation: Option<u64>,
    /// Stop after this time, write a checkpoint, and exit with code 4
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    pub time: Option<f64>,
}

/// Returns the setting of the flag `name` (without `--`). The setting gives the key `path` the whole number
/// `value`. Returns None if `value` is None.
pub fn whole(name: &str, path: &str, value: Option<u64>) -> Option<Setting> {
    value.map(|value| Setting::of_flag(&format!("--{name} {value}"), path, value.to_string()))
}

impl SearchArguments {
    /// Returns the folder of the search, if the command line names it.
    pub fn folder(&self) -> Option<&Path> {
        [&self.resume, &self.claim, &self.out].into_iter().flatten().next().map(PathBuf::as_path)
    }

    /// Returns the settings of the flags.
    pub fn settings(&self) -> Vec<Setting> {
        let mut settings = self.question.settings();
        settings.extend(whole("seed", "search.seed", self.seed));
        settings.extend(whole("budget", "search.budget", self.rules.budget));
        settings.extend(whole("stagnation", "search.stagnation", self.rules.stagnation));
        settings.extend(whole("keep", "search.keep", self.keep));
        settings.extend(word("solver", "search.solver", self.solver.as_ref()));
        if self.ideal {
            settings.push(Setting::of_flag("--ideal", "search.ideal", "true"));
        }
        if self.robust {
            settings.push(Setting::of_flag("--robust", "search.robust", "true"));
        }
        if let Some(gap) = self.rules.gap {
            settings.push(Setting::of_flag(&format!("--gap {}", typed(gap)), "search.gap", toml_number(gap)));
        }
        if let Some(goals) = &self.pareto {
            let listed: Vec<_> = goals.iter().map(|goal| toml_string(goal)).collect();
            let flag = format!("--pareto {}", goals.join(","));
            settings.push(Setting::of_flag(&flag, "search.pareto", format!("[{}]", listed.join(", "))));
        }
        settings
    }
}
