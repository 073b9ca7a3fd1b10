//! Inverse kinematics of any arm with six revolute axes: all real solutions of a pose, at most 16.
//!
//! The method follows M. Raghavan, B. Roth, "Inverse kinematics of the general 6R manipulator and related
//! linkages", Journal of Mechanical Design 115, 1993. D. Manocha and J. F. Canny compute the roots of the
//! determinant as eigenvalues in floating-point numbers. Their paper is "Efficient inverse kinematics for
//! general 6R manipulators", IEEE Transactions on Robotics and Automation 10, 1994. Here, a polynomial on the
//! unit circle has the same roots.
//!
//! The arm and the inverse of the flange's pose form a closed loop. Let t_0 to t_5 be the joint angles and
//! G_0 to G_5 constant rigid transformations, one of which contains the pose:
//!
//! ```text
//! Rz(t_0) G_0 Rz(t_1) G_1 Rz(t_2) G_2 Rz(t_3) G_3 Rz(t_4) G_4 Rz(t_5) G_5 = 1
//! ```
//!
//! The loop may begin at any joint and run in either direction (`loop_arrangement`).
//!
//! 1. The axis of t_5 is a line with the direction l through a point p. A rotation by t_5 moves neither the
//!    line nor the point. Two transformations bring the line and the point into the same frame:
//!    `G_1 Rz(t_2) G_2 Rz(t_3) G_3 Rz(t_4) G_4` and `Rz(-t_1) G_0^-1 Rz(-t_0) G_5^-1`. The two results are
//!    equal because the loop is closed. A rigid transformation maps the 14 numbers l, p,
//!    l x p, (p.p) l - 2 (l.p) p, p.p and l.p linearly (`line_coordinates`). This gives 14 equations.
//! 2. The products of cosines and sines of t_0 and t_1 occur linearly. The elimination of these products
//!    leaves six equations (`loop_equations`). These equations are linear in 1, cosine and sine of t_2. They
//!    are also linear in the nine products of `cc`, `cs`, `ss` of t_3 with `cc`, `cs`, `ss` of t_4. Here c
//!    and s are cosine and sine of half an angle.
//! 3. The products of these equations with the tangent of half of t_3 are six more equations. All twelve
//!    equations are linear in twelve products. The determinant is a trigonometric polynomial of degree 8 in
//!    t_2 (`half_angle_equations`). The coefficients come from 24 samples on the circle, which also show the
//!    rounding error (`circle_polynomial`).
//! 4. The real roots are isolated by bounds of the Taylor series (`polynomial_roots`).
//! 5. At a root, the null space of the twelve equations gives t_3 and t_4 (`angle_pairs`). The eliminated
//!    equations then give the other angles. Newton's method on the pose of the flange refines each solution,
//!    and rejects candidates that are not solutions (`scaled_arm`, `pose_problem`).
//!
//! The determinant is 0 at every t_2 if the arm is degenerate in an arrangement, for example because of
//! parallel axes. As a test, the solver solves the flange poses of 16 trial postures in several arrangements.
//! It chooses the arrangement in which the solutions include the most trial postures. A pose that is
//! degenerate in this arrangement is solved in another arrangement. If solutions are not isolated (the arm
//! can move while the flange does not), some of them are returned.

mod angle_pairs;
mod circle_polynomial;
mod elimination;
mod half_angle_equations;
mod line_coordinates;
mod loop_arrangement;
mod loop_equations;
mod polynomial_roots;
mod pose_problem;
mod scaled_arm;

use crate::cell::JointKind;
use crate::low_discrepancy::GOLDEN_STEP;
use crate::pose::Pose;
use crate::robot::{Chain, Link, Posture};
pub(super) use elimination::solve_six;
use loop_arrangement::LoopArrangement;
use loop_equations::InnerSide;
use pose_problem::{JointSolutions, PoseProblem};
use scaled_arm::ScaledArm;
use std::f64::consts::{PI, TAU};

/// Number of trial postures. An arrangement is tested on the flange poses of these postures.
const TRIALS: usize = 16;

/// Least number of trial postures that the solver of an arm must find. One posture may be nearly singular.
const LEAST_FOUND: usize = TRIALS - 1;

/// Inverse kinematics of an arm with six revolute joints, whose axes may have any position relative to each
/// other.
#[derive(Debug, Clone)]
pub struct GeneralSixAxes {
    arm: ScaledArm,
    arrangement: LoopArrangement,
    /// Inner side of the loop equations. In this arrangement, the inner side does not depend on the pose.
    inner: Box<InnerSide>,
}

impl GeneralSixAxes {
    /// Returns the solver of an arm with six revolute axes. The preparation takes a few milliseconds at most.
    ///
    /// # Errors
    /// Returns the reason if the chain does not have six revolute joints. As a test, the function solves the
    /// flange poses of 16 trial postures. If the solutions lack more than one trial posture, the arm counts
    /// as degenerate, and the function returns this reason.
    pub fn new(chain: &Chain) -> Result<Self, String> {
        let rows: &[Link; 6] = chain.links.as_slice().try_into().map_err(|_| {
            format!("the chain has {} joints, and the general method needs six", chain.links.len())
        })?;
        if let Some(k) = rows.iter().position(|row| row.kind != JointKind::Revolute) {
            return Err(format!(
                "joint {} is prismatic, and the general method needs revolute joints",
                k + 1
            ));
        }
        let arm = ScaledArm::new(rows);
        let [first, others @ ..] = LoopArrangement::CONSTANT_INSIDE;
        let mut best = Self::arranged(&arm, first);
        let mut most = best.count_found(Self::solve_in_own_arrangement);
        for arrangement in others {
            if most == TRIALS {
                break;
            }
            let other = Self::arranged(&arm, arrangement);
            let found = other.count_found(Self::solve_in_own_arrangement);
            if found > most {
                (best, most) = (other, found);
            }
        }
        if most < LEAST_FOUND {
            most = best.count_found(Self::solve_in_any_arrangement);
        }
        if most < LEAST_FOUND {
            return Err(format!(
                "the general method finds only {most} of {TRIALS} trial postures: the arm is degenerate"
            ));
        }
        Ok(best)
    }

