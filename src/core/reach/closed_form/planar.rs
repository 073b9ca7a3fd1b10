//! Closed form of the planar arm: a base yaw, then three parallel axes that move the tool in a vertical
//! plane. An optional fifth axis rolls the tool about its own axis.
//!
//! The Hitachi PW 10-II belongs to this family. It is the robot of the seed paper, the journal paper from
//! which this project grew. Palletizers are planar arms, too: their third parallel axis is passive.
//!
//! Let s be the signed horizontal distance of the TCP from the base axis in the vertical plane: positive in
//! front, negative behind. Let z be the height of the TCP, and phi the angle of the last parallel link. Let
//! (U, V) be the vector from the wrist to the TCP, a function of phi. Let l_1 and r_1 be the D-H length and
//! offset of link 1. The wrist then lies at `u = s - l_1 - U(phi)` and `v = z - r_1 - V(phi)` relative to
//! axis 2.
//!
//! The law of cosines gives two solutions for the elbow, and theta_4 = phi - theta_2 - theta_3. A given
//! elevation of the tool (its bending angle) allows two values of phi. For the first value, the tool points
//! away from the base axis. For the second value, the tool points towards the base axis. The two values
//! coincide if the tool is vertical. A target has up to 2 x 2 x 2 branches: two signs of s, two values of phi
//! and two elbows. The solver computes sines and cosines by square roots alone; angles are computed only for
//! branches that are reported.

use crate::cell::{JointKind, tool_columns};
use crate::pose::exact_sin_cos;
use crate::reach::attitude_set::AttitudeSet;
use crate::reach::tool_attitudes::{PlanarAttitude, ToolAttitudes};
use crate::robot::{Chain, Link, Posture};
use nalgebra::{Matrix3, Rotation3, Vector3};
use std::ops::Range;

/// Largest excess over 1 at which the cosine of the elbow angle still counts as 1.
///
/// Rounding would otherwise lose the solution of a stretched arm. A target with
/// `lateral^2 <= d^2 (1 + STRETCHED)` counts as far enough from the base axis. Here d is the distance of the
/// target from this axis, and `lateral` is the lateral offset of the arm.
pub(in crate::reach) const STRETCHED: f64 = 1e-12;

/// Largest deviation of a unit vector (no unit) or of a point (m) that counts as a rounding error.
const IN_PLACE: f64 = 1e-9;

/// Bit of a branch index at which the index of the spin begins.
const SPIN_SHIFT: u32 = 6;

/// Returns the index of the spin that a branch index holds, for a planar arm with a roll axis.
pub(in crate::reach) fn spin_of(branch: u64) -> usize {
    (branch >> SPIN_SHIFT) as usize
}

/// Returns a branch index with its spin replaced by the spin with the given index.
pub(in crate::reach) fn with_spin(branch: u64, spin: usize) -> u64 {
    (spin as u64) << SPIN_SHIFT | branch & !(u64::MAX << SPIN_SHIFT)
}

/// Closed form of the planar arm; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanarArm {
    /// Sine of alpha_1, the D-H twist between axes 1 and 2: 1 or -1.
    pub(in crate::reach) side: f64,
    pub(in crate::reach) r1: f64,
    pub(in crate::reach) l: [f64; 3],
    /// Signed distance along axis 2 from the base axis to the vertical plane in which the TCP moves.
    pub(in crate::reach) lateral: f64,
    /// Cosine and sine of theta_1 in the middle of the range of joint 1.
    middle_yaw: (f64, f64),
    /// Coordinates x and y of the TCP in a rotated frame: frame 3 after the rotation by theta_4 about z.
    tool: (f64, f64),
    /// Components x and y of the tool axis in the frame of `tool`.
    axis: (f64, f64),
    roll: Option<Roll>,
}

/// Last axis of a five-axis arm, which rolls the tool about the tool axis.
#[derive(Debug, Clone, PartialEq)]
struct Roll {
    /// Sine of alpha_1, the D-H twist between axes 1 and 2: 1 or -1.
    side: f64,
    /// Cosine and sine of alpha_4, the D-H twist between axes 4 and 5.
    twist: (f64, f64),
    /// Reference axis of the tool, which defines its spin: components x and y in frame 4 at theta_5 = 0.
    reference: (f64, f64),
}

