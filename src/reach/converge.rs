//! The numeric way: attitudes as goals, whose answers keep the limits themselves.

use super::inverse::{Approach, Branch, Gap, Inverse, Reach};
use super::kernel::Kernel;
use super::numeric::{Goal, Held, Missing};
use crate::cell::JointVector;
use crate::robot::Posture;
use nalgebra::{Matrix3, Vector3};

impl Inverse {
    pub(super) fn converge(
        &self,
        target: &Vector3<f64>,
        approach: &Approach,
        mut found: impl FnMut(u32, &Posture),
    ) -> Gap {
        let mut joints = Vec::new();
        let mut gap = Gap::ALL;
        for (k, goal) in self.goals(target, approach).iter().enumerate() {
            let missed = match self.numeric(goal, &mut joints) {
                Missing::None => Gap { reach: 0.0, limits: 0.0 },
                Missing::OutOfReach { by } => Gap { reach: by, limits: 0.0 },
                Missing::Attitude { by, .. } => Gap { reach: 0.0, limits: by },
                Missing::NotConverged { position, angle } => Gap { reach: 0.0, limits: position + angle },
            };
            gap = if missed.is_less(&gap) { missed } else { gap };
            for (i, q) in joints.iter().enumerate() {
                found((k << 8 | i) as u32, &self.chain.posture(q));
            }
        }
        gap
    }

    pub(super) fn converged(&self, target: &Vector3<f64>, approach: &Approach) -> Reach {
        let (mut all, mut joints, mut nearest) = (Vec::new(), Vec::new(), Missing::None);
        for (k, goal) in self.goals(target, approach).iter().enumerate() {
            let missed = self.numeric(goal, &mut joints);
            if is_nearer(&missed, &nearest) {
                nearest = missed;
            }
            all.extend(joints.iter().enumerate().map(|(i, q)| Branch {
                index: (k << 8 | i) as u32,
                joints: *q,
                posture: self.chain.posture(q),
                violation: None,
                off: 0.0,
            }));
        }
        match nearest {
            _ if !all.is_empty() => Reach::Branches(all),
            Missing::None => Reach::OutOfReach { by: 0.0 },
            Missing::OutOfReach { by } => Reach::OutOfReach { by },
            Missing::Attitude { by, joint } => Reach::Attitude { by, joint },
            Missing::NotConverged { position, angle } => Reach::NotConverged { position, angle },
        }
    }

    fn numeric(&self, goal: &Goal, joints: &mut Vec<JointVector>) -> Missing {
        joints.clear();
        match &self.kernel {
            Kernel::Numeric(numeric) => numeric.all(goal, joints),
            _ => Missing::None,
        }
    }

    /// What is asked of the TCP: free angles are left to the solver.
    pub(super) fn goals(&self, target: &Vector3<f64>, approach: &Approach) -> Vec<Goal> {
        let hold = &approach.hold;
        let goal = |attitude| Goal { position: *target, attitude };
        if hold.spin_is_free && hold.azimuth_is_free {
            return hold.elevations.iter().map(|e| goal(Held::Elevation(*e))).collect();
        }
        // All spins have the same tool axis.
        let step = if hold.spin_is_free { hold.columns_per_azimuth() } else { 1 };
        let columns = (0..hold.columns.len()).step_by(step).map(|k| hold.columns_at(k, target));
        let held = |columns: Matrix3<f64>| match hold.spin_is_free {
            true => Held::Axis(columns.column(2).into_owned()),
            false => Held::Rotation(columns * self.tool_rows),
        };
        columns.map(|columns| goal(held(columns))).collect()
    }
}

/// Whether the first says more of how near an answer is: an attitude missed by less, before not
/// converged, before out of reach by less.
fn is_nearer(a: &Missing, b: &Missing) -> bool {
    let key = |missing: &Missing| match missing {
        Missing::Attitude { by, .. } => (0, *by),
        Missing::NotConverged { position, angle } => (1, position + angle),
        Missing::OutOfReach { by } => (2, *by),
        Missing::None => (3, 0.0),
    };
    key(a) < key(b)
}
