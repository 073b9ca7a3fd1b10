//! What exists in a workcell: plain data in SI units, valid by construction.

use super::attitude::Attitude;
use super::choices::*;
use super::constraints::{Fence, Margins, TransferRules};
use super::coordinate::Coordinate;
use super::error_model::{ErrorSet, FrameErrors};
use super::robot_model::Robot;
use super::sense::{Sense, Unit};
use super::shape::{Rectangle, Solid};
use crate::pose::Pose;
use nalgebra::{Matrix3, Vector3};

/// Where an equipment stands: its frame in the world, m and rad.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub yaw: f64,
}

impl Placement {
    pub fn pose(&self) -> Pose {
        Pose::from_translation_yaw(Vector3::new(self.x, self.y, self.z), self.yaw)
    }

    /// Turns world axes into this frame.
    pub fn from_world(&self) -> Matrix3<f64> {
        let (s, c) = self.yaw.sin_cos();
        Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0)
    }

    /// x, y, z, yaw.
    pub fn values(&self) -> [f64; 4] {
        [self.x, self.y, self.z, self.yaw]
    }

    pub fn from_values([x, y, z, yaw]: [f64; 4]) -> Self {
        Self { x, y, z, yaw }
    }

    /// The placement of something that stands at `own` in this frame.
    pub fn carrying(&self, own: &Placement) -> Placement {
        let (s, c) = self.yaw.sin_cos();
        Placement {
            x: self.x + c * own.x - s * own.y,
            y: self.y + s * own.x + c * own.y,
            z: self.z + own.z,
            yaw: self.yaw + own.yaw,
        }
    }

    /// This placement in the frame of another.
    pub fn seen_from(&self, other: &Placement) -> Placement {
        let (dx, dy) = (self.x - other.x, self.y - other.y);
        let (s, c) = other.yaw.sin_cos();
        Placement { x: c * dx + s * dy, y: c * dy - s * dx, z: self.z - other.z, yaw: self.yaw - other.yaw }
    }
}

/// How far something may stand from where it is meant to: plus-or-minus x, y, z (m) and yaw (rad), in the
/// frame in which its placement is given.
///
/// Where it ends up is known to those who program the robot, who then work from there; what they do not
/// know of it belongs to its `errors`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlacementTolerance(pub [f64; 4]);

/// What an equipment is to the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    Equipment,
    /// Always where it is; two obstacles may touch.
    Obstacle,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Equipment {
    pub name: String,
    pub role: Role,
    /// The work surface: horizontal rectangle at z = 0 of the equipment's frame.
    pub surface: Option<Rectangle>,
    /// Floor space: contains every solid in plan.
    pub footprint: Rectangle,
    pub solids: Vec<Solid>,
    /// Index of the equipment that it stands on, and moves with.
    pub on: Option<usize>,
    /// x, y, z, yaw, in the world or in the frame of what it stands on.
    pub placement: [Coordinate; 4],
    /// Errors of its placement or fixture, in its frame (m, rad).
    pub errors: Option<FrameErrors>,
    /// How exactly it is placed.
    pub tolerance: PlacementTolerance,
}

/// A box that no equipment may enter, in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct KeepOut {
    pub name: String,
    pub min: Vector3<f64>,
    pub max: Vector3<f64>,
}

/// Three points that teach a frame span a triangle at least so high, m: a flatter one teaches no
/// plane, for its frame turns by errors over height.
pub const TEACH_HEIGHT: f64 = 0.02;

/// What the robot carries to or from an operation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Held {
    /// In the frame of the TCP.
    pub solids: Vec<Solid>,
    /// It rests on the equipment of the operation: touching that is no collision.
    pub touches_surface: bool,
}

/// The nodes of an operation, in the frame of its equipment.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Divisions along x and y of a part of the surface: (m + 1)(n + 1) nodes.
    Grid { area: Rectangle, divisions: (usize, usize) },
    /// x and y, m.
    Points(Vec<(f64, f64)>),
}

