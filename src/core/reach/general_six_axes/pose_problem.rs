//! All solutions of one pose in one arrangement of the loop.

use super::angle_pairs::angle_pairs;
use super::circle_polynomial::CirclePolynomial;
use super::half_angle_equations::HalfAngleEquations;
use super::loop_arrangement::LoopArrangement;
use super::loop_equations::{InnerSide, OuterSide};
use super::polynomial_roots::polynomial_roots;
use super::scaled_arm::{RefinedJoints, ScaledArm};
use crate::pose::Pose;
use std::f64::consts::{PI, TAU};

/// Largest number of isolated solutions of six revolute axes.
const MAX_SOLUTIONS: usize = 16;

/// Two solutions count as the same if their joint angles differ by less than this value, rad.
const SAME_JOINT: f64 = 1e-5;

/// Limit, rad, of the joint differences between a start of Newton's method and the solution found.
///
/// If every joint difference is below this limit, the start may lie between two nearby solutions.
const NEAR_START: f64 = 0.2;

/// Ratio of two joint changes (rad) above which Newton's first step overshoots the solution.
///
/// The numerator is [`RefinedJoints::first_step`]. The denominator is the largest joint difference between
/// start and solution.
const OVERSHOOT: f64 = 1.05;

/// Largest residual of the equations at a start of Newton's method.
///
/// The coefficients of an equation have the norm 1.
const MAX_RESIDUAL: f64 = 0.03;

/// Largest residual at a start of Newton's method if angle 2 is exact.
const EXACT_RESIDUAL: f64 = 2e-4;

/// Increase of the largest residual per radian of the uncertainty of angle 2.
const RESIDUAL_PER_UNCERTAINTY: f64 = 1000.0;

/// The polynomial is sampled again in the vicinity of a root if the uncertainty of the root is above this
/// value, rad.
const UNCERTAIN: f64 = 1e-3;

/// The vicinity of a root extends on both sides by its uncertainty, but at most by this value, rad.
const MAX_EXTENSION: f64 = 0.1;

/// Upper limit, rad, of the angle a that defines the scale `tan(a)` of a magnified polynomial.
///
/// The angle a is the smaller of this limit and a quarter of the width of the magnified interval.
const MAX_HALF_SPAN: f64 = 0.7;

/// Largest absolute angle, as a share of pi, at which a root of a magnified polynomial is used.
const MAGNIFIED: f64 = 0.7;

/// Distinct solutions of one pose, as joint angles in rad.
pub(super) struct JointSolutions {
    joints: [[f64; 6]; MAX_SOLUTIONS],
    count: usize,
}

/// One pose of the flange in one arrangement of the loop.
pub(super) struct PoseProblem<'a> {
    arm: &'a ScaledArm,
    arrangement: LoopArrangement,
    target: &'a Pose,
    links: [Pose; 6],
    outer: OuterSide,
    equations: HalfAngleEquations,
    polynomial: CirclePolynomial,
}

impl<'a> PoseProblem<'a> {
    /// Returns the problem of a pose with lengths in units of the arm's length.
    ///
    /// `inner` is the inner side of the loop equations in this arrangement. If `inner` is None, this
    /// function computes the inner side from the pose.
    pub fn new(
        arm: &'a ScaledArm,
        arrangement: LoopArrangement,
        inner: Option<&InnerSide>,
        target: &'a Pose,
    ) -> Self {
        let links = arrangement.links(&arm.links, target);
        let outer = OuterSide::new(&links);
        let equations = match inner {
            Some(inner) => outer.without_outer_angles(inner),
            None => outer.without_outer_angles(&InnerSide::new(&links)),
        };
        let polynomial = equations.polynomial();
        Self { arm, arrangement, target, links, outer, equations, polynomial }
    }

    /// Returns whether the pose is not degenerate in this arrangement.
    pub fn is_regular(&self) -> bool {
        self.polynomial.is_regular()
    }

    /// Returns the least absolute value of the determinant in a coarse scan, as a share of the greatest
    /// absolute value.
    pub fn least_determinant(&self) -> f64 {
        self.polynomial.least_sample()
    }

