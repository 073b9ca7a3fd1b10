//! Six-axis arms whose last or first three axes meet in one point: a spherical wrist or shoulder.
//!
//! The first three joints position the wrist centre, and the last three set the orientation (Pieper 1968). An
//! arm with a spherical shoulder is solved as the reversed chain, from flange to base. In the reversed chain,
//! the shoulder takes the place of the wrist.

use super::positioning_arm::PositioningArm;
use super::reversed_chain::{in_either_direction, solve_either_direction};
use super::subproblems::{ALIGNED, Twists, before_twist, turned_back};
use crate::cell::JointKind;
use crate::pose::Pose;
use crate::reach::Shell;
use crate::robot::{Chain, Link, Posture};
use nalgebra::Vector3;

/// Closed form of an arm with a spherical wrist or shoulder; lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub struct SphericalWrist {
    /// D-H rows from base to flange; for a spherical shoulder, the rows of the reversed chain.
    links: [Link; 6],
    arm: PositioningArm,
    twists: Twists,
    /// Wrist centre in the last D-H frame.
    centre: Vector3<f64>,
    /// Constant part `Tx(l_6) Rx(alpha_6)` of the last D-H row, if the arm is solved from flange to base;
    /// None for a spherical wrist.
    reversed: Option<Pose>,
}

