//! Tolerance analysis of a layout: the effect of misplaced equipment on every operation.
//!
//! The point on the surface and the branch of the posture do not change. Several bodies move inside their
//! placement tolerances: the robot base, the equipment on which the point lies, and the equipment that
//! carries this equipment. If the operation is relative to a pick, the equipment of the pick and its
//! carriers also move. The controller is assumed to know where the bodies are. Placement errors that the
//! controller does not know are given as `errors` of the equipment. A misplacement therefore changes the
//! value only because it changes the posture. This is true for every registration. For a taught frame, the
//! postures in which the robot touches the taught points also change.
//!
//! - Worst corner: all corners of the tolerance box are checked if the box has at most 8 dimensions. For a
//!   larger box, the corners of the box of each body are checked, while the other bodies are not misplaced.
//!   The corner of the whole box that is worst to first order is also checked. A corner is called lost if the
//!   posture cannot be used there, or if floor spaces overlap. The corners of the box of each body on which
//!   the operation does not depend are also checked. Such a body may obstruct the robot.
//! - Gradient: the derivatives are computed by central differences.
//! - Largest allowed misplacement: the analysis finds three separate sizes. They are a multiple of the
//!   tolerance box, a displacement in plan, and a yaw of the equipment. A misplacement is allowed if no floor
//!   spaces overlap, the posture is usable and the value is within its limit. A multiple of the box is
//!   checked at its corners, and at the middles of its edges and facets. A facet of a box with n dimensions
//!   has n - 1 dimensions. A displacement is checked in 16 directions, and a yaw in both directions. Each
//!   size grows by the factor [`STRIDE`] until a check fails. Bisection finds the size up to which this check
//!   succeeds. If another check fails at this size, bisection is repeated for that check. A failure that
//!   occurs only between two checked sizes is missed. A certified operation needs no check up to the
//!   tolerances themselves ([`crate::certificate`]).

use super::certify::is_between_solids;
use super::misplacement::{BoxPoints, Moves, ToleranceBoxes};
use super::workcell::Workcell;
use crate::cell::{Layout, Slot};
use crate::error_map::{HeldPosture, MapperWorkspace, OperationMap, Probe, Spot, Status};
use crate::units::rad_from_deg;
use rayon::prelude::*;

/// Half the distance between the two points of a central difference, m or rad.
const DIFFERENCE_STEP: f64 = 1e-4;
/// Largest checked multiple of the box of placement tolerances.
const MAX_SCALE: f64 = 100.0;
/// Largest displacement in plan that is checked, m.
const MAX_SHIFT: f64 = 0.25;
/// Largest yaw that is checked, degrees.
const MAX_TURN_DEG: f64 = 30.0;
/// Ratio of each checked size of a misplacement to the size checked before it.
const STRIDE: f64 = 1.6;
/// Number of steps from the smallest checked size of a misplacement to the largest. Each step multiplies
/// the size by [`STRIDE`].
///
/// The smallest size is therefore about 1/7600 of the largest.
const SCALE_STEPS: i32 = 19;
/// Number of bisection steps between the last allowed size of a misplacement and the first refused size.
const BISECTIONS: usize = 26;
/// Number of directions of a displacement in plan.
const DIRECTIONS: usize = 16;
/// Factor that reduces the displacement found in the checked directions to a displacement that is allowed in
/// every direction.
///
/// The nearest point of a straight edge of the allowed region may lie between two checked directions. The
/// distance to this point is at least the displacement found, times the cosine of half the angle between
/// neighbouring directions.
const DIRECTION_FACTOR: f64 = 0.98; // cos(11.25 deg) = 0.9808

/// Misplacement, and the value of the operation there (m, rad, share of failures, or cost of tolerances).
#[derive(Debug, Clone, PartialEq)]
pub struct Corner {
    pub moves: Moves,
    pub value: f64,
}

/// Misplacement at which floor spaces overlap or the posture of the operation cannot be used, with the
/// reason.
#[derive(Debug, Clone, PartialEq)]
pub struct Lost {
    pub moves: Moves,
    pub status: Status,
}

/// Reason why a misplacement larger than [`Largest::most`] is not allowed.
#[derive(Debug, Clone, PartialEq)]
pub enum MisplacementEnd {
    Lost(Lost),
    /// The value exceeds the limit of the operation.
    Limit(Corner),
}

