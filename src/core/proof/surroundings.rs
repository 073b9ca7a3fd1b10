//! Targets near a spot that the arm must reach, too.
//!
//! A spot is of use only if the arm also reaches the far end of the longer approach or retract line. If the
//! layout must withstand misplacements, the arm must also reach the misplaced spots and line ends. Each of
//! these targets has a height and a radius (distance from the base axis) that differ from those of the
//! spot. A spot is cut off if no posture of the arm has the height, the radius and the tool elevation of
//! one of these targets.

use super::branch_and_bound::is_empty;
use super::region::OperationRegion;
use super::task::Task;
use crate::cell::Equipment;
use crate::layout::Workcell;
use std::f64::consts::FRAC_PI_2;

/// Ranges of the differences of height and radius between a target and the spot, m.
#[derive(Debug, Clone, Copy, PartialEq)]
struct TargetOffset {
    height: (f64, f64),
    radius: (f64, f64),
}

/// Targets of one operation that the arm must reach in addition to the spot.
pub(super) struct Surroundings<'a> {
    workcell: &'a Workcell,
    offsets: Vec<TargetOffset>,
}

impl<'a> Surroundings<'a> {
    /// Collects the targets of an operation. `region` holds the elevations of the tool.
    pub fn new(workcell: &'a Workcell, region: &OperationRegion) -> Self {
        let cell = &workcell.cell;
        let operation = &cell.operations[region.operation];
        let kept = workcell.inverse().fixed_elevation();
        let (low, high) = region.elevation.or(kept.map(|e| (e, e))).unwrap_or((-FRAC_PI_2, FRAC_PI_2));
        // The line runs against the tool axis.
        let level = if low <= 0.0 && high >= 0.0 { 1.0 } else { low.cos().max(high.cos()) };
        let line = |length: f64| TargetOffset {
            height: (-length * high.sin(), -length * low.sin()),
            radius: (-length * level, length * level),
        };
        let length = operation.approach.max(operation.retract);
        let pieces = std::iter::successors(Some(&cell.equipment[operation.equipment]), |piece| {
            piece.on.map(|under| &cell.equipment[under])
        });
        let misplaced = |sum: (f64, f64), Equipment { tolerance, .. }: &Equipment| {
            let [x, y, z, _] = tolerance.0;
            // A misplacement in the direction of the base axis may have this length, whatever the yaw.
            (sum.0 + z, sum.1 + x.min(y))
        };
        let pieces = pieces.filter(|_| workcell.certifies());
        let (z, r) = pieces.fold((0.0, 0.0), misplaced);
        let mut offsets = Vec::new();
        for length in [0.0, length] {
            let TargetOffset { height, radius } = line(length);
            for (z, r) in [(z, r), (z, -r), (-z, r), (-z, -r)] {
                let offset = TargetOffset {
                    height: (height.0 + z, height.1 + z),
                    radius: (radius.0 + r, radius.1 + r),
                };
                let is_spot = length == 0.0 && (z, r) == (0.0, 0.0);
                if !is_spot && !offsets.contains(&offset) {
                    offsets.push(offset);
                }
            }
        }
        Self { workcell, offsets }
    }

    /// Returns whether the spot is the only target.
    pub fn is_empty(&self) -> bool {
        self.offsets.is_empty()
    }

    /// Returns whether the arm certainly cannot reach a target of any spot in a region.
    pub fn are_cut_off(&self, region: &OperationRegion) -> bool {
        let Some((low, high)) = region.radius else { return false };
        self.offsets.iter().any(|offset| {
            let radius =
                ((low + offset.radius.0).max(0.0), (high + offset.radius.1).max(-low - offset.radius.0));
            let height = (region.height.0 + offset.height.0, region.height.1 + offset.height.1);
            let there = OperationRegion { height, radius: Some(radius), ..*region };
            Task::new(self.workcell, &there).is_ok_and(|task| is_empty(&task))
        })
    }
}
