//! Coordinates of a line and of a point on this line. A rigid transformation maps these coordinates linearly.

use crate::pose::Pose;
use nalgebra::Vector3;

/// The 14 coordinates of a line in direction `l` through a point `p`, and the number one.
///
/// A rigid transformation maps these 15 numbers linearly. Sums and multiples of these numbers are mapped in
/// the same way. So this type also holds the terms a, b and c of coordinates `a + b cos t + c sin t`.
#[derive(Clone, Copy, Debug)]
pub(super) struct LineCoordinates {
    /// The vectors `l`, `p`, `l x p` and `(p.p) l - 2 (l.p) p`.
    pub vectors: [Vector3<f64>; 4],
    /// The numbers `p.p`, `l.p` and one.
    pub numbers: [f64; 3],
}

impl LineCoordinates {
    /// Returns the coordinates of the z axis, with the origin as the point on the axis.
    pub fn axis() -> Self {
        let zero = Vector3::zeros();
        Self { vectors: [Vector3::z(), zero, zero, zero], numbers: [0.0, 0.0, 1.0] }
    }

    /// Returns the coordinates of the line and the point after a rigid transformation.
    pub fn moved(&self, by: &Pose) -> Self {
        let t = by.translation;
        let [l, p, m, w] = self.vectors.map(|vector| by.rotation * vector);
        let [pp, lp, one] = self.numbers;
        let (tl, tt) = (t.dot(&l), t.dot(&t));
        Self {
            vectors: [l, p + t * one, m + l.cross(&t), w + 2.0 * t.cross(&m) - 2.0 * (lp + tl) * t + tt * l],
            numbers: [pp + 2.0 * t.dot(&p) + tt * one, lp + tl, one],
        }
    }

    /// Returns the coordinates after a rotation about z, as coefficients of 1, of the cosine and of the sine
    /// of the angle.
    pub fn rotated(&self) -> [Self; 3] {
        let zeros = [0.0; 3];
        [
            Self { vectors: self.vectors.map(|v| Vector3::new(0.0, 0.0, v.z)), ..*self },
            Self { vectors: self.vectors.map(|v| Vector3::new(v.x, v.y, 0.0)), numbers: zeros },
            Self { vectors: self.vectors.map(|v| Vector3::new(-v.y, v.x, 0.0)), numbers: zeros },
        ]
    }

    /// Returns the coordinates after a rotation about z, as coefficients of `cc`, `cs` and `ss`.
    ///
    /// Here `c` and `s` are the cosine and the sine of half the angle.
    pub fn half_angle_rotated(&self) -> [Self; 3] {
        let mixed = self.vectors.map(|v| Vector3::new(-2.0 * v.y, 2.0 * v.x, 0.0));
        [
            *self,
            Self { vectors: mixed, numbers: [0.0; 3] },
            Self { vectors: self.vectors.map(|v| Vector3::new(-v.x, -v.y, v.z)), ..*self },
        ]
    }

    /// Returns the six coordinates that a rotation about z does not change.
    pub fn invariants(&self) -> [f64; 6] {
        let [l, p, m, w] = self.vectors;
        [l.z, p.z, m.z, w.z, self.numbers[0], self.numbers[1]]
    }
}
