//! Flags that name measured positions of the robot.

use super::value_parsers::positive;
use clap::Args;
use std::path::PathBuf;

/// Flags of the commands that compare predicted errors with measured positions.
#[derive(Args)]
pub struct MeasuredFlags {
    /// Compare predicted errors with measured errors; this table (CSV or text, or .csv.gz) states the
    /// measured positions; can be given several times
    #[arg(long, value_name = "FILE")]
    pub measured: Vec<PathBuf>,
    /// Read the joint coordinates of the measured positions from this table; rows are matched by a
    /// shared column such as id, or by their order
    #[arg(long, value_name = "FILE", requires = "measured")]
    pub joints: Option<PathBuf>,
    /// Read a joint (q1, q2, ...) or a coordinate (x, y, z) from the column with this name or number (from
    /// 1); can be given several times
    #[arg(long, value_name = "QUANTITY=NAME", value_parser = column, requires = "measured")]
    pub column: Vec<(String, String)>,
    /// Group measured poses into spots: along each axis, a commanded position differs by at most this length
    /// from the first position of the spot [default: 1]
    #[arg(long, value_name = "MM", value_parser = positive, requires = "measured")]
    pub spot: Option<f64>,
}

/// Parses a quantity and the name of its column, written as `QUANTITY=NAME`.
pub fn column(text: &str) -> Result<(String, String), String> {
    let parts = text.split_once('=').ok_or("write QUANTITY=NAME, for example q1=shoulder")?;
    Ok((parts.0.trim().to_string(), parts.1.trim().to_string()))
}
