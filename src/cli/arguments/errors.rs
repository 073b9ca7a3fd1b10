//! Arguments of `errors`.

use super::value_parsers::positive;
use crate::cli::packages::PackageFolders;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Frame to which the pose accuracy refers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum AccuracyBase {
    /// Base frame fitted to positions of the real robot throughout its working space
    Fitted,
    /// Nominal base frame
    Nominal,
}

#[derive(Args)]
pub struct ErrorsArguments {
    /// Name of a built-in robot, a robot file (TOML), or a URDF or xacro file
    #[arg(required_unless_present = "presets")]
    pub robot: Option<PathBuf>,
    /// Take the tolerances from the preset of this class of arms; --presets lists the presets
    #[arg(long, value_name = "NAME", conflicts_with = "errors")]
    pub preset: Option<String>,
    /// Take the tolerances from this error set of the robot [default: the first set of tolerances of the
    /// robot]
    #[arg(long, value_name = "NAME")]
    pub errors: Option<String>,
    /// Scale the tolerances so that the predicted pose accuracy AP equals this value from the data sheet
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub ap: Option<f64>,
    /// Add random joint errors that give this pose repeatability RP from the data sheet
    #[arg(long, value_name = "MM", value_parser = positive)]
    pub rp: Option<f64>,
    /// Frame to which the pose accuracy refers
    #[arg(long, value_name = "FRAME", value_enum, default_value_t = AccuracyBase::Fitted)]
    pub base: AccuracyBase,
    /// List the presets with their sources
    #[arg(long, conflicts_with_all = ["robot", "preset", "errors", "ap", "rp", "toml", "json"])]
    pub presets: bool,
    /// Print the tolerances as a table for the robot file
    #[arg(long, conflicts_with = "json")]
    pub toml: bool,
    /// Print tolerances and accuracy as JSON on stdout
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub packages: PackageFolders,
}
