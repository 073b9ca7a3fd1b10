//! How far a posture is from joint limits and singularities.

use crate::cell::{JointVector, MAX_JOINTS};
use crate::reach::jacobian;
use crate::robot::{Chain, Frames};
use nalgebra::{SMatrix, Vector3};

/// The Jacobian by columns: rows x, y, z in arm reaches, then rotation in rad.
pub(super) type Columns = SMatrix<f64, 6, MAX_JOINTS>;

/// What of a posture may be made large besides keeping the error small.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measures {
    /// Of the joint nearest to a limit: its distance from it as a share of half its range. 1: in the
    /// middle, 0: at the limit, less than 0: beyond.
    pub limits: f64,
    pub joint: usize,
    /// See [`singularity`].
    pub singularity: f64,
}

/// Both measures at joint coordinates (rad, m); `reach`: a length of the size of the arm, m.
pub fn measures(chain: &Chain, joints: &JointVector, reach: f64) -> Measures {
    let frames = chain.frames(&chain.posture(joints));
    let moving = chain.links.iter().zip(joints).enumerate().filter(|(_, (link, _))| is_moving(link.limits));
    let share = moving.map(|(i, (link, q))| {
        let (low, high) = link.limits;
        (i, (q - low).min(high - q) / ((high - low) / 2.0))
    });
    let (joint, limits) = share.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 1.0));
    Measures { limits, joint, singularity: singularity(chain, &frames, reach) }
}

/// The smallest singular value of the geometric Jacobian at the TCP with lengths divided by `reach` (m):
/// 0 in a singular posture (C. A. Klein, B. E. Blaho, "Dexterity measures for the design and control of
/// kinematically redundant manipulators", IJRR 6(2), 1987; on dividing by a length of the arm: J. Angeles,
/// Fundamentals of Robotic Mechanical Systems, on the characteristic length). An arm with n < 6
/// actuators moves the TCP in n directions only: the n-th largest value counts.
pub fn singularity(chain: &Chain, frames: &Frames, reach: f64) -> f64 {
    let actuators = chain.links.iter().filter(|link| is_moving(link.limits)).count();
    let mut values: [f64; 6] = scaled_jacobian(chain, frames, reach).singular_values().into();
    values.sort_by(|a, b| b.total_cmp(a));
    actuators.min(6).checked_sub(1).map_or(0.0, |last| values[last])
}

/// A passive joint is no actuator: its column is 0.
pub(super) fn scaled_jacobian(chain: &Chain, frames: &Frames, reach: f64) -> Columns {
    let mut columns = Columns::zeros();
    let all = jacobian(chain, frames);
    for j in (0..chain.axes()).filter(|&j| is_moving(chain.links[j].limits)) {
        let position: Vector3<f64> = all[j].position / reach;
        columns.fixed_view_mut::<3, 1>(0, j).copy_from(&position);
        columns.fixed_view_mut::<3, 1>(3, j).copy_from(&all[j].rotation);
    }
    columns
}

fn is_moving((low, high): (f64, f64)) -> bool {
    low < high
}
