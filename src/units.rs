//! Millimetres and degrees (files, reports) to metres and radians (everywhere else).
//!
//! This is the only place that converts. Inside the crate every length is in m and every angle in
//! rad; names that carry a unit (`x_mm`, `yaw_deg`) are outside values.

/// Millimetres to metres. Division, not multiplication by 0.001: it is correctly rounded, so that
/// a length written in a file with few digits comes back with the same few digits.
pub fn m_from_mm(mm: f64) -> f64 {
    mm / 1000.0
}

/// Metres to millimetres.
pub fn mm_from_m(m: f64) -> f64 {
    m * 1000.0
}

/// Degrees to radians.
pub fn rad_from_deg(deg: f64) -> f64 {
    deg.to_radians()
}

/// Radians to degrees.
pub fn deg_from_rad(rad: f64) -> f64 {
    rad.to_degrees()
}

/// Percent to a share of one.
pub fn share_from_percent(percent: f64) -> f64 {
    percent / 100.0
}

/// A share of one to percent.
pub fn percent_from_share(share: f64) -> f64 {
    share * 100.0
}

/// Rounds a value for print to `digits` decimals; never returns the negative zero.
pub fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    let r = (value * scale).round() / scale;
    if r == 0.0 { 0.0 } else { r }
}

/// The angle in (-pi, pi] that differs from `rad` by whole turns.
pub fn wrapped(rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let w = rad - turn * (rad / turn).round();
    if w <= -std::f64::consts::PI { w + turn } else { w }
}
