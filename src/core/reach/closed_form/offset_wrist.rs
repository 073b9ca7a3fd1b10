//! Six-axis arms whose wrist has an offset: axes 4 and 5 intersect, but axis 6 does not pass through their
//! intersection.
//!
//! The pose of the flange fixes axis 6. A value of theta_6 then determines axis 5, and the intersection P of
//! axes 4 and 5. The first three joints must move P to this position; most arms have up to four solutions.
//! For each solution, the angle between axes 4 and 5 must equal the D-H twist alpha_4. This condition is one
//! equation for theta_6, and a scan finds its roots. A scan over one angle with closed forms for the other
//! joints is the "1D search" of A. J. Elias, J. T. Wen, "IK-Geo: Unified robot inverse kinematics using
//! subproblem decomposition" (2022).

use super::positioning_arm::PositioningArm;
use super::reversed_chain::{in_either_direction, solve_either_direction};
use super::roots_on_circle::{CircleRoots, CircleValues};
use super::subproblems::{Angle, before_twist, turned_back};
use crate::cell::JointKind;
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
use nalgebra::Vector3;

/// Two wrist axes count as parallel if the absolute sine of their twist (alpha_4 or alpha_5) is below this
/// value.
const LEAST_SINE: f64 = 1e-3;

/// Inverse kinematics of an arm with an offset wrist; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct OffsetWrist {
    /// D-H rows from base to flange, or the rows of the reversed chain.
    links: [Link; 6],
    arm: PositioningArm,
    /// Faster variant of `arm`, which returns lower bounds of distances in place of the distances.
    fast: PositioningArm,
    /// Constant part `Tx(l_6) Rx(alpha_6)` of the last D-H row, if the arm is solved from flange to base;
    /// otherwise None.
    lead: Option<Pose>,
}

/// Axis 6 in frame 0. The pose of the flange determines this axis.
struct FixedAxis {
    /// Axis x of frame 6.
    ///
    /// The field `y6` is axis y of frame 6 before the rotation by the twist alpha_6.
    x6: Vector3<f64>,
    y6: Vector3<f64>,
    /// Direction of axis 6.
    z5: Vector3<f64>,
    /// Origin of frame 5, m.
    origin: Vector3<f64>,
}

/// Axis 5 for a value of theta_6, in frame 0.
struct PlacedAxis {
    /// Direction of axis 5.
    z4: Vector3<f64>,
    /// Axis x of frame 5.
    x5: Vector3<f64>,
    /// Intersection of axes 4 and 5, m.
    centre: Vector3<f64>,
}

