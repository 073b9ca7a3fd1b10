//! The Denavit-Hartenberg chain and its forward kinematics.

use super::loads::Loads;
use super::periodic::PeriodicDeflection;
use crate::cell::{ErrorSet, HeldPart, JointKind, JointVector, MAX_JOINTS, Margins, Robot};
use crate::low_discrepancy::halton;
use crate::pose::{Pose, exact_sin_cos};
use nalgebra::{Matrix3, Vector3};
use std::sync::Arc;

/// One row of the Denavit-Hartenberg table, with the sine and cosine of its twist precomputed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    pub kind: JointKind,
    /// Joint angle theta at actuator coordinate 0, rad.
    pub theta: f64,
    /// Axial offset r at actuator coordinate 0, m.
    pub r: f64,
    /// Length l of the common normal, m.
    pub l: f64,
    /// Twist angle alpha, rad, from the joint axis before the link to the joint axis after the link.
    pub alpha: f64,
    /// Cosine of alpha. It is exact at multiples of a right angle, so parallel axes stay parallel.
    pub cos_alpha: f64,
    /// Sine of alpha, exact at multiples of a right angle.
    pub sin_alpha: f64,
    /// Least and greatest actuator coordinate, rad or m.
    pub limits: (f64, f64),
}

impl Link {
    /// Returns the link transform `Rz(theta) Tz(r) Tx(l) Rx(alpha)`, eq. (1) of the seed paper. `cos` and
    /// `sin` belong to the joint angle theta, and `r` is the axial offset, m.
    pub fn pose(&self, cos: f64, sin: f64, r: f64) -> Pose {
        step(&Pose::identity(), self, cos, sin, r)
    }

    /// Returns whether the joint is passive: its limits leave it only one coordinate.
    pub fn is_passive(&self) -> bool {
        self.limits.0 == self.limits.1
    }
}

/// One configuration of the chain: cosine, sine and axial offset `r` (m) of every D-H row.
///
/// The cosine and sine belong to the joint angle theta of the row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posture {
    pub cos: [f64; MAX_JOINTS],
    pub sin: [f64; MAX_JOINTS],
    pub r: [f64; MAX_JOINTS],
}

/// Frames of a chain at one posture, in the base frame of the robot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// D-H frames: entry 0 is the mount of the chain, entry k the frame after link k.
    ///
    /// Unused entries are the identity.
    pub links: [Pose; MAX_JOINTS + 1],
    /// Frame of the tool centre point (TCP).
    pub tcp: Pose,
}

impl Default for Frames {
    fn default() -> Self {
        Self { links: [Pose::identity(); MAX_JOINTS + 1], tcp: Pose::identity() }
    }
}

/// Serial chain with joint coupling and tool.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Pose of D-H frame 0 in the base frame of the robot.
    pub mount: Pose,
    pub links: Vec<Link>,
    /// Pose of every joint frame in the D-H frame of the link before the joint.
    ///
    /// A joint frame is fixed to the link before the joint.
    pub joint_frames: Vec<Pose>,
    /// Matrix that maps actuator coordinates to D-H coordinates: lower triangular with a unit diagonal.
    pub coupling: Vec<Vec<f64>>,
    /// Pose of the TCP in the frame of the mechanical interface, which is the last D-H frame.
    pub tool: Pose,
    /// Whether the tool is rotated relative to the mechanical interface.
    turned_tool: bool,
    /// Unit vector along the tool axis, in the frame of the TCP.
    pub tool_axis: Vector3<f64>,
    /// Masses of links, tool and held part, whose weights deflect elastic joints.
    pub loads: Loads,
    /// Periodic errors of the joints, which [`Chain::with_errors`] takes from an error set.
    pub periodic: Arc<[PeriodicDeflection]>,
}

impl Chain {
    /// Returns the chain of a robot, with the joint limits of the robot file.
    pub fn new(robot: &Robot) -> Self {
        let links = robot.joints.iter().map(|j| {
            let (sin_alpha, cos_alpha) = exact_sin_cos(j.alpha);
            let (theta, r, l, alpha, limits) = (j.theta, j.r, j.l, j.alpha, j.limits);
            Link { kind: j.kind, theta, r, l, alpha, cos_alpha, sin_alpha, limits }
        });
        let mut loads = Loads::default();
        robot.masses.iter().for_each(|m| loads[m.link].add(m.mass, &m.centre));
        Self {
            mount: robot.mount,
            links: links.collect(),
            joint_frames: robot.joint_frames.clone(),
            coupling: robot.coupling.clone(),
            tool: robot.tool,
            turned_tool: robot.tool.rotation != Matrix3::identity(),
            tool_axis: robot.tool_axis,
            loads,
            periodic: Arc::default(),
        }
    }

