//! The robot as its error sets see it.

use crate::cell::{Joint, JointKind};
use crate::cell::{PER_LINK, Parameter};

/// The joints that errors belong to.
#[derive(Clone, Copy)]
pub struct ErrorRows<'j> {
    pub axes: usize,
    /// None of a robot that could not be read.
    pub joints: &'j [Joint],
    /// Whether its rows begin with the common normal.
    pub modified: bool,
}

impl ErrorRows<'_> {
    /// Where a modified row 1, `Tx(l + dl) Rx(alpha + dalpha) Ry(dbeta)`, has its dl, dalpha and dbeta:
    /// the first and the last in the frame of joint 1, behind the twist, the other in the base, before
    /// it. So the product is exact: `Tx Rx` commute, and each of the two frames turns but once.
    fn of_first_row(&self) -> [usize; 3] {
        let (base, joint) = (PER_LINK * self.axes, Parameter::first_joint(self.axes));
        [joint, base + 3, joint + 4]
    }

    /// The places of dl, dalpha and dbeta of a row.
    fn of_row(&self, row: usize) -> [usize; 3] {
        [2, 3, 4].map(|k| PER_LINK * row + k)
    }

    /// The places that nothing in the file is about: of modified rows, what ends the last standard one.
    pub fn unused(&self) -> Option<[usize; 3]> {
        (self.modified && self.axes > 0).then(|| self.of_row(self.axes - 1))
    }

    /// Brings what is listed by the rows of the file into the order of [`Parameter::of_robot`]: dl,
    /// dalpha and dbeta of a modified row belong to the standard row before it, of the first to where
    /// [`Self::of_first_row`] says. What the file says there, nothing, goes to [`Self::unused`].
    pub fn in_order<T>(&self, list: &mut [T]) {
        let Some(last) = self.unused() else { return };
        for (k, first) in self.of_first_row().into_iter().enumerate() {
            (1..self.axes).for_each(|i| list.swap(self.of_row(i - 1)[k], self.of_row(i)[k]));
            list.swap(last[k], first);
        }
    }

    pub fn slides(&self, joint: usize) -> bool {
        self.joints.get(joint).is_some_and(|j| j.kind == JointKind::Prismatic)
    }
}
