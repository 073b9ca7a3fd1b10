//! Bounding spheres of the robot's solids.
//!
//! The spheres give an upper bound of the displacement of each solid when the robot moves.

use super::bodies::CollisionBody;
use super::robot_solids::RobotSolid;
use nalgebra::Vector3;

/// Sphere that contains one solid of the robot and moves with it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundingSphere {
    /// Index of the frame that carries the solid: 0 is the robot base, and k is the frame after the k-th
    /// Denavit-Hartenberg row.
    pub frame: usize,
    /// Centre in the frame that carries the solid, m.
    pub centre: Vector3<f64>,
    /// Radius, m.
    pub radius: f64,
}

/// Returns the bounding sphere of every robot solid, in the order of `links`.
pub(super) fn bounding_spheres(links: &[RobotSolid]) -> Vec<BoundingSphere> {
    let ball = |body: &CollisionBody| {
        let ball = body.shape.compute_local_bounding_sphere();
        let centre = Vector3::new(ball.center.x, ball.center.y, ball.center.z);
        (body.local.transform(&centre), ball.radius)
    };
    let sphere = |link: &RobotSolid| {
        let balls: Vec<_> = link.bare.iter().map(ball).collect();
        let centre = balls.iter().map(|b| b.0).sum::<Vector3<f64>>() / balls.len().max(1) as f64;
        let radius = balls.iter().map(|b| (b.0 - centre).norm() + b.1).fold(0.0, f64::max);
        BoundingSphere { frame: link.frame, centre, radius }
    };
    links.iter().map(sphere).collect()
}