impl OffsetWrist {
    /// Returns the solver of an arm with an offset wrist, or with an offset shoulder.
    ///
    /// An arm with an offset shoulder is solved from flange to base.
    ///
    /// # Errors
    /// Returns the reason if the chain is not such an arm.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        in_either_direction(chain, Self::forward)
    }

    fn forward(links: [Link; 6], lead: Option<Pose>) -> Result<Self, String> {
        let [first, second, third, d, e, f] = links;
        if [d, e, f].iter().any(|l| l.kind != JointKind::Revolute) {
            return Err("a joint of the wrist is prismatic".into());
        }
        if d.l.abs() > 1e-12 {
            return Err("the axes 4 and 5 do not intersect (l_4 is not 0)".into());
        }
        if [d, e].iter().any(|l| l.sin_alpha.abs() < LEAST_SINE) {
            return Err("two neighbouring axes of the wrist are parallel (alpha_4 or alpha_5)".into());
        }
        let arm = PositioningArm::new(&[first, second, third], d.r)?;
        Ok(Self { links, fast: arm.fast(), arm, lead })
    }

    /// Returns whether the offset is in the shoulder, so that the arm is solved from flange to base.
    pub fn is_reversed(&self) -> bool {
        self.lead.is_some()
    }

    /// Calls `found` with every posture that puts the last D-H frame at `flange`; joint limits are ignored.
    ///
    /// `flange` is a pose in frame 0, without the tool. `posture` is working memory. Before the call, it must
    /// hold the constant D-H values of the chain, such as r of a revolute joint. The function overwrites the
    /// joint coordinates. The branch index is the running number of the solution among all solutions of this
    /// pose. A solution may change its index while the pose moves, because other solutions appear and vanish.
    ///
    /// Returns a measure (m) of how far the target is out of reach. The measure is 0 if there is a solution.
    /// Otherwise, one of the two following rules gives the measure.
    ///
    /// Let P be the intersection of axes 4 and 5. The solver scans theta_6, which determines the required
    /// position of P. If the first three joints cannot reach P at any scanned theta_6, the measure is a
    /// distance. This distance is the least one between P and the points that these joints reach. If the
    /// joints reach P but no solution exists, the measure is the least `|r_4 (cos beta - cos alpha_4)|` of
    /// the scan. Here r_4 is the forearm length, and beta is the angle between axes 4 and 5.
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        solve_either_direction(self.lead.as_ref(), flange, posture, found, |flange, posture, found| {
            self.reach(flange, posture, found)
        })
    }

    fn reach(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        let axis = self.fixed_axis(flange);
        let mut scratch = *posture;
        let roots = CircleRoots::new(|turn| self.misses(&axis, turn, &mut scratch));
        let mut number = 0;
        for &(branch, angle) in roots.all() {
            let (sin, cos) = angle.sin_cos();
            let placed = self.placed_axis(&axis, (cos, sin));
            self.fast.solve(&placed.centre, &mut scratch, &mut |own, posture: &mut Posture| {
                if usize::from(own) == branch {
                    self.turn_wrist(&placed, (cos, sin), posture);
                    found(number, posture);
                    number += 1;
                }
            });
        }
        match (number, roots.least().is_finite()) {
            (0, true) => (roots.least() * self.links[3].r.abs()).max(f64::MIN_POSITIVE),
            (0, false) => self.distance(&axis, &mut scratch),
            _ => 0.0,
        }
    }

    /// Returns axis 6 for a pose of the flange in frame 0.
    fn fixed_axis(&self, flange: &Pose) -> FixedAxis {
        let last = &self.links[5];
        let [x6, y6, z5] = before_twist(&flange.rotation, (last.cos_alpha, last.sin_alpha));
        FixedAxis { x6, y6, z5, origin: flange.translation - z5 * last.r - x6 * last.l }
    }

    /// Returns axis 5 for the angle theta_6.
    fn placed_axis(&self, axis: &FixedAxis, (cos, sin): Angle) -> PlacedAxis {
        let e = &self.links[4];
        let (x5, y5) = (axis.x6 * cos - axis.y6 * sin, axis.x6 * sin + axis.y6 * cos);
        let z4 = y5 * e.sin_alpha + axis.z5 * e.cos_alpha;
        PlacedAxis { z4, x5, centre: axis.origin - z4 * e.r - x5 * e.l }
    }

    /// Returns the cosine of the angle between axes 4 and 5 minus its required value, for each branch of the
    /// first three joints.
    fn misses(&self, axis: &FixedAxis, turn: Angle, scratch: &mut Posture) -> CircleValues {
        let placed = self.placed_axis(axis, turn);
        let mut values = CircleValues::NONE;
        values.gap = self.fast.solve(&placed.centre, scratch, &mut |branch, posture: &mut Posture| {
            let z4 = self.behind_arm(&placed.z4, posture);
            let k = usize::from(branch);
            values.functions[k] = z4.z - self.links[3].cos_alpha;
            values.aside[k] = (z4.x, z4.y);
        });
        values
    }

    /// Converts a vector from frame 0 to frame 3.
    fn behind_arm(&self, vector: &Vector3<f64>, posture: &Posture) -> Vector3<f64> {
        let links = self.links[..3].iter().enumerate();
        links.fold(*vector, |v, (k, link)| {
            turned_back(&v, (posture.cos[k], posture.sin[k]), (link.cos_alpha, link.sin_alpha))
        })
    }

    /// Writes the angles theta_4, theta_5 and theta_6 into a posture that contains the first three joints.
    fn turn_wrist(&self, placed: &PlacedAxis, theta6: Angle, posture: &mut Posture) {
        let d = &self.links[3];
        let z4 = self.behind_arm(&placed.z4, posture);
        let per = d.sin_alpha.signum() / z4.x.hypot(z4.y);
        let theta4 = (-z4.y * per, z4.x * per);
        let x5 = turned_back(&self.behind_arm(&placed.x5, posture), theta4, (d.cos_alpha, d.sin_alpha));
        let per = 1.0 / x5.x.hypot(x5.y);
        (posture.cos[3], posture.sin[3]) = theta4;
        (posture.cos[4], posture.sin[4]) = (x5.x * per, x5.y * per);
        (posture.cos[5], posture.sin[5]) = theta6;
    }

    /// Returns the least distance (m) between P and the points that the first three joints reach.
    ///
    /// P is the intersection of axes 4 and 5. The function computes the distance at evenly spaced values of
    /// theta_6.
    fn distance(&self, axis: &FixedAxis, scratch: &mut Posture) -> f64 {
        const ANGLES: usize = 16;
        let turns = (0..ANGLES).map(|k| (std::f64::consts::TAU * k as f64 / ANGLES as f64).sin_cos());
        let distances = turns.map(|(sin, cos)| {
            self.arm.solve(&self.placed_axis(axis, (cos, sin)).centre, scratch, &mut |_, _: &mut Posture| ())
        });
        distances.fold(f64::INFINITY, f64::min)
    }
}
