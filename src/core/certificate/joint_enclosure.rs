//! Joint enclosure: bounds of the joint coordinates with which one branch reaches every target in the target
//! box.

use super::posed_chain::{PosedChain, Rows, times};
use super::target_box::{BoxAxis, TargetBox};
use crate::cell::{JointKind, JointVector, MAX_JOINTS};
use crate::reach::{MAX_ROWS, RotationRow, ToolTask};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Bounds of the joint coordinates with which one branch of the arm reaches every target in the target box.
#[derive(Debug, Clone, PartialEq)]
pub struct JointEnclosure {
    /// Half widths of the D-H coordinates about the nominal posture, rad or m; 0 for joints that do not move.
    pub half: JointVector,
    /// First-order changes of the D-H coordinates, rad or m, with one entry per axis of the target box
    /// ([`BoxAxis`]).
    ///
    /// The entry of an axis is the change if the target moves along this axis by the half width of the box.
    pub first: [JointVector; BoxAxis::COUNT],
    /// Upper bounds of the deviation of the D-H coordinates from their linear expansion, rad or m.
    pub bend: JointVector,
    /// Half widths about the nominal posture, rad or m, of the active joints. In a run of parallel axes, they
    /// refer to the sums of the angles from the first joint of the run.
    pub coordinates: Rows,
    /// Upper bound of the angle by which the tool rotates relative to the surface, rad.
    pub tool_turn: f64,
}

/// Reason why a posture has no joint enclosure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NoEnclosure {
    /// The posture is too near to a singular posture for a target box of this size.
    NearlySingular,
    /// A joint may exceed its limit by up to `by` (rad or m).
    JointLimit { joint: usize, by: f64 },
}

impl JointEnclosure {
    /// Enclosure of joints that do not move.
    pub const NONE: Self = Self {
        half: [0.0; MAX_JOINTS],
        first: [[0.0; MAX_JOINTS]; BoxAxis::COUNT],
        bend: [0.0; MAX_JOINTS],
        coordinates: [0.0; MAX_ROWS],
        tool_turn: 0.0,
    };

    /// Returns the joint enclosure of a posture with the actuator coordinates `joints` and the frames
    /// `frames`.
    ///
    /// The result is valid for every nominal posture whose D-H coordinates differ from those of the given
    /// posture by at most `beyond` (rad or m). For a single posture, `beyond` is 0.
    ///
    /// # Errors
    /// Returns the reason if there is no joint enclosure, or if the enclosure exceeds the joint limits.
    pub fn new(
        chain: &Chain,
        task: &ToolTask,
        (joints, frames): (&JointVector, &Frames),
        target: &TargetBox,
        beyond: &JointVector,
    ) -> Result<Self, NoEnclosure> {
        let posed = PosedChain::new(chain, task, frames);
        let n = task.rows;
        let inverse = posed.inverse().ok_or(NoEnclosure::NearlySingular)?;
        let mut first = [[0.0; MAX_ROWS]; BoxAxis::COUNT];
        for (axis, first) in BoxAxis::ALL.into_iter().zip(&mut first) {
            let (half, rate) = (target.half(axis), posed.rate(axis));
            if half > 0.0 && rate != [0.0; MAX_ROWS] {
                *first = times(n, &inverse, &rate).map(|v| v * half);
            }
            if !first.iter().all(|v| v.is_finite()) {
                return Err(NoEnclosure::NearlySingular);
            }
        }
        // The linear part alone is enough to refuse most postures near a limit.
        let linear = Self::of_coordinates(&posed, &first, &[0.0; MAX_ROWS], target);
        linear.check_limits(chain, joints)?;
        let mut around = [0.0; MAX_ROWS];
        let mut sum = 0.0;
        for (around, &joint) in around.iter_mut().zip(&task.active[..n]) {
            // A sum of angles changes by at most the sum of the changes of the angles.
            sum += beyond[joint];
            *around = sum;
        }
        let bend = posed.bend(&inverse, &first, &around).ok_or(NoEnclosure::NearlySingular)?;
        let found = Self::of_coordinates(&posed, &first, &bend, target);
        found.check_limits(chain, joints)?;
        Ok(found)
    }

    /// Returns the half widths of the actuator coordinates about the nominal posture, rad or m.
    pub fn actuators(&self, chain: &Chain) -> JointVector {
        let mut half = [0.0; MAX_JOINTS];
        for theta in &self.first {
            let moved = actuators(chain, theta);
            half.iter_mut().zip(moved).for_each(|(half, by)| *half += by.abs());
        }
        // The signs of the deviations are not known, so the absolute values add up.
        let mut bend = self.bend;
        for i in 0..chain.axes() {
            bend[i] += (0..i).map(|j| chain.coupling[i][j].abs() * bend[j]).sum::<f64>();
        }
        half.iter_mut().zip(bend).for_each(|(half, by)| *half += by);
        half
    }