impl PlanarArm {
    /// Returns the closed form of a planar arm.
    ///
    /// # Errors
    /// Returns the reason if the chain is not a planar arm.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        let [a, b, c, d, ref rest @ ..] = chain.links[..] else {
            return Err(format!("the chain has {} axes, not 4 or 5", chain.axes()));
        };
        if rest.len() > 1 {
            return Err(format!("the chain has {} axes, not 4 or 5", chain.axes()));
        }
        if chain.links.iter().any(|l| l.kind != JointKind::Revolute) {
            return Err("the chain has a prismatic joint".into());
        }
        if a.cos_alpha.abs() > 1e-12 {
            return Err(
                "the second axis is not perpendicular to the first (alpha_1 is not +-90 degrees)".into()
            );
        }
        if [b, c].iter().any(|l| l.sin_alpha.abs() > 1e-12 || l.cos_alpha < 0.0) {
            return Err("axes 2, 3 and 4 are not parallel (alpha_2 or alpha_3 is not 0)".into());
        }
        if b.l.abs() < 1e-6 || c.l.abs() < 1e-6 {
            return Err("the length of an arm link is 0 (l_2 or l_3)".into());
        }
        if (chain.mount.rotation.column(2) - Vector3::z()).norm() > IN_PLACE {
            return Err("the first axis is not vertical".into());
        }
        let (tip, axis, roll) = match rest {
            [e] => {
                let (tip, axis, reference) = rolled(chain, e)?;
                (
                    tip,
                    axis,
                    Some(Roll { side: a.sin_alpha.signum(), twist: (d.cos_alpha, d.sin_alpha), reference }),
                )
            }
            _ => (chain.tool.translation, chain.tool.rotation * chain.tool_axis, None),
        };
        let turned = |v: &Vector3<f64>| {
            Vector3::new(v.x, d.cos_alpha * v.y - d.sin_alpha * v.z, d.sin_alpha * v.y + d.cos_alpha * v.z)
        };
        let (axis, tip) = (turned(&axis), turned(&tip) + Vector3::new(d.l, 0.0, d.r));
        if axis.z.abs() > IN_PLACE {
            return Err("the tool axis does not lie in the plane of the arm".into());
        }
        let middle_yaw = (a.theta + (a.limits.0 + a.limits.1) / 2.0).sin_cos();
        Ok(Self {
            side: a.sin_alpha.signum(),
            r1: a.r,
            l: [a.l, b.l, c.l],
            lateral: b.r + c.r + tip.z,
            middle_yaw: (middle_yaw.1, middle_yaw.0),
            tool: (tip.x, tip.y),
            axis: (axis.x, axis.y),
            roll,
        })
    }

    /// Returns whether the arm has a roll axis, with which it can choose the spin of its tool.
    pub fn rolls(&self) -> bool {
        self.roll.is_some()
    }

    /// Writes the tool attitudes in the plane of the arm into `planar`. Each elevation of `set` gives one or
    /// two attitudes.
    pub(in crate::reach) fn attitudes(&self, set: &AttitudeSet, planar: &mut Vec<PlanarAttitude>) {
        planar.clear();
        for &elevation in &set.elevations {
            let (sin, cos) = exact_sin_cos(elevation);
            planar.push(self.attitude(cos, sin));
            if cos.abs() >= 1e-12 {
                planar.push(self.attitude(-cos, sin));
            }
        }
    }

    fn attitude(&self, cos_elevation: f64, sin_elevation: f64) -> PlanarAttitude {
        let (ax, ay) = self.axis;
        // psi is the angle of the tool axis; phi = psi - atan2(ay, ax) is the angle of the last link.
        let (cos_psi, sin_psi) = (cos_elevation, self.side * sin_elevation);
        let (cos_phi, sin_phi) = (cos_psi * ax + sin_psi * ay, sin_psi * ax - cos_psi * ay);
        let (x, y) = self.tool;
        let (u, v) = (x * cos_phi - y * sin_phi, x * sin_phi + y * cos_phi);
        PlanarAttitude { cos_phi, sin_phi, u, v, cos_elevation, sin_elevation }
    }

    /// Calls `found` with every branch that puts the TCP at `target` (frame 0, m); joint limits are ignored.
    ///
    /// Bit 0 of the branch index distinguishes the two elbow solutions. Bit 1 is set if the arm leans back
    /// over the base. Bits 2 to 5 hold the index of the attitude in the plane of the arm. A tilted tool has
    /// two attitudes for each elevation: it points along the azimuth theta_1 or opposite to it. The bits from
    /// 6 on hold the index of the spin.
    ///
    /// Only the first `spins` spins of `attitudes` are used. An arm without a roll axis ignores `spins`.
    ///
    /// Returns the least distance, m, by which a branch misses the target; 0 if a branch reaches it.
    #[inline]
    pub(in crate::reach) fn solve(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        spins: usize,
        posture: &mut Posture,
        found: &mut impl FnMut(u64, &Posture),
    ) -> f64 {
        let lateral = self.side * self.lateral;
        let radius2 = target.x * target.x + target.y * target.y;
        let along2 = radius2 - lateral * lateral;
        if along2 < -STRETCHED * radius2 {
            return lateral.abs() - radius2.sqrt();
        }
        let along = along2.max(0.0).sqrt();
        let [l1, l2, l3] = self.l;
        let mut missing = f64::INFINITY;
        for (w, way) in attitudes.planar.iter().enumerate() {
            let v = self.side * (target.z - self.r1) - way.v;
            for (back, s) in [(0, along), (2, -along)] {
                let u = s - l1 - way.u;
                let d2 = u * u + v * v;
                let cos3 = (d2 - l2 * l2 - l3 * l3) / (2.0 * l2 * l3);
                if cos3.abs() > 1.0 + STRETCHED {
                    let d = d2.sqrt();
                    missing = missing.min((d - (l2.abs() + l3.abs())).max((l2.abs() - l3.abs()).abs() - d));
                    continue;
                }
                missing = 0.0;
                let cos3 = cos3.clamp(-1.0, 1.0);
                // Heron's formula and this form of k1 avoid cancellation for a folded arm with equal links.
                let (long, short) = ((l2 + l3) * (l2 + l3) - d2, d2 - (l2 - l3) * (l2 - l3));
                let sin3 = (long * short).max(0.0).sqrt() / (2.0 * l2 * l3).abs();
                let k1 = (d2 + l2 * l2 - l3 * l3) / (2.0 * l2);
                (posture.cos[0], posture.sin[0]) = self.base_yaw(target, s, lateral, radius2);
                for (elbow, sin3) in [(0, -sin3), (1, sin3)] {
                    let k2 = l3 * sin3;
                    let (cos2, sin2) =
                        if d2 > 0.0 { ((k1 * u + k2 * v) / d2, (k1 * v - k2 * u) / d2) } else { (1.0, 0.0) };
                    let (c23, s23) = (cos2 * cos3 - sin2 * sin3, sin2 * cos3 + cos2 * sin3);
                    (posture.cos[1], posture.sin[1]) = (cos2, sin2);
                    (posture.cos[2], posture.sin[2]) = (cos3, sin3);
                    posture.cos[3] = way.cos_phi * c23 + way.sin_phi * s23;
                    posture.sin[3] = way.sin_phi * c23 - way.cos_phi * s23;
                    let index = (w as u64) << 2 | back | elbow;
                    match &self.roll {
                        None => found(index, posture),
                        Some(roll) => {
                            roll.turn(&attitudes.set, 0..spins, target, way, posture, |k, posture| {
                                found(k << SPIN_SHIFT | index, posture);
                            });
                        }
                    }
                }
            }
        }
        missing.max(0.0)
    }

    /// Calls `found` with the branches that differ from a given branch only by the spin. The tuple holds the
    /// index and the posture of the given branch. `spins` are indices of spins of `attitudes`. The postures
    /// equal those of [`Self::solve`], bit for bit.
    pub(in crate::reach) fn spun(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        spins: Range<usize>,
        (index, posture): (u64, &mut Posture),
        mut found: impl FnMut(u64, &Posture),
    ) {
        let index = index & !(u64::MAX << SPIN_SHIFT);
        let (Some(roll), Some(way)) = (&self.roll, attitudes.planar.get((index >> 2) as usize)) else {
            return;
        };
        roll.turn(&attitudes.set, spins, target, way, posture, |k, posture| {
            found(k << SPIN_SHIFT | index, posture);
        });
    }

    /// Returns cosine and sine of theta_1, which rotates the point (`s`, -`lateral`) about the base axis to
    /// the target. The module documentation defines s, and `lateral` is the signed lateral offset of the arm.
    ///
    /// If the target is on the base axis, theta_1 is free and is set to the middle of its range.
    #[inline]
    fn base_yaw(&self, target: &Vector3<f64>, s: f64, lateral: f64, radius2: f64) -> (f64, f64) {
        if radius2 < 1e-24 {
            return self.middle_yaw;
        }
        ((target.x * s - target.y * lateral) / radius2, (target.y * s + target.x * lateral) / radius2)
    }
}

