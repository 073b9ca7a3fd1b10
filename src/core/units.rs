//! Unit conversion between files or reports (mm, degrees) and the crate (m, rad).
//!
//! No other module converts units. Inside the crate every length is in m and every angle in rad. A variable
//! with a unit in its name (`x_mm`, `yaw_deg`) holds a value of a file or a report.

/// Length of an inch, m.
pub const INCH: f64 = 0.0254;

/// Length of a centimetre, m.
pub const CENTIMETRE: f64 = 1e-2;

/// Length of a micrometre, m.
pub const MICROMETRE: f64 = 1e-6;

/// Length of a millimetre, m.
pub const MILLIMETRE: f64 = 1e-3;

/// Converts millimetres to metres.
///
/// The function divides by 1000, because division rounds correctly and multiplication by 0.001 does not. So a
/// length that a file gives with few digits is reported with the same digits.
pub fn m_from_mm(mm: f64) -> f64 {
    mm / 1000.0
}

/// Converts metres to millimetres.
pub fn mm_from_m(m: f64) -> f64 {
    m * 1000.0
}

/// Converts degrees to radians.
pub fn rad_from_deg(deg: f64) -> f64 {
    deg.to_radians()
}

/// Converts radians to degrees.
pub fn deg_from_rad(rad: f64) -> f64 {
    rad.to_degrees()
}

/// Converts percent to a share from 0 to 1.
pub fn share_from_percent(percent: f64) -> f64 {
    percent / 100.0
}

/// Converts a share from 0 to 1 to percent.
pub fn percent_from_share(share: f64) -> f64 {
    share * 100.0
}

/// Rounds a value to `digits` decimal places. Never returns negative zero.
pub fn rounded(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    let r = (value * scale).round() / scale;
    if r == 0.0 { 0.0 } else { r }
}

/// Returns the angle in (-pi, pi] that differs from `rad` by a whole number of turns.
pub fn wrapped(rad: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    let w = rad - turn * (rad / turn).round();
    if w <= -std::f64::consts::PI { w + turn } else { w }
}