    /// Checks that all joints stay within their limits; `joints` are the nominal actuator coordinates. A
    /// joint that can rotate by a full revolution has no limit, and a passive joint is not checked.
    fn check_limits(&self, chain: &Chain, joints: &JointVector) -> Result<(), NoEnclosure> {
        let half = self.actuators(chain);
        for (joint, link) in chain.links.iter().enumerate() {
            let (low, high) = link.limits;
            let is_limited = low < high && (link.kind == JointKind::Prismatic || high - low < TAU);
            let by = (low - joints[joint] + half[joint]).max(joints[joint] + half[joint] - high);
            if is_limited && by > 0.0 {
                return Err(NoEnclosure::JointLimit { joint, by });
            }
        }
        Ok(())
    }

    /// Returns an upper bound of the displacement of the points in a ball, m. The ball is fixed to the link
    /// frame with the index `frame`. The displacement is relative to the link frame with the index `first`.
    ///
    /// The centre of the ball is `centre` (base frame, m). Only joints with an index of at least `first` and
    /// below `frame` cause the displacement. `frames` are the frames of the nominal posture.
    pub fn displacement(
        &self,
        chain: &Chain,
        frames: &Frames,
        (centre, radius): (&Vector3<f64>, f64),
        (first, frame): (usize, usize),
    ) -> f64 {
        let (mut sum, mut turned) = (0.0, 0.0);
        for j in first..frame {
            let before = &frames.links[j];
            match chain.links[j].kind {
                JointKind::Revolute => {
                    let axis = before.rotation.column(2);
                    sum += self.half[j] * (axis.cross(&(centre - before.translation)).norm() + radius);
                    turned += self.half[j];
                }
                JointKind::Prismatic => sum += self.half[j],
            }
        }
        // The lever arms grow by at most the displacement itself.
        if turned < 0.5 { sum / (1.0 - turned) } else { f64::INFINITY }
    }

    /// Converts an enclosure in the coordinates of a [`PosedChain`] to an enclosure of the joint coordinates.
    ///
    /// `first` holds the first-order displacements of the coordinates, one row per axis of the target box.
    /// `bend` holds upper bounds of the deviations from these displacements.
    fn of_coordinates(
        posed: &PosedChain<'_>,
        first: &[Rows; BoxAxis::COUNT],
        bend: &Rows,
        target: &TargetBox,
    ) -> Self {
        let n = posed.task.rows;
        let theta = |y: &Rows, sign: fn(f64) -> f64| {
            let mut all = [0.0; MAX_JOINTS];
            for (k, &joint) in posed.task.active[..n].iter().enumerate() {
                all[joint] = (0..=k).map(|c| sign(posed.to_theta[k][c]) * y[c]).sum();
            }
            all
        };
        let coordinates: Rows =
            std::array::from_fn(|k| first.iter().map(|steps| steps[k].abs()).sum::<f64>() + bend[k]);
        let first = first.each_ref().map(|steps| theta(steps, |factor| factor));
        let bend = theta(bend, f64::abs);
        let half: JointVector =
            std::array::from_fn(|j| first.iter().map(|steps| steps[j].abs()).sum::<f64>() + bend[j]);
        // If the task does not keep the whole orientation, there are two cases. If its rotation rows are sums
        // of joint rates, only the first joint can rotate the tool, about the vertical. If its rotation rows
        // are components of the angular velocity (numeric solver), every joint can rotate the tool.
        let tool_turn = match (posed.task.keeps_orientation, posed.task.rotation[0].0) {
            (true, _) if posed.task.radial => target.heading + target.yaw,
            (true, _) => 0.0,
            (false, RotationRow::Joints(_)) => half[0] + target.yaw,
            (false, RotationRow::Along(_)) => half.iter().sum::<f64>() + target.yaw,
        };
        Self { half, first, bend, coordinates, tool_turn }
    }
}

/// Returns the changes of the actuator coordinates that follow from changes of the D-H coordinates, rad or m.
fn actuators(chain: &Chain, theta: &JointVector) -> JointVector {
    let mut q = *theta;
    for i in 0..chain.axes() {
        q[i] -= (0..i).map(|j| chain.coupling[i][j] * q[j]).sum::<f64>();
    }
    q
}
