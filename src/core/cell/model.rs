//! Model of a workcell: plain data in SI units, valid by construction.

use super::attitude::Attitude;
use super::choices::*;
use super::constraints::{Fence, Margins, TransferRules};
use super::coordinate::Coordinate;
use super::error_model::{ErrorSet, FrameErrors};
use super::goal::Goal;
use super::robot_model::Robot;
use super::sense::{Sense, Unit};
use super::shape::{Rectangle, Solid};
use super::title_block::TitleBlock;
use super::tolerance_cost::ToleranceCost;
use crate::pose::Pose;
use crate::units::wrapped;
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Placement of the robot base or of equipment, m and rad.
///
/// The placement is given in the world frame, or in the frame of the equipment that carries the placed
/// equipment.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    pub x: f64,
    pub y: f64,
    pub z: f64,
    pub yaw: f64,
}

impl Placement {
    /// Returns the pose of the placement.
    pub fn pose(&self) -> Pose {
        Pose::from_translation_yaw(Vector3::new(self.x, self.y, self.z), self.yaw)
    }

    /// Returns the rotation matrix that converts vectors from world axes to the axes of this placement.
    pub fn from_world(&self) -> Matrix3<f64> {
        let (s, c) = self.yaw.sin_cos();
        Matrix3::new(c, s, 0.0, -s, c, 0.0, 0.0, 0.0, 1.0)
    }

    /// Returns x, y, z (m) and yaw (rad).
    pub fn values(&self) -> [f64; 4] {
        [self.x, self.y, self.z, self.yaw]
    }

    /// Returns the placement with x, y, z (m) and yaw (rad).
    pub fn from_values([x, y, z, yaw]: [f64; 4]) -> Self {
        Self { x, y, z, yaw }
    }

    /// Converts the placement of a carried body from the frame of its carrier to the parent frame of the
    /// carrier. `own` is the placement in the frame of the carrier. `self` is the placement of the carrier in
    /// its parent frame.
    pub fn carrying(&self, own: &Placement) -> Placement {
        let (s, c) = self.yaw.sin_cos();
        Placement {
            x: self.x + c * own.x - s * own.y,
            y: self.y + s * own.x + c * own.y,
            z: self.z + own.z,
            yaw: self.yaw + own.yaw,
        }
    }

    /// Returns this placement relative to `other`; both must be given in the same frame.
    pub fn seen_from(&self, other: &Placement) -> Placement {
        let (dx, dy) = (self.x - other.x, self.y - other.y);
        let (s, c) = other.yaw.sin_cos();
        Placement { x: c * dx + s * dy, y: c * dy - s * dx, z: self.z - other.z, yaw: self.yaw - other.yaw }
    }

    /// Returns this placement in the frame of the robot base, with a yaw of at most half a turn.
    pub fn from_base(&self, base: &Placement) -> Placement {
        let seen = self.seen_from(base);
        let yaw = if seen.yaw.abs() > PI { wrapped(seen.yaw) } else { seen.yaw };
        Placement { yaw, ..seen }
    }
}

/// Placement tolerance: half widths of x, y, z (m) and yaw (rad), in the frame in which the placement is
/// given.
///
/// The programmer of the robot must know the actual placement and adapt the program to it. An unknown
/// placement error does not belong to this tolerance, but to the `errors` of the equipment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlacementTolerance(pub [f64; 4]);

/// Role of a piece of equipment in the search.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    Equipment,
    /// Equipment that the search never moves; two obstacles may overlap.
    Obstacle,
}

/// Worktable, conveyor, fixture or obstacle, with its solids and floor space.
#[derive(Debug, Clone, PartialEq)]
pub struct Equipment {
    pub name: String,
    pub role: Role,
    /// Work surface: horizontal rectangle at z = 0 of the equipment's frame; None without a surface.
    pub surface: Option<Rectangle>,
    /// Floor space, which contains all solids of the equipment in plan view.
    pub footprint: Rectangle,
    pub solids: Vec<Solid>,
    /// Index of the equipment on which this equipment stands and with which it moves; None if it stands on no
    /// other equipment.
    pub on: Option<usize>,
    /// Coordinates x, y, z, yaw in the world frame, or in the frame of the equipment that carries this
    /// equipment.
    pub placement: [Coordinate; 4],
    /// Errors of the equipment's frame, in the axes of that frame (m, rad); None without errors.
    pub errors: Option<FrameErrors>,
    /// Cost models of the six components of `errors`; empty if every component has the default model.
    pub error_costs: Vec<ToleranceCost>,
    /// Tolerance of the placement.
    pub tolerance: PlacementTolerance,
}

