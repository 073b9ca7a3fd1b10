//! Corner of a tolerance box, as a bit set of signs.

use super::MAX_SOURCES;

/// Corner of a tolerance box: one sign per column. A column is the linear effect of one source, or of all
/// means together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ToleranceCorner {
    /// Bit set of the columns with the sign -1.
    pub negative: u128,
}

impl ToleranceCorner {
    /// Returns the corner with the given signs.
    pub fn of_signs(signs: &[f64]) -> Self {
        let bit = |(k, sign): (usize, &f64)| u128::from(*sign < 0.0) << k;
        Self { negative: signs.iter().enumerate().map(bit).fold(0, |set, bit| set | bit) }
    }

    /// Returns the sign of a column: 1 or -1.
    #[inline]
    pub fn sign(self, column: usize) -> f64 {
        if self.negative >> column & 1 == 1 { -1.0 } else { 1.0 }
    }

    /// Returns the signs of all columns.
    pub fn signs(self) -> [f64; MAX_SOURCES] {
        std::array::from_fn(|column| self.sign(column))
    }

    /// Returns the corner after the signs in a bit set are reversed.
    #[inline]
    pub fn flipped(self, set: u128) -> Self {
        Self { negative: self.negative ^ set }
    }

    /// Returns the corner with the opposite signs of the first `count` columns.
    pub fn opposite(self, count: usize) -> Self {
        self.flipped(first(count))
    }

    /// Returns the corner with only the first `count` columns.
    pub fn of_first(self, count: usize) -> Self {
        Self { negative: self.negative & first(count) }
    }

    /// Returns the corner whose signs in the bit set `set` are those of `other`.
    pub fn with_signs_of(self, other: Self, set: u128) -> Self {
        Self { negative: self.negative & !set | other.negative & set }
    }
}

/// Returns the bit set of the first `count` columns.
fn first(count: usize) -> u128 {
    u128::MAX.checked_shr(128 - count.min(128) as u32).unwrap_or(0)
}
