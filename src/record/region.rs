//! Regions of a layout in documents: where each piece of equipment and the robot base may stand.

use super::numbers::{degrees, millimetres};
use crate::assess::Assessment;
use crate::cell::Cell;
use crate::region::{Region, WholeTurn};
use crate::units::rounded;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Region in the world frame in which a piece of equipment or the robot base may stand. All other pieces keep
/// their placements. An operation that happens at one node keeps its spot and branch. An operation that
/// happens at every node uses the best posture of each node.
///
/// Everywhere in the region, the layout works at every misplacement within the placement tolerances. The
/// objective grows by at most the percentage `indifference_percent` of the cell file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionEntry {
    /// Name of the equipment, or `robot base`.
    pub equipment: String,
    /// Closed rings of points (x, y) in plan, for the z and yaw of the layout. A point is inside if it lies
    /// in an odd number of rings. If the search moves the piece along one axis only, the only ring is a line
    /// of two points. The list is empty if the search moves the piece along neither axis.
    pub outline_mm: Vec<Vec<[f64; 2]>>,
    /// Width of a band along the outline. In this band, the result does not distinguish inside from outside.
    pub rim_mm: f64,
    /// Least and greatest z, at the x, y and yaw of the layout.
    pub z_mm: [f64; 2],
    /// Least and greatest yaw, at the x, y and z of the layout.
    pub yaw_deg: [f64; 2],
    /// Largest distance by which the piece may be displaced in every direction in plan. Null if the search
    /// does not displace the piece in plan.
    pub room_mm: Option<f64>,
    /// Largest angle by which the piece may be rotated in either direction. Null if the search does not
    /// rotate the piece.
    pub room_deg: Option<f64>,
    /// Reason why `room_mm` is not larger. If `room_mm` is null, the reason applies to `room_deg`.
    pub ends_with: String,
}

/// Rotation of equipment as one body about the base axis (the vertical line through the origin of the robot
/// base). Equipment takes part in this rotation if the search varies its x, y and yaw over ranges. Carried
/// equipment rotates only with its carrier.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TurnEntry {
    /// Least and greatest angle of the rotation.
    pub turn_deg: [f64; 2],
    /// Reason why the equipment cannot rotate farther in the direction with the smaller allowed rotation. If
    /// both directions allow equal rotations, the reason belongs to the negative direction.
    pub ends_with: String,
}

impl RegionEntry {
    /// Returns one entry per piece that the search places; empty if no regions were computed.
    pub fn all(a: &Assessment<'_>) -> Vec<Self> {
        let pieces = a.regions.iter().flat_map(|regions| &regions.pieces);
        pieces.map(|region| Self::new(a.cell, region)).collect()
    }

    fn new(cell: &Cell, region: &Region) -> Self {
        let ring = |ring: &Vec<(f64, f64)>| ring.iter().map(|p| [tenth(p.0), tenth(p.1)]).collect();
        Self {
            equipment: region.body.name(cell).into(),
            outline_mm: region.rings.iter().map(ring).collect(),
            rim_mm: millimetres(region.rim),
            z_mm: inward([region.z.0, region.z.1].map(millimetres), 1),
            yaw_deg: inward([region.yaw.0, region.yaw.1].map(degrees), 2),
            room_mm: region.room.map(|room| down(millimetres(room), 2)),
            room_deg: region.turn.map(|turn| down(degrees(turn), 2)),
            ends_with: region.ended.in_words(cell),
        }
    }
}

impl TurnEntry {
    /// Returns the allowed rotation of the equipment about the base axis. Returns None if no regions were
    /// computed. Also returns None if the equipment under an operation does not take part in this rotation.
    pub fn new(a: &Assessment<'_>) -> Option<Self> {
        let WholeTurn { least, most, ended } = a.regions.as_ref()?.whole.as_ref()?;
        let turn_deg = inward([*least, *most].map(degrees), 2);
        Some(Self { turn_deg, ends_with: ended.in_words(a.cell) })
    }
}

/// Returns a length in mm, rounded to 0.1 mm.
fn tenth(m: f64) -> f64 {
    rounded(millimetres(m), 1)
}

/// Rounds the ends of an interval inwards, unless they are equal.
fn inward([least, most]: [f64; 2], digits: i32) -> [f64; 2] {
    match -down(-least, digits) <= down(most, digits) {
        true => [-down(-least, digits), down(most, digits)],
        false => [least, most],
    }
}

/// Rounds a displacement or angle down, because a larger displacement or angle may not be feasible.
fn down(value: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    // Without the added 1e-6, a rounding error could reduce a multiple of the step to the next lower
    // multiple. Adding 0 avoids a negative zero.
    ((value * scale + 1e-6).floor() / scale) + 0.0
}