    /// Adds the solutions to `all`.
    ///
    /// In a degenerate arrangement, the polynomial is only noise. The roots then serve only as starts of
    /// Newton's method.
    pub fn solve(&self, all: &mut JointSolutions) {
        if !self.is_regular() {
            polynomial_roots(&self.polynomial, &mut |angle2, _| self.add(angle2, f64::INFINITY, all));
            return;
        }
        // Neighbouring uncertain roots are merged into one vicinity.
        let mut vicinity: Option<(f64, f64)> = None;
        polynomial_roots(&self.polynomial, &mut |angle2, uncertainty| {
            if uncertainty < UNCERTAIN {
                return self.add(angle2, uncertainty, all);
            }
            let extension = uncertainty.min(MAX_EXTENSION);
            let (low, high) = (angle2 - extension, angle2 + extension);
            vicinity = match vicinity {
                Some((from, to)) if low < to + UNCERTAIN => Some((from.min(low), to.max(high))),
                Some((from, to)) => {
                    self.solve_near(from, to, all);
                    Some((low, high))
                }
                None => Some((low, high)),
            };
            all.count < MAX_SOLUTIONS
        });
        if let Some((from, to)) = vicinity {
            self.solve_near(from, to, all);
        }
    }

    /// Adds the solutions whose angle 2 is in or near an interval (rad).
    ///
    /// The interval is magnified to half of the circle if it is at most 2.8 rad wide. If it is wider, the
    /// scale is limited ([`MAX_HALF_SPAN`]), and the interval covers more than half of the circle.
    fn solve_near(&self, from: f64, to: f64, all: &mut JointSolutions) {
        let middle = 0.5 * (from + to);
        let scale = (0.25 * (to - from)).min(MAX_HALF_SPAN).tan();
        let polynomial = self.equations.polynomial_near(middle, scale);
        polynomial_roots(&polynomial, &mut |angle, uncertainty| {
            angle.abs() > MAGNIFIED * PI || {
                let (s, c) = (0.5 * angle).sin_cos();
                self.add(middle + 2.0 * (scale * s).atan2(c), 2.0 * scale * uncertainty, all)
            }
        });
    }

    /// Adds the solutions at one angle 2 with a given uncertainty (rad). Returns whether there may be more
    /// solutions.
    fn add(&self, angle2: f64, uncertainty: f64, all: &mut JointSolutions) -> bool {
        let limit = match uncertainty.is_finite() {
            true => MAX_RESIDUAL.min(EXACT_RESIDUAL + RESIDUAL_PER_UNCERTAINTY * uncertainty),
            false => f64::INFINITY,
        };
        let (sin, cos) = angle2.sin_cos();
        angle_pairs(&self.equations.at(cos, sin), limit, &mut |angle3, angle4| {
            self.outer.complete(&self.links, [angle2, angle3, angle4], &mut |angles| {
                let start = self.arrangement.joints(angles);
                let Some(refined) = all.refine(self.arm, start, self.target) else { return };
                // If the first step overshoots, the start is between two nearby solutions.
                let overshot = refined.first_step / OVERSHOOT;
                if is_near(&start, &refined.angles, NEAR_START.min(overshot)) {
                    let beyond = std::array::from_fn(|k| 2.0 * start[k] - refined.angles[k]);
                    all.refine(self.arm, beyond, self.target);
                }
            });
        });
        all.count < MAX_SOLUTIONS
    }
}

impl JointSolutions {
    /// Returns an empty set.
    pub fn new() -> Self {
        Self { joints: [[0.0; 6]; MAX_SOLUTIONS], count: 0 }
    }

    /// Returns the joint angles (rad) of all solutions.
    pub fn all(&self) -> &[[f64; 6]] {
        &self.joints[..self.count]
    }

    /// Returns whether the joint angles (rad) agree with a solution, up to whole turns.
    pub fn contains(&self, joints: &[f64; 6]) -> bool {
        self.all().iter().any(|known| is_near(known, joints, SAME_JOINT))
    }

    /// Returns the solution to which Newton's method leads from a start (rad), and adds it if it is new.
    ///
    /// Returns `None` if there is no such solution. Also returns `None` if the start is a known solution, or
    /// if the set is full.
    fn refine(&mut self, arm: &ScaledArm, start: [f64; 6], target: &Pose) -> Option<RefinedJoints> {
        if self.count == MAX_SOLUTIONS || self.contains(&start) {
            return None;
        }
        let refined = arm.refined(start, target, |joints| self.contains(joints))?;
        if !self.contains(&refined.angles) {
            self.joints[self.count] = refined.angles;
            self.count += 1;
        }
        Some(refined)
    }
}

/// Returns whether all joint angles of two postures differ by less than `limit` (rad), up to whole turns.
fn is_near(one: &[f64; 6], other: &[f64; 6], limit: f64) -> bool {
    one.iter().zip(other).all(|(a, b)| (a - b - TAU * ((a - b) / TAU).round()).abs() < limit)
}
