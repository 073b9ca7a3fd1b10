//! Geometric subproblems, in the manner of Paden and Kahan, that the solvers of six-axis arms share.
//!
//! Sources: R. M. Murray, Z. Li, S. S. Sastry, A Mathematical Introduction to Robotic Manipulation, 1994,
//! section 3.2; A. J. Elias, J. T. Wen, "IK-Geo: Unified robot inverse kinematics using subproblem
//! decomposition" (2022).
//!
//! Every angle is a pair (cosine, sine). The formulas avoid cancellation where two solutions coincide, so a
//! double solution is accurate to rounding.

use nalgebra::{Matrix3, Vector3};

/// Largest excess over 1 at which a cosine still counts as 1. Without this tolerance, rounding could reject a
/// target at the edge of the reach.
pub(in crate::reach) const BOUNDARY: f64 = 1e-12;

/// Two axes count as aligned if the sine of their angle is below this value. The common normal of aligned
/// axes has no reliable direction.
///
/// A point counts as lying on an axis if its distance (m) from the axis is below this value.
pub(in crate::reach) const ALIGNED: f64 = 1e-12;

/// Cosine and sine of an angle.
pub(in crate::reach) type Angle = (f64, f64);

/// Returns the difference `b - a` of two angles.
#[inline]
pub(in crate::reach) fn difference(b: Angle, a: Angle) -> Angle {
    (b.0 * a.0 + b.1 * a.1, b.1 * a.0 - b.0 * a.1)
}

/// Two links in a plane: link `a` at the angle t, link `b` at t + s. Lengths are in m and may be negative.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct TwoLinks {
    a: f64,
    b: f64,
    per_twice_a: f64,
    per_twice_ab: f64,
}

impl TwoLinks {
    /// Returns two links of the lengths `a` and `b`, m.
    pub fn new(a: f64, b: f64) -> Self {
        Self { a, b, per_twice_a: 0.5 / a, per_twice_ab: 0.5 / (a * b) }
    }

    /// Returns the least and greatest distance from the axis of link `a` to the tip of link `b`, m.
    pub fn range(&self) -> (f64, f64) {
        ((self.a.abs() - self.b.abs()).abs(), self.a.abs() + self.b.abs())
    }

    /// Returns both solutions (t, s) that put the tip of link `b` at (u, v), m.
    ///
    /// Link `a` has the angle t, and link `b` the angle t + s. The first solution has sin s <= 0, and the
    /// second has sin s >= 0. If the tip is on the axis of link `a`, t is free and is set to 0.
    ///
    /// # Errors
    /// Returns how far (u, v) is out of reach, m.
    #[inline]
    pub fn solve(&self, u: f64, v: f64) -> Result<[(Angle, Angle); 2], f64> {
        let (a, b) = (self.a, self.b);
        let d2 = u * u + v * v;
        let cos = (d2 - a * a - b * b) * self.per_twice_ab;
        if cos.abs() > 1.0 + BOUNDARY {
            let (least, most) = self.range();
            return Err((d2.sqrt() - most).max(least - d2.sqrt()));
        }
        let cos = cos.clamp(-1.0, 1.0);
        // Heron's formula avoids cancellation for a nearly straight or folded pair of links.
        let heron = ((a + b) * (a + b) - d2) * (d2 - (a - b) * (a - b));
        let sin = heron.max(0.0).sqrt() * self.per_twice_ab.abs();
        let (along, across, per) = ((d2 + a * a - b * b) * self.per_twice_a, b * sin, 1.0 / d2);
        let first = |k: f64| match d2 > 0.0 {
            true => ((along * u + k * v) * per, (along * v - k * u) * per),
            false => (1.0, 0.0),
        };
        Ok([(first(-across), (cos, -sin)), (first(across), (cos, sin))])
    }
}

/// Solver for the rotation about the middle axis of three axes, given the angle between the outer axes.
///
/// `first` is the D-H twist between the first and the middle axis. `second` is the twist between the middle
/// and the last axis (IK-Geo, subproblem 4).
#[derive(Debug, Clone, PartialEq)]
pub(in crate::reach) struct Twists {
    pub first: Angle,
    pub second: Angle,
    per_sines: f64,
    /// `1 - cos` and `1 + cos` of the angle `first + second`.
    sum: (f64, f64),
    /// `1 - cos` and `1 + cos` of the angle `first - second`.
    apart: (f64, f64),
}

impl Twists {
    /// Returns the solver for two twists, neither of which may be a multiple of pi.
    pub fn new(first: Angle, second: Angle) -> Self {
        let ((ca, sa), (cb, sb)) = (first, second);
        let (sum, apart) = (ca * cb - sa * sb, ca * cb + sa * sb);
        let sides = |cosine: f64| (1.0 - cosine, 1.0 + cosine);
        Self { first, second, per_sines: 1.0 / (sa * sb), sum: sides(sum), apart: sides(apart) }
    }

    /// Returns the rotation about the middle axis, from 0 to 180 degrees; None if no rotation gives the angle
    /// between the outer axes.
    ///
    /// `cosine` and `sine2` are the cosine and the squared sine of the angle between the outer axes.
    #[inline]
    pub fn turn(&self, cosine: f64, sine2: f64) -> Option<Angle> {
        let cos = (self.first.0 * self.second.0 - cosine) * self.per_sines;
        if cos.abs() > 1.0 + BOUNDARY {
            return None;
        }
        // Computing `1 - |cosine|` from the sine avoids cancellation for nearly parallel outer axes.
        let near = sine2 / (1.0 + cosine.abs());
        let product = match cosine > 0.0 {
            true => (self.sum.0 - near) * (near - self.apart.0),
            false => (near - self.sum.1) * (self.apart.1 - near),
        };
        Some((cos.clamp(-1.0, 1.0), product.max(0.0).sqrt() * self.per_sines.abs()))
    }
}

/// Returns `Rx(-alpha) Rz(-theta) v`: the components of `v` in the frame after the rotations of one D-H
/// row.
#[inline]
pub(in crate::reach) fn turned_back(v: &Vector3<f64>, theta: Angle, alpha: Angle) -> Vector3<f64> {
    let (x, y) = (theta.0 * v.x + theta.1 * v.y, theta.0 * v.y - theta.1 * v.x);
    Vector3::new(x, alpha.0 * y + alpha.1 * v.z, alpha.0 * v.z - alpha.1 * y)
}

/// Returns the axes of the last D-H frame before its twist: the columns of `rotation * Rx(-alpha)`.
#[inline]
pub(in crate::reach) fn before_twist(rotation: &Matrix3<f64>, alpha: Angle) -> [Vector3<f64>; 3] {
    let (x, y, z) = (rotation.column(0), rotation.column(1), rotation.column(2));
    [x.into_owned(), y * alpha.0 - z * alpha.1, y * alpha.1 + z * alpha.0]
}
