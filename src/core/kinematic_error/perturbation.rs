//! Signed sample of the parameter errors, prepared for the error models.

use super::elastic::ElasticErrors;
use crate::cell::{JointKind, MAX_JOINTS, PER_FRAME, PER_LINK, Parameter, SignedErrors};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};

/// Small rotation angle with sine and versine (1 minus cosine), computed without loss of digits.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    /// Angle, rad.
    pub angle: f64,
    pub sin: f64,
    /// Versine `1 - cos(angle)`, computed from half the angle.
    pub versine: f64,
}

impl Turn {
    /// Returns the small rotation by `angle` (rad).
    pub fn new(angle: f64) -> Self {
        if angle == 0.0 {
            return Self::default();
        }
        let (sin, cos) = (angle / 2.0).sin_cos();
        Self { angle, sin: 2.0 * sin * cos, versine: 2.0 * sin * sin }
    }
}

/// Errors of one link: the four errors of eq. (4) of the seed paper, and dbeta. The error dbeta is a
/// rotation about the y axis after the link.
///
/// The errors dtheta (revolute joint) and dr (prismatic joint) include the errors that the joint coupling
/// transmits from other actuators.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LinkError {
    pub dtheta: Turn,
    /// Error of the axial offset, m.
    pub dr: f64,
    pub dl: f64,
    pub dalpha: Turn,
    pub dbeta: Turn,
}

/// Error of a frame in its own axes: translation along x, y and z (m), then rotations about z, y and x in
/// this order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameError {
    pub slides: [f64; 3],
    /// Rotations about x, y and z, stored in this order.
    pub turns: [Turn; 3],
}

impl FrameError {
    /// Returns the frame error with the components `values`: three translations (m), then three rotations
    /// (rad) about x, y and z. Returns None if all components are 0.
    pub fn new(values: &[f64]) -> Option<Self> {
        let value = |k: usize| values.get(k).copied().unwrap_or(0.0);
        let any = (0..PER_FRAME).any(|k| value(k) != 0.0);
        let (slides, turns) = ([value(0), value(1), value(2)], [3, 4, 5].map(|k| Turn::new(value(k))));
        any.then_some(Self { slides, turns })
    }
}

/// Errors and poses of the joint frames. Each pose is given in the D-H frame of the link before the joint.
#[derive(Debug, Clone, PartialEq)]
pub struct JointErrors {
    sizes: [f64; PER_FRAME * MAX_JOINTS],
    pub frames: [Pose; MAX_JOINTS],
    pub errors: [Option<FrameError>; MAX_JOINTS],
}

impl JointErrors {
    /// Returns the errors of the joint frames, given by six values per joint.
    fn new(chain: &Chain, values: &[f64]) -> Self {
        let (sizes, frames) = ([0.0; PER_FRAME * MAX_JOINTS], [Pose::identity(); MAX_JOINTS]);
        let mut all = Self { sizes, frames, errors: [None; MAX_JOINTS] };
        all.sizes[..values.len()].copy_from_slice(values);
        all.frames.iter_mut().zip(&chain.joint_frames).for_each(|(to, frame)| *to = *frame);
        let values = values.chunks(PER_FRAME);
        all.errors.iter_mut().zip(values).for_each(|(error, values)| *error = FrameError::new(values));
        all
    }
}

/// Largest number of small motions of a chain, without the motions of the joint frames.
///
/// Joint frames seldom have errors and are stored separately. Millions of samples are created, so each
/// sample must take little memory.
const MAX_MOTIONS: usize = Parameter::first_joint(MAX_JOINTS);

/// Signed sample of the parameter errors of one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    links: [LinkError; MAX_JOINTS],
    axes: usize,
    sizes: [f64; MAX_MOTIONS],
    pub base: Option<FrameError>,
    pub tool: Option<FrameError>,
    pub joints: Option<JointErrors>,
    /// Elastic errors. They are boxed to keep the sample small, because most samples have no elastic errors.
    pub elastic: Option<Box<ElasticErrors>>,
}

impl Perturbation {
    /// Prepares the signed sample of a cell file for the error models.
    pub fn new(chain: &Chain, errors: &SignedErrors) -> Self {
        Self::of_values(chain, &errors.values())
    }

