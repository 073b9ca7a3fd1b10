//! What exists in a workcell: plain data in SI units, valid by construction.

use super::robot_model::{Robot, SignedErrors};
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
}

/// A box that no equipment may enter, in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct KeepOut {
    pub name: String,
    pub min: Vector3<f64>,
    pub max: Vector3<f64>,
}

/// In which sense the error is measured: world axes of the position error.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sense {
    X,
    Y,
    Z,
    Xy,
    Xyz,
}

impl Sense {
    pub const ALL: [Sense; 5] = [Sense::X, Sense::Y, Sense::Z, Sense::Xy, Sense::Xyz];

    pub fn name(self) -> &'static str {
        match self {
            Sense::X => "x",
            Sense::Y => "y",
            Sense::Z => "z",
            Sense::Xy => "xy",
            Sense::Xyz => "xyz",
        }
    }

    /// Size of the position error in this sense, same unit.
    pub fn of(self, e: &Vector3<f64>) -> f64 {
        match self {
            Sense::X => e.x.abs(),
            Sense::Y => e.y.abs(),
            Sense::Z => e.z.abs(),
            Sense::Xy => (e.x * e.x + e.y * e.y).sqrt(),
            Sense::Xyz => e.norm(),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Model {
    /// Eqs. (4)-(6).
    Nonlinear,
    /// Eqs. (7)-(8).
    Linear,
}

impl Model {
    pub const ALL: [Model; 2] = [Model::Nonlinear, Model::Linear];

    pub fn name(self) -> &'static str {
        match self {
            Model::Nonlinear => "nonlinear",
            Model::Linear => "linear",
        }
    }
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
    /// Tool bending angle: elevation of the tool axis above the horizontal, rad; -pi/2 points down.
    pub bend: f64,
    pub sense: Sense,
    pub weight: f64,
}

impl Operation {
    pub fn nodes(&self) -> usize {
        (self.grid.0 + 1) * (self.grid.1 + 1)
    }
}

/// How the errors of several operations make one objective.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Objective {
    WeightedSum,
    WeightedMaximum,
}

impl Objective {
    pub const ALL: [Objective; 2] = [Objective::WeightedSum, Objective::WeightedMaximum];

    pub fn name(self) -> &'static str {
        match self {
            Objective::WeightedSum => "sum",
            Objective::WeightedMaximum => "max",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Solver {
    CmaEs,
    ParticleSwarm,
    SimulatedAnnealing,
}

impl Solver {
    pub const ALL: [Solver; 3] = [Solver::CmaEs, Solver::ParticleSwarm, Solver::SimulatedAnnealing];

    pub fn name(self) -> &'static str {
        match self {
            Solver::CmaEs => "cma-es",
            Solver::ParticleSwarm => "particle-swarm",
            Solver::SimulatedAnnealing => "simulated-annealing",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SearchSettings {
    pub solver: Solver,
    pub objective: Objective,
    /// Layout evaluations.
    pub budget: u64,
    pub seed: u64,
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
    pub equipment: Vec<Equipment>,
    pub keep_out: Vec<KeepOut>,
    pub operations: Vec<Operation>,
    /// Whether anything is checked for collision and overlap.
    pub collision: bool,
    /// Least distance between solids, m; at 0 touching counts as collision.
    pub clearance: f64,
    /// Height of the floor in the world, m.
    pub floor: f64,
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

    /// The chosen sample of the kinematic errors.
    pub fn signed_errors(&self) -> &SignedErrors {
        &self.robot.errors[self.errors]
    }
}
