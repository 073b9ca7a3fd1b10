//! The chain of links and its forward kinematics.

use crate::cell::{JointKind, JointVector, MAX_JOINTS, Margins, Robot};
use crate::pose::{Pose, exact_sin_cos};
use nalgebra::{Matrix3, Vector3};

/// A D-H row made ready for the node loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Link {
    pub kind: JointKind,
    /// Angle and axial offset at coordinate 0 (rad, m).
    pub theta: f64,
    pub r: f64,
    /// Common normal, m.
    pub l: f64,
    /// Twist, rad, and its cosine and sine. Those of multiples of a right angle are exact, so that
    /// parallel axes stay parallel.
    pub alpha: f64,
    pub cos_alpha: f64,
    pub sin_alpha: f64,
    pub limits: (f64, f64),
}

impl Link {
    /// Eq. (1) at cosine and sine of theta, and r (m).
    pub fn pose(&self, cos: f64, sin: f64, r: f64) -> Pose {
        step(&Pose::identity(), self, cos, sin, r)
    }
}

/// The D-H variables of one configuration: cosine and sine of each theta, and each r (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Posture {
    pub cos: [f64; MAX_JOINTS],
    pub sin: [f64; MAX_JOINTS],
    pub r: [f64; MAX_JOINTS],
}

/// The frames of a chain at one posture, in the base.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// 0: where the chain stands on the base, k: the frame after `A_k`; the rest is identity.
    pub links: [Pose; MAX_JOINTS + 1],
    pub tcp: Pose,
}

impl Default for Frames {
    fn default() -> Self {
        Self { links: [Pose::identity(); MAX_JOINTS + 1], tcp: Pose::identity() }
    }
}

/// A serial chain with coupling and tool.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Robot base to D-H frame 0.
    pub mount: Pose,
    pub links: Vec<Link>,
    /// Joint frame k in D-H frame k, before row k.
    pub joint_frames: Vec<Pose>,
    /// D-H coordinates = `coupling` * actuators + zero; lower triangular, units on the diagonal.
    pub coupling: Vec<Vec<f64>>,
    /// Mechanical interface to TCP.
    pub tool: Pose,
    /// Whether the tool is turned against the mechanical interface.
    turned_tool: bool,
    /// Unit vector in the frame of the TCP.
    pub tool_axis: Vector3<f64>,
}

impl Chain {
    pub fn new(robot: &Robot) -> Self {
        let links = robot.joints.iter().map(|j| {
            let (sin_alpha, cos_alpha) = exact_sin_cos(j.alpha);
            let (theta, r, l, alpha, limits) = (j.theta, j.r, j.l, j.alpha, j.limits);
            Link { kind: j.kind, theta, r, l, alpha, cos_alpha, sin_alpha, limits }
        });
        Self {
            mount: robot.mount,
            links: links.collect(),
            joint_frames: robot.joint_frames.clone(),
            coupling: robot.coupling.clone(),
            tool: robot.tool,
            turned_tool: robot.tool.rotation != Matrix3::identity(),
            tool_axis: robot.tool_axis,
        }
    }

    /// The same with the limits that are kept.
    pub fn with_margins(robot: &Robot, margins: &Margins) -> Self {
        let mut chain = Self::new(robot);
        for (link, joint) in chain.links.iter_mut().zip(&robot.joints) {
            link.limits = margins.kept(joint);
        }
        chain
    }

    pub fn axes(&self) -> usize {
        self.links.len()
    }

    /// The posture at actuator coordinates `q` (rad or m).
    pub fn posture(&self, q: &JointVector) -> Posture {
        let mut posture = Posture { cos: [1.0; MAX_JOINTS], sin: [0.0; MAX_JOINTS], r: [0.0; MAX_JOINTS] };
        for (i, link) in self.links.iter().enumerate() {
            let coupled: f64 = self.coupling[i].iter().zip(q).map(|(c, q)| c * q).sum();
            let (turn, slide) = match link.kind {
                JointKind::Revolute => (coupled, 0.0),
                JointKind::Prismatic => (0.0, coupled),
            };
            (posture.sin[i], posture.cos[i]) = (link.theta + turn).sin_cos();
            posture.r[i] = link.r + slide;
        }
        posture
    }

    /// The k-th point of the Halton sequence between the joint limits.
    pub fn spread(&self, k: usize) -> JointVector {
        const PRIMES: [usize; MAX_JOINTS] = [2, 3, 5, 7, 11, 13, 17, 19];
        let radical = |base: usize| {
            let (mut n, mut value, mut digit) = (k + 1, 0.0, 1.0);
            while n > 0 {
                digit /= base as f64;
                value += digit * (n % base) as f64;
                n /= base;
            }
            value
        };
        let mut q = [0.0; MAX_JOINTS];
        for ((q, link), base) in q.iter_mut().zip(&self.links).zip(PRIMES) {
            *q = link.limits.0 + (link.limits.1 - link.limits.0) * radical(base);
        }
        q
    }

    /// Every frame of the chain at a posture.
    pub fn frames(&self, posture: &Posture) -> Frames {
        let mut frames = Frames::default();
        self.place(posture, &mut frames);
        frames
    }

    /// [`Self::frames`] into memory that is kept from posture to posture.
    #[inline]
    pub fn place(&self, posture: &Posture, frames: &mut Frames) {
        let mut t = self.mount;
        frames.links[0] = t;
        for (i, link) in self.links.iter().enumerate() {
            t = step(&t, link, posture.cos[i], posture.sin[i], posture.r[i]);
            frames.links[i + 1] = t;
        }
        frames.tcp = match self.turned_tool {
            true => t * self.tool,
            false => Pose { translation: t.transform(&self.tool.translation), ..t },
        };
    }

    /// Eq. (2) with the tool: the pose of the TCP in the base.
    pub fn forward(&self, posture: &Posture) -> Pose {
        self.frames(posture).tcp
    }
}

/// `T A` for one link, using the zeros of `A`.
#[inline]
fn step(t: &Pose, link: &Link, c: f64, s: f64, r: f64) -> Pose {
    let (x, y, z) = (t.rotation.column(0), t.rotation.column(1), t.rotation.column(2));
    let x1 = x * c + y * s;
    let y1 = y * c - x * s;
    // Parallel and right-angled axes are most of all links.
    let (y2, z2) = match (link.cos_alpha, link.sin_alpha) {
        (1.0, 0.0) => (y1, z.into_owned()),
        (0.0, sa) => (z * sa, y1 * -sa),
        (ca, sa) => (y1 * ca + z * sa, z * ca - y1 * sa),
    };
    Pose { rotation: Matrix3::from_columns(&[x1, y2, z2]), translation: t.translation + z * r + x1 * link.l }
}
