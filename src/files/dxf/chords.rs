//! Conversion of an outline with arcs to a polygon that encloses the outline.
//!
//! Tangents replace an arc that bulges out of the outline, and chords replace an arc that bulges into the
//! outline. Tangents and chords lie on the outer side of the outline. The distance between tangents and arc
//! is at most `r (1 / cos(d / 2) - 1)`. The distance between chords and arc is at most `r (1 - cos(d / 2))`.
//! Here, `r` is the radius of the arc. One tangent or chord replaces a piece of the arc with the central
//! angle `d`.

use super::entities::PathVertex;
use crate::geometry::polygon_area;
use nalgebra::{Rotation2, Vector2};
use std::f64::consts::FRAC_PI_2;

/// Largest number of pieces of one arc.
const MAX_PIECES: f64 = 500.0;

/// Returns the corners of the polygon for a closed outline. No corner is farther than `tolerance` from
/// the outline.
///
/// # Errors
/// Returns a message if an arc would need more than [`MAX_PIECES`] pieces.
pub fn polygon(vertices: &[PathVertex], tolerance: f64) -> Result<Vec<Vector2<f64>>, String> {
    let is_left = area(vertices) > 0.0;
    let mut corners = Vec::new();
    for (a, b) in vertices.iter().zip(vertices.iter().cycle().skip(1)) {
        corners.push(a.at);
        let chord = b.at - a.at;
        if a.bulge == 0.0 || chord.norm() == 0.0 {
            continue;
        }
        let angle = 4.0 * a.bulge.atan();
        // If the arc turns left by less than half a turn, its centre lies to the left of the chord.
        let apothem = (1.0 - a.bulge * a.bulge) / (4.0 * a.bulge);
        let centre = a.at + chord / 2.0 + Vector2::new(-chord.y, chord.x) * apothem;
        let from = a.at - centre;
        let radius = from.norm();
        let is_outward = (angle > 0.0) == is_left;
        let piece = match is_outward {
            true => 2.0 * (radius / (radius + tolerance)).acos(),
            false => 2.0 * (1.0 - tolerance / radius).max(-1.0).acos(),
        };
        let pieces = (angle.abs() / piece.min(FRAC_PI_2)).ceil().max(1.0);
        if pieces.is_nan() || pieces > MAX_PIECES {
            return Err(format!("an arc needs more than {MAX_PIECES} pieces at this tolerance"));
        }
        let step = angle / pieces;
        // Neighbouring tangents meet halfway between their points of contact. Neighbouring chords meet on the
        // arc.
        let (first, count, size) = match is_outward {
            true => (0.5, pieces as usize, 1.0 / (step / 2.0).cos()),
            false => (1.0, pieces as usize - 1, 1.0),
        };
        corners.extend((0..count).map(|k| centre + Rotation2::new(step * (first + k as f64)) * from * size));
    }
    Ok(corners)
}

/// Returns the signed area within an outline: positive if the outline runs anticlockwise.
fn area(vertices: &[PathVertex]) -> f64 {
    let corners: Vec<_> = vertices.iter().map(|v| (v.at.x, v.at.y)).collect();
    let next = vertices.iter().cycle().skip(1);
    let segments = vertices.iter().zip(next).filter(|(a, _)| a.bulge != 0.0).map(|(a, b)| {
        let angle = 4.0 * a.bulge.abs().atan();
        let radius = (b.at - a.at).norm() * (1.0 + a.bulge * a.bulge) / (4.0 * a.bulge.abs());
        a.bulge.signum() * radius * radius * (angle - angle.sin()) / 2.0
    });
    polygon_area(&corners) + segments.sum::<f64>()
}
