//! Lower bound of a worst case as a function of the rotation of the tool about its axis by the last joint.
//!
//! Let c be a corner of the tolerance box, and let `L(c)` be the linear error there. Only the effects of the
//! errors after the last joint rotate with the tool. Let S be the sum of all other effects at a corner where
//! this sum is long, and let d be the direction of S. For each effect `e_k` that rotates with the tool, the
//! sign of `d . e_k` gives its sign at the corner c. After every rotation, the worst case is then at least
//! `|S + sum_k sign(d . e_k) e_k| - O`. Here O is the largest sum of the products that can reduce the worst
//! case (`worst_bounds`).

use super::zonotope::far_vertex;
use nalgebra::Vector6;

/// Largest rounding error of a bound, as a share of the bound.
pub const ROUNDING: f64 = 1e-9;

/// Lower bound of the worst case at one posture, after any rotation of the tool about its axis by the
/// last joint.
#[derive(Debug, Clone, Default)]
pub struct SpunWorstCase {
    /// Linear error along the rows of the sense, m or rad, at a corner where it is large. The sum contains
    /// only the sources whose effects do not rotate with the tool.
    staying: Vector6<f64>,
    /// Unit vector along `staying`.
    direction: Vector6<f64>,
    /// Effects that rotate with the tool: the constant part, and the coefficients of cosine and sine of the
    /// angle.
    rotating: Vec<[Vector6<f64>; 3]>,
    /// Upper bound of the products of errors that can reduce the worst case, m or rad; infinite if no bound
    /// is known.
    lost: f64,
}

impl SpunWorstCase {
    /// Prepares the bounds of a sense with `rows` rows. The columns in `staying` are the effects of the
    /// sources that do not rotate with the tool. `rotating` returns the parts of all other effects. `lost` is
    /// an upper bound of the products of errors that can reduce the worst case, m or rad.
    pub fn set(
        &mut self,
        rows: usize,
        staying: &[Vector6<f64>],
        rotating: impl Iterator<Item = [Vector6<f64>; 3]>,
        lost: f64,
    ) {
        self.staying = far_vertex(staying, rows);
        self.direction = self.staying.try_normalize(f64::MIN_POSITIVE).unwrap_or_default();
        self.rotating.clear();
        self.rotating.extend(rotating);
        self.lost = lost;
    }

    /// Returns the lower bound after a rotation with the given cosine and sine.
    pub fn at(&self, (cos, sin): (f64, f64)) -> f64 {
        let mut sum = self.staying;
        for [still, of_cos, of_sin] in &self.rotating {
            let effect = still + of_cos * cos + of_sin * sin;
            sum += if effect.dot(&self.direction) < 0.0 { -effect } else { effect };
        }
        (sum.norm() * (1.0 - ROUNDING) - self.lost).max(0.0)
    }

    /// Returns whether the lower bound depends on the rotation of the tool.
    pub fn rotates(&self) -> bool {
        !self.rotating.is_empty()
    }
}
