//! Working envelope as closed lines: horizontal sections at several heights, and one vertical section.

use crate::assess::{Assessment, step_of, tolerance_of};
use crate::reach::{Envelope, EnvelopeSection, Fineness};
use nalgebra::Vector3;

/// Number of horizontal sections between the lowest and the highest point of the envelope.
const LEVELS: usize = 9;

/// Closed lines of a working envelope, in the world frame, m. The last point is joined to the first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rings {
    /// Outlines of the horizontal section at the height of the operation's TCP.
    pub at_work: Vec<Vec<Vector3<f64>>>,
    /// Outlines of the horizontal sections at other heights, and of a vertical section through the base axis.
    ///
    /// The azimuth of the vertical section is the azimuth of the TCP when every joint is in the middle of its
    /// range.
    pub around: Vec<Vec<Vector3<f64>>>,
}

/// Returns the working envelope for the tool attitude of an operation, within the joint limits.
///
/// Each section is sampled on a lattice. The spacing of the lattice is twice the spacing that [`step_of`]
/// returns.
pub fn rings(a: &Assessment<'_>, operation: usize) -> Rings {
    let inverse = a.workcell.inverse();
    let attitude = &a.layout.attitudes[operation];
    let operation = &a.cell.operations[operation];
    let (at, base) = (&a.layout.placements[operation.equipment], &a.layout.base);
    let envelope = Envelope::new(inverse, attitude, at.yaw - base.yaw);
    let step = 2.0 * step_of(&a.cell.robot, inverse);
    let fine = Fineness { step, tolerance: tolerance_of(inverse, step), on_progress: &|_| () };
    let frame = base.pose();
    let world =
        |region: &EnvelopeSection, lift: &dyn Fn([f64; 2]) -> Vector3<f64>| -> Vec<Vec<Vector3<f64>>> {
            let ring = |points: &Vec<[f64; 2]>| points.iter().map(|p| frame.transform(&lift(*p))).collect();
            region.outlines.iter().map(|o| ring(&o.points)).collect()
        };
    let level = |z: f64| world(&envelope.plan(z, &fine), &|[x, y]| Vector3::new(x, y, z));
    let azimuth = envelope.middle();
    let (sin, cos) = azimuth.sin_cos();
    let section = envelope.section(azimuth, &fine);
    let heights = section.points().map(|p| p[1]);
    let (low, high) = heights.fold((f64::MAX, f64::MIN), |(lo, hi), z| (lo.min(z), hi.max(z)));
    let mut around = world(&section, &|[r, z]| Vector3::new(r * cos, r * sin, z));
    for k in 0..LEVELS {
        if low < high {
            around.extend(level(low + (high - low) * (k as f64 + 0.5) / LEVELS as f64));
        }
    }
    Rings { at_work: level(at.z + operation.standoff - base.z), around }
}
