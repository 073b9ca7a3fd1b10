//! Arguments of the commands that judge a layout as drawn: `check`, `map`, `compare`, `readings`, `robust`.

use super::measured::MeasuredFlags;
use super::question::{ErrorFlags, QuestionFlags};
use super::value_parsers::seconds;
use crate::cli::packages::PackageFolders;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct CheckArguments {
    /// Cell file (TOML), or a URDF or xacro file of a robot
    pub cell: PathBuf,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Print the result of the check as JSON on stdout
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
    #[command(flatten)]
    pub measured: MeasuredFlags,
    /// Print the map as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Write the map as a picture
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    /// Write map.json, map.csv, map.svg, discrepancy.svg and manifest.json to this new folder; with
    /// --measured, also measured.csv, measured.svg and residuals.svg
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
    /// Compare four variants of one cell: as drawn, with compensation of the measured robot errors, with the
    /// best layout of a search, and with both
    #[arg(long, conflicts_with = "out")]
    pub calibrated: bool,
    #[command(flatten)]
    pub search: RemedySearchFlags,
}

/// Flags of the two searches of `compare --calibrated`.
#[derive(Args)]
pub struct RemedySearchFlags {
    /// Seed of the searches of --calibrated [default: the seed of the cell, or 1]
    #[arg(long, requires = "calibrated")]
    pub seed: Option<u64>,
    /// Stop each search of --calibrated after this many layout evaluations
    #[arg(long, value_name = "N", requires = "calibrated", value_parser = clap::value_parser!(u64).range(1..))]
    pub budget: Option<u64>,
    /// Stop each search of --calibrated after this time, and use the best layout found so far
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, requires = "calibrated")]
    pub time: Option<f64>,
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
    /// Print the analysis as JSON on stdout
    #[arg(long)]
    pub json: bool,
}
