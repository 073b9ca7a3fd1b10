//! The robot as its error sets see it.

use super::error_model::PER_LINK;
use super::robot_model::{Joint, JointKind};

/// The joints that errors belong to.
#[derive(Clone, Copy)]
pub struct Arm<'j> {
    pub axes: usize,
    /// None of a robot that could not be read.
    pub joints: &'j [Joint],
    /// Whether its rows begin with the common normal.
    pub modified: bool,
}

/// The base components that a modified row 1 has as dl, dalpha and dbeta.
pub const OF_FIRST_ROW: [usize; 3] = [0, 3, 4];

impl Arm<'_> {
    /// Brings what is listed by the rows of the file into the order of [`Parameter::of_robot`]: dl,
    /// dalpha and dbeta of a modified row belong to the standard row before it, of the first to the
    /// base. In the place of the last row's comes what the file says of the base: nothing.
    pub fn in_order<T>(&self, list: &mut [T]) {
        if !self.modified || self.axes == 0 {
            return;
        }
        for (base, row) in OF_FIRST_ROW.into_iter().zip(2..PER_LINK) {
            let place = |i: usize| PER_LINK * i + row;
            (1..self.axes).for_each(|i| list.swap(place(i - 1), place(i)));
            list.swap(place(self.axes - 1), PER_LINK * self.axes + base);
        }
    }

    pub fn slides(&self, joint: usize) -> bool {
        self.joints.get(joint).is_some_and(|j| j.kind == JointKind::Prismatic)
    }
}
