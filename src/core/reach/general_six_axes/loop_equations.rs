//! Equations of the closed loop, and the elimination of the angles 0, 1 and 5.

use super::elimination::eliminate;
use super::half_angle_equations::HalfAngleEquations;
use super::line_coordinates::LineCoordinates;
use super::scaled_arm::turned;
use crate::pose::Pose;

/// The normal equations for angle 0 are nearly dependent if their determinant is below this share of the
/// squared trace.
///
/// In this case, only one equation for angle 0 is independent, and this equation has two solutions.
const NEARLY_DEPENDENT: f64 = 1e-12;

/// Inner side of the loop equations: axis of joint 5, as a function of the angles 2, 3 and 4.
///
/// The coordinates are in the frame after the rotation of joint 1.
///
/// The field `terms` holds 3 x 9 coefficients. The first index stands for 1, cosine and sine of angle 2. The
/// second index stands for the nine products of half-angle terms of the angles 3 and 4.
#[derive(Clone, Debug)]
pub(super) struct InnerSide {
    terms: [[LineCoordinates; 9]; 3],
}

/// Outer side of the loop equations: axis of joint 5, as a function of angle 0.
///
/// The coordinates are in the frame before the rotation of joint 1.
///
/// The axis follows from a path backwards through the loop: link 0, joint 0 and link 5.
///
/// The terms are the coefficients of 1, of the cosine and of the sine of angle 0. A rotation by minus angle 1
/// converts the axis to the frame of [`InnerSide`].
pub(super) struct OuterSide {
    terms: [LineCoordinates; 3],
}

impl InnerSide {
    /// Returns the inner side of the loop equations. The inner side depends only on links 1 to 4.
    pub fn new(links: &[Pose; 6]) -> Self {
        let mut terms = [[LineCoordinates::axis(); 9]; 3];
        let fourth = LineCoordinates::axis().moved(&links[4]).half_angle_rotated();
        for (j, term) in fourth.iter().enumerate() {
            for (i, term) in term.moved(&links[3]).half_angle_rotated().iter().enumerate() {
                for (part, term) in terms.iter_mut().zip(term.moved(&links[2]).rotated()) {
                    part[3 * i + j] = term.moved(&links[1]);
                }
            }
        }
        Self { terms }
    }
}

impl OuterSide {
    /// Returns the outer side of the loop equations. The outer side depends only on links 5 and 0.
    pub fn new(links: &[Pose; 6]) -> Self {
        let [one, cos, mut sin] = LineCoordinates::axis().moved(&links[5].inverse()).rotated();
        sin.vectors = sin.vectors.map(|v| -v);
        let back = links[0].inverse();
        Self { terms: [one, cos, sin].map(|term| term.moved(&back)) }
    }

    /// Returns the six equations for the angles 2, 3 and 4 that remain after the elimination of the angles 0,
    /// 1 and 5.
    ///
    /// Six of the 14 equations do not contain angle 1. The elimination of cosine and sine of angle 0 leaves
    /// four of these six. The other eight equations contain six products of two factors. The first factor is
    /// cosine or sine of angle 1. The second factor is 1, or cosine or sine of angle 0. The elimination of
    /// these six products leaves two equations.
    pub fn without_outer_angles(&self, inner: &InnerSide) -> HalfAngleEquations {
        let mut first = self.first_six(inner);
        let mut others = self.other_eight(inner);
        eliminate::<6, 2, 29>(&mut first);
        eliminate::<8, 6, 33>(&mut others);
        let mut rows = [[0.0; 27]; 6];
        for (row, from) in rows.iter_mut().zip(&first[2..]) {
            row.copy_from_slice(&from[2..]);
        }
        for (row, from) in rows[4..].iter_mut().zip(&others[6..]) {
            row.copy_from_slice(&from[6..]);
        }
        HalfAngleEquations::new(rows)
    }

    /// Returns the six equations without angle 1. The first two columns belong to cosine and sine of angle 0.
    /// The other 27 columns belong to the terms of [`InnerSide`].
    fn first_six(&self, inner: &InnerSide) -> [[f64; 29]; 6] {
        let [one, cos, sin] = self.terms.map(|term| term.invariants());
        let mut rows = [[0.0; 29]; 6];
        for (i, row) in rows.iter_mut().enumerate() {
            (row[0], row[1]) = (cos[i], sin[i]);
        }
        for (k, term) in inner.terms.iter().flatten().enumerate() {
            let constant = term.numbers[2];
            for ((row, value), one) in rows.iter_mut().zip(term.invariants()).zip(one) {
                row[2 + k] = value - one * constant;
            }
        }
        rows
    }

