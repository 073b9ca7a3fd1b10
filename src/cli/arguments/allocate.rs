//! Arguments of the command `allocate`.

use super::question::QuestionFlags;
use super::value_parsers::{at, share};
use crate::assess::NodeChoice;
use crate::cli::packages::PackageFolders;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct AllocateArguments {
    /// Cell file (TOML), or a result folder of `search`, whose best layout is used
    #[arg(value_name = "CELL")]
    pub of: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Consider only this operation [default: all operations with a limit]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Node of the grid: `best` (the node of least error), or two indices I,J along x and y, counted from 0
    /// [default: best]
    #[arg(long, value_name = "best|I,J", value_parser = at, default_value = "best", hide_default_value = true, allow_hyphen_values = true)]
    pub at: NodeChoice,
    /// Meet the limits at every usable node of the surfaces, not only at the spots
    #[arg(long, conflicts_with = "at")]
    pub nodes: bool,
    /// Move each operation to the node at which its limit is cheapest to meet
    #[arg(long, conflicts_with_all = ["at", "nodes"])]
    pub cheapest: bool,
    /// Required yield: at least this share of the arms built to the tolerances must stay within each limit;
    /// applies only to the quantity yield
    #[arg(long = "yield", value_name = "SHARE", value_parser = share, default_value = "0.99", allow_hyphen_values = true)]
    pub share: f64,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Print the allocation as JSON on stdout
    #[arg(long, conflicts_with = "toml")]
    pub json: bool,
    /// Write a picture of the tolerances before and after the allocation
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Print the tolerances as tables for the robot and cell files
    #[arg(long)]
    pub toml: bool,
}
