//! A robot: plain data in SI units, valid by construction.

use super::error_model::{ErrorSet, PER_FRAME, PER_LINK};
use super::shape::{Rectangle, Solid};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Longest chain of joints. Joint vectors are arrays of this length; the unused tail is zero.
pub const MAX_JOINTS: usize = 8;

/// Most error parameters of a robot: those of its links, of its base, tool and joint frames.
pub const MAX_PARAMETERS: usize = (PER_LINK + PER_FRAME) * MAX_JOINTS + 2 * PER_FRAME;

/// Actuator coordinates, rad (revolute) or m (prismatic), in the robot's own (the paper's) zero.
pub type JointVector = [f64; MAX_JOINTS];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    Revolute,
    Prismatic,
}

/// How the rows of a file are meant. Inside there are standard rows only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// `A = Rz(theta) Tz(r) Tx(l) Rx(alpha)`: a row ends with its common normal.
    Standard,
    /// Craig's `A = Tx(l) Rx(alpha) Rz(theta) Tz(r)`: a row begins with it.
    Modified,
}

impl Convention {
    pub const ALL: [Self; 2] = [Self::Standard, Self::Modified];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Modified => "modified",
        }
    }
}

/// One row of the standard Denavit-Hartenberg table, eq. (1): `A = Rz(theta) Tz(r) Tx(l) Rx(alpha)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    pub name: String,
    pub kind: JointKind,
    /// Angle theta at coordinate 0, rad (a revolute joint adds its coordinate).
    pub theta: f64,
    /// Axial offset at coordinate 0, m (a prismatic joint adds its coordinate).
    pub r: f64,
    /// Common normal, m.
    pub l: f64,
    /// Twist, rad.
    pub alpha: f64,
    /// Lower and upper limit of the actuator coordinate; both 0 of a passive joint, which follows the
    /// others by the coupling alone.
    pub limits: (f64, f64),
}

impl Joint {
    pub fn is_passive(&self) -> bool {
        self.limits.0 == self.limits.1
    }
}

/// A solid that moves with a link: 0 is the base, k the frame after `A_k`.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkSolid {
    pub link: usize,
    pub solid: Solid,
}

/// Whether the robot is checked against itself.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfCollision {
    pub checked: bool,
    /// Pairs of [`Robot::solids`] that may touch, besides those of one link and of neighbours.
    pub allowed: Vec<(usize, usize)>,
}

impl Default for SelfCollision {
    fn default() -> Self {
        Self { checked: true, allowed: Vec::new() }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    pub name: String,
    pub source: String,
    /// Convention of the rows in its file: reports name the parameters as the file does.
    pub convention: Convention,
    /// Robot base to D-H frame 0.
    pub mount: Pose,
    pub joints: Vec<Joint>,
    /// Frame of every joint in the D-H frame before its row, fixed to the link before it: the
    /// origin frame of a URDF joint, the identity for D-H rows.
    pub joint_frames: Vec<Pose>,
    /// Row i: how the D-H coordinate i follows the actuators, lower triangular with units on the
    /// diagonal; the identity for a serial arm.
    pub coupling: Vec<Vec<f64>>,
    /// Where the arm rests: actuator coordinates inside the limits, rad or m.
    pub home: JointVector,
    /// Last D-H frame to TCP: the tip link of a URDF comes first, then the tool.
    pub tool: Pose,
    /// Working direction of the tool in the frame of the TCP, unit length.
    pub tool_axis: Vector3<f64>,
    /// Solids on the links. The solids of the tool come last: they move with the mechanical interface.
    pub solids: Vec<LinkSolid>,
    /// How many of them are the tool's.
    pub tool_solids: usize,
    pub self_collision: SelfCollision,
    /// Floor space of the base, in its frame.
    pub footprint: Rectangle,
    pub errors: Vec<ErrorSet>,
    /// None of a robot written as D-H rows.
    pub urdf: Option<UrdfOrigin>,
}

/// Where rows come from that were derived from a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOrigin {
    /// Path of the URDF from the folder of the cell.
    pub file: String,
    pub base_link: String,
    pub tip_link: String,
    /// Last D-H frame to tip link.
    pub tip: Pose,
    /// What of it is not used, and how often it is there.
    pub ignored: Vec<(String, usize)>,
}

impl Robot {
    pub fn axes(&self) -> usize {
        self.joints.len()
    }

    /// Theta and r at coordinate 0, l and alpha of every row as its file has them (rad, m).
    pub fn rows_of_file(&self) -> Vec<[f64; 4]> {
        let turned = &self.mount.rotation;
        let first = (self.mount.translation.x, turned[(2, 1)].atan2(turned[(1, 1)]));
        let before = std::iter::once(first).chain(self.joints.iter().map(|j| (j.l, j.alpha)));
        let rows = self.joints.iter().zip(before);
        rows.map(|(j, (l, alpha))| match self.convention {
            Convention::Standard => [j.theta, j.r, j.l, j.alpha],
            Convention::Modified => [j.theta, j.r, l, alpha],
        })
        .collect()
    }

    /// An upper bound of the distance from the base axis that the TCP can reach, m.
    pub fn reach(&self) -> f64 {
        let upright = self.mount.rotation.m33.abs() > 1.0 - 1e-12;
        let links = self.joints.iter().enumerate().map(|(i, joint)| {
            // The first offset and its travel lie along the base axis, unless the first axis leans.
            let axial = if i == 0 && upright { 0.0 } else { joint.r.abs() + self.travel(i) };
            joint.l.hypot(axial)
        });
        let aside = self.mount.translation.xy().norm();
        aside + links.sum::<f64>() + self.tool.translation.norm()
    }

    /// How far the D-H coordinate of a sliding joint can be from 0, by its own and coupled actuators.
    fn travel(&self, i: usize) -> f64 {
        let farthest = |joint: &Joint| joint.limits.0.abs().max(joint.limits.1.abs());
        match self.joints[i].kind {
            JointKind::Prismatic => {
                self.coupling[i].iter().zip(&self.joints).map(|(c, j)| c.abs() * farthest(j)).sum()
            }
            JointKind::Revolute => 0.0,
        }
    }
}
