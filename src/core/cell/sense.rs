//! Senses: the error components that matter to an operation.
//!
//! A sense is a list of rows. A row is a weighted component of the position or rotation error at a point.

use crate::units;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Largest number of rows (weighted components) of a sense: three of position, three of rotation.
pub const MAX_ROWS: usize = 6;

/// Frame in which the directions of a sense are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    World,
    /// Frame of the equipment on which the operation happens.
    Surface,
    /// Frame of the TCP in the evaluated posture.
    Tool,
}

impl Frame {
    /// All frames.
    pub const ALL: [Frame; 3] = [Frame::World, Frame::Surface, Frame::Tool];

    /// Returns the name of this frame as it appears in files, for example `world`.
    pub const fn name(self) -> &'static str {
        match self {
            Frame::World => "world",
            Frame::Surface => "surface",
            Frame::Tool => "tool",
        }
    }
}

/// Row of a sense: the position error along a direction, or the rotation error about that direction.
///
/// The length of the direction is the weight of the row. The rows of built-in senses have weight 1. If a
/// sense combines rotation errors with position errors, its rotation rows have weights in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    pub turns: bool,
    pub direction: Vector3<f64>,
}

impl Row {
    const ZERO: Self = Self { turns: false, direction: Vector3::new(0.0, 0.0, 0.0) };
}

/// Unit of the value of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Unit {
    #[serde(rename = "mm")]
    Length,
    #[serde(rename = "deg")]
    Angle,
    /// Share of failures among all trials, 0 to 1.
    Share,
    /// Cost of tolerances, in the unit of the cost models.
    Cost,
}

impl Unit {
    /// All units.
    pub const ALL: [Unit; 4] = [Unit::Length, Unit::Angle, Unit::Share, Unit::Cost];

    /// Returns whether values in this unit are errors, which can be compared with the limit of an operation.
    pub fn is_error(self) -> bool {
        matches!(self, Unit::Length | Unit::Angle)
    }

    /// Returns the name of this unit as it appears in files and reports, for example `mm`.
    pub fn word(self) -> &'static str {
        match self {
            Unit::Length => "mm",
            Unit::Angle => "deg",
            Unit::Share => "share",
            Unit::Cost => "cost",
        }
    }

    /// Converts a value from SI to the unit of files and reports.
    pub fn from_si(self, value: f64) -> f64 {
        match self {
            Unit::Length => units::mm_from_m(value),
            Unit::Angle => units::deg_from_rad(value),
            Unit::Share | Unit::Cost => value,
        }
    }
}

/// Measure of the size of an error: the norm of the weighted components that the rows define.
#[derive(Debug, Clone, PartialEq)]
pub struct Sense {
    pub name: String,
    pub frame: Frame,
    /// Point at which the error is measured, as a vector from the TCP in the tool frame, m.
    pub point: Vector3<f64>,
    pub unit: Unit,
    rows: [Row; MAX_ROWS],
    count: usize,
}

/// Names of the built-in senses, which exist in world, surface and tool axes.
pub const PLAIN: [&str; 9] = ["x", "y", "z", "xy", "xyz", "rx", "ry", "rz", "rotation"];

/// Names of the senses of the [seed paper](crate). Error maps report the error at every node in these senses.
pub const PAPER: [&str; 5] = ["x", "y", "z", "xy", "xyz"];

impl Sense {
    /// Returns a sense whose rows (weighted components) are those in `given`; rows after the first
    /// [`MAX_ROWS`] are left out.
    pub fn new(name: &str, frame: Frame, point: Vector3<f64>, unit: Unit, given: &[Row]) -> Self {
        let mut rows = [Row::ZERO; MAX_ROWS];
        let count = given.len().min(MAX_ROWS);
        rows[..count].copy_from_slice(&given[..count]);
        Self { name: name.to_string(), frame, point, unit, rows, count }
    }

    /// Returns the built-in sense with a name from [`PLAIN`], in world axes; None for an unknown name.
    ///
    /// A suffix of `name` selects other axes: `xy@tool` is the sense `xy` in tool axes.
    pub fn plain(name: &str) -> Option<Self> {
        let (word, frame) = match name.split_once('@') {
            Some((word, frame)) => (word, Frame::ALL.into_iter().find(|f| f.name() == frame)?),
            None => (name, Frame::World),
        };
        let rows = Self::plain_rows(word)?;
        let unit = if rows.iter().any(|r| r.turns) { Unit::Angle } else { Unit::Length };
        // `xy@world` becomes `xy`, so that every sense has only one name.
        let name = if frame == Frame::World { word } else { name };
        Some(Self::new(name, frame, Vector3::zeros(), unit, &rows))
    }

    /// Returns the rows (weighted components) of the built-in sense with the name `word`; None if `word` is
    /// not in [`PLAIN`].
    pub fn plain_rows(word: &str) -> Option<Vec<Row>> {
        let (turns, axes) = match word {
            "rotation" => (true, "xyz"),
            "rx" | "ry" | "rz" => (true, &word[1..]),
            "x" | "y" | "z" | "xy" | "xyz" => (false, word),
            _ => return None,
        };
        let axis = |c| match c {
            'x' => Vector3::x(),
            'y' => Vector3::y(),
            _ => Vector3::z(),
        };
        Some(axes.chars().map(|c| Row { turns, direction: axis(c) }).collect())
    }

    /// Returns the five senses of the seed paper ([`PAPER`]) in world axes.
    pub fn paper() -> Vec<Self> {
        PAPER.iter().filter_map(|name| Self::plain(name)).collect()
    }

    /// Returns the rows (weighted components) of the sense.
    pub fn rows(&self) -> &[Row] {
        &self.rows[..self.count]
    }

    /// Returns whether all rows (weighted components) are position errors of the TCP along world-frame
    /// directions.
    pub fn is_of_position(&self) -> bool {
        self.frame == Frame::World && self.point == Vector3::zeros() && self.rows().iter().all(|r| !r.turns)
    }
}
