//! The robot as its error sets see it.

use super::robot_model::{Joint, JointKind};

/// The joints that errors belong to.
#[derive(Clone, Copy)]
pub struct Arm<'j> {
    pub axes: usize,
    /// None of a robot that could not be read.
    pub joints: &'j [Joint],
}

impl Arm<'_> {
    pub fn slides(&self, joint: usize) -> bool {
        self.joints.get(joint).is_some_and(|j| j.kind == JointKind::Prismatic)
    }
}