    /// Returns the eight equations with angle 1. The first six columns belong to the six products that
    /// [`Self::without_outer_angles`] eliminates. The other 27 columns belong to the terms of [`InnerSide`].
    fn other_eight(&self, inner: &InnerSide) -> [[f64; 33]; 8] {
        let mut rows = [[0.0; 33]; 8];
        for (k, term) in self.terms.iter().enumerate() {
            for (pair, v) in rows.chunks_exact_mut(2).zip(&term.vectors) {
                (pair[0][2 * k], pair[0][2 * k + 1]) = (v.x, v.y);
                (pair[1][2 * k], pair[1][2 * k + 1]) = (v.y, -v.x);
            }
        }
        for (k, term) in inner.terms.iter().flatten().enumerate() {
            for (pair, v) in rows.chunks_exact_mut(2).zip(&term.vectors) {
                (pair[0][6 + k], pair[1][6 + k]) = (v.x, v.y);
            }
        }
        rows
    }

    /// Calls `found` with all six angles of the loop (rad) that belong to given angles 2, 3 and 4.
    ///
    /// Angle 0 is the least-squares solution of the six equations without angle 1. The given angles may be
    /// approximate. The six angles then solve the equations only approximately.
    pub fn complete(&self, links: &[Pose; 6], inner: [f64; 3], found: &mut impl FnMut([f64; 6])) {
        let between = inner
            .iter()
            .zip(&links[2..5])
            .fold(links[1], |frame, (angle, link)| turned(&frame, *angle) * *link);
        let line = LineCoordinates::axis().moved(&between);
        let [one, cos, sin] = self.terms.map(|term| term.invariants());
        let (mut cc, mut cs, mut ss, mut cr, mut sr) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for (i, value) in line.invariants().into_iter().enumerate() {
            let rest = value - one[i];
            cc += cos[i] * cos[i];
            cs += cos[i] * sin[i];
            ss += sin[i] * sin[i];
            cr += cos[i] * rest;
            sr += sin[i] * rest;
        }
        let mut with = |angle0: f64| found(self.closed(links, &between, &line, angle0, inner));
        if cc * ss - cs * cs > NEARLY_DEPENDENT * (cc + ss).powi(2) {
            with((sr * cc - cr * cs).atan2(cr * ss - sr * cs));
        } else {
            // Only one equation is independent: a weighted sum of cosine and sine of angle 0 is known.
            let (x, y, rest) = if cc > ss { (cc, cs, cr) } else { (cs, ss, sr) };
            let (middle, norm) = (y.atan2(x), x.hypot(y));
            let half = if norm > 0.0 { (rest / norm).clamp(-1.0, 1.0).acos() } else { 0.0 };
            with(middle + half);
            with(middle - half);
        }
    }

    /// Returns all six angles of the loop (rad), given all angles except 1 and 5.
    ///
    /// Angle 1 is the least-squares rotation from the inner side to the outer side. Angle 5 follows from the
    /// orientation of the rest of the loop.
    fn closed(
        &self,
        links: &[Pose; 6],
        between: &Pose,
        line: &LineCoordinates,
        angle0: f64,
        [angle2, angle3, angle4]: [f64; 3],
    ) -> [f64; 6] {
        let (sin, cos) = angle0.sin_cos();
        let (mut real, mut imaginary) = (0.0, 0.0);
        for (i, inner) in line.vectors.iter().enumerate() {
            let [a, b, c] = self.terms.map(|term| term.vectors[i]);
            let outer = a + b * cos + c * sin;
            real += outer.x * inner.x + outer.y * inner.y;
            imaginary += outer.y * inner.x - outer.x * inner.y;
        }
        let angle1 = imaginary.atan2(real);
        let first = turned(&Pose::IDENTITY, angle0) * links[0];
        let all = turned(&first, angle1) * *between;
        // The last rotation and the last link together are the inverse of the rest of the loop.
        let last = all.rotation.transpose() * links[5].rotation.transpose();
        [angle0, angle1, angle2, angle3, angle4, last.m21.atan2(last.m11)]
    }
}
