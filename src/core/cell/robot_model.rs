//! Model of a robot: plain data in SI units, valid by construction.

use super::error_model::{ErrorSet, PER_FRAME, PER_LINK};
use super::shape::{Rectangle, Solid};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Longest chain of joints. Joint vectors are arrays of this length; the unused tail is zero.
pub const MAX_JOINTS: usize = 8;

/// Largest number of error parameters of a robot: those of its links, base, tool and joint frames.
pub const MAX_PARAMETERS: usize = (PER_LINK + PER_FRAME) * MAX_JOINTS + 2 * PER_FRAME;

/// Actuator coordinates, rad (revolute) or m (prismatic), counted from the zero posture as in the seed paper.
pub type JointVector = [f64; MAX_JOINTS];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    Revolute,
    Prismatic,
}

/// Denavit-Hartenberg convention of the rows of a file. The crate itself uses standard rows only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// `A = Rz(theta) Tz(r) Tx(l) Rx(alpha)`: a row ends with its common normal.
    Standard,
    /// Craig's `A = Tx(l) Rx(alpha) Rz(theta) Tz(r)`: a row begins with its common normal.
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
    /// Lower and upper limit of the actuator coordinate, rad or m.
    ///
    /// Both are 0 for a passive joint, which follows the others through the coupling alone.
    pub limits: (f64, f64),
}

impl Joint {
    pub fn is_passive(&self) -> bool {
        self.limits.0 == self.limits.1
    }
}

/// Solid that moves with a link: link 0 is the robot base, link k has the frame after `A_k`.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkSolid {
    pub link: usize,
    pub solid: Solid,
}

/// Self-collision check of a robot.
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
    /// Convention of the rows in the robot's file, by which reports name the parameters.
    pub convention: Convention,
    /// Pose of D-H frame 0 in the robot base.
    pub mount: Pose,
    pub joints: Vec<Joint>,
    /// Pose of every joint frame in the D-H frame before its row, fixed to the link before the joint.
    ///
    /// It is the origin frame of a URDF joint, and the identity for D-H rows.
    pub joint_frames: Vec<Pose>,
    /// Matrix that maps actuator to D-H coordinates: lower triangular with a unit diagonal.
    ///
    /// Row i gives D-H coordinate i. A serial arm has the identity.
    pub coupling: Vec<Vec<f64>>,
    /// Home posture: actuator coordinates inside the limits, rad or m.
    pub home: JointVector,
    /// Pose of the TCP in the last D-H frame.
    ///
    /// For a URDF it is the pose of the tip link, followed by the pose of the tool on that link.
    pub tool: Pose,
    /// Working direction of the tool in the frame of the TCP, unit length.
    pub tool_axis: Vector3<f64>,
    /// Solids on the links; those of the tool come last and move with the mechanical interface.
    pub solids: Vec<LinkSolid>,
    /// Number of the solids that belong to the tool.
    pub tool_solids: usize,
    pub self_collision: SelfCollision,
    /// Floor space of the base, in its frame.
    pub footprint: Rectangle,
    pub errors: Vec<ErrorSet>,
    /// URDF from which the rows were derived; None for a robot written as D-H rows.
    pub urdf: Option<UrdfOrigin>,
}

/// Origin of D-H rows that were derived from a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOrigin {
    /// Path of the URDF, relative to the folder of the cell.
    pub file: String,
    pub base_link: String,
    pub tip_link: String,
    /// Pose of the tip link in the last D-H frame.
    pub tip: Pose,
    /// Elements of the URDF that are not used, and how often each occurs.
    pub ignored: Vec<(String, usize)>,
}

impl Robot {
    pub fn axes(&self) -> usize {
        self.joints.len()
    }

    /// Returns theta, r, l and alpha (rad, m) of every row in the convention of the robot file.
    ///
    /// Theta and r are those at coordinate 0.
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

    /// Returns an upper bound of the distance of the TCP from the base axis, m.
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

    /// Returns the largest distance of a prismatic D-H coordinate from 0, m, with all coupled actuators; 0 if
    /// revolute.
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