    /// Returns this chain with the periodic errors of an error set.
    ///
    /// In [`Self::periodic`], every periodic error has the factor 1. The actual factors are parameters of the
    /// error set ([`crate::cell::Parameter::Periodic`]), which the error model applies.
    pub fn with_errors(mut self, set: &ErrorSet) -> Self {
        let errors = set.signed().into_iter().flat_map(|sample| &sample.periodic);
        self.periodic =
            errors.map(|error| PeriodicDeflection::new(error, self.links[error.joint].theta)).collect();
        self
    }

    /// Returns this chain with the mass of a part that the tool holds.
    pub fn carrying(mut self, part: &HeldPart) -> Self {
        let last = self.axes();
        self.loads[last].add(part.mass, &self.tool.transform(&part.centre));
        self
    }

    /// Returns the chain of a robot, with its joint limits reduced by the margins of the cell.
    pub fn with_margins(robot: &Robot, margins: &Margins) -> Self {
        let mut chain = Self::new(robot);
        for (link, joint) in chain.links.iter_mut().zip(&robot.joints) {
            link.limits = margins.kept(joint);
        }
        chain
    }

    /// Returns the number of joints.
    pub fn axes(&self) -> usize {
        self.links.len()
    }

    /// Returns an upper bound of the distance from the frame before a link to the frame after it, m.
    pub fn link_length(&self, link: usize) -> f64 {
        let farthest = |link: &Link| link.limits.0.abs().max(link.limits.1.abs());
        let travel = match self.links[link].kind {
            JointKind::Prismatic => {
                self.coupling[link].iter().zip(&self.links).map(|(c, l)| c.abs() * farthest(l)).sum()
            }
            JointKind::Revolute => 0.0,
        };
        self.links[link].l.hypot(self.links[link].r.abs() + travel)
    }

    /// Returns the posture at actuator coordinates `q` (rad or m).
    pub fn posture(&self, q: &JointVector) -> Posture {
        let mut posture = Posture { cos: [1.0; MAX_JOINTS], sin: [0.0; MAX_JOINTS], r: [0.0; MAX_JOINTS] };
        for (i, link) in self.links.iter().enumerate() {
            let turn = match link.kind {
                JointKind::Revolute => self.dh_coordinate(i, q),
                JointKind::Prismatic => 0.0,
            };
            (posture.sin[i], posture.cos[i]) = (link.theta + turn).sin_cos();
            posture.r[i] = self.offset(i, q);
        }
        posture
    }

    /// Returns the axial offset r (m) of D-H row `i` at the actuator coordinates `q` (rad or m).
    pub fn offset(&self, i: usize, q: &JointVector) -> f64 {
        match self.links[i].kind {
            JointKind::Revolute => self.links[i].r,
            JointKind::Prismatic => self.links[i].r + self.dh_coordinate(i, q),
        }
    }

    /// Returns the displacement of the D-H coordinate of joint `i` by the actuators, rad or m.
    fn dh_coordinate(&self, i: usize, q: &JointVector) -> f64 {
        self.coupling[i].iter().zip(q).map(|(c, q)| c * q).sum()
    }

    /// Returns a copy of `posture` with the values in `by` (rad or m) added to the D-H coordinates (theta or
    /// r).
    pub fn displaced(&self, posture: &Posture, by: &JointVector) -> Posture {
        let mut displaced = *posture;
        for (i, link) in self.links.iter().enumerate() {
            match link.kind {
                JointKind::Revolute => {
                    let (sin, cos) = by[i].sin_cos();
                    displaced.cos[i] = posture.cos[i] * cos - posture.sin[i] * sin;
                    displaced.sin[i] = posture.sin[i] * cos + posture.cos[i] * sin;
                }
                JointKind::Prismatic => displaced.r[i] += by[i],
            }
        }
        displaced
    }

