//! A signed sample of the errors, made ready for the models.

use crate::cell::{JointKind, MAX_JOINTS, PER_FRAME, PER_LINK, Parameter, SignedErrors};
use crate::pose::Pose;
use crate::robot::Chain;

/// A small turn, with what its sine and cosine need: no two nearly equal numbers are subtracted.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Turn {
    /// rad
    pub angle: f64,
    pub sin: f64,
    /// 1 - cos(angle), from the half angle.
    pub versine: f64,
}

impl Turn {
    pub fn new(angle: f64) -> Self {
        if angle == 0.0 {
            return Self::default();
        }
        let (sin, cos) = (angle / 2.0).sin_cos();
        Self { angle, sin: 2.0 * sin * cos, versine: 2.0 * sin * sin }
    }
}

/// Errors of one link, eq. (4) with the fifth parameter; the joint coupling is in dtheta and dr.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct LinkError {
    pub dtheta: Turn,
    /// m
    pub dr: f64,
    pub dl: f64,
    pub dalpha: Turn,
    pub dbeta: Turn,
}

/// Error of a frame in itself: slides along x, y, z (m), then turns about z, y, x.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameError {
    pub slides: [f64; 3],
    /// About x, y, z.
    pub turns: [Turn; 3],
}

impl FrameError {
    /// None if nothing is wrong.
    pub fn new(values: &[f64]) -> Option<Self> {
        let value = |k: usize| values.get(k).copied().unwrap_or(0.0);
        let any = (0..PER_FRAME).any(|k| value(k) != 0.0);
        let (slides, turns) = ([value(0), value(1), value(2)], [3, 4, 5].map(|k| Turn::new(value(k))));
        any.then_some(Self { slides, turns })
    }
}

/// Errors of the joint frames, and where these are: in the D-H frame before their row.
#[derive(Debug, Clone, PartialEq)]
pub struct JointErrors {
    sizes: [f64; PER_FRAME * MAX_JOINTS],
    pub frames: [Pose; MAX_JOINTS],
    pub errors: [Option<FrameError>; MAX_JOINTS],
}

impl JointErrors {
    /// Of six values for every joint.
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

/// Most motions before those of the joint frames, which seldom are wrong: samples are made by the million.
const MOTIONS: usize = Parameter::first_joint(MAX_JOINTS);

/// One signed sample of the errors, for one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    links: [LinkError; MAX_JOINTS],
    axes: usize,
    sizes: [f64; MOTIONS],
    pub base: Option<FrameError>,
    pub tool: Option<FrameError>,
    pub joints: Option<JointErrors>,
}

impl Perturbation {
    pub fn new(chain: &Chain, errors: &SignedErrors) -> Self {
        Self::of_values(chain, &errors.values())
    }

    /// Of values in the order of [`Parameter::of_robot`], or of those before the joint frames. The error
    /// dq acts on the actuators: it reaches the D-H coordinates through the coupling. Does not allocate.
    pub fn of_values(chain: &Chain, values: &[f64]) -> Self {
        let axes = chain.axes();
        let mut links = [LinkError::default(); MAX_JOINTS];
        let mut sizes = [0.0; MOTIONS];
        let (values, joints) = values.split_at(Parameter::first_joint(axes));
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
        let mut all = Self { links, axes, sizes, base, tool, joints: None };
        // In place: to move what is not there would cost as much as to move it.
        if joints.iter().any(|v| *v != 0.0) {
            all.joints = Some(JointErrors::new(chain, joints));
        }
        all
    }

    /// Sizes of the motions, in the order of [`Parameter::of_robot`]; those of dq and dr are of the D-H
    /// coordinates. First all before the joint frames, then those of the joint frames: none if none is
    /// wrong.
    pub fn sizes(&self) -> [&[f64]; 2] {
        let joints = self.joints.as_ref().map_or(&[][..], |joints| &joints.sizes[..PER_FRAME * self.axes]);
        [&self.sizes[..Parameter::first_joint(self.axes)], joints]
    }

    /// Where the joint frames are in the D-H frame before their row; none if none is wrong.
    pub fn joint_frames(&self) -> &[Pose] {
        self.joints.as_ref().map_or(&[], |joints| &joints.frames[..self.axes])
    }

    pub fn links(&self) -> &[LinkError] {
        &self.links[..self.axes]
    }
}
