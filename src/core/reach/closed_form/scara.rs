//! Closed form of the SCARA: three revolute axes and one prismatic axis, all parallel, in any order.
//!
//! Seen along the axes, the chain is a polygon of four vectors L_0 to L_3. The sum of these vectors is the
//! position of the flange. Each vector is rotated by the revolute joints before it. The orientation of the
//! flange gives the direction of L_3. The law of cosines gives two solutions (elbows) for L_1 and L_2. The
//! prismatic joint sets the height. Vectors in the plane are complex numbers.

use crate::cell::JointKind;
use crate::pose::Pose;
use crate::robot::{Chain, Posture};
use nalgebra::{Complex, ComplexField};

/// Vector in the plane normal to the axes, as a complex number.
type Plane = Complex<f64>;

/// Largest excess over 1 at which the absolute cosine of the elbow angle still counts as 1 (stretched or
/// folded arm).
const STRETCHED_ELBOW: f64 = 1e-12;

/// Closed form of a SCARA; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct Scara {
    /// Indices of the D-H rows of the revolute joints.
    turning: [usize; 3],
    /// Index of the D-H row of the prismatic joint.
    sliding: usize,
    /// Direction of each revolute axis relative to axis z of frame 0: +1 or -1.
    senses: [f64; 3],
    sliding_sense: f64,
    flange_sense: f64,
    /// Vectors L_0 to L_3 from joint to joint, seen along the axes, with every revolute joint at theta = 0.
    sides: [Plane; 4],
    /// Direction of the x axis of the flange with every revolute joint at theta = 0.
    flange: Plane,
    /// Height of the flange if the D-H offset r of the prismatic joint is 0, m.
    height: f64,
}

impl Scara {
    /// Returns the closed form of a SCARA.
    ///
    /// # Errors
    /// Returns the reason if the chain is not a SCARA.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        let kinds: Vec<_> = chain.links.iter().map(|l| l.kind).collect();
        let of = |kind| (0..kinds.len()).filter(|&i| kinds[i] == kind).collect::<Vec<_>>();
        let (turning, sliding) = (of(JointKind::Revolute), of(JointKind::Prismatic));
        let ([a, b, c], [sliding]) = (&turning[..], &sliding[..]) else {
            return Err("the chain does not have three revolute joints and one prismatic joint".into());
        };
        // The last row is checked, too, although its twist would rotate only the flange.
        if chain.links.iter().any(|l| l.sin_alpha != 0.0) {
            return Err("the axes are not all parallel".into());
        }
        let mut arm = Self {
            turning: [*a, *b, *c],
            sliding: *sliding,
            senses: [1.0; 3],
            sliding_sense: 1.0,
            flange_sense: 1.0,
            sides: [Plane::new(0.0, 0.0); 4],
            flange: Plane::new(1.0, 0.0),
            height: 0.0,
        };
        arm.measure(chain);
        if arm.sides[1].norm() < 1e-6 || arm.sides[2].norm() < 1e-6 {
            return Err("one of the two arm links has the length 0".into());
        }
        Ok(arm)
    }

    /// Computes the directions of the axes, and the geometry of the arm with every revolute joint at theta =
    /// 0.
    fn measure(&mut self, chain: &Chain) {
        let (mut sense, mut direction, mut side) = (1.0, Plane::new(1.0, 0.0), 0);
        for link in &chain.links {
            match link.kind {
                JointKind::Revolute => {
                    self.senses[side] = sense;
                    side += 1;
                    self.height += sense * link.r;
                }
                JointKind::Prismatic => {
                    self.sliding_sense = sense;
                    direction *= Plane::new(link.theta.cos(), sense * link.theta.sin());
                }
            }
            self.sides[side] += direction * link.l;
            sense *= link.cos_alpha;
        }
        (self.flange, self.flange_sense) = (direction, sense);
    }

    /// Calls `found` with the two postures that put the last D-H frame at `flange`.
    ///
    /// `flange` is a pose in frame 0 with a z axis that [`Self::can_hold`] accepts. The two postures differ
    /// in the elbow and have the branch indices 0 and 1. Returns how far the target is out of reach, m; 0
    /// if there is a solution.
    pub(in crate::reach) fn solve(
        &self,
        flange: &Pose,
        posture: &mut Posture,
        found: &mut dyn FnMut(u8, &Posture),
    ) -> f64 {
        let x = flange.rotation.column(0);
        // Rotation of L_3 by all three joints.
        let whole = Plane::new(x[0], x[1]) * self.flange.conj();
        let p = Plane::new(flange.translation.x, flange.translation.y);
        let reach = p - self.sides[0] - self.sides[3] * whole;
        let (l1, l2) = (self.sides[1].norm(), self.sides[2].norm());
        let d2 = reach.norm_sqr();
        let cos = (d2 - l1 * l1 - l2 * l2) / (2.0 * l1 * l2);
        if cos.abs() > 1.0 + STRETCHED_ELBOW {
            return (d2.sqrt() - l1 - l2).max((l1 - l2).abs() - d2.sqrt());
        }
        // Heron's formula avoids cancellation for a stretched arm.
        let (long, short) = ((l1 + l2) * (l1 + l2) - d2, d2 - (l1 - l2) * (l1 - l2));
        let sin = (long * short).max(0.0).sqrt() / (2.0 * l1 * l2);
        posture.r[self.sliding] = (flange.translation.z - self.height) * self.sliding_sense;
        let (u1, u2) = (self.sides[1] / l1, self.sides[2] / l2);
        for (elbow, sin) in [(0, sin), (1, -sin)] {
            let bend = Plane::new(cos.clamp(-1.0, 1.0), sin);
            // L_1 + L_2 = turn1 u1 (l1 + l2 bend)
            let span = u1 * (bend * l2 + l1);
            let turn1 = if d2 > 0.0 { reach * span.conj() / d2 } else { Plane::new(1.0, 0.0) };
            let turn2 = bend * u1 * u2.conj();
            let turn3 = whole * (turn1 * turn2).conj();
            for (k, turn) in [turn1, turn2, turn3].into_iter().enumerate() {
                let row = self.turning[k];
                (posture.cos[row], posture.sin[row]) = (turn.real(), self.senses[k] * turn.imaginary());
            }
            found(elbow, posture);
        }
        0.0
    }

    /// Returns whether the flange of the arm has the z axis of the pose `flange`. The flange of a SCARA has
    /// the same z axis in every posture.
    pub(in crate::reach) fn can_hold(&self, flange: &Pose) -> bool {
        (flange.rotation[(2, 2)] - self.flange_sense).abs() < 1e-12
    }
}
