//! The working envelope as rings: level cuts at several heights, and the upright section.

use crate::assess::{Assessment, step_of, tolerance_of};
use crate::reach::{Envelope, EnvelopeSection, Fineness};
use nalgebra::Vector3;

/// Level cuts from the lowest to the highest reach.
const LEVELS: usize = 9;

/// Closed lines, world, m; the last point is joined to the first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rings {
    /// At the height of the operation's TCP.
    pub at_work: Vec<Vec<Vector3<f64>>>,
    /// At other heights, and in the upright plane in which the arm points with its joints in the middle.
    pub around: Vec<Vec<Vector3<f64>>>,
}

/// What the arm reaches with its tool as an operation holds it, joint limits kept. Drawn coarsely.
pub fn rings(a: &Assessment<'_>, operation: usize) -> Rings {
    let inverse = a.workcell.inverse();
    let attitude = &a.layout.attitudes[operation];
    let operation = &a.cell.operations[operation];
    let (at, base) = (&a.layout.placements[operation.equipment], &a.layout.base);
    let envelope = Envelope::new(inverse, attitude, at.yaw - base.yaw);
    let step = 2.0 * step_of(&a.cell.robot, inverse);
    let fine = Fineness { step, tolerance: tolerance_of(inverse, step), asked: &|_| () };
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
