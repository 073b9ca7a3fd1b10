//! Order of the joints of the closed loop in the elimination.

use crate::pose::Pose;

/// Order of the joints in the loop: place k has joint `first + k`, or joint `first - k` if reversed.
///
/// Joints are counted from 0, modulo 6. Every arrangement solves a general arm. An arm with parallel or
/// intersecting axes is degenerate in some arrangements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LoopArrangement {
    first: usize,
    is_reversed: bool,
}

impl LoopArrangement {
    /// Arrangements in which the equations of the angles 2, 3 and 4 do not depend on the pose of the flange.
    pub const CONSTANT_INSIDE: [Self; 4] = [
        Self { first: 5, is_reversed: false },
        Self { first: 0, is_reversed: true },
        Self { first: 0, is_reversed: false },
        Self { first: 5, is_reversed: true },
    ];

    /// Returns all arrangements, in the order in which the solver tries them.
    ///
    /// The solver tries them if a pose is degenerate in the arrangement of the arm.
    pub fn all() -> impl Iterator<Item = Self> {
        [2, 3, 4, 5, 0, 1].into_iter().flat_map(|k| {
            [Self { first: k, is_reversed: false }, Self { first: (k + 4) % 6, is_reversed: true }]
        })
    }

    /// Returns the constant links of the loop; link k follows the joint of place k.
    ///
    /// The inverse of the flange's pose `target` closes the loop and becomes a part of the link after joint 5
    /// of the arm. The product of all joint rotations and links is then the identity.
    pub fn links(self, links: &[Pose; 6], target: &Pose) -> [Pose; 6] {
        let closing = links[5] * target.inverse();
        let link = |k: usize| if k % 6 == 5 { closing } else { links[k % 6] };
        std::array::from_fn(|k| match self.is_reversed {
            true => link(self.first + 11 - k).inverse(),
            false => link(self.first + k),
        })
    }

    /// Returns the joint angles (rad), in the order of the arm, that correspond to the angles of the loop.
    pub fn joints(self, angles: [f64; 6]) -> [f64; 6] {
        let mut joints = [0.0; 6];
        for (k, angle) in angles.into_iter().enumerate() {
            match self.is_reversed {
                true => joints[(self.first + 6 - k) % 6] = -angle,
                false => joints[(self.first + k) % 6] = angle,
            }
        }
        joints
    }
}
