//! Model of a robot: plain data in SI units, valid by construction.

use super::error_model::ErrorSet;
use super::parameter::Parameter;
use super::rate_limits::RateLimits;
use super::shape::{Rectangle, Solid};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Largest number of joints of a robot. Joint vectors are arrays of this length, whose unused entries are
/// zero.
pub const MAX_JOINTS: usize = 8;

/// Largest number of error parameters of a robot: parameters of links, base, tool and joint frames, and
/// elastic parameters.
pub const MAX_PARAMETERS: usize = Parameter::count(MAX_JOINTS);

/// Largest number of error parameters that can differ from 0 in one error set of a robot.
pub const MAX_ERRORS: usize = Parameter::first_elastic(MAX_JOINTS);

/// Actuator coordinates, rad (revolute) or m (prismatic), measured from the zero posture as in the
/// [seed paper](crate).
pub type JointVector = [f64; MAX_JOINTS];

/// Kind of a joint.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    Revolute,
    Prismatic,
}

/// Denavit-Hartenberg convention of the rows in a robot file. In memory, all rows are standard rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Convention {
    /// Standard row `A = Rz(theta) Tz(r) Tx(l) Rx(alpha)`, which ends with the common normal and the twist.
    Standard,
    /// Modified row (Craig) `A = Tx(l) Rx(alpha) Rz(theta) Tz(r)`, which begins with the common normal and
    /// the twist.
    Modified,
}

impl Convention {
    /// Both conventions.
    pub const ALL: [Self; 2] = [Self::Standard, Self::Modified];

    /// Returns the name of this convention as it appears in files, for example `modified`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Standard => "standard",
            Self::Modified => "modified",
        }
    }
}

/// Joint as a standard Denavit-Hartenberg row, eq. (1) of the [seed paper](crate):
/// `A = Rz(theta) Tz(r) Tx(l) Rx(alpha)`.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    pub name: String,
    pub kind: JointKind,
    /// Angle theta at joint coordinate 0, rad; a revolute joint adds its coordinate.
    pub theta: f64,
    /// Axial offset r at joint coordinate 0, m; a prismatic joint adds its coordinate.
    pub r: f64,
    /// Common normal l: distance of this joint axis from the next joint axis, m.
    pub l: f64,
    /// Twist alpha: angle from this joint axis to the next joint axis, rad.
    pub alpha: f64,
    /// Lower and upper limit of the actuator coordinate, rad or m.
    ///
    /// Both limits are 0 for a passive joint. A passive joint has no actuator. Other joints move it through
    /// [`Robot::coupling`].
    pub limits: (f64, f64),
    pub rates: RateLimits,
}

impl Joint {
    /// Returns whether the joint has no actuator. Other joints move such a joint through [`Robot::coupling`].
    pub fn is_passive(&self) -> bool {
        self.limits.0 == self.limits.1
    }
}

/// Solid that moves with a link.
///
/// Link 0 is the robot base. Link k moves with the frame after the k-th Denavit-Hartenberg row.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkSolid {
    pub link: usize,
    pub solid: Solid,
}

/// Mass that moves with a link.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkMass {
    /// Number of Denavit-Hartenberg rows before the frame with which the mass moves.
    pub link: usize,
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the frame with which the mass moves, m.
    pub centre: Vector3<f64>,
}

/// Settings of the self-collision check of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct SelfCollision {
    pub checked: bool,
    /// Pairs of [`Robot::solids`] that are allowed to touch. A contact is also allowed if two solids belong
    /// to one link or to neighbouring links.
    pub allowed: Vec<(usize, usize)>,
}

impl Default for SelfCollision {
    fn default() -> Self {
        Self { checked: true, allowed: Vec::new() }
    }
}

/// Robot: joints, limits, tool, solids, masses and error sets.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    pub name: String,
    pub source: String,
    /// Convention of the rows in the robot file; reports state the parameters in this convention.
    pub convention: Convention,
    /// Pose of Denavit-Hartenberg frame 0 in the frame of the robot base.
    pub mount: Pose,
    pub joints: Vec<Joint>,
    /// Pose of every joint frame, which is fixed to the link before the joint.
    ///
    /// The pose is given in the Denavit-Hartenberg frame of this link.
    ///
    /// For a URDF, the joint frame is the origin frame of the URDF joint. For a robot given as
    /// Denavit-Hartenberg rows, the pose is the identity.
    pub joint_frames: Vec<Pose>,
    /// Matrix that maps actuator coordinates to Denavit-Hartenberg coordinates: lower triangular, unit
    /// diagonal.
    ///
    /// Row i gives Denavit-Hartenberg coordinate i. For an arm without coupled joints, the matrix is the
    /// identity.
    pub coupling: Vec<Vec<f64>>,
    /// Home posture: actuator coordinates within the limits, rad or m.
    pub home: JointVector,
    /// Pose of the TCP in the last Denavit-Hartenberg frame.
    ///
    /// For a URDF it is the pose of the tip link, followed by the pose of the tool on that link.
    pub tool: Pose,
    /// Working direction of the tool in the frame of the TCP, unit length.
    pub tool_axis: Vector3<f64>,
    /// Solids on the links. Solids of the tool come last and move with the mechanical interface (flange).
    pub solids: Vec<LinkSolid>,
    /// Number of solids that belong to the tool.
    pub tool_solids: usize,
    /// Masses of the links and of the tool; a robot without masses has no gravity torques.
    pub masses: Vec<LinkMass>,
    pub self_collision: SelfCollision,
    /// Time, s, that each joint without a stated acceleration needs from rest to full speed. None if the file
    /// states no such time.
    pub full_speed_after: Option<f64>,
    /// Floor space of the robot base, in the base frame.
    pub footprint: Rectangle,
    pub errors: Vec<ErrorSet>,
    /// URDF from which the Denavit-Hartenberg rows were derived; None if the robot file states the rows.
    pub urdf: Option<UrdfOrigin>,
}

