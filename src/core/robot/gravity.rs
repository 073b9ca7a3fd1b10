//! Torques of gravity about the joint axes.
//!
//! Gravity points along -z of the robot base frame. A cell rotates the base about the vertical only, so this
//! is also -z of the world frame. An arm on a wall or a gantry has its tilt in
//! [`Chain::mount`](super::Chain::mount), which is part of every frame used here.

use super::Frames;
use super::loads::Loads;
use nalgebra::Vector3;

/// Standard acceleration of gravity, m/s^2 (ISO 80000-3).
pub const STANDARD_GRAVITY: f64 = 9.806_65;

/// Returns the horizontal lever of a link about the axis of a joint, m: `z . (l x g)`.
///
/// Here z is the joint axis, l the vector from the frame before the link to the frame after it, and g the
/// unit vector of gravity. A unit weight at the end of the link causes a torque about the joint axis, and so
/// does a unit weight at the start of the link. The lever is the difference of these torques, end minus
/// start.
pub fn lever(frames: &Frames, joint: usize, link: usize) -> f64 {
    let along = frames.links[link + 1].translation - frames.links[link].translation;
    about_axis(frames, joint, &along)
}

/// Returns the torque about a joint axis that the weights of all masses carried by the joint cause, N m.
pub fn gravity_torque(frames: &Frames, loads: &Loads, joint: usize) -> f64 {
    let origin = frames.links[joint].translation;
    let carried = loads.iter().zip(&frames.links).skip(joint + 1).filter(|(load, _)| load.mass > 0.0);
    let moment = carried.fold(Vector3::zeros(), |sum, (load, frame)| {
        sum + (frame.translation - origin) * load.mass + frame.rotation * load.moment
    });
    STANDARD_GRAVITY * about_axis(frames, joint, &moment)
}

/// Returns `z . (r x g)`, where z is the axis of a joint and g the unit vector of gravity.
fn about_axis(frames: &Frames, joint: usize, r: &Vector3<f64>) -> f64 {
    let axis = frames.links[joint].rotation.column(2);
    axis.dot(&r.cross(&-Vector3::z()))
}
