//! Tests the normal quantile against published values.

use sweetspot::reading::normal_quantile::normal_quantile;

/// Quantiles of the standard normal distribution. Abramowitz and Stegun, Handbook of Mathematical Functions,
/// table 26.5, give the first digits, and mpmath gives the other digits.
const PUBLISHED: [(f64, f64); 8] = [
    (0.75, 0.674_489_750_196_081_7),
    (0.9, 1.281_551_565_544_600_4),
    (0.95, 1.644_853_626_951_472_7),
    (0.975, 1.959_963_984_540_054),
    (0.99, 2.326_347_874_040_841),
    (0.995, 2.575_829_303_548_900_4),
    (0.999, 3.090_232_306_167_813_5),
    (0.9999, 3.719_016_485_455_68),
];

#[test]
fn the_normal_quantile_agrees_with_published_values() {
    for (p, z) in PUBLISHED {
        let found = normal_quantile(p);
        assert!((found - z).abs() < 1e-12 * z, "{p}: {found} instead of {z}");
        let lower = normal_quantile(1.0 - p);
        assert!((lower + z).abs() < 1e-12 * z, "{}: {lower} instead of {}", 1.0 - p, -z);
    }
    assert!(normal_quantile(0.5).abs() < 1e-15);
}

#[test]
fn the_normal_quantile_keeps_its_digits_in_the_lower_tail() {
    let found = normal_quantile(1e-9);
    assert!((found + 5.997_807_015_007_686_5).abs() < 1e-12, "{found}");
}
