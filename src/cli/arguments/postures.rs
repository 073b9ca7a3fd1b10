//! Arguments of the commands that judge one posture: `budget` and `explain`.

use super::question::QuestionFlags;
use super::value_parsers::{at, measure};
use crate::assess::NodeChoice;
use crate::cli::packages::PackageFolders;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct BudgetArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Show only this operation [default: all operations]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Node of the grid: `best` (the node of least error), or two indices I,J along x and y, counted from 0
    /// [default: best]
    #[arg(long, value_name = "best|I,J", value_parser = at, default_value = "best", hide_default_value = true, allow_hyphen_values = true)]
    pub at: NodeChoice,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Print the budget as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct ExplainArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Show this operation [default: the first operation]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Node of the grid: `best` (the node of least error), or two indices I,J along x and y, counted from 0
    /// [default: best]
    #[arg(long, value_name = "best|I,J", value_parser = at, default_value = "best", hide_default_value = true, allow_hyphen_values = true)]
    pub at: NodeChoice,
    /// Show the posture with these joint values (degrees or mm) instead of the posture at a node
    #[arg(
        long,
        value_name = "Q1,Q2,...",
        value_delimiter = ',',
        value_parser = measure,
        allow_hyphen_values = true,
        conflicts_with = "at"
    )]
    pub joints: Option<Vec<f64>>,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Print the explanation as JSON on stdout
    #[arg(long)]
    pub json: bool,
}