/// Support of the robot base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BaseSupport {
    /// The base stands on the floor, or on a pedestal if the base is above the floor. The rectangle is the
    /// cross-section of the pedestal in the base frame, m.
    Pedestal(Rectangle),
    /// A wall or a gantry carries the base; no pedestal occupies the space below the base.
    Hung,
}

/// Keep-out box in the world. The robot, its tool, held parts and equipment must stay outside.
/// Obstacles ([`Role::Obstacle`]) may overlap the box.
#[derive(Debug, Clone, PartialEq)]
pub struct KeepOut {
    pub name: String,
    /// Corner of least x, y and z, m.
    pub min: Vector3<f64>,
    /// Corner of greatest x, y and z, m.
    pub max: Vector3<f64>,
}

/// Least height, m, of the triangle whose corners are the three points at which a frame is taught.
///
/// The height is measured perpendicular to the longest side. The rotation error (rad) of a taught frame
/// approximately equals the error of its points divided by this height. A flatter triangle is therefore
/// rejected.
pub const TEACH_HEIGHT: f64 = 0.02;

/// Part that the robot carries to or from an operation.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeldPart {
    /// Solids of the part, in the frame of the TCP.
    pub solids: Vec<Solid>,
    /// Whether the part rests on the equipment of the operation. If so, contact between the part and the
    /// equipment is allowed.
    pub touches_surface: bool,
    /// Mass of the part, kg; 0 if the cell does not state it.
    pub mass: f64,
    /// Centre of mass in the frame of the TCP, m.
    pub centre: Vector3<f64>,
}

/// Nodes of an operation: a grid or listed points, in the frame of the operation's equipment.
#[derive(Debug, Clone, PartialEq)]
pub enum Place {
    /// Grid on a part of the surface: m and n divisions along x and y give (m + 1)(n + 1) nodes.
    Grid { area: Rectangle, divisions: (usize, usize) },
    /// List of nodes (x, y), m.
    Points(Vec<(f64, f64)>),
}

impl Place {
    /// Returns the numbers of divisions along x and y.
    ///
    /// A list of n points counts as n - 1 divisions along x and none along y.
    pub fn divisions(&self) -> (usize, usize) {
        match self {
            Place::Grid { divisions, .. } => *divisions,
            Place::Points(points) => (points.len().max(1) - 1, 0),
        }
    }

    /// Returns a description of the nodes: "grid 10 by 8" or "4 points".
    pub fn in_words(&self) -> String {
        match self {
            Place::Grid { divisions: (m, n), .. } => format!("grid {m} by {n}"),
            Place::Points(points) => format!("{} points", points.len()),
        }
    }
}

/// Precision operation: a task of the robot on a work surface.
#[derive(Debug, Clone, PartialEq)]
pub struct Operation {
    pub name: String,
    /// Index of the equipment on whose surface the operation happens.
    pub equipment: usize,
    /// Nodes on the surface.
    pub place: Place,
    /// Rule that combines the values of the nodes into the value of the operation.
    pub over: NodeAggregation,
    /// Height of the TCP above the surface, m.
    pub standoff: f64,
    /// Nominal attitude of the tool.
    pub attitude: Attitude,
    /// Search variables for elevation, azimuth and spin, rad; None for an angle that `attitude` fixes.
    pub angles: [Option<Coordinate>; 3],
    pub sense: Sense,
    /// Largest error with which the operation succeeds, measured in the operation's sense (m or rad).
    pub limit: Option<f64>,
    /// Index of the earlier operation that picks the part which this operation places; None without a pick.
    ///
    /// An operation with a pick is judged by the error of the placed part. Errors common to pick and place
    /// cancel in this error.
    pub relative_to: Option<usize>,
    /// Points (x, y) at which the frame of the surface is taught, in the nominal frame of the surface, m.
    ///
    /// If None, the points are the reachable nodes nearest to three corners of the grid.
    pub teach: Option<[(f64, f64); 3]>,
    /// Weight of the operation in the objective.
    pub weight: f64,
    pub held: HeldPart,
    /// Length, m, of the straight approach along the tool axis to the spot (node where the operation
    /// happens). The value 0 means that no approach is checked.
    pub approach: f64,
    /// Length, m, of the straight retract along the tool axis from the spot (node where the operation
    /// happens). The value 0 means that no retract is checked.
    pub retract: f64,
    /// Time that the robot rests at the spot, or at every listed point, s.
    pub dwell: f64,
    /// Maximum speed of the TCP on the approach and the retract, m/s; None if only the joints limit it.
    pub line_speed: Option<f64>,
}

