//! Small motions that a parameter error causes: rotations about an axis, or translations along it.

use crate::cell::{JointKind, Parameter};
use crate::kinematic_error::deflection;
use crate::pose::{Displacement, Pose};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Frame that defines the axis of a small motion. This axis is the x, y or z axis of the frame
/// ([`ParameterMotion::axis`]).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MotionFrame {
    Base,
    /// Link frame after this number of Denavit-Hartenberg rows.
    Link(usize),
    /// Frame of the joint with this index, counted from 0.
    Joint(usize),
    Tcp,
    /// Frame of the equipment on which the operation happens.
    Work,
}

/// Small motion that a parameter error causes, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterMotion {
    pub place: MotionFrame,
    /// Index of the axis in the frame [`Self::place`]: 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// Whether the motion is a rotation; otherwise it is a translation.
    pub turns: bool,
    /// Size of the motion per unit of the parameter. The factor is 1 unless the joints are coupled or the
    /// parameter is elastic ([`Parameter::is_elastic`]).
    pub factor: f64,
    pub direction: Vector3<f64>,
    /// Vector from the origin of the frame [`Self::place`] to the TCP, m.
    pub lever: Vector3<f64>,
}

impl ParameterMotion {
    /// Returns the displacement of the TCP per unit of the parameter.
    ///
    /// A rotation moves the TCP by `w x (p - o)`, and a translation moves it by `w`. Here `w` is the unit
    /// vector [`Self::direction`], `p` the TCP and `o` the origin of [`Self::place`]. The result is
    /// multiplied by [`Self::factor`].
    pub fn effect(&self) -> Displacement {
        let unit = match self.turns {
            true => Displacement { position: self.direction.cross(&self.lever), rotation: self.direction },
            false => Displacement { position: self.direction, rotation: Vector3::zeros() },
        };
        unit * self.factor
    }
}

/// Returns the small motions that one unit of a parameter causes at a posture (given by `frames`).
///
/// `work` is the pose of the operation's equipment in the base frame. An error of a piece of equipment moves
/// the frame `work`.
pub fn motions(chain: &Chain, frames: &Frames, work: &Pose, parameter: Parameter) -> Vec<ParameterMotion> {
    let one = |place: MotionFrame, axis: usize, turns: bool, factor: f64| {
        let frame = match place {
            MotionFrame::Base => Pose::identity(),
            MotionFrame::Link(k) => frames.links[k],
            MotionFrame::Joint(k) => frames.links[k] * chain.joint_frames[k],
            MotionFrame::Tcp => frames.tcp,
            MotionFrame::Work => *work,
        };
        let direction = frame.rotation.column(axis).into_owned();
        let lever = frames.tcp.translation - frame.translation;
        ParameterMotion { place, axis, turns, factor, direction, lever }
    };
    let component = |place, c: usize| vec![one(place, c % 3, c >= 3, 1.0)];
    match parameter {
        // The actuator moves every D-H coordinate that is coupled to it.
        Parameter::Dq(i) => (i..chain.axes())
            .filter(|&j| chain.coupling[j][i] != 0.0)
            .map(|j| {
                let turns = chain.links[j].kind == JointKind::Revolute;
                one(MotionFrame::Link(j), 2, turns, chain.coupling[j][i])
            })
            .collect(),
        Parameter::Dr(i) => vec![one(MotionFrame::Link(i), 2, false, 1.0)],
        Parameter::Dl(i) => vec![one(MotionFrame::Link(i + 1), 0, false, 1.0)],
        Parameter::Dalpha(i) => vec![one(MotionFrame::Link(i + 1), 0, true, 1.0)],
        Parameter::Dbeta(i) => vec![one(MotionFrame::Link(i + 1), 1, true, 1.0)],
        Parameter::Base(c) => component(MotionFrame::Base, c),
        Parameter::Tool(c) => component(MotionFrame::Tcp, c),
        Parameter::Joint(k, c) => component(MotionFrame::Joint(k), c),
        Parameter::Elastic(..) | Parameter::Compliance(_) | Parameter::Periodic(_) => {
            deflection(frames, &chain.loads, &chain.periodic, parameter)
                .map(|(joint, factor)| one(MotionFrame::Link(joint), 2, true, factor))
                .into_iter()
                .collect()
        }
        Parameter::Equipment(_, c) => component(MotionFrame::Work, c),
    }
}