impl Place {
    /// Nodes along x and along y, less one; of points all along x.
    pub fn divisions(&self) -> (usize, usize) {
        match self {
            Place::Grid { divisions, .. } => *divisions,
            Place::Points(points) => (points.len().max(1) - 1, 0),
        }
    }

    /// "grid 10 by 8" or "4 points".
    pub fn in_words(&self) -> String {
        match self {
            Place::Grid { divisions: (m, n), .. } => format!("grid {m} by {n}"),
            Place::Points(points) => format!("{} points", points.len()),
        }
    }
}

/// A precision operation: somewhere on a surface, the tool at one elevation.
#[derive(Debug, Clone, PartialEq)]
pub struct Operation {
    pub name: String,
    /// Index of the equipment whose surface carries it.
    pub equipment: usize,
    /// Where on the surface.
    pub place: Place,
    /// What of its nodes counts.
    pub over: Over,
    /// TCP above the surface, m.
    pub standoff: f64,
    /// As drawn.
    pub attitude: Attitude,
    /// Search variables for elevation, azimuth and spin, rad; None: the angle of `attitude` holds.
    pub angles: [Option<Coordinate>; 3],
    pub sense: Sense,
    /// Largest error in the sense (m or rad) with which the operation succeeds.
    pub limit: Option<f64>,
    /// The operation before this one in which the part was picked: what counts is the error of the
    /// placed part, in which common errors cancel.
    pub relative_to: Option<usize>,
    /// Points of the surface (its frame, m) at which a frame is taught; None: the reachable nodes
    /// nearest to three corners of the grid.
    pub teach: Option<[(f64, f64); 3]>,
    pub weight: f64,
    pub held: Held,
    /// Lengths of the straight ways along the tool axis to the spot and back, m; 0: not checked.
    pub approach: f64,
    pub retract: f64,
}

impl Operation {
    pub fn nodes(&self) -> usize {
        let (m, n) = self.place.divisions();
        (m + 1) * (n + 1)
    }
}

/// A whole workcell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    pub name: String,
    pub robot: Robot,
    /// Robot base in the world: x, y, z, yaw.
    pub base: [Coordinate; 4],
    /// How exactly the robot base is placed.
    pub base_tolerance: PlacementTolerance,
    /// Index into [`Robot::errors`].
    pub errors: usize,
    pub model: Model,
    pub reading: Reading,
    /// What the statistical reading makes small.
    pub quantity: Quantity,
    pub registration: Registration,
    /// A model is not trusted where it is off by more than this share of the resultant error.
    pub guard: f64,
    pub equipment: Vec<Equipment>,
    pub keep_out: Vec<KeepOut>,
    pub operations: Vec<Operation>,
    /// Senses that the cell file defines.
    pub senses: Vec<Sense>,
    /// Whether anything is checked for collision and overlap.
    pub collision: bool,
    /// Least distance between solids, m; at 0 touching counts as collision.
    pub clearance: f64,
    /// Height of the floor in the world, m.
    pub floor: f64,
    pub margins: Margins,
    /// None: the moves between operations are not checked.
    pub transfer: Option<TransferRules>,
    pub fence: Option<Fence>,
    pub search: SearchSettings,
}

impl Cell {
    /// The chosen errors of the robot.
    pub fn error_set(&self) -> &ErrorSet {
        &self.robot.errors[self.errors]
    }

    /// A sense by its word: a plain one, or one of the cell file.
    pub fn sense(&self, word: &str) -> Option<Sense> {
        Sense::plain(word).or_else(|| self.senses.iter().find(|s| s.name == word).cloned())
    }

    /// What the objective adds up.
    pub fn unit(&self) -> Unit {
        match (self.reading, self.quantity) {
            (Reading::Statistical, Quantity::Yield) => Unit::Share,
            _ => self.operations.first().map_or(Unit::Length, |o| o.sense.unit),
        }
    }
}
