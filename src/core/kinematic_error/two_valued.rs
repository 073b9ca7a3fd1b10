//! Nonlinear position error of samples in which every parameter error has one of two values.
//!
//! The corners of a tolerance box are such samples. The small motions of both values are computed once. A
//! walk from the tool back to the base adds up the displacements that the motions cause. The walk keeps the
//! position error before each motion. For the next sample, the walk starts again at the first motion that
//! differs from the last sample.

use super::perturbation::Turn;
use crate::cell::{JointKind, PER_FRAME, PER_LINK, Parameter};
use crate::pose::Pose;
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Frame in whose axes small motions are given.
#[derive(Debug, Clone, Copy)]
enum WalkFrame {
    Base,
    /// Frame of the chain, by its index in [`Frames::links`].
    Link(usize),
    /// Frame of the joint with this index, and its pose in the D-H frame of the link before the joint.
    Joint(usize, Pose),
    Tool,
}

/// Parameter error that causes a small motion.
#[derive(Debug, Clone, Copy)]
struct MotionCause {
    /// Index of the parameter error.
    error: usize,
    /// Size of the motion per unit of the error.
    factor: f64,
}

/// Translation along an axis of a frame, caused by one parameter error.
#[derive(Debug, Clone, Copy)]
struct SlidePart {
    cause: MotionCause,
    /// Index of the frame in [`TwoValuedWalk::frames`], and index of the axis.
    axis: (usize, usize),
    /// Translations (base frame, m) for the two values, at the present posture.
    by: [Vector3<f64>; 2],
}

/// Small motion of the walk.
#[derive(Debug, Clone)]
enum WalkMotion {
    Turn {
        cause: MotionCause,
        /// Index of the frame in [`TwoValuedWalk::frames`], and index of the axis.
        frame: (usize, usize),
        by: [Turn; 2],
        /// Direction of the axis and a point on it, base frame, at the present posture.
        axis: Vector3<f64>,
        through: Vector3<f64>,
    },
    /// Translation with one part or several parts.
    Slide(Vec<SlidePart>),
}

/// Position error of a chain, computed by a walk through its small motions from the tool back to the base.
/// Every parameter error has one of two values.
#[derive(Debug, Clone)]
pub struct TwoValuedWalk {
    frames: Vec<WalkFrame>,
    steps: Vec<WalkMotion>,
    /// The two values of each parameter error, m or rad.
    values: Vec<[f64; 2]>,
    /// Index of the first step that depends on each parameter error.
    first: Vec<usize>,
    /// Position error before each step, and after the last step, m.
    reached: Vec<Vector3<f64>>,
    /// Bit set of the last sample: the parameter errors with the second value. None if the posture is new.
    last: Option<u128>,
}

impl TwoValuedWalk {
    /// Prepares the walk of a chain. `errors` holds the parameters that have an error, as indices in the
    /// order of [`Parameter::of_robot`].
    ///
    /// Returns None if there are more than 128 errors, if an error is elastic, or if a small motion depends
    /// on several errors.
    pub fn new(chain: &Chain, errors: &[usize]) -> Option<Self> {
        let axes = chain.axes();
        let is_elastic = |parameter: &usize| *parameter >= Parameter::first_elastic(axes);
        if errors.len() > 128 || errors.iter().any(is_elastic) {
            return None;
        }
        let mut walk = Self {
            frames: Vec::new(),
            steps: Vec::new(),
            values: vec![[0.0; 2]; errors.len()],
            first: vec![usize::MAX; errors.len()],
            reached: Vec::new(),
            last: None,
        };
        let known = |parameter: usize| {
            let error = errors.iter().position(|error| *error == parameter)?;
            Some(MotionCause { error, factor: 1.0 })
        };
        let frame_error =
            |first: usize| -> [Option<MotionCause>; PER_FRAME] { std::array::from_fn(|k| known(first + k)) };
        let base = PER_LINK * axes;
        walk.add_frame(WalkFrame::Tool, frame_error(base + PER_FRAME));
        for (i, link) in chain.links.iter().enumerate().rev() {
            let own = |k: usize| known(PER_LINK * i + k);
            // The error dq drives all joints that are coupled to it.
            let driven = (0..=i)
                .filter(|j| chain.coupling[i][*j] != 0.0)
                .filter_map(|j| Some(MotionCause { factor: chain.coupling[i][j], ..known(PER_LINK * j)? }));
            let mut driven: Vec<_> = driven.collect();
            let mut axial: Vec<_> = own(1).into_iter().collect();
            if link.kind == JointKind::Prismatic {
                axial.append(&mut driven);
            }
            if driven.len() > 1 || axial.len() > 1 {
                return None;
            }
            let (before, after) = (walk.frame(WalkFrame::Link(i)), walk.frame(WalkFrame::Link(i + 1)));
            walk.add_turn((after, 1), own(4));
            walk.add_turn((after, 0), own(3));
            walk.add_slide([((after, 0), own(2)), ((before, 2), axial.first().copied())]);
            walk.add_turn((before, 2), driven.first().copied());
            let joint = chain.joint_frames.get(i).copied().unwrap_or_else(Pose::identity);
            let first = Parameter::first_joint(axes) + PER_FRAME * i;
            walk.add_frame(WalkFrame::Joint(i, joint), frame_error(first));
        }
        walk.add_frame(WalkFrame::Base, frame_error(base));
        walk.reached = vec![Vector3::zeros(); walk.steps.len() + 1];
        Some(walk)
    }