/// Source of Denavit-Hartenberg rows that were derived from a URDF.
#[derive(Debug, Clone, PartialEq)]
pub struct UrdfOrigin {
    /// Path of the URDF, relative to the folder of the cell.
    pub file: String,
    pub base_link: String,
    pub tip_link: String,
    /// Pose of the tip link in the last Denavit-Hartenberg frame.
    pub tip: Pose,
    /// Elements of the URDF that are not used, and how often each occurs.
    pub ignored: Vec<(String, usize)>,
}

/// Axial offset of a row, m, above which the reach is bounded by distances between points on the axes.
const FAR_ROW: f64 = 5.0;

impl Robot {
    /// Returns the number of joints.
    pub fn axes(&self) -> usize {
        self.joints.len()
    }

    /// Returns the indices of the joints with an actuator whose maximum speed is not given.
    pub fn joints_without_speed(&self) -> Vec<usize> {
        let lacks_speed = |joint: &Joint| !joint.is_passive() && joint.rates.velocity.is_none();
        let numbered = self.joints.iter().enumerate();
        numbered.filter(|(_, joint)| lacks_speed(joint)).map(|(k, _)| k).collect()
    }

    /// Returns theta, r, l and alpha (rad, m) of every row in the convention of the robot file.
    ///
    /// Theta and r are the values at joint coordinate 0.
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

    /// Returns an upper bound of the horizontal distance of the TCP from the base axis, m.
    pub fn reach(&self) -> f64 {
        let upright = self.mount.rotation.m33.abs() > 1.0 - 1e-12;
        let links = self.joints.iter().enumerate().map(|(i, joint)| {
            // The first offset and its travel lie along the base axis, unless the first axis is inclined.
            let axial = if i == 0 && upright { 0.0 } else { joint.r.abs() + self.travel(i) };
            joint.l.hypot(axial)
        });
        let aside = self.mount.translation.xy().norm();
        let by_rows = links.sum::<f64>() + self.tool.translation.norm();
        let has_far_rows = self.joints.iter().any(|joint| joint.r.abs() > FAR_ROW);
        aside + if has_far_rows { by_rows.min(self.reach_of_axes(upright)) } else { by_rows }
    }

    /// Returns an upper bound of the distance of the TCP from the base axis, or from the origin of the first
    /// row if `upright` is false.
    ///
    /// The bound is the sum of the distances between one point on each axis and the next. The axial offsets
    /// of almost parallel axes can be hundreds of metres, but points near each other exist on such axes.
    /// Least squares (Gauss-Seidel) choose the points; any choice gives a valid bound.
    fn reach_of_axes(&self, upright: bool) -> f64 {
        const SWEEPS: usize = 200;
        let n = self.joints.len();
        // Coordinate of the point along each axis.
        let mut at = vec![0.0; n];
        let (sin_cos, t): (Vec<_>, _) =
            (self.joints.iter().map(|joint| joint.alpha.sin_cos()).collect(), self.tool.translation);
        for _ in 0..SWEEPS {
            for i in 0..n {
                let row = &self.joints[i];
                let (sin, cos) = sin_cos[i];
                let after = match at.get(i + 1) {
                    Some(next) => row.r + next * cos,
                    None => row.r + t.y * sin + t.z * cos,
                };
                let before = match i {
                    0 => (!upright).then_some(0.0),
                    _ => Some((at[i - 1] - self.joints[i - 1].r) * sin_cos[i - 1].1),
                };
                at[i] = before.map_or(after, |before| (before + after) / 2.0);
            }
        }
        let link = |i: usize| {
            let (row, (sin, cos)) = (&self.joints[i], sin_cos[i]);
            let end = match at.get(i + 1) {
                Some(next) => Vector3::new(row.l, -next * sin, row.r + next * cos),
                None => Vector3::new(row.l + t.x, t.y * cos - t.z * sin, row.r + t.y * sin + t.z * cos),
            };
            (end - Vector3::new(0.0, 0.0, at[i])).norm() + self.travel(i)
        };
        let first = if upright { 0.0 } else { at.first().map_or(0.0, |at| at.abs()) };
        first + (0..n).map(link).sum::<f64>()
    }

    /// Returns an upper bound of the absolute value of the Denavit-Hartenberg coordinate `i`, m.
    ///
    /// The bound is a sum over all actuators. Each term is the absolute value of the coupling coefficient
    /// times the greatest absolute value of the actuator coordinate.
    ///
    /// Returns 0 for a revolute joint.
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
