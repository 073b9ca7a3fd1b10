//! Conversion of error parameters from the rows of a file, standard or modified, to standard rows.

use crate::cell::{Joint, JointKind};
use crate::cell::{PER_LINK, Parameter};

/// Robot whose errors are read: number of axes, joints, and convention of the rows.
#[derive(Clone, Copy)]
pub struct ErrorRows<'j> {
    pub axes: usize,
    /// Joints; empty if the robot could not be read.
    pub joints: &'j [Joint],
    /// Whether the rows are in modified convention, in which a row begins with the common normal.
    pub modified: bool,
    /// Whether an actuator moves a D-H coordinate other than its own.
    pub is_coupled: bool,
}

impl ErrorRows<'_> {
    /// Returns the indices of the parameters that hold dl, dalpha and dbeta of row 1 of a modified D-H table.
    /// These are the errors of the common normal l, of the twist alpha and of Hayati's fifth parameter.
    ///
    /// The row begins with `Tx(l + dl) Rx(alpha + dalpha) Ry(dbeta)`, where T translates along an axis and R
    /// rotates about an axis. In the frame of joint 1, dl becomes the error x, and dbeta the error ry. In the
    /// base frame, dalpha becomes the error rx. The conversion is exact, because Tx and Rx commute. The
    /// conversion adds only one rotation error to each frame: rx to the base, and ry to joint 1.
    fn of_first_row(&self) -> [usize; 3] {
        let (base, joint) = (PER_LINK * self.axes, Parameter::first_joint(self.axes));
        [joint, base + 3, joint + 4]
    }

    /// Returns the indices of the parameters dl, dalpha and dbeta of a row. These are the errors of the
    /// common normal l, of the twist alpha and of Hayati's fifth parameter.
    fn of_row(&self, row: usize) -> [usize; 3] {
        [2, 3, 4].map(|k| PER_LINK * row + k)
    }

    /// Returns the indices of the parameters that a file with modified rows cannot set; None for standard
    /// rows.
    ///
    /// These parameters are dl, dalpha and dbeta ([`Self::of_row`]) of the last standard row.
    pub fn unused(&self) -> Option<[usize; 3]> {
        (self.modified && self.axes > 0).then(|| self.of_row(self.axes - 1))
    }

    /// Converts `list`, one entry per robot parameter, from the rows of the file to standard rows. The
    /// parameters are in the order of [`Parameter::of_robot`]. A list for standard rows does not change.
    ///
    /// The entries for dl, dalpha and dbeta ([`Self::of_row`]) of a modified row move to the preceding row.
    /// The entries for row 1 move to the indices [`Self::of_first_row`]. The entries that were at these
    /// indices move to the indices [`Self::unused`].
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
