//! Which small motion a parameter's error is: a turn about or a slide along which axis.

use crate::cell::{JointKind, Parameter};
use crate::pose::{Displacement, Pose};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Where the axis of a motion is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    Base,
    /// The frame after so many D-H rows.
    Link(usize),
    /// The frame of a joint, from 0.
    Joint(usize),
    Tcp,
    /// The equipment that carries the operation.
    Work,
}

/// One small motion, base frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Motion {
    pub place: Place,
    /// 0, 1, 2: x, y, z of that frame.
    pub axis: usize,
    /// About the axis, or along it.
    pub turns: bool,
    /// How much of it a unit of the parameter makes: not 1 through a joint coupling alone.
    pub factor: f64,
    pub direction: Vector3<f64>,
    /// From the axis' frame to the TCP, m.
    pub lever: Vector3<f64>,
}

impl Motion {
    /// What a unit of the parameter moves: `w x (p - o)` of a turn, `w` of a slide.
    pub fn effect(&self) -> Displacement {
        let unit = match self.turns {
            true => Displacement { position: self.direction.cross(&self.lever), rotation: self.direction },
            false => Displacement { position: self.direction, rotation: Vector3::zeros() },
        };
        unit * self.factor
    }
}

/// The motions that a unit of a parameter makes at a posture; of an equipment, those of its frame at
/// `work`.
pub fn motions(chain: &Chain, frames: &Frames, work: &Pose, parameter: Parameter) -> Vec<Motion> {
    let one = |place: Place, axis: usize, turns: bool, factor: f64| {
        let frame = match place {
            Place::Base => Pose::identity(),
            Place::Link(k) => frames.links[k],
            Place::Joint(k) => frames.links[k] * chain.joint_frames[k],
            Place::Tcp => frames.tcp,
            Place::Work => *work,
        };
        let direction = frame.rotation.column(axis).into_owned();
        let lever = frames.tcp.translation - frame.translation;
        Motion { place, axis, turns, factor, direction, lever }
    };
    let component = |place, c: usize| vec![one(place, c % 3, c >= 3, 1.0)];
    match parameter {
        // The actuator moves every D-H coordinate that is coupled to it.
        Parameter::Dq(i) => (i..chain.axes())
            .filter(|&j| chain.coupling[j][i] != 0.0)
            .map(|j| {
                let turns = chain.links[j].kind == JointKind::Revolute;
                one(Place::Link(j), 2, turns, chain.coupling[j][i])
            })
            .collect(),
        Parameter::Dr(i) => vec![one(Place::Link(i), 2, false, 1.0)],
        Parameter::Dl(i) => vec![one(Place::Link(i + 1), 0, false, 1.0)],
        Parameter::Dalpha(i) => vec![one(Place::Link(i + 1), 0, true, 1.0)],
        Parameter::Dbeta(i) => vec![one(Place::Link(i + 1), 1, true, 1.0)],
        Parameter::Base(c) => component(Place::Base, c),
        Parameter::Tool(c) => component(Place::Tcp, c),
        Parameter::Joint(k, c) => component(Place::Joint(k), c),
        Parameter::Equipment(_, c) => component(Place::Work, c),
    }
}
