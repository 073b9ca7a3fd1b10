//! Arms whose tool has the same elevation in every posture, such as a SCARA or a palletizer.

use crate::robot::Chain;

/// Number of postures whose elevations are compared.
const POSTURES: usize = 32;

/// Elevations count as equal if they differ by at most this value, rad.
const SAME_ELEVATION: f64 = 1e-9;

/// Returns the elevation of the tool axis (rad) if it is the same in all sampled postures of the chain;
/// otherwise None.
pub(super) fn fixed_elevation(chain: &Chain) -> Option<f64> {
    let elevation = |k: usize| {
        let tcp = chain.forward(&chain.posture(&chain.halton_sample(k)));
        let axis = tcp.rotation * chain.tool_axis;
        axis.z.atan2(axis.x.hypot(axis.y))
    };
    let first = elevation(0);
    (1..POSTURES).all(|k| (elevation(k) - first).abs() < SAME_ELEVATION).then_some(first)
}
