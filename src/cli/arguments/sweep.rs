//! Arguments of `sweep`.

use super::question::word;
use super::search::whole;
use crate::cell::Solver;
use crate::cli::packages::PackageFolders;
use crate::files::Setting;
use clap::Args;
use clap::builder::PossibleValuesParser;
use std::path::PathBuf;

#[derive(Args)]
pub struct SweepArguments {
    /// Cell file (TOML)
    #[arg(required_unless_present = "resume", conflicts_with = "resume")]
    pub cell: Option<PathBuf>,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// A key of the cell file and its values; text needs no quotes, and commas inside brackets do not
    /// separate values; can be given several times
    #[arg(
        long = "set",
        value_name = "PATH=A,B,...",
        required_unless_present = "resume",
        conflicts_with = "resume"
    )]
    pub sets: Vec<String>,
    /// Map the layout as drawn instead of searching
    #[arg(long, conflicts_with = "resume")]
    pub map: bool,
    /// Seed of all random numbers of every combination [default: the seed of the cell]
    #[arg(long, conflicts_with = "resume")]
    pub seed: Option<u64>,
    /// Number of layout evaluations per combination
    #[arg(long, value_name = "N", conflicts_with = "resume")]
    pub budget: Option<u64>,
    /// Global solver
    #[arg(long, value_parser = PossibleValuesParser::new(Solver::ALL.map(Solver::name)), conflicts_with = "resume")]
    pub solver: Option<String>,
    /// Number of combinations to process in parallel; the result does not depend on it [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: Option<u16>,
    /// Write to this folder: a new one, or the folder of the same sweep, which is then resumed [default:
    /// results/CELL-NNN]
    #[arg(long, value_name = "DIR", conflicts_with = "resume")]
    pub out: Option<PathBuf>,
    /// Resume the sweep in this folder
    #[arg(long, value_name = "DIR")]
    pub resume: Option<PathBuf>,
    /// Process only this combination (numbered from 0) and write no table, for array jobs on a cluster;
    /// --resume then writes the table
    #[arg(long, value_name = "INDEX")]
    pub only: Option<usize>,
    /// Print the table as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Returns the settings that apply to every combination of a sweep.
pub fn common_settings(seed: Option<u64>, budget: Option<u64>, solver: Option<&String>) -> Vec<Setting> {
    let seed = whole("seed", "search.seed", seed);
    let budget = whole("budget", "search.budget", budget);
    seed.into_iter().chain(budget).chain(word("solver", "search.solver", solver)).collect()
}
