//! Tests the low-discrepancy sequences against their definitions.

use sweetspot::low_discrepancy::{RobertsSequence, halton, primes, radical_inverse, richtmyer_steps};

#[test]
fn the_radical_inverse_mirrors_the_digits() {
    let binary: Vec<f64> = (0..6).map(|k| radical_inverse(k, 2)).collect();
    assert_eq!(binary, [0.0, 0.5, 0.25, 0.75, 0.125, 0.625]);
    let ternary: Vec<f64> = (1..5).map(|k| radical_inverse(k, 3) * 9.0).collect();
    for (found, wanted) in ternary.iter().zip([3.0, 6.0, 1.0, 4.0]) {
        assert!((found - wanted).abs() < 1e-14, "{ternary:?}");
    }
}

#[test]
fn halton_points_use_the_first_primes() {
    assert_eq!(primes().take(8).collect::<Vec<_>>(), [2, 3, 5, 7, 11, 13, 17, 19]);
    let first: Vec<f64> = halton(1).take(4).collect();
    assert_eq!(first, [1.0 / 2.0, 1.0 / 3.0, 1.0 / 5.0, 1.0 / 7.0]);
}

#[test]
fn the_r_d_sequence_follows_the_golden_ratio_and_the_plastic_number() {
    let golden = RobertsSequence::new(1);
    assert_eq!(golden.coordinate(0, 0), 0.5);
    assert!((golden.coordinate(1, 0) - 0.118_033_988_749_895).abs() < 1e-14);
    let plastic = RobertsSequence::new(2);
    assert!((plastic.coordinate(1, 0) - 0.254_877_666_246_693).abs() < 1e-14);
    assert!((plastic.coordinate(1, 1) - 0.069_840_290_998_053).abs() < 1e-14);
}

#[test]
fn richtmyer_steps_are_square_roots_of_primes() {
    let steps: Vec<f64> = richtmyer_steps().take(3).collect();
    assert_eq!(steps, [2f64.sqrt() - 1.0, 3f64.sqrt() - 1.0, 5f64.sqrt() - 2.0]);
}