/// Largest misplacement at which the posture is usable and the value is within its limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest {
    /// Size of the misplacement: a multiple of the tolerance box, a distance in m, or an angle in rad.
    pub most: f64,
    /// Reason why a misplacement larger than [`Self::most`] is not allowed; None if every checked
    /// misplacement is allowed.
    pub ended: Option<MisplacementEnd>,
}

/// Effect of misplacements on one operation, within the placement tolerances and beyond them.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// Value of the operation in the layout without misplacements (m, rad, share of failures, or cost of
    /// tolerances).
    pub value: f64,
    /// Placement tolerances of the bodies on which the operation depends: coordinates and half widths.
    ///
    /// The half widths are in m or rad.
    pub tolerance: Moves,
    /// Number of corners of the placement tolerances that were checked.
    pub corners: usize,
    /// Corner with the greatest value; None if `tolerance` is empty, or if every corner is in `lost`.
    pub worst: Option<Corner>,
    /// Corners of the placement tolerances at which floor spaces overlap or the posture cannot be used.
    pub lost: Vec<Lost>,
    /// Coordinates of the layout, each with the derivative of the value with respect to that coordinate, per
    /// m or rad. A derivative is None if the arm cannot reach one of the two points of the central
    /// difference.
    ///
    /// Joint limits are ignored. The coordinates are x, y, z and yaw of the equipment, and every other
    /// coordinate in `tolerance`.
    pub gradient: Vec<(Slot, Option<f64>)>,
    /// Largest allowed multiple of the placement tolerances; None if the cell has no placement tolerances.
    pub scale: Option<Largest>,
    /// Largest horizontal displacement of the equipment that is allowed in every direction, m.
    pub shift: Largest,
    /// Largest rotation of the equipment about the vertical that is allowed in either direction, rad.
    pub turn: Largest,
}

impl Robustness {
    /// Returns whether the posture is usable and the value is within its limit at every checked
    /// misplacement inside the tolerances.
    pub fn holds(&self) -> bool {
        let scale = self.scale.as_ref().is_none_or(|scale| scale.most >= 1.0);
        // Without tolerances, `shift` shows whether the layout without misplacements is allowed.
        self.lost.is_empty() && scale && self.shift.most > 0.0
    }
}

/// Function that queries a held posture. The function returns a value, or the status of the point if the
/// posture cannot be held.
type AskHeld = fn(&mut Probe<'_>, &HeldPosture) -> Result<f64, Status>;

/// One operation with the postures that it keeps while bodies are misplaced.
struct HeldOperation<'a> {
    workcell: &'a Workcell,
    layout: &'a Layout,
    operation: usize,
    held: Vec<HeldPosture>,
    /// Spots of all operations.
    spots: Vec<Option<Spot>>,
    limit: Option<f64>,
    /// Whether the operation certainly works and stays within its limit at every misplacement within the
    /// tolerances.
    is_certified: bool,
}

impl Workcell {
    /// Computes the effect of misplacements on every operation of a layout, given the maps of the layout. The
    /// entry of an operation without a spot is None.
    ///
    /// All entries are None if the layout does not belong to the cell.
    pub fn robustness(&self, layout: &Layout, maps: &[OperationMap]) -> Vec<Option<Robustness>> {
        if self.cell.misfit(layout).is_some() {
            return vec![None; maps.len()];
        }
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let robustness = |map: &OperationMap| {
            let value = map.value?;
            let held = self.held(layout, map, &spots);
            let is_certified = self.holds_within(layout, map, &spots, held.limit);
            Some(HeldOperation { is_certified, ..held }.robustness(value))
        };
        maps.iter().map(robustness).collect()
    }

    /// Computes the value of an operation when bodies are misplaced, from the maps of the layout without
    /// misplacements. The spot and the branch do not change.
    ///
    /// # Errors
    /// Returns the reason, as a [`Status`], if floor spaces overlap or the posture cannot be used at the
    /// misplacement.
    pub fn misplaced_value(
        &self,
        layout: &Layout,
        maps: &[OperationMap],
        operation: usize,
        moves: &[(Slot, f64)],
    ) -> Result<f64, Status> {
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        self.held(layout, &maps[operation], &spots).value(moves, &mut MapperWorkspace::default())
    }

