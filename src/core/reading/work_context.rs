//! Context of the errors of an operation in one layout: the work frame, and the pick of the part that the
//! operation places.

use super::effects::Effects;
use super::registration::Taught;
use crate::pose::Pose;
use crate::robot::Frames;
use nalgebra::{Matrix3, Vector3};

/// Work frame of one operation in one layout.
#[derive(Debug, Clone)]
pub struct WorkFrame {
    /// Index of the equipment on which the robot works.
    pub equipment: usize,
    /// Pose of the equipment in the base frame.
    pub work: Pose,
    /// Rotation from world axes to the base frame.
    pub world: Matrix3<f64>,
    /// Taught surface frame; None if the frame was not taught.
    pub taught: Option<Box<Taught>>,
}

/// Work frame and posture of the operation that picks the part, with the effects of the errors at this
/// posture.
#[derive(Debug, Clone)]
pub struct PickReference {
    pub site: WorkFrame,
    pub frames: Frames,
    pub effects: Effects,
}

/// Work frame of an operation, and data of the pick if the operation places a picked part. The error at a
/// posture depends on the frame and on these data.
#[derive(Debug, Clone)]
pub struct WorkContext {
    pub site: WorkFrame,
    /// Data of the operation that picks the part; None if this operation places no picked part.
    pub reference: Option<Box<PickReference>>,
}

impl WorkContext {
    /// Returns whether a target (base frame, m) was touched to teach the surface frame.
    ///
    /// The taught frame removes all or a part of the error at a touched point. No error remains at the
    /// origin. An error along the x axis remains at the second point. An error in the xy plane remains at the
    /// third point. These remaining errors do not represent the errors elsewhere on the surface.
    pub fn touches(&self, target: &Vector3<f64>) -> bool {
        self.site.taught.as_ref().is_some_and(|taught| taught.touches(target))
    }

    /// Returns the distance (m) of a target (base frame, m) from the nearest touched point; infinite if no
    /// point was touched.
    pub fn distance_from_touched(&self, target: &Vector3<f64>) -> f64 {
        self.site.taught.as_ref().map_or(f64::INFINITY, |taught| taught.distance(target))
    }
}
