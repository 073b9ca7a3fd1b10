//! What exists in a workcell: plain data in SI units, valid by construction.

use super::attitude::Attitude;
use super::choices::*;
use super::constraints::{Fence, Margins, TransferRules};
use super::error_model::{ErrorSet, FrameErrors};
use super::robot_model::Robot;
use super::sense::{Sense, Unit};
use super::shape::{Rectangle, Solid};
use crate::pose::Pose;
use nalgebra::Vector3;

/// One coordinate of a placement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Coordinate {
    Fixed(f64),
    /// A search variable.
    Range {
        min: f64,
        max: f64,
        start: f64,
    },
}

impl Coordinate {
    pub fn start(&self) -> f64 {
        match *self {
            Coordinate::Fixed(value) | Coordinate::Range { start: value, .. } => value,
        }
    }
}

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
}

/// One placement per equipment, in the order of [`Cell::equipment`].
#[derive(Debug, Clone, PartialEq)]
pub struct Layout {
    pub placements: Vec<Placement>,
}

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
    /// x, y, z, yaw.
    pub placement: [Coordinate; 4],
    /// Of its placement or fixture.
    pub errors: Option<FrameErrors>,
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

/// A precision operation: somewhere on a surface, the tool at one elevation.
#[derive(Debug, Clone, PartialEq)]
pub struct Operation {
    pub name: String,
    /// Index of the equipment whose surface carries it.
    pub equipment: usize,
    /// Divisions along x and y of the surface: (m + 1)(n + 1) nodes.
    pub grid: (usize, usize),
    /// TCP above the surface, m.
    pub standoff: f64,
    pub attitude: Attitude,
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
        (self.grid.0 + 1) * (self.grid.1 + 1)
    }
}

/// A whole workcell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    pub name: String,
    pub robot: Robot,
    /// Robot base in the world.
    pub base: Placement,
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
    /// Those defined in the cell file.
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
    /// The layout as drawn: fixed coordinates and the start of each range.
    pub fn start(&self) -> Layout {
        let at = |e: &Equipment| {
            let [x, y, z, yaw] = e.placement.map(|c| c.start());
            Placement { x, y, z, yaw }
        };
        Layout { placements: self.equipment.iter().map(at).collect() }
    }

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