    /// Adds a frame to the list of frames, and returns the index of this frame.
    fn frame(&mut self, frame: WalkFrame) -> usize {
        self.frames.push(frame);
        self.frames.len() - 1
    }

    /// Adds the motions of a frame error: rotations about x, y and z, then the translation.
    fn add_frame(&mut self, frame: WalkFrame, errors: [Option<MotionCause>; PER_FRAME]) {
        let frame = self.frame(frame);
        (0..3).for_each(|k| self.add_turn((frame, k), errors[3 + k]));
        self.add_slide([0, 1, 2].map(|k| ((frame, k), errors[k])));
    }

    fn add_turn(&mut self, frame: (usize, usize), cause: Option<MotionCause>) {
        let Some(cause) = cause else { return };
        self.note_first(&cause);
        let [axis, through] = [Vector3::zeros(); 2];
        self.steps.push(WalkMotion::Turn { cause, frame, by: [Turn::default(); 2], axis, through });
    }

    fn add_slide<const N: usize>(&mut self, parts: [((usize, usize), Option<MotionCause>); N]) {
        let part = |(axis, cause): ((usize, usize), Option<MotionCause>)| {
            Some(SlidePart { cause: cause?, axis, by: [Vector3::zeros(); 2] })
        };
        let parts: Vec<SlidePart> = parts.into_iter().filter_map(part).collect();
        parts.iter().for_each(|part| self.note_first(&part.cause));
        if !parts.is_empty() {
            self.steps.push(WalkMotion::Slide(parts));
        }
    }

    /// Notes that the next step depends on a parameter error.
    fn note_first(&mut self, cause: &MotionCause) {
        let first = &mut self.first[cause.error];
        *first = (*first).min(self.steps.len());
    }

    /// Sets the posture of the chain, and the two values (m or rad) of each parameter error.
    pub fn set_posture(&mut self, frames: &Frames, values: impl Iterator<Item = [f64; 2]>) {
        self.last = None;
        let mut is_changed = false;
        for (known, values) in self.values.iter_mut().zip(values) {
            is_changed |= *known != values;
            *known = values;
        }
        let sizes = |cause: &MotionCause| self.values[cause.error].map(|value| cause.factor * value);
        let pose = |frame: &WalkFrame| match frame {
            WalkFrame::Base => Pose::identity(),
            WalkFrame::Link(k) => frames.links[*k],
            WalkFrame::Joint(k, pose) => frames.links[*k] * *pose,
            WalkFrame::Tool => frames.tcp,
        };
        let placed = |(frame, axis): (usize, usize)| {
            let pose = pose(&self.frames[frame]);
            (pose.rotation.column(axis).into_owned(), pose.translation)
        };
        for step in &mut self.steps {
            match step {
                WalkMotion::Turn { cause, frame, by, axis, through } => {
                    (*axis, *through) = placed(*frame);
                    if is_changed {
                        *by = sizes(cause).map(Turn::new);
                    }
                }
                WalkMotion::Slide(parts) => {
                    for part in parts {
                        let (direction, _) = placed(part.axis);
                        part.by = sizes(&part.cause).map(|size| direction * size);
                    }
                }
            }
        }
    }

    /// Returns the position error of the TCP in the base frame, m. `p` is the nominal position of the TCP in
    /// the same frame, m. `second` is the bit set of the parameter errors that have the second of their two
    /// values. The caller must have set the posture with [`Self::set_posture`].
    ///
    /// The result equals [`super::position_error`] under the nonlinear model.
    pub fn position_error(&mut self, p: &Vector3<f64>, second: u128) -> Vector3<f64> {
        let count = self.steps.len();
        let mut changed = self.last.map_or(u128::MAX, |last| last ^ second);
        let mut from = if self.last.is_none() { 0 } else { count };
        while from > 0 && changed != 0 {
            from = from.min(self.first[changed.trailing_zeros() as usize]);
            changed &= changed - 1;
        }
        self.last = Some(second);
        let value = |error: usize| (second >> error & 1) as usize;
        let mut e = self.reached[from];
        for (k, step) in self.steps.iter().enumerate().skip(from) {
            e += match step {
                WalkMotion::Turn { cause, by, axis, through, .. } => {
                    let (by, w) = (&by[value(cause.error)], p + e - *through);
                    // Rodrigues' formula, as in the nonlinear model.
                    axis.cross(&w) * by.sin + (*axis * axis.dot(&w) - w) * by.versine
                }
                WalkMotion::Slide(parts) => parts.iter().map(|part| part.by[value(part.cause.error)]).sum(),
            };
            self.reached[k + 1] = e;
        }
        e
    }
}