impl Roll {
    /// Calls `found` with the index of each spin in `spins`, with the last axis rotated so that the tool has
    /// this spin.
    fn turn(
        &self,
        set: &AttitudeSet,
        spins: Range<usize>,
        target: &Vector3<f64>,
        way: &PlanarAttitude,
        posture: &mut Posture,
        mut found: impl FnMut(u64, &Posture),
    ) {
        let (c1, s1) = (posture.cos[0], posture.sin[0]);
        // Frame 4 is `Rz(theta_1) Rx(alpha_1) Rz(phi) Rx(alpha_4)`.
        let (along, up, across) =
            (Vector3::new(c1, s1, 0.0), Vector3::z() * self.side, Vector3::new(s1, -c1, 0.0) * self.side);
        let x4 = along * way.cos_phi + up * way.sin_phi;
        let y4 = (up * way.cos_phi - along * way.sin_phi) * self.twist.0 + across * self.twist.1;
        let (heading, cos_elevation) = match set.vertical {
            true => (set.zero_heading(target), 0.0),
            false => {
                let side = way.cos_elevation.signum();
                ((side * c1, side * s1), way.cos_elevation.abs())
            }
        };
        let h = Vector3::new(heading.0, heading.1, 0.0);
        let (upright, sideways) =
            (Vector3::z() * cos_elevation - h * way.sin_elevation, h.cross(&Vector3::z()));
        let (a, b) = self.reference;
        for (k, (cos, sin)) in set.spin_directions.iter().enumerate().take(spins.end).skip(spins.start) {
            let wanted = upright * *cos + sideways * *sin;
            let (x, y) = (wanted.dot(&x4), wanted.dot(&y4));
            // If the tool deviates from the vertical, the projection of the wanted direction is shorter than
            // 1.
            let length = if set.tolerance > 0.0 { x.hypot(y).max(f64::MIN_POSITIVE) } else { 1.0 };
            let (x, y) = (x / length, y / length);
            (posture.cos[4], posture.sin[4]) = (x * a + y * b, y * a - x * b);
            found(k as u64, posture);
        }
    }
}

