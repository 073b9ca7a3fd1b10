//! Arguments of the commands about a robot alone: `robots`, `robot`, `envelope`.

use super::value_parsers::{bend, measure, step};
use crate::cli::packages::PackageFolders;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct RobotsArguments {
    /// Print the list as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

#[derive(Args)]
pub struct RobotArguments {
    /// Name of a built-in robot, a robot file (TOML), or a URDF or xacro file
    pub robot: PathBuf,
    /// Print the robot file, as a template for your own robot file
    #[arg(long, conflicts_with = "json")]
    pub toml: bool,
    /// Print the robot as JSON on stdout
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub packages: PackageFolders,
}

#[derive(Args)]
pub struct EnvelopeArguments {
    /// Name of a built-in robot, a robot file or cell file (TOML), or a URDF or xacro file
    #[arg(value_name = "ROBOT|CELL")]
    pub of: PathBuf,
    /// Hold the tool as in this operation of the cell [default: the first operation]
    #[arg(long, value_name = "NAME")]
    pub operation: Option<String>,
    /// Elevation of the tool axis in degrees: -90 points down, 0 is horizontal [default: the bend of the
    /// operation, or -90]
    #[arg(long, value_name = "DEG", value_parser = bend, allow_hyphen_values = true)]
    pub bend: Option<f64>,
    /// Draw the plan at this height above the robot base; can be given several times [default: the height of
    /// the operation, or the height of the widest reach]
    #[arg(long, value_name = "MM", value_parser = measure, allow_hyphen_values = true)]
    pub height: Vec<f64>,
    /// Distance between sample points [default: depends on the robot]
    #[arg(long, value_name = "MM", value_parser = step, allow_hyphen_values = true)]
    pub step: Option<f64>,
    /// Print the envelope as JSON on stdout
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub packages: PackageFolders,
    /// Write the section and the plan of the envelope as a picture
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}
