//! Linear and second-order error model: derivatives of the TCP pose with respect to every parameter.
//!
//! The models are eqs. (7)-(8) and section 2.3 of the seed paper.

use super::Perturbation;
use super::elastic::deflection;
use crate::cell::{JointKind, MAX_JOINTS, PER_FRAME, PER_LINK, Parameter};
use crate::pose::{Displacement, Pose};
use crate::robot::{Chain, Frames, Loads, PeriodicDeflection};
use nalgebra::Vector3;
use std::sync::Arc;

/// Effect of one unit of a small motion on the TCP: displacement `g` and rotation `w` of the TCP.
///
/// The displacement is in m per unit. The rotation is the unit vector along the axis of the motion, or zero
/// for a translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MotionTerm {
    pub g: Vector3<f64>,
    pub w: Vector3<f64>,
}

impl MotionTerm {
    const NONE: Self = Self { g: Vector3::new(0.0, 0.0, 0.0), w: Vector3::new(0.0, 0.0, 0.0) };

    /// Returns the effect of the motion with index `k` in the order of [`Parameter::of_robot`].
    ///
    /// Motions of joint frames are not allowed here. The function [`Self::of_joint`] handles them.
    ///
    /// The motion with the index of the parameter dq is a rotation about the joint axis, even at a prismatic
    /// joint. The translation along the axis of a prismatic joint has the index of dr.
    #[inline(always)]
    fn of(frames: &Frames, axes: usize, k: usize) -> Self {
        let links = PER_LINK * axes;
        let (frame, axis, turns) = if k < links {
            let (before, after) = (&frames.links[k / PER_LINK], &frames.links[k / PER_LINK + 1]);
            match k % PER_LINK {
                0 => (before, 2, true),
                1 => (before, 2, false),
                2 => (after, 0, false),
                3 => (after, 0, true),
                _ => (after, 1, true),
            }
        } else {
            let component = (k - links) % PER_FRAME;
            let frame = if k < links + PER_FRAME { &Pose::IDENTITY } else { &frames.tcp };
            (frame, component % 3, component >= 3)
        };
        Self::about(frames, frame, axis, turns)
    }

    /// Returns the effect of motion `k` of the joint frames. `joints` holds the pose of each joint frame in
    /// the D-H frame of the link before the joint.
    ///
    /// This function is separate because [`Self::of`] must remain small enough to be inlined.
    #[inline(never)]
    fn of_joint(frames: &Frames, joints: &[Pose], k: usize) -> Self {
        let (joint, component) = (k / PER_FRAME, k % PER_FRAME);
        let frame = frames.links[joint] * joints[joint];
        Self::about(frames, &frame, component % 3, component >= 3)
    }

    /// Returns the effect of a rotation about an axis of a frame if `turns` is true; otherwise the effect of
    /// a translation along the axis.
    ///
    /// Without the attribute `inline(always)`, the linear model takes twice as long.
    #[inline(always)]
    fn about(frames: &Frames, frame: &Pose, axis: usize, turns: bool) -> Self {
        let axis = frame.rotation.column(axis).into_owned();
        Self::along(axis, &(frames.tcp.translation - frame.translation), turns)
    }

    /// Returns the effect of a motion on a point. The motion is a rotation about `axis` if `turns` is true,
    /// otherwise a translation along `axis`.
    ///
    /// The vector `arm` leads from the axis to the point, m.
    #[inline(always)]
    pub fn along(axis: Vector3<f64>, arm: &Vector3<f64>, turns: bool) -> Self {
        match turns {
            true => Self { g: axis.cross(arm), w: axis },
            false => Self { g: axis, w: Vector3::zeros() },
        }
    }
}

/// Returns the parameter indices of all motions, in order from base to tool.
///
/// If `joints` is true, the motions of each joint frame are included, before the motions of its D-H row.
fn outwards(axes: usize, joints: bool) -> impl Iterator<Item = usize> {
    let (base, tool) = (PER_LINK * axes, PER_LINK * axes + PER_FRAME);
    let frame = |first: usize| [0, 1, 2, 5, 4, 3].map(|k| first + k);
    let joint = move |i: usize| joints.then(|| frame(Parameter::first_joint(axes) + PER_FRAME * i));
    let row = move |i: usize| joint(i).into_iter().flatten().chain(PER_LINK * i..PER_LINK * (i + 1));
    frame(base).into_iter().chain((0..axes).flat_map(row)).chain(frame(tool))
}

