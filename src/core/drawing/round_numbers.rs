//! Round numbers for scale bars and for the factor that enlarges arrows.

/// Leading factors 1, 2 and 5 of round numbers.
pub const ONE_TWO_FIVE: &[f64] = &[1.0, 2.0, 5.0];
/// Leading factors 1 to 9 of round numbers.
pub const DIGITS: &[f64] = &[1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0];
/// Leading factors 1, 1.5, 2, ... 9.5 of round numbers.
pub const HALF_DIGITS: &[f64] =
    &[1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5, 6.0, 6.5, 7.0, 7.5, 8.0, 8.5, 9.0, 9.5];

/// Returns the largest round number that does not exceed `limit`, which must be positive.
///
/// A round number is one of the factors in `leads`, multiplied by a power of ten.
pub fn round_down(limit: f64, leads: &[f64]) -> f64 {
    let decade = 10f64.powi(limit.log10().floor() as i32);
    // The logarithm of a power of ten may be wrong in the last bit.
    let fits = |lead: &&f64| **lead * decade <= limit * (1.0 + 1e-12);
    leads.iter().rev().find(fits).map_or(decade, |lead| lead * decade)
}
