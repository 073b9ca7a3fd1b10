//! Arguments of `calibrate`.

use super::measured::column;
use super::measuring_plan::MeasuringPlanFlags;
use crate::cli::packages::PackageFolders;
use clap::Args;
use std::path::PathBuf;

#[derive(Args)]
pub struct CalibrateArguments {
    /// Name of a built-in robot, a robot file (TOML), or a nominal URDF; with --plan, a cell file
    pub robot: PathBuf,
    /// Tables of measured positions (CSV or text, or compressed as .csv.gz), one for each set-up of the
    /// instrument. Alternatively, one file with a calibration: the YAML file of the Universal Robots ROS
    /// driver, the calibration.conf of a Universal Robots controller, or a calibrated URDF
    #[arg(required_unless_present = "plan")]
    pub data: Vec<PathBuf>,
    /// Test the calibration with a table that is not part of the fit; can be given several times
    #[arg(long, value_name = "FILE")]
    pub test: Vec<PathBuf>,
    /// Also identify the deflections of the joints under the weight of the links
    #[arg(long)]
    pub elastic: bool,
    /// Also identify the periodic error of every revolute joint: its cosine and sine terms up to this
    /// order, at most 64. An order of 32 resolves waves with a period of 11 degrees; the fit then takes
    /// several seconds for 300 positions
    #[arg(long, value_name = "ORDER", value_parser = clap::value_parser!(u8).range(1..=64))]
    pub harmonics: Option<u8>,
    /// Take the prior standard deviations of the parameters (before the measurement) from this error set;
    /// parameters without a tolerance keep their nominal values [default: 0.5 mm for lengths, 0.5 degrees
    /// for joint zeros, 0.1 degrees for other angles]
    #[arg(long, value_name = "ERRORS")]
    pub prior: Option<String>,
    /// Use this many randomly drawn rows of every table [default: all rows]
    #[arg(long, value_name = "N")]
    pub poses: Option<usize>,
    /// Seed of the random draw of --poses, or of the postures among which --plan chooses
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Read the joint coordinates from this table; rows are matched by a shared column such as id, or by
    /// their order
    #[arg(long, value_name = "FILE")]
    pub joints: Option<PathBuf>,
    /// Read a joint (q1, q2, ...) or a coordinate (x, y, z) from the column with this name or number (from
    /// 1); can be given several times
    #[arg(long, value_name = "QUANTITY=NAME", value_parser = column)]
    pub column: Vec<(String, String)>,
    /// Print the identified errors as a table for the robot file
    #[arg(long, conflicts_with = "json")]
    pub toml: bool,
    /// Print the calibration as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Plot the distance between every measured position and its prediction against the coordinate of every
    /// joint
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
    #[command(flatten)]
    pub planning: MeasuringPlanFlags,
    #[command(flatten)]
    pub packages: PackageFolders,
}