/// Returns the error under the linear model, eqs. (7)-(8) of the seed paper: the sum of all small motions.
pub fn linear(frames: &Frames, errors: &Perturbation) -> Displacement {
    let axes = errors.links().len();
    let [sizes, of_joints] = errors.sizes();
    let add = |sum, MotionTerm { g, w }: MotionTerm, size: f64| {
        sum + Displacement { position: g, rotation: w } * size
    };
    let wrong = sizes.iter().enumerate().filter(|(_, size)| **size != 0.0);
    let sum =
        wrong.fold(Displacement::NONE, |sum, (k, size)| add(sum, MotionTerm::of(frames, axes, k), *size));
    let wrong = of_joints.iter().enumerate().filter(|(_, size)| **size != 0.0);
    wrong.fold(sum, |sum, (k, size)| add(sum, MotionTerm::of_joint(frames, errors.joint_frames(), k), *size))
}

/// Returns the error under the second-order model.
///
/// The displacement that each small motion causes is rotated by the sum of all rotations nearer to the base.
/// Half of the motion's own rotation is added to this sum. The rotation vectors are composed to second order.
pub fn second_order(frames: &Frames, errors: &Perturbation) -> Displacement {
    let axes = errors.links().len();
    let (mut sum, mut turned) = (Displacement::NONE, Vector3::zeros());
    let (joints, [sizes, of_joints]) = (errors.joint_frames(), errors.sizes());
    for k in outwards(axes, !joints.is_empty()) {
        let of_joint = k.checked_sub(sizes.len());
        let size = of_joint.map_or_else(|| sizes[k], |k| of_joints[k]);
        if size != 0.0 {
            let MotionTerm { g, w } = of_joint
                .map_or_else(|| MotionTerm::of(frames, axes, k), |k| MotionTerm::of_joint(frames, joints, k));
            let (g, w) = (g * size, w * size);
            sum.position += g + (turned + w / 2.0).cross(&g);
            sum.rotation += w + turned.cross(&w) / 2.0;
            turned += w;
        }
    }
    sum
}

/// Returns the joint whose frame a motion displaces. `k` is the index of the motion among the motions of all
/// joint frames.
fn frame_of(k: usize) -> usize {
    k / PER_FRAME
}

/// Largest number of small motions of a chain, reached by a chain with [`MAX_JOINTS`] joints.
const MAX_MOTIONS: usize = Parameter::first_elastic(MAX_JOINTS);

/// First and second derivatives of the TCP pose with respect to the parameters of one chain, in the base
/// frame.
///
/// An expansion holds the derivatives at one posture at a time and is reused between postures.
#[derive(Debug, Clone)]
pub struct Expansion {
    axes: usize,
    joint_frames: Vec<Pose>,
    terms: [MotionTerm; MAX_MOTIONS],
    /// Motions (index and size) that a unit error of each actuator causes through the joint coupling.
    drives: Vec<Vec<(usize, f64)>>,
    /// Indices of the motions that [`Self::set`] updates.
    wanted: Vec<usize>,
    loads: Loads,
    periodic: Arc<[PeriodicDeflection]>,
    /// Elastic parameters in the order of [`Parameter::elastic`], each with the motion that it causes (index
    /// and size). The motions belong to the posture of the last [`Self::set`]. The list is empty if no
    /// elastic parameter is wanted.
    elastic: Vec<(Parameter, (usize, f64))>,
}

impl Expansion {
    /// Returns an expansion that holds the derivatives with respect to all parameters of the robot.
    pub fn new(chain: &Chain) -> Self {
        let axes = chain.axes();
        let drives = (0..axes).map(|j| {
            let driven = (j..axes).filter(|&i| chain.coupling[i][j] != 0.0);
            let motion = |i: usize| match chain.links[i].kind {
                JointKind::Revolute => PER_LINK * i,
                JointKind::Prismatic => PER_LINK * i + 1,
            };
            driven.map(|i| (motion(i), chain.coupling[i][j])).collect()
        });
        let (drives, wanted) = (drives.collect(), (0..Parameter::first_elastic(axes)).collect());
        let (joint_frames, loads, periodic, terms) = (
            chain.joint_frames.clone(),
            chain.loads,
            chain.periodic.clone(),
            [MotionTerm::NONE; MAX_MOTIONS],
        );
        let elastic = Parameter::elastic(axes).map(|p| (p, (PER_LINK * p.deflected_joint(), 0.0)));
        Self { axes, joint_frames, terms, drives, wanted, loads, periodic, elastic: elastic.collect() }
    }

    /// Returns an expansion that holds only the derivatives with respect to `parameters` (indices). All other
    /// derivatives are undefined.
    pub fn of(chain: &Chain, parameters: &[usize]) -> Self {
        let mut expansion = Self::new(chain);
        let mut wanted: Vec<usize> =
            parameters.iter().flat_map(|&p| expansion.motions(p)).map(|motion| motion.0).collect();
        wanted.sort_unstable();
        wanted.dedup();
        expansion.wanted = wanted;
        if parameters.iter().all(|&p| p < Parameter::first_elastic(chain.axes())) {
            expansion.elastic.clear();
        }
        expansion
    }