    /// Returns the posture at actuator coordinates 0, where theta and r have the values of the D-H table.
    pub fn zero_posture(&self) -> Posture {
        self.posture(&[0.0; MAX_JOINTS])
    }

    /// Returns point `k` + 1 of the Halton sequence, scaled to the joint ranges (rad or m).
    pub fn halton_sample(&self, k: usize) -> JointVector {
        let mut q = [0.0; MAX_JOINTS];
        for ((q, link), share) in q.iter_mut().zip(&self.links).zip(halton(k as u64 + 1)) {
            *q = link.limits.0 + (link.limits.1 - link.limits.0) * share;
        }
        q
    }

    /// Returns every frame of the chain at a posture.
    pub fn frames(&self, posture: &Posture) -> Frames {
        let mut frames = Frames::default();
        self.place(posture, &mut frames);
        frames
    }

    /// Writes every frame of the chain at a posture into the existing `frames`.
    #[inline]
    pub fn place(&self, posture: &Posture, frames: &mut Frames) {
        let mut t = self.mount;
        frames.links[0] = t;
        for (i, link) in self.links.iter().enumerate() {
            t = step(&t, link, posture.cos[i], posture.sin[i], posture.r[i]);
            frames.links[i + 1] = t;
        }
        frames.tcp = self.tcp_on(&t);
    }

    /// Writes the last frame and the TCP of a posture into `frames`. The frames before the last joint must
    /// already belong to the posture.
    #[inline]
    pub fn place_last(&self, posture: &Posture, frames: &mut Frames) {
        let Some((link, i)) = self.links.last().zip(self.axes().checked_sub(1)) else { return };
        let last = step(&frames.links[i], link, posture.cos[i], posture.sin[i], posture.r[i]);
        (frames.links[i + 1], frames.tcp) = (last, self.tcp_on(&last));
    }

    /// Returns whether the last joint leaves the computed position of the TCP unchanged, bit for bit.
    ///
    /// The D-H row of the joint then has neither a common normal nor a twist, and the TCP is on its axis.
    pub fn keeps_tcp_exactly(&self) -> bool {
        let is_on_axis = self.tool.translation.x == 0.0 && self.tool.translation.y == 0.0;
        let turns_alone =
            |link: &Link| link.kind == JointKind::Revolute && link.l == 0.0 && link.sin_alpha == 0.0;
        is_on_axis && self.links.last().is_some_and(turns_alone)
    }

    /// Returns the pose of the TCP if the last link has the pose `last`.
    #[inline]
    fn tcp_on(&self, last: &Pose) -> Pose {
        match self.turned_tool {
            true => *last * self.tool,
            false => Pose { translation: last.transform(&self.tool.translation), ..*last },
        }
    }

    /// Returns the pose of the TCP in the base frame of the robot.
    ///
    /// This is the product of the mount, the D-H chain (eq. (2) of the seed paper) and the tool.
    pub fn forward(&self, posture: &Posture) -> Pose {
        let mut t = self.mount;
        for (i, link) in self.links.iter().enumerate() {
            t = step(&t, link, posture.cos[i], posture.sin[i], posture.r[i]);
        }
        self.tcp_on(&t)
    }
}

/// Returns the frame after a link: `T A`, where `T` is the frame `t` before the link and `A` the link
/// transform.
///
/// Products with those entries of `A` that are always 0 are not computed.
#[inline(always)] // a call that is not inlined makes `Chain::place` three times as slow
fn step(t: &Pose, link: &Link, c: f64, s: f64, r: f64) -> Pose {
    let (x, y, z) = (t.rotation.column(0), t.rotation.column(1), t.rotation.column(2));
    let x1 = x * c + y * s;
    let y1 = y * c - x * s;
    // Most links have parallel or perpendicular axes.
    let (y2, z2) = match (link.cos_alpha, link.sin_alpha) {
        (1.0, 0.0) => (y1, z.into_owned()),
        (0.0, sa) => (z * sa, y1 * -sa),
        (ca, sa) => (y1 * ca + z * sa, z * ca - y1 * sa),
    };
    Pose { rotation: Matrix3::from_columns(&[x1, y2, z2]), translation: t.translation + z * r + x1 * link.l }
}
