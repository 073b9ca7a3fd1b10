//! Chain with its errors: eqs. (4)-(6) of the seed paper as a product of constant motions and joint
//! rotations.
//!
//! The pose of the TCP is `T' = B_0 Rz(theta_1) B_1 Rz(theta_2) B_2 ... B_N`, where `Rz(theta_i)` is the
//! rotation of joint i about its axis, and N is the number of joints. The constant motions `B_i` contain all
//! errors and are computed once. The error is then the difference between two positions a few metres from the
//! base. This difference is accurate to 1e-14 m, which is enough to rank nodes.

use super::lanes::{CosSin, Lanes};
use crate::cell::JointKind;
use crate::kinematic_error::{FrameError, Perturbation, Turn};
use crate::pose::Pose;
use crate::robot::Chain;
use nalgebra::{Rotation3, Vector3};
use pulp::Simd;

/// Chain with a signed sample of its errors.
#[derive(Debug, Clone, PartialEq)]
pub struct PerturbedChain {
    /// Constant motion before the first joint (`B_0` in the formula of the module), in the base frame.
    pub base: Pose,
    /// Constant motions from each joint to the next (`B_1` to `B_(N-1)` in the formula of the module).
    between: Vec<ConstantMotion>,
    /// Position of the TCP in the frame that the last joint rotates, m.
    tip: Vector3<f64>,
}

/// Constant motion between two consecutive joints.
#[derive(Debug, Clone, PartialEq)]
struct ConstantMotion {
    pose: Pose,
    /// Whether the rotation of the motion is about x alone. This holds if theta and beta of the link and
    /// the rotation of the next joint frame have no errors.
    twists: bool,
}

impl PerturbedChain {
    /// Prepares a chain. Returns None if a joint is prismatic or elastic, because the motions between
    /// joints are then not constant.
    pub fn new(chain: &Chain, errors: &Perturbation) -> Option<Self> {
        if errors.elastic.is_some() || chain.links.iter().any(|l| l.kind == JointKind::Prismatic) {
            return None;
        }
        let framed = |error: &Option<FrameError>| error.as_ref().map_or(Pose::identity(), moved);
        let joint = |k: usize| match &errors.joints {
            Some(joints) => joints.frames[k] * framed(&joints.errors[k]) * joints.frames[k].inverse(),
            None => Pose::identity(),
        };
        let about = |axis: &Vector3<f64>, by: &Turn| turned(axis, by.angle);
        let mut constant: Vec<Pose> = Vec::new();
        for (link, error) in chain.links.iter().zip(errors.links()) {
            let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
            let shift =
                Pose { translation: z * (link.r + error.dr) + x * (link.l + error.dl), ..Pose::identity() };
            let twist = turned(&x, link.alpha + error.dalpha.angle);
            constant.push(about(&z, &error.dtheta) * shift * twist * about(&y, &error.dbeta));
        }
        let last = constant.pop()? * chain.tool * framed(&errors.tool);
        for (k, b) in constant.iter_mut().enumerate() {
            *b = *b * joint(k + 1);
        }
        let base = framed(&errors.base) * chain.mount * joint(0);
        let twists = |pose: &Pose| {
            pose.rotation.column(0) == Vector3::x() && pose.rotation.row(0) == Vector3::x().transpose()
        };
        let between =
            constant.into_iter().map(|pose| ConstantMotion { twists: twists(&pose), pose }).collect();
        Some(Self { base, between, tip: last.translation })
    }

    /// Computes the TCP position (m) from the cosine and sine of every joint angle.
    ///
    /// The position is given in the frame whose pose in the base frame is [`Self::base`].
    #[inline(always)]
    pub fn tip<S: Simd>(&self, turns: &[CosSin<S>]) -> [Lanes<S>; 3] {
        let any = turns[0].0;
        let mut p = [any.like(self.tip.x), any.like(self.tip.y), any.like(self.tip.z)];
        for k in (0..turns.len()).rev() {
            if let Some(b) = self.between.get(k) {
                p = b.moved(&p);
            }
            let (cos, sin) = turns[k];
            p = [cos * p[0] - sin * p[1], sin * p[0] + cos * p[1], p[2]];
        }
        p
    }
}

impl ConstantMotion {
    /// Applies the motion to a point.
    #[inline(always)]
    fn moved<S: Simd>(&self, p: &[Lanes<S>; 3]) -> [Lanes<S>; 3] {
        let Pose { rotation: r, translation: t } = &self.pose;
        let [x, y, z] = *p;
        let y2 = y.times_plus(x.like(r[(1, 1)]), z.times_plus(x.like(r[(1, 2)]), x.like(t.y)));
        let z2 = y.times_plus(x.like(r[(2, 1)]), z.times_plus(x.like(r[(2, 2)]), x.like(t.z)));
        if self.twists {
            return [x + t.x, y2, z2];
        }
        let x2 = y.times_plus(x.like(r[(0, 1)]), z.times_plus(x.like(r[(0, 2)]), x.like(t.x)));
        [
            x.times_plus(x.like(r[(0, 0)]), x2),
            x.times_plus(x.like(r[(1, 0)]), y2),
            x.times_plus(x.like(r[(2, 0)]), z2),
        ]
    }
}

/// Returns the pose of a frame that has errors, relative to the same frame without errors.
///
/// The errors are applied in the order translation, rotation about z, rotation about y, rotation about x.
fn moved(error: &FrameError) -> Pose {
    let axes = [Vector3::z(), Vector3::y(), Vector3::x()];
    let slide = Pose { translation: Vector3::from(error.slides), ..Pose::identity() };
    axes.iter().enumerate().fold(slide, |pose, (k, axis)| pose * turned(axis, error.turns[2 - k].angle))
}

fn turned(axis: &Vector3<f64>, angle: f64) -> Pose {
    let rotation = Rotation3::new(axis * angle).into_inner();
    Pose { rotation, ..Pose::identity() }
}