    /// Updates the derivatives for another posture, given by its `frames`.
    pub fn set(&mut self, frames: &Frames) {
        let first_joint = Parameter::first_joint(self.axes);
        let joints = self.wanted.partition_point(|&k| k < first_joint);
        for &k in &self.wanted[..joints] {
            self.terms[k] = MotionTerm::of(frames, self.axes, k);
        }
        for motions in
            self.wanted[joints..].chunk_by(|a, b| frame_of(a - first_joint) == frame_of(b - first_joint))
        {
            let joint = frame_of(motions[0] - first_joint);
            let frame = frames.links[joint] * self.joint_frames[joint];
            for &k in motions {
                let component = (k - first_joint) % PER_FRAME;
                self.terms[k] = MotionTerm::about(frames, &frame, component % 3, component >= 3);
            }
        }
        for (parameter, (_, size)) in &mut self.elastic {
            *size = deflection(frames, &self.loads, &self.periodic, *parameter).map_or(0.0, |(_, size)| size);
        }
    }

    /// Returns the first derivative of the TCP pose with respect to a parameter.
    pub fn first(&self, parameter: usize) -> Displacement {
        if self.is_motion(parameter) {
            return Displacement { position: self.terms[parameter].g, rotation: self.terms[parameter].w };
        }
        self.motions(parameter).fold(Displacement::NONE, |sum, (k, size)| {
            sum + Displacement { position: self.terms[k].g, rotation: self.terms[k].w } * size
        })
    }

    /// Returns the second derivative of the TCP pose (position and rotation vector) with respect to the
    /// parameters `a` and `b`.
    pub fn second(&self, a: usize, b: usize) -> Displacement {
        let mut sum = Displacement::NONE;
        if a == b && self.is_motion(a) {
            let MotionTerm { g, w } = &self.terms[a];
            return Displacement { position: w.cross(g), ..sum };
        }
        for (j, size_j) in self.motions(a) {
            for (k, size_k) in self.motions(b) {
                let (j, k) = if self.place(j) <= self.place(k) { (j, k) } else { (k, j) };
                let (w, later) = (self.terms[j].w, self.terms[k]);
                let rotation = if j == k { Vector3::zeros() } else { w.cross(&later.w) / 2.0 };
                sum = sum + Displacement { position: w.cross(&later.g), rotation } * (size_j * size_k);
            }
        }
        sum
    }

    /// Returns whether one unit of a parameter causes one unit of the motion with the same index, and no
    /// other motion.
    fn is_motion(&self, parameter: usize) -> bool {
        let is_actuator = parameter < PER_LINK * self.axes && parameter.is_multiple_of(PER_LINK);
        !is_actuator && parameter < Parameter::first_elastic(self.axes)
    }

    /// Returns the effect of the motion with index `k` at the posture of the last [`Self::set`].
    pub fn term(&self, k: usize) -> &MotionTerm {
        &self.terms[k]
    }

    /// Returns the motions (index and size) that one unit of a parameter causes.
    pub fn motions(&self, parameter: usize) -> impl Iterator<Item = (usize, f64)> + '_ {
        let is_actuator = parameter < PER_LINK * self.axes && parameter.is_multiple_of(PER_LINK);
        let driven: &[_] = if is_actuator { &self.drives[parameter / PER_LINK] } else { &[] };
        let own = match parameter.checked_sub(Parameter::first_elastic(self.axes)) {
            None => (!is_actuator).then_some((parameter, 1.0)),
            Some(k) => self.elastic.get(k).map(|(_, motion)| *motion),
        };
        driven.iter().copied().chain(own)
    }

    /// Returns the rank, counted from 0, of the motion with index `k` in the order from base to tool.
    ///
    /// The rank also counts the motions of all joint frames.
    pub fn place(&self, k: usize) -> usize {
        let (base, first_joint) = (PER_LINK * self.axes, Parameter::first_joint(self.axes));
        // The closure returns the rank of the first motion of joint frame i. The motions of the D-H row of
        // joint i follow.
        let joint = |i: usize| PER_FRAME + (PER_FRAME + PER_LINK) * i;
        let in_frame = |first: usize| [0, 1, 2, 5, 4, 3][(k - first) % PER_FRAME];
        match k {
            _ if k < base => joint(k / PER_LINK) + PER_FRAME + k % PER_LINK,
            _ if k < base + PER_FRAME => in_frame(base),
            _ if k < first_joint => joint(self.axes) + in_frame(base),
            _ => joint((k - first_joint) / PER_FRAME) + in_frame(first_joint),
        }
    }
}
