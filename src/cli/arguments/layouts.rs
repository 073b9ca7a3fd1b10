//! Arguments of the commands that judge a layout as drawn: `check`, `map`, `compare`, `readings`, `robust`.

use super::question::{ErrorFlags, QuestionFlags};
use crate::cli::packages::PackageFolders;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct CheckArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Print the errors as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct MapArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Print the map as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Write the map as a picture
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write map.json, map.csv, map.svg, discrepancy.svg and manifest.json to this new folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

#[derive(Args)]
pub struct CompareArguments {
    /// Cell files, or result folders of `search`
    #[arg(required = true)]
    pub layouts: Vec<PathBuf>,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Write an HTML page that shows the layouts side by side; an existing page is replaced
    #[arg(short, long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Print the comparison as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct ReadingsArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub errors: ErrorFlags,
    /// Write readings.json, readings.csv and manifest.json to this new folder
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the readings as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct RobustArguments {
    /// Cell file (TOML)
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    #[command(flatten)]
    pub question: QuestionFlags,
    /// Print the answer as JSON on stdout
    #[arg(long)]
    pub json: bool,
}