    /// Returns the solver of an arm in one arrangement.
    ///
    /// In this arrangement, the inner side of the loop equations must not depend on the pose.
    fn arranged(arm: &ScaledArm, arrangement: LoopArrangement) -> Self {
        // The inner side depends on links 1 to 4, and the pose is a part of link 0 or link 5.
        let inner = InnerSide::new(&arrangement.links(&arm.links, &Pose::IDENTITY));
        Self { arm: arm.clone(), arrangement, inner: Box::new(inner) }
    }

    /// Calls `found` with every posture that puts the last D-H frame at `flange`; joint limits are ignored.
    ///
    /// `flange` is a pose in frame 0, without the tool. `posture` is working memory. Before the call, it must
    /// hold the constant D-H values of the chain, such as r of a revolute joint. The function overwrites the
    /// joint coordinates. The branch index is the running number of the solution among all solutions of this
    /// pose. A solution may change its index while the pose moves, because other solutions appear and vanish.
    ///
    /// Returns a measure (m) of how far the target is out of reach. The measure is 0 if there is a solution,
    /// and positive if there is none. The measure is `f64::MAX` if the pose is not finite.
    ///
    /// All reachable positions of the origin of frame 5 lie inside a sphere. If the pose requires a position
    /// outside this sphere, the measure is the distance from the sphere. If the required position is inside
    /// the sphere but no solution exists, the measure comes from a determinant. This determinant depends on
    /// one joint angle and is 0 at every solution. A coarse scan of this angle samples the determinant. The
    /// measure is the length of the arm times the ratio of the least to the greatest absolute determinant.
    pub fn solve(&self, flange: &Pose, posture: &mut Posture, found: &mut dyn FnMut(u8, &Posture)) -> f64 {
        let target = self.arm.scaled(flange);
        let beyond = self.arm.beyond_reach(&target);
        if beyond.is_nan() {
            return f64::MAX;
        }
        if beyond > 0.0 {
            return (beyond * self.arm.length).clamp(f64::MIN_POSITIVE, f64::MAX);
        }
        let mut solutions = JointSolutions::new();
        let least_determinant = self.solve_in_any_arrangement(&target, &mut solutions);
        for (number, joints) in solutions.all().iter().enumerate() {
            for ((cos, sin), angle) in posture.cos.iter_mut().zip(&mut posture.sin).zip(joints) {
                (*sin, *cos) = angle.sin_cos();
            }
            found(number as u8, posture);
        }
        match solutions.all().is_empty() {
            true => (least_determinant * self.arm.length).max(f64::MIN_POSITIVE),
            false => 0.0,
        }
    }

    /// Adds the solutions of a pose, if the pose is regular in the arrangement of the arm.
    ///
    /// Lengths of the pose are in units of the arm's length.
    ///
    /// Returns the ratio of the least to the greatest absolute determinant of a coarse scan.
    fn solve_in_own_arrangement(&self, target: &Pose, solutions: &mut JointSolutions) -> f64 {
        let problem = self.problem(target);
        if problem.is_regular() {
            problem.solve(solutions);
        }
        problem.least_determinant()
    }

    /// Adds the solutions of a pose, in the first arrangement in which the pose is regular.
    ///
    /// Lengths of the pose are in units of the arm's length.
    ///
    /// Returns the ratio of the least to the greatest absolute determinant of a coarse scan.
    fn solve_in_any_arrangement(&self, target: &Pose, solutions: &mut JointSolutions) -> f64 {
        let own = self.problem(target);
        let problem = match own.is_regular() {
            true => own,
            false => LoopArrangement::all()
                .filter(|other| *other != self.arrangement)
                .map(|other| PoseProblem::new(&self.arm, other, None, target))
                .find(PoseProblem::is_regular)
                .unwrap_or(own),
        };
        problem.solve(solutions);
        problem.least_determinant()
    }

    /// Returns the problem of a pose (lengths in units of the arm's length) in the arrangement of the arm.
    fn problem<'a>(&'a self, target: &'a Pose) -> PoseProblem<'a> {
        PoseProblem::new(&self.arm, self.arrangement, Some(&self.inner), target)
    }

    /// Solves the flange pose of every trial posture with `solve`. Returns the number of trial postures that
    /// are among the solutions.
    fn count_found(&self, solve: impl Fn(&Self, &Pose, &mut JointSolutions) -> f64) -> usize {
        let is_found = |joints: &[f64; 6]| {
            let mut solutions = JointSolutions::new();
            solve(self, &self.arm.flange(joints), &mut solutions);
            solutions.contains(joints)
        };
        trial_postures().filter(is_found).count()
    }
}

/// Returns joint angles (rad) that are spread over a whole turn, without special relations between them.
fn trial_postures() -> impl Iterator<Item = [f64; 6]> {
    // Steps of the golden section, perturbed so that they do not repeat.
    let mut share = 0.37;
    let mut next = move || {
        share = (share + GOLDEN_STEP + 0.1 * share * share) % 1.0;
        TAU * share - PI
    };
    (0..TRIALS).map(move |_| std::array::from_fn(|_| next()))
}
