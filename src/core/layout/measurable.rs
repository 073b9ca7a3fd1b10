//! Postures of a cell that an instrument can measure: reachable, collision-free and visible.

use super::workcell::Workcell;
use crate::cell::{JointVector, Layout};
use crate::clearance::{ContactMemory, SolidRef};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Position of the measuring instrument, and directions from which the reflector can be seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sightline {
    /// Position of the instrument, in the world frame, m.
    pub instrument: Vector3<f64>,
    /// Direction in which the reflector opens, and the largest angle (rad) between this direction and the
    /// line of sight. The direction is in the frame of the mechanical interface. None if the reflector is
    /// visible from every side.
    pub opening: Option<(Vector3<f64>, f64)>,
}

/// Postures that can be measured, and the numbers of tried postures that cannot be measured.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasurablePoses {
    pub joints: Vec<JointVector>,
    /// Number of postures in which the robot touches something, or comes nearer than the clearance of the
    /// cell.
    pub colliding: usize,
    /// Number of collision-free postures at which the reflector is hidden or faces away.
    pub hidden: usize,
}

/// Largest number of postures that are tried for each requested posture.
const MAX_TRIES: usize = 100;

impl Workcell {
    /// Returns the solid that contains a point (world frame, m) in a layout; None if no solid contains the
    /// point.
    pub fn solid_at(&self, layout: &Layout, point: &Vector3<f64>) -> Option<SolidRef> {
        let placed = self.placed(layout).into_solids();
        self.mapper.scene().solid_at(&placed, point)
    }

    /// Returns postures of a layout that can be measured, spread evenly over the joint space. The number of
    /// postures is at most `wanted`.
    ///
    /// Postures are points of a Halton sequence within the joint limits and the margins of the cell. The
    /// number `seed` selects the point of the sequence that is tried first. The position `reflector` is in
    /// the frame of the mechanical interface, m. If `sightline` is None, the reflector counts as visible in
    /// every posture. `progress` receives the number of postures found.
    pub fn measurable_poses(
        &self,
        layout: &Layout,
        reflector: &Vector3<f64>,
        sightline: Option<&Sightline>,
        (wanted, seed): (usize, u64),
        progress: &mut dyn FnMut(usize),
    ) -> MeasurablePoses {
        let placed = self.placed(layout).into_solids();
        let (scene, chain) = (self.mapper.scene(), self.mapper.chain());
        let (base, mut memory) = (layout.base.pose(), ContactMemory::default());
        let mut found = MeasurablePoses::default();
        let tries = MAX_TRIES * wanted;
        let first = (seed as usize).wrapping_mul(tries) % u32::MAX as usize;
        for k in first..first + tries {
            if found.joints.len() == wanted {
                break;
            }
            let joints = chain.halton_sample(k);
            let frames = chain.frames(&chain.posture(&joints));
            let interface = base * frames.links[chain.axes()];
            let faces = sightline.is_none_or(|sightline| sightline.faces(&interface, reflector));
            if !scene.is_free(&placed, &frames.links, None, &mut memory) {
                found.colliding += 1;
            } else if !faces
                || sightline.is_some_and(|sightline| {
                    let at = interface.transform(reflector);
                    scene.hides(&placed, &frames.links, &at, &sightline.instrument).is_some()
                })
            {
                found.hidden += 1;
            } else {
                found.joints.push(joints);
                progress(found.joints.len());
            }
        }
        found
    }

    /// Returns the position (m) of a reflector in the world frame at a posture. `reflector` is the position
    /// (m) of the reflector in the frame of the mechanical interface.
    pub fn reflector_at(
        &self,
        layout: &Layout,
        joints: &JointVector,
        reflector: &Vector3<f64>,
    ) -> Vector3<f64> {
        let frames = self.mapper.frames(joints);
        (layout.base.pose() * frames.links[self.mapper.chain().axes()]).transform(reflector)
    }
}

impl Sightline {
    /// Returns whether the reflector opens towards the instrument.
    fn faces(&self, interface: &Pose, reflector: &Vector3<f64>) -> bool {
        self.opening.is_none_or(|(axis, angle)| {
            let line = self.instrument - interface.transform(reflector);
            (interface.rotation * axis).angle(&line) <= angle
        })
    }
}