impl SphericalWrist {
    /// Returns the closed form of an arm with a spherical wrist or shoulder.
    ///
    /// # Errors
    /// Returns the reason if the chain is not such an arm.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        in_either_direction(chain, Self::forward)
    }

    fn forward(links: [Link; 6], reversed: Option<Pose>) -> Result<Self, String> {
        let [_, _, _, d, e, f] = &links;
        if [d, e, f].iter().any(|l| l.kind != JointKind::Revolute) {
            return Err("a joint of the wrist is prismatic".into());
        }
        if [d.l, e.l, e.r].iter().any(|x| x.abs() > 1e-12) {
            return Err("the last three axes do not meet in one point (l_4, l_5 or r_5 is not 0)".into());
        }
        if [d, e].iter().any(|l| l.sin_alpha.abs() < 1e-6) {
            return Err("two neighbouring axes of the wrist are parallel (alpha_4 or alpha_5)".into());
        }
        let arm = PositioningArm::new(&[links[0], links[1], links[2]], d.r)?;
        let twists = Twists::new((d.cos_alpha, d.sin_alpha), (e.cos_alpha, e.sin_alpha));
        let centre = -Vector3::new(f.l, f.r * f.sin_alpha, f.r * f.cos_alpha);
        Ok(Self { links, arm, twists, centre, reversed })
    }

    /// Calls `found` with every posture that puts the last D-H frame at `flange`; joint limits are ignored.
    ///
    /// `flange` is a pose in frame 0, without the tool. `posture` is working memory. Before the call, it must
    /// hold the constant D-H values of the chain, such as r of a revolute joint. The function overwrites the
    /// joint coordinates.
    ///
    /// Bit 0 of the branch index is set if the wrist is flipped. For an anthropomorphic arm, bit 1
    /// distinguishes the two elbow solutions, and bit 2 is set if the arm leans back over its base.
    ///
    /// For other arms, bit 1 distinguishes the two solutions for joint 2. Bit 2 is set if the polynomial of
    /// Pieper's equation increases at the solution for joint 3. If bit 2 has the same value for two roots of
    /// this equation, then bit 3 is set for the second root. The roots are in ascending order of theta_3 from
    /// -180 degrees, or of r_3 if joint 3 is prismatic.
    ///
    /// During a continuous motion, the index of the posture changes only at a singularity or at theta_3 = 180
    /// degrees. No better numbering exists for a cuspidal arm, which can change posture without passing a
    /// singularity.
    ///
    /// If axes 4 and 6 are aligned, theta_4 is 0 and the wrist is not flipped. If the wrist centre lies on
    /// axis 1 or 2, the angle theta of that axis is 0. For a spherical shoulder, all these axes are
    /// numbered from flange to base.
    ///
    /// Returns the distance (m) from the wrist centre to the nearest point that the first three joints
    /// reach. A distance of 0 does not always mean that a solution exists. If alpha_4 or alpha_5 is not a
    /// right angle, axes 4 to 6 cannot reach every orientation.
    #[inline]
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        solve_either_direction(self.reversed.as_ref(), flange, posture, found, |flange, posture, found| {
            self.reach(flange, posture, found)
        })
    }

    /// Returns a faster variant of the solver. For a target out of reach, [`Self::solve`] of the variant
    /// returns only a lower bound in place of the distance. At the boundary of the reach, rounding may hide a
    /// solution from the variant.
    pub fn fast(&self) -> Self {
        Self { arm: self.arm.fast(), ..self.clone() }
    }

    /// Returns a lower bound of the distance, m, that [`Self::solve`] returns. The bound is much cheaper to
    /// compute than a solution.
    #[inline]
    pub fn bound(&self, flange: &Pose) -> f64 {
        self.arm.bound(&self.centre(flange))
    }

    /// Returns the point that the first three joints must reach, m: the wrist centre in frame 0. For a
    /// spherical shoulder, it is the shoulder centre in the first frame of the reversed chain.
    #[inline]
    pub fn centre(&self, flange: &Pose) -> Vector3<f64> {
        match &self.reversed {
            Some(lead) => (*lead * flange.inverse()).transform(&self.centre),
            None => flange.transform(&self.centre),
        }
    }

    /// Returns a shell that contains every reachable position of the point that [`Self::centre`] returns;
    /// None if one of the first three joints is prismatic.
    pub fn shell(&self) -> Option<Shell> {
        self.arm.shell()
    }

    #[inline]
    fn reach(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        let p = flange.transform(&self.centre);
        let last = &self.links[5];
        let [x, _, z] = before_twist(&flange.rotation, (last.cos_alpha, last.sin_alpha));
        self.arm.solve(&p, posture, &mut |branch, posture: &mut Posture| {
            self.turn(branch << 1, x, z, posture, found);
        })
    }

    /// Calls `found` with each solution for theta_4 to theta_6 that reaches the required orientation.
    ///
    /// The orientation is given by the unit vectors `x` and `z` in frame 0. These vectors are axes x and z of
    /// frame 6 before the rotation by the D-H twist alpha_6. `posture` holds theta_1 to theta_3.
    #[inline]
    fn turn(
        &self,
        branch: u8,
        mut x: Vector3<f64>,
        mut z: Vector3<f64>,
        posture: &mut Posture,
        found: &mut dyn FnMut(u8, &Posture),
    ) {
        for (k, link) in self.links[..3].iter().enumerate() {
            let (theta, alpha) = ((posture.cos[k], posture.sin[k]), (link.cos_alpha, link.sin_alpha));
            (x, z) = (turned_back(&x, theta, alpha), turned_back(&z, theta, alpha));
        }
        let across2 = z.x * z.x + z.y * z.y;
        let Some((cos5, sin5)) = self.twists.turn(z.z, across2) else { return };
        let ((ca, sa), (cb, sb)) = (self.twists.first, self.twists.second);
        // In the frame rotated by theta_4, axis 6 has the components x = +-u and y = v; theta_4 rotates axis
        // 6 to z.
        let (u, v) = (sb * sin5, -(ca * sb * cos5 + sa * cb));
        let size2 = u * u + v * v;
        let in_line = across2.min(size2) < ALIGNED * ALIGNED;
        let per = 1.0 / (size2 * across2).sqrt();
        for (flipped, sin5, u) in [(0, sin5, u), (1, -sin5, -u)] {
            let theta = match in_line {
                true => (1.0, 0.0),
                false => ((u * z.x + v * z.y) * per, (u * z.y - v * z.x) * per),
            };
            // theta_6 compensates for any value of theta_4.
            let w = turned_back(&x, theta, (ca, sa));
            (posture.cos[3], posture.sin[3]) = theta;
            (posture.cos[4], posture.sin[4]) = (cos5, sin5);
            posture.cos[5] = cos5 * w.x + sin5 * w.y;
            posture.sin[5] = cb * (cos5 * w.y - sin5 * w.x) + sb * w.z;
            found(branch | flipped, posture);
            if in_line {
                break;
            }
        }
    }
}
