//! Colours that colour-blind readers can tell apart, even in a greyscale print.

/// Colour map viridis (N. Smith, S. van der Walt and E. Firing; CC0), sampled at equal steps. The lightness
/// of the map rises evenly.
const VIRIDIS: [[f64; 3]; 6] = [
    [68.0, 1.0, 84.0],
    [65.0, 68.0, 135.0],
    [42.0, 120.0, 142.0],
    [34.0, 168.0, 132.0],
    [122.0, 209.0, 81.0],
    [253.0, 231.0, 37.0],
];

/// Blue of the palette of Okabe and Ito (2008). The constants from [`ORANGE`] to [`SKY`] belong to the same
/// palette.
pub const BLUE: &str = "#0072b2";
pub const ORANGE: &str = "#e69f00";
pub const GREEN: &str = "#009e73";
pub const VERMILION: &str = "#d55e00";
pub const PURPLE: &str = "#cc79a7";
pub const SKY: &str = "#56b4e9";

/// Returns red, green and blue (0 to 255) of the colour map viridis at a position from 0 (dark) to 1
/// (bright).
pub fn viridis(share: f64) -> [u8; 3] {
    let last = VIRIDIS.len() - 1;
    let t = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) } * last as f64;
    let k = (t.floor() as usize).min(last - 1);
    let (a, b, f) = (VIRIDIS[k], VIRIDIS[k + 1], t - k as f64);
    [0, 1, 2].map(|c| (a[c] + (b[c] - a[c]) * f).round() as u8)
}

/// Returns the colour of the colour map viridis at a position from 0 (dark) to 1 (bright), in hexadecimal
/// notation.
pub fn viridis_hex(share: f64) -> String {
    let [r, g, b] = viridis(share);
    format!("#{r:02x}{g:02x}{b:02x}")
}