    /// Prepares parameter errors in the order of [`Parameter::of_robot`]. The list `values` may end before
    /// the errors of the joint frames.
    ///
    /// The error dq is an error of an actuator coordinate. The joint coupling maps it to errors of the D-H
    /// coordinates. The function allocates memory only for elastic errors.
    pub fn of_values(chain: &Chain, values: &[f64]) -> Self {
        let axes = chain.axes();
        let mut links = [LinkError::default(); MAX_JOINTS];
        let mut sizes = [0.0; MAX_MOTIONS];
        let (values, joints) = values.split_at(Parameter::first_joint(axes));
        let (joints, elastic) = joints.split_at(joints.len().min(PER_FRAME * axes));
        sizes[..values.len()].copy_from_slice(values);
        for (i, (link, error)) in chain.links.iter().zip(&mut links).enumerate() {
            let own = &values[PER_LINK * i..];
            let dq: f64 = (0..=i).map(|j| chain.coupling[i][j] * values[PER_LINK * j]).sum();
            let (dtheta, slide) = match link.kind {
                JointKind::Revolute => (dq, 0.0),
                JointKind::Prismatic => (0.0, dq),
            };
            (sizes[PER_LINK * i], sizes[PER_LINK * i + 1]) = (dtheta, own[1] + slide);
            *error = LinkError {
                dtheta: Turn::new(dtheta),
                dr: own[1] + slide,
                dl: own[2],
                dalpha: Turn::new(own[3]),
                dbeta: Turn::new(own[4]),
            };
        }
        let (base, tool) = values[PER_LINK * axes..].split_at(PER_FRAME);
        let (base, tool) = (FrameError::new(base), FrameError::new(tool));
        let mut all = Self { links, axes, sizes, base, tool, joints: None, elastic: None };
        // The fields are assigned in place, because moving a `None` costs as much as moving a `Some`.
        if joints.iter().any(|v| *v != 0.0) {
            all.joints = Some(JointErrors::new(chain, joints));
        }
        if !elastic.is_empty() {
            all.elastic = ElasticErrors::new(chain, elastic).map(Box::new);
        }
        all
    }

    /// Returns this sample without its elastic errors.
    pub fn rigid(&self) -> Self {
        Self { elastic: None, ..self.clone() }
    }

    /// Returns a copy of this sample in which the errors dtheta include the elastic deflections at a posture.
    ///
    /// The field [`Self::elastic`] of the result is None, so that the deflections are not counted twice.
    pub fn deflected(&self, frames: &Frames) -> Self {
        let mut at = self.clone();
        let Some(elastic) = at.elastic.take() else { return at };
        for (i, turn) in elastic.deflections(frames).into_iter().enumerate().take(self.axes) {
            let dtheta = at.links[i].dtheta.angle + turn;
            at.links[i].dtheta = Turn::new(dtheta);
            at.sizes[PER_LINK * i] = dtheta;
        }
        at
    }

    /// Returns the sizes of the small motions (m or rad) in the order of [`Parameter::of_robot`].
    ///
    /// The first slice holds the motions of links, base and tool. A parameter dq ([`Parameter::Dq`]) is the
    /// error of an actuator coordinate. The slice holds dtheta, the error of the D-H coordinate theta, at the
    /// index of dq. The slice holds the error of the D-H coordinate r at the index of dr. These two errors
    /// include the effect of the joint coupling, but not the elastic deflections ([`Self::deflected`]). The
    /// second slice holds the motions of the joint frames, and is empty if no joint frame has an error.
    pub fn sizes(&self) -> [&[f64]; 2] {
        let joints = self.joints.as_ref().map_or(&[][..], |joints| &joints.sizes[..PER_FRAME * self.axes]);
        [&self.sizes[..Parameter::first_joint(self.axes)], joints]
    }

    /// Returns the pose of every joint frame in the D-H frame of the link before the joint. The list is empty
    /// if no joint frame has an error.
    pub fn joint_frames(&self) -> &[Pose] {
        self.joints.as_ref().map_or(&[], |joints| &joints.frames[..self.axes])
    }

    /// Returns the errors of the links, in order from the base to the tool.
    pub fn links(&self) -> &[LinkError] {
        &self.links[..self.axes]
    }
}
