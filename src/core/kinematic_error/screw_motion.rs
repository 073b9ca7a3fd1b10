//! Small motions that parameter errors cause in the chain, as screw axes at a posture.

use crate::cell::{JointKind, PER_FRAME, Parameter};
use crate::pose::Pose;
use crate::robot::{Chain, Frames, PeriodicDeflection, STANDARD_GRAVITY};
use nalgebra::Vector3;

/// Small motion at one place in the chain. The motion moves all parts from this place to the tool.
///
/// Axis and point are given at the reference posture, in the base frame.
#[derive(Debug, Clone, Copy)]
pub struct ScrewMotion {
    /// Number of joints that precede the motion in the chain.
    pub link: usize,
    /// Whether the motion is a rotation; otherwise it is a translation.
    pub turns: bool,
    /// Unit vector along the axis of the motion.
    pub axis: Vector3<f64>,
    /// Point on the axis of a rotation, m.
    pub through: Vector3<f64>,
    /// Index of the error source.
    pub source: usize,
    /// Signed angle (rad) or length (m) of the motion per unit of the source.
    pub factor: f64,
}

/// Returns the small motions that one unit of an error parameter causes in the chain.
///
/// A parameter of the equipment causes no motion of the chain. The motion of an elastic parameter depends
/// on the posture and is left out. The function [`largest_deflection`] bounds this motion.
pub fn motions(chain: &Chain, frames: &Frames, parameter: Parameter, source: usize) -> Vec<ScrewMotion> {
    let one = |link: usize, frame: &Pose, axis: usize, turns: bool, factor: f64| ScrewMotion {
        link,
        turns,
        axis: frame.rotation.column(axis).into_owned(),
        through: frame.translation,
        source,
        factor,
    };
    let of_frame =
        |link: usize, frame: &Pose, c: usize| vec![one(link, frame, c % 3, c >= PER_FRAME / 2, 1.0)];
    let rows = &frames.links;
    match parameter {
        Parameter::Dq(j) => (j..chain.axes())
            .filter(|&i| chain.coupling[i][j] != 0.0)
            .map(|i| {
                let turns = chain.links[i].kind == JointKind::Revolute;
                one(i, &rows[i], 2, turns, chain.coupling[i][j])
            })
            .collect(),
        Parameter::Dr(i) => vec![one(i, &rows[i], 2, false, 1.0)],
        Parameter::Dl(i) => vec![one(i + 1, &rows[i + 1], 0, false, 1.0)],
        Parameter::Dalpha(i) => vec![one(i + 1, &rows[i + 1], 0, true, 1.0)],
        Parameter::Dbeta(i) => vec![one(i + 1, &rows[i + 1], 1, true, 1.0)],
        Parameter::Base(c) => of_frame(0, &Pose::identity(), c),
        Parameter::Tool(c) => of_frame(chain.axes(), &frames.tcp, c),
        Parameter::Joint(i, c) => of_frame(i, &(rows[i] * chain.joint_frames[i]), c),
        Parameter::Elastic(..)
        | Parameter::Compliance(_)
        | Parameter::Periodic(_)
        | Parameter::Equipment(..) => Vec::new(),
    }
}

/// Returns the rotation by which an elastic parameter ([`Parameter::is_elastic`]) deflects a joint. Returns
/// None for any other parameter.
///
/// In every posture, one unit of the parameter rotates the joint by at most [`ScrewMotion::factor`] of the
/// result. This bound depends on the kind of parameter:
///
/// - elastic term: the length of the link, because the lever is at most this long
/// - compliance: the sum, over all masses after the joint, of weight times largest distance from the joint
/// - periodic error: the sum of the amplitudes of its terms
pub fn largest_deflection(
    chain: &Chain,
    frames: &Frames,
    parameter: Parameter,
    source: usize,
) -> Option<ScrewMotion> {
    let joint = parameter.is_elastic().then_some(parameter.deflected_joint())?;
    let factor = match parameter {
        Parameter::Elastic(_, link) => chain.link_length(link),
        Parameter::Periodic(_) => {
            chain.periodic.iter().filter(|error| error.joint == joint).map(PeriodicDeflection::largest).sum()
        }
        _ => (joint + 1..=chain.axes())
            .map(|k| {
                let arm: f64 = (joint..k).map(|link| chain.link_length(link)).sum();
                let load = &chain.loads[k];
                STANDARD_GRAVITY * (load.mass * arm + load.moment.norm())
            })
            .sum(),
    };
    let row = &frames.links[joint];
    let (axis, through) = (row.rotation.column(2).into_owned(), row.translation);
    Some(ScrewMotion { link: joint, turns: true, axis, through, source, factor })
}