    fn held<'a>(
        &'a self,
        layout: &'a Layout,
        map: &OperationMap,
        spots: &[Option<Spot>],
    ) -> HeldOperation<'a> {
        let limit = self.cell.operations[map.operation].limit.filter(|_| self.cell.unit().is_error());
        let (held, spots) = (self.held_nodes(layout, map), spots.to_vec());
        let is_certified = false;
        HeldOperation { workcell: self, layout, operation: map.operation, held, spots, limit, is_certified }
    }
}

impl HeldOperation<'_> {
    fn robustness(&self, value: f64) -> Robustness {
        let boxes = ToleranceBoxes::of(&self.workcell.cell, self.operation);
        let tolerance: Moves = boxes.own.concat();
        let gradient = self.gradient(&tolerance);
        let mut corners = boxes.moves(1.0, BoxPoints::Corners);
        let uphill = uphill(&tolerance, &gradient);
        corners.extend((!boxes.is_whole()).then(|| uphill.clone()));
        let (mut worst, mut lost) = (None::<Corner>, Vec::new());
        let judge = |memory: &mut MapperWorkspace, moves: &Moves| self.value(moves, memory);
        let values: Vec<_> = corners.par_iter().map_init(Default::default, judge).collect();
        for (moves, value) in corners.iter().zip(values) {
            match value {
                Ok(value) if worst.as_ref().is_none_or(|w| value > w.value) => {
                    worst = Some(Corner { moves: moves.clone(), value });
                }
                Ok(_) => {}
                Err(status) => lost.push(Lost { moves: moves.clone(), status }),
            }
        }
        let scale = (!corners.is_empty()).then(|| {
            let mut box_points = boxes.moves(1.0, BoxPoints::Surface);
            box_points.extend((!boxes.is_whole()).then_some(uphill));
            self.largest(if self.is_certified { 1.0 } else { 0.0 }, MAX_SCALE, &box_points)
        });
        let (shift, turn) = (self.shift(), self.turn());
        let (corners, worst) = (corners.len(), worst.filter(|_| !tolerance.is_empty()));
        Robustness { value, tolerance, corners, worst, lost, gradient, scale, shift, turn }
    }

    fn equipment(&self, axis: usize) -> Slot {
        Slot::Equipment(self.workcell.cell.operations[self.operation].equipment, axis)
    }

    fn shift(&self) -> Largest {
        let directions = (0..DIRECTIONS).map(|k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
            vec![(self.equipment(0), cos), (self.equipment(1), sin)]
        });
        let found = self.largest(0.0, MAX_SHIFT, &directions.collect::<Vec<_>>());
        Largest { most: found.most * DIRECTION_FACTOR, ..found }
    }

    fn turn(&self) -> Largest {
        let both = [1.0, -1.0].map(|turn| vec![(self.equipment(3), turn)]);
        self.largest(0.0, rad_from_deg(MAX_TURN_DEG), &both)
    }

    /// Finds the largest size of a misplacement, up to `max`, at which all misplacements are allowed.
    ///
    /// The misplacements of a size are the misplacements in `unit`, multiplied by the size. All misplacements
    /// up to the size `certified` are allowed, and are not checked.
    fn largest(&self, certified: f64, max: f64, unit: &[Moves]) -> Largest {
        let ends = |size: f64| self.first_end(unit, size);
        if certified == 0.0
            && let Some((_, ended)) = ends(0.0)
        {
            return Largest { most: 0.0, ended: Some(ended) };
        }
        let mut most = certified;
        let sizes = (0..=SCALE_STEPS).rev().map(|stride| max / STRIDE.powi(stride));
        let first = sizes.filter(|size| *size > certified).find_map(|size| match ends(size) {
            Some(ended) => Some((size, ended)),
            None => {
                most = size;
                None
            }
        });
        let Some((mut beyond, (mut failing, mut ended))) = first else {
            return Largest { most, ended: None };
        };
        // At the size `most`, all misplacements are allowed. At the size `beyond`, the misplacement with the
        // index `failing` is not allowed.
        loop {
            let mut allowed = most;
            for _ in 0..BISECTIONS {
                let middle = (allowed + beyond) / 2.0;
                match self.first_end(&unit[failing..=failing], middle) {
                    Some((_, sooner)) => (beyond, ended) = (middle, sooner),
                    None => allowed = middle,
                }
            }
            match ends(allowed) {
                Some((other, sooner)) if allowed > most => {
                    (beyond, failing, ended) = (allowed, other, sooner)
                }
                _ => return Largest { most: allowed, ended: Some(ended) },
            }
        }
    }

    /// Returns the index of the first misplacement that is not allowed, and the reason; None if all are
    /// allowed. The checked misplacements are those in `unit`, multiplied by `size`.
    fn first_end(&self, unit: &[Moves], size: f64) -> Option<(usize, MisplacementEnd)> {
        // Without a limit, the function checks only whether the postures can be used.
        let ask: AskHeld = match self.limit {
            Some(_) => |probe, held| probe.holding(held).map_err(|status| probe.reason(held, status)),
            None => |probe, held| {
                probe.keeps_free(held).map(|()| 0.0).map_err(|status| probe.reason(held, status))
            },
        };
        let end = |memory: &mut MapperWorkspace, (k, moves): (usize, &Moves)| {
            let moves: Moves = moves.iter().map(|(slot, by)| (*slot, size * by)).collect();
            match (self.asked(&moves, memory, ask), self.limit) {
                (Err(status), _) => Some((k, MisplacementEnd::Lost(Lost { moves, status }))),
                (Ok(value), Some(limit)) if value > limit => {
                    Some((k, MisplacementEnd::Limit(Corner { moves, value })))
                }
                _ => None,
            }
        };
        unit.par_iter().enumerate().map_init(Default::default, end).find_map_first(|end| end)
    }

    /// Computes the value at a misplacement.
    ///
    /// # Errors
    /// Returns the status if floor spaces overlap, or if the posture cannot be used at the misplacement.
    fn value(&self, moves: &[(Slot, f64)], memory: &mut MapperWorkspace) -> Result<f64, Status> {
        self.asked(moves, memory, |probe, held| probe.holding(held))
    }

    /// Calls `ask` for every held posture at a misplacement, and returns the combined result.
    ///
    /// # Errors
    /// Returns the status if floor spaces overlap, or if a posture cannot be used at the misplacement.
    fn asked(
        &self,
        moves: &[(Slot, f64)],
        memory: &mut MapperWorkspace,
        ask: AskHeld,
    ) -> Result<f64, Status> {
        let layout = self.workcell.cell.misplaced(self.layout, moves);
        let mut overlaps = Vec::new();
        self.workcell.plan.overlaps(&layout, &mut overlaps);
        if let Some(overlap) = overlaps.into_iter().find(is_between_solids) {
            return Err(Status::Overlap(overlap));
        }
        self.probed(&layout, memory, ask)
    }

    fn probed(
        &self,
        layout: &Layout,
        memory: &mut MapperWorkspace,
        mut ask: impl FnMut(&mut Probe<'_>, &HeldPosture) -> Result<f64, Status>,
    ) -> Result<f64, Status> {
        let placed = self.workcell.placed(layout);
        let mut probe = Probe::new(&placed, self.operation, &self.spots, memory).map_err(Status::Unjudged)?;
        let values: Result<Vec<f64>, Status> = self.held.iter().map(|held| ask(&mut probe, held)).collect();
        Ok(self.workcell.cell.operations[self.operation].over.of(&mut values?))
    }

    fn gradient(&self, tolerance: &[(Slot, f64)]) -> Vec<(Slot, Option<f64>)> {
        let own = (0..4).map(|axis| self.equipment(axis));
        let others = tolerance.iter().map(|(slot, _)| *slot).filter(|slot| !own.clone().any(|o| o == *slot));
        let mut memory = MapperWorkspace::default();
        let mut slope = |slot: Slot| {
            let [high, low] = [DIFFERENCE_STEP, -DIFFERENCE_STEP].map(|by| {
                let layout = self.workcell.cell.misplaced(self.layout, &[(slot, by)]);
                // The best spot is often at a joint limit, so the derivative ignores joint limits.
                let missing = Status::OutOfReach { by: 0.0 };
                self.probed(&layout, &mut memory, |probe, held| probe.beyond_limits(held).ok_or(missing)).ok()
            });
            Some((high? - low?) / (2.0 * DIFFERENCE_STEP))
        };
        own.clone().chain(others).map(|slot| (slot, slope(slot))).collect()
    }
}

/// Returns the corner of a tolerance box at which the value is greatest to first order.
fn uphill(tolerance: &[(Slot, f64)], gradient: &[(Slot, Option<f64>)]) -> Moves {
    let slope = |slot: Slot| gradient.iter().find(|(s, _)| *s == slot).and_then(|(_, g)| *g).unwrap_or(0.0);
    tolerance.iter().map(|(slot, half)| (*slot, half.copysign(slope(*slot)))).collect()
}
