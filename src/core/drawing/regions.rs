//! Regions in pictures: the places where the robot base and each piece of equipment may stand.

use crate::assess::Assessment;
use crate::region::{MovableBody, Region};
use nalgebra::Vector3;

/// Region of one piece (robot base or equipment): positions of its frame origin at which the layout is
/// feasible.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnRegion {
    /// Name of the equipment, or `robot base`.
    pub name: String,
    /// Closed outlines of the region in the world frame, m. Each point has the height of the frame origin of
    /// the piece.
    pub rings: Vec<Vec<Vector3<f64>>>,
    /// Largest distance, m, by which the piece may be displaced in every direction in plan
    /// ([`Region::room`]). None if neither x nor y may vary.
    pub room: Option<f64>,
    /// Largest angle, rad, by which the piece may be rotated in either direction ([`Region::turn`]). None if
    /// the yaw is not a coordinate that may vary.
    pub turn: Option<f64>,
}

/// Returns the regions of an assessed layout. The list is empty if no regions were computed.
pub fn regions(a: &Assessment<'_>) -> Vec<DrawnRegion> {
    let drawn = |region: &Region| {
        let z = match region.body {
            MovableBody::Base => a.layout.base.z,
            MovableBody::Equipment(k) => a.layout.placements[k].z,
        };
        let ring = |ring: &Vec<(f64, f64)>| ring.iter().map(|(x, y)| Vector3::new(*x, *y, z)).collect();
        DrawnRegion {
            name: region.body.name(a.cell).to_string(),
            rings: region.rings.iter().map(ring).collect(),
            room: region.room,
            turn: region.turn,
        }
    };
    a.regions.iter().flat_map(|regions| &regions.pieces).map(drawn).collect()
}
