//! Arguments of `correct`.

use super::question::QuestionFlags;
use crate::cli::packages::PackageFolders;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Frame of the targets of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TargetFrame {
    /// World frame
    World,
    /// Frame of the work surface of the operation
    Surface,
    /// Base frame of the robot
    Base,
}

#[derive(Args)]
pub struct CorrectArguments {
    /// Cell file (TOML), or a result folder of `search`, whose best layout is used
    #[arg(value_name = "RESULT|CELL")]
    pub of: PathBuf,
    /// Correct only this operation [default: all operations; with --targets, the first operation]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Correct every usable node instead of the spot alone
    #[arg(long, conflicts_with = "targets")]
    pub nodes: bool,
    /// Correct the targets of this table (CSV) with the columns x, y, z in mm. Optional columns are name, and
    /// rx, ry, rz in degrees (rotation Rz Ry Rx). Without rotations, the tool keeps the attitude of the
    /// operation
    #[arg(long, value_name = "FILE")]
    pub targets: Option<PathBuf>,
    /// Frame of the targets in the table
    #[arg(long, value_name = "FRAME", value_enum, default_value_t = TargetFrame::World, requires = "targets")]
    pub frame: TargetFrame,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Print the corrections as CSV on stdout
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    /// Print the corrections as JSON on stdout
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub packages: PackageFolders,
}
