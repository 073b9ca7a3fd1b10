//! Arguments of `calibrate` that plan measuring poses, or choose among measured poses.

use super::value_parsers::measure;
use clap::Args;
use std::path::PathBuf;

/// Largest number of poses of one plan.
const MAX_POSES: u64 = 1000;

/// Largest number of postures among which a plan chooses.
const MAX_CANDIDATES: u64 = 20_000;

#[derive(Args)]
pub struct MeasuringPlanFlags {
    /// Plan this many measuring poses for the operations of a cell file; give the cell file instead of
    /// ROBOT
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..=MAX_POSES),
        conflicts_with_all = ["data", "test", "poses", "choose", "column", "toml", "harmonics", "svg"]
    )]
    pub plan: Option<u64>,
    /// Use only the N most informative rows of every table, and ignore all other rows
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..=MAX_POSES),
        conflicts_with = "poses"
    )]
    pub choose: Option<u64>,
    /// Let --choose select the rows that best determine the position errors at the operations of this cell
    /// [default: the rows that best determine the position errors at the postures of all rows]
    #[arg(long = "for", value_name = "CELL", requires = "choose")]
    pub task: Option<PathBuf>,
    /// State the position of the tracker in the world frame, mm; only poses at which the tracker sees the
    /// reflector are planned
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "plan")]
    pub tracker: Option<[f64; 3]>,
    /// State the position of the reflector in the frame of the mechanical interface, mm [default: the
    /// TCP]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    pub reflector: Option<[f64; 3]>,
    /// State the direction in which the reflector opens, in the frame of the mechanical interface [default:
    /// the reflector is visible from every side]
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "tracker")]
    pub opening: Option<[f64; 3]>,
    /// State the largest angle between the direction of --opening and the line of sight, deg
    #[arg(long, value_name = "DEG", value_parser = measure, default_value = "30", requires = "opening")]
    pub opening_angle: f64,
    /// Choose the poses among this many candidate postures
    #[arg(
        long,
        value_name = "N",
        value_parser = clap::value_parser!(u64).range(1..=MAX_CANDIDATES),
        default_value_t = 2000,
        requires = "plan"
    )]
    pub candidates: u64,
    /// Write the plan as a CSV table to be filled in; an existing file is replaced, and - means stdout
    #[arg(long, value_name = "FILE", requires = "plan")]
    pub csv: Option<PathBuf>,
}

/// Parses a point or a direction: three numbers separated by commas.
fn point(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').map(measure).collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| "write three numbers, for example 2000,-500,800".to_string())
}