impl Operation {
    /// Returns the number of nodes.
    pub fn nodes(&self) -> usize {
        let (m, n) = self.place.divisions();
        (m + 1) * (n + 1)
    }
}

/// Workcell: robot, equipment, obstacles and operations, and what a search may change.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    pub name: String,
    pub robot: Robot,
    /// Coordinates of the robot base in the world: x, y, z, yaw.
    pub base: [Coordinate; 4],
    /// Tolerance of the placement of the robot base.
    pub base_tolerance: PlacementTolerance,
    pub base_support: BaseSupport,
    /// Index of the chosen error set in [`Robot::errors`].
    pub errors: usize,
    pub model: Model,
    pub reading: Reading,
    /// Quantity that the search minimizes in the statistical reading.
    pub quantity: Quantity,
    pub registration: Registration,
    /// Guard: largest deviation from the nonlinear model at which reports trust the linear or second-order
    /// model.
    ///
    /// The deviation is a share of the nonlinear error.
    pub guard: f64,
    pub equipment: Vec<Equipment>,
    pub keep_out: Vec<KeepOut>,
    pub operations: Vec<Operation>,
    /// Senses that the cell file defines.
    pub senses: Vec<Sense>,
    /// Whether collisions of the robot and overlaps of equipment are checked.
    pub collision: bool,
    /// Least allowed distance between solids, m; contact counts as collision even if the clearance is 0.
    pub clearance: f64,
    /// Height of the floor in the world, m.
    pub floor: f64,
    pub margins: Margins,
    /// Rules for transfers; None if the moves between operations are not checked.
    pub transfer: Option<TransferRules>,
    pub fence: Option<Fence>,
    pub search: SearchSettings,
    pub title_block: TitleBlock,
    /// Values that the cell file leaves out and that are assumed.
    pub assumed: Vec<Assumption>,
}

/// Reason why errors that compensate each other ([`Cell::errors_compensate`]) have no worst case and no
/// statistics.
pub const NO_TOLERANCES: &str =
    "the errors compensate each other in one calibrated arm, so they cannot be read as tolerances";

impl Cell {
    /// Returns the chosen error set of the robot.
    pub fn error_set(&self) -> &ErrorSet {
        &self.robot.errors[self.errors]
    }

    /// Returns whether the errors of a signed sample compensate each other. The function assumes this if
    /// the error of an axial offset or common normal exceeds the reach of the arm.
    ///
    /// In some factory calibrations, Denavit-Hartenberg rows contain lengths of kilometres. The magnitudes of
    /// such errors are not tolerances. The message for this case is [`NO_TOLERANCES`].
    pub fn errors_compensate(&self) -> bool {
        let ErrorSet::Signed(sample) = self.error_set() else { return false };
        sample.dr.iter().chain(&sample.dl).any(|length| length.abs() > self.robot.reach())
    }

    /// Returns a sense by its name: a built-in sense, or a sense that the cell file defines. Returns None for
    /// any other name.
    pub fn sense(&self, word: &str) -> Option<Sense> {
        Sense::plain(word).or_else(|| self.senses.iter().find(|s| s.name == word).cloned())
    }

    /// Returns the unit of the values that the objective combines.
    pub fn unit(&self) -> Unit {
        match self.search.objective {
            Objective::ToleranceCost => Unit::Cost,
            _ if self.is_yield() => Unit::Share,
            _ => self.operations.first().map_or(Unit::Length, |o| o.sense.unit),
        }
    }

    /// Returns the goals that are measured for layouts of this cell.
    ///
    /// The goals include the cost of tolerances only if the search takes this cost into account. The goals
    /// include the cycle time only if the maximum speed of every joint with an actuator is given.
    pub fn measured_goals(&self) -> impl Iterator<Item = Goal> {
        let (has_cost, has_time) = (self.search.prices_tolerances(), self.has_speeds());
        Goal::ALL.into_iter().filter(move |goal| match goal {
            Goal::Cost => has_cost,
            Goal::Time => has_time,
            _ => true,
        })
    }

    /// Returns whether the maximum speed of every joint with an actuator is given. Cycle times require these
    /// speeds.
    pub fn has_speeds(&self) -> bool {
        self.robot.joints_without_speed().is_empty()
    }

    /// Returns whether the value of an operation is the share of arms whose error exceeds the limit.
    pub fn is_yield(&self) -> bool {
        (self.reading, self.quantity) == (Reading::Statistical, Quantity::Yield)
    }
}