/// TCP (m), tool axis, and components x and y of the reference axis, in frame 4 with theta_5 = 0.
type Rolled = (Vector3<f64>, Vector3<f64>, (f64, f64));

/// Returns TCP, tool axis and reference axis of the tool of a five-axis arm, in frame 4 with theta_5 = 0.
///
/// # Errors
/// Fails if the last axis is not the tool axis through the TCP.
fn rolled(chain: &Chain, last: &Link) -> Result<Rolled, String> {
    let twist = Rotation3::from_matrix_unchecked(Matrix3::new(
        1.0,
        0.0,
        0.0, //
        0.0,
        last.cos_alpha,
        -last.sin_alpha, //
        0.0,
        last.sin_alpha,
        last.cos_alpha,
    ));
    let tip = twist * chain.tool.translation + Vector3::new(last.l, 0.0, last.r);
    let columns = twist * chain.tool.rotation * tool_columns(&chain.tool_axis);
    let (axis, reference) = (columns.column(2).into_owned(), columns.column(0).into_owned());
    if axis.xy().norm() > IN_PLACE || tip.xy().norm() > IN_PLACE {
        return Err("the last axis is not the tool axis through the TCP".into());
    }
    Ok((Vector3::new(0.0, 0.0, tip.z), axis, (reference.x, reference.y)))
}
