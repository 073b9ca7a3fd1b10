//! What misplacement does to a layout: equipment is never placed exactly.
//!
//! For each operation the point of the surface and the posture's branch are kept, while the robot base,
//! the equipment that carries it, what that stands on, and those of the pick it is relative to move inside
//! their placement tolerances. What the program does not know of the place is no matter of this: that
//! belongs to the `errors` of the equipment. So misplacement counts through the posture, in every
//! registration; of taught frames the touching postures move, too.
//!
//! - The worst corner: all corners of the box of up to 8 dimensions; of a larger one the corners of each
//!   body's own box with the others as drawn, and the corner that is worst to first order. A corner at
//!   which the posture is lost, collides, or equipment overlaps says so. So does one of another body that
//!   gets in the way.
//! - The gradient, by central differences.
//! - The largest misplacement that keeps value and limit: a share of the box, a distance in plan and a yaw.
//!   Checked are all corners and the middles of all edges and faces of the box, or 16 directions in plan,
//!   or both turns, at scales that grow by [`STRIDE`] until one fails; then halved between. Something
//!   that fails between two scales and holds again at the next would be missed.

use super::Workcell;
use super::misplacement::{Boxes, Moves, Points};
use super::worst::is_between_solids;
use crate::cell::{Layout, Slot, Unit};
use crate::clearance::PlacedSolids;
use crate::error_map::{Kept, OperationMap, Probe, Spot, Status};
use crate::units::rad_from_deg;

/// Half the distance of the central differences, m and rad.
const STEP: f64 = 1e-4;
/// How far it is looked: times the tolerance, m, degrees.
const SCALES: f64 = 100.0;
const FAR: f64 = 0.25;
const TURN: f64 = 30.0;
/// From one scale to the next, and the number of scales: the first is 1/7500 of the last.
const STRIDE: f64 = 1.6;
const STRIDES: i32 = 19;
/// Halvings between the last scale that holds and the first that does not.
const HALVINGS: usize = 26;
/// Directions of a displacement in plan.
const DIRECTIONS: usize = 16;
/// Of what was found in these directions so much is sure: between two of them a straight edge of what is
/// allowed comes nearer by the cosine of half their angle.
const BETWEEN: f64 = 0.98; // cos(11.25 deg) = 0.9808

/// A misplacement and the value there (m, rad or a share).
#[derive(Debug, Clone, PartialEq)]
pub struct Corner {
    pub moves: Moves,
    pub value: f64,
}

/// A misplacement at which the operation cannot go on as it is, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Lost {
    pub moves: Moves,
    pub status: Status,
}

/// Why a misplacement cannot be larger.
#[derive(Debug, Clone, PartialEq)]
pub enum Ended {
    Lost(Lost),
    /// It passes the limit.
    Limit(Corner),
}

/// The largest misplacement that keeps reach, clearance and limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Largest {
    /// Times the tolerance, m or rad.
    pub most: f64,
    /// What happens beyond; None: nothing, as far as it was looked.
    pub ended: Option<Ended>,
}

/// What misplacement does to one operation.
#[derive(Debug, Clone, PartialEq)]
pub struct Robustness {
    /// As drawn, m, rad or a share.
    pub value: f64,
    /// The box: what may be misplaced by how much (m, rad); empty: nothing.
    pub tolerance: Moves,
    /// Corners looked at.
    pub corners: usize,
    /// The corner with the greatest value; None without tolerance, or if all are lost.
    pub worst: Option<Corner>,
    /// Corners at which it is lost.
    pub lost: Vec<Lost>,
    /// Change of the value per m or rad of its equipment and of what else is in the box, joint limits
    /// aside; None at the end of reach.
    pub gradient: Vec<(Slot, Option<f64>)>,
    /// Of the box; None without tolerance.
    pub scale: Option<Largest>,
    /// Of its equipment in plan, m, in the worst direction.
    pub shift: Largest,
    /// Of its equipment about the vertical, rad, the worse way.
    pub turn: Largest,
}

impl Robustness {
    /// Whether the operation keeps reach, clearance and limit wherever the tolerance lets things stand.
    pub fn holds(&self) -> bool {
        let scale = self.scale.as_ref().is_none_or(|scale| scale.most >= 1.0);
        // Without tolerance: as drawn.
        self.lost.is_empty() && scale && self.shift.most > 0.0
    }
}

/// One operation with what it keeps.
struct Holding<'a> {
    workcell: &'a Workcell,
    layout: &'a Layout,
    operation: usize,
    kept: Vec<Kept>,
    /// Of all operations.
    spots: Vec<Option<Spot>>,
    limit: Option<f64>,
}

impl Workcell {
    /// What misplacement does to every operation; None of one without spot. `maps` are those of the
    /// layout.
    pub fn robustness(&self, layout: &Layout, maps: &[OperationMap]) -> Vec<Option<Robustness>> {
        let spots: Vec<_> = maps.iter().map(OperationMap::spot).collect();
        let all = maps.iter().map(|map| {
            let operation = &self.cell.operations[map.operation];
            let all = operation.over.takes_all();
            let nodes = map.nodes.iter().enumerate().filter(|(k, _)| all || map.best == Some(*k));
            let kept = nodes.filter_map(|(k, node)| {
                let posture = node.posture.as_ref()?;
                let at = self.mapper.local(map.operation, k);
                Some(Kept { at, branch: posture.branch, joints: posture.joints })
            });
            let limit = operation.limit.filter(|_| self.cell.unit() != Unit::Share);
            let (kept, spots) = (kept.collect(), spots.clone());
            let holding = Holding { workcell: self, layout, operation: map.operation, kept, spots, limit };
            map.value.map(|value| holding.robustness(value))
        });
        all.collect()
    }
}

impl Holding<'_> {
    fn robustness(&self, value: f64) -> Robustness {
        let boxes = Boxes::of(&self.workcell.cell, self.operation);
        let tolerance: Moves = boxes.own.concat();
        let gradient = self.gradient(&tolerance);
        let mut corners = boxes.moves(1.0, Points::Corners);
        let uphill = uphill(&tolerance, &gradient);
        corners.extend((!boxes.is_whole()).then(|| uphill.clone()));
        let (mut worst, mut lost) = (None::<Corner>, Vec::new());
        for moves in corners.iter() {
            match self.value(moves) {
                Ok(value) if worst.as_ref().is_none_or(|w| value > w.value) => {
                    worst = Some(Corner { moves: moves.clone(), value });
                }
                Ok(_) => {}
                Err(status) => lost.push(Lost { moves: moves.clone(), status }),
            }
        }
        let scale = (!corners.is_empty()).then(|| {
            largest(SCALES, |scale| {
                let mut moves = boxes.moves(scale, Points::Surface);
                let scaled = uphill.iter().map(|(slot, by)| (*slot, scale * by)).collect();
                moves.extend((!boxes.is_whole()).then_some(scaled));
                self.first_end(&moves)
            })
        });
        let (shift, turn) = (self.shift(), self.turn());
        let (corners, worst) = (corners.len(), worst.filter(|_| !tolerance.is_empty()));
        Robustness { value, tolerance, corners, worst, lost, gradient, scale, shift, turn }
    }

    fn equipment(&self, axis: usize) -> Slot {
        Slot::Equipment(self.workcell.cell.operations[self.operation].equipment, axis)
    }

    fn shift(&self) -> Largest {
        let found = largest(FAR, |distance| {
            let moves = (0..DIRECTIONS).map(|k| {
                let (sin, cos) = (std::f64::consts::TAU * k as f64 / DIRECTIONS as f64).sin_cos();
                vec![(self.equipment(0), distance * cos), (self.equipment(1), distance * sin)]
            });
            self.first_end(&moves.collect::<Vec<_>>())
        });
        Largest { most: found.most * BETWEEN, ..found }
    }

    fn turn(&self) -> Largest {
        largest(rad_from_deg(TURN), |turn| {
            self.first_end(&[turn, -turn].map(|turn| vec![(self.equipment(3), turn)]))
        })
    }

    /// The first misplacement that loses the posture or passes the limit.
    fn first_end(&self, all: &[Moves]) -> Option<Ended> {
        all.iter().find_map(|moves| match self.value(moves) {
            Err(status) => Some(Ended::Lost(Lost { moves: moves.clone(), status })),
            Ok(value) => self
                .limit
                .filter(|limit| value > *limit)
                .map(|_| Ended::Limit(Corner { moves: moves.clone(), value })),
        })
    }

    /// The value when misplaced, or why there is none.
    fn value(&self, moves: &[(Slot, f64)]) -> Result<f64, Status> {
        let layout = self.workcell.cell.misplaced(self.layout, moves);
        let mut overlaps = Vec::new();
        self.workcell.plan.overlaps(&layout, &mut overlaps);
        if let Some(overlap) = overlaps.into_iter().find(is_between_solids) {
            return Err(Status::Overlap(overlap));
        }
        self.asked(&layout, |probe, kept| probe.keeping(kept))
    }

    fn asked(
        &self,
        layout: &Layout,
        mut ask: impl FnMut(&mut Probe<'_>, &Kept) -> Result<f64, Status>,
    ) -> Result<f64, Status> {
        let Workcell { cell, mapper, scene, .. } = self.workcell;
        let mut placed = PlacedSolids::default();
        scene.place(layout, &mut placed);
        let probe = Probe::new((mapper, scene, &placed), self.operation, layout, &self.spots);
        let mut probe = probe.map_err(Status::Unjudged)?;
        let values: Result<Vec<f64>, Status> = self.kept.iter().map(|kept| ask(&mut probe, kept)).collect();
        Ok(cell.operations[self.operation].over.of(&mut values?))
    }

    fn gradient(&self, tolerance: &[(Slot, f64)]) -> Vec<(Slot, Option<f64>)> {
        let own = (0..4).map(|axis| self.equipment(axis));
        let others = tolerance.iter().map(|(slot, _)| *slot).filter(|slot| !own.clone().any(|o| o == *slot));
        let slope = |slot: Slot| {
            let [high, low] = [STEP, -STEP].map(|by| {
                let layout = self.workcell.cell.misplaced(self.layout, &[(slot, by)]);
                // A best spot often stands at a limit: that is no matter of the slope.
                let missing = Status::OutOfReach { by: 0.0 };
                self.asked(&layout, |probe, kept| probe.beyond_limits(kept).ok_or(missing)).ok()
            });
            Some((high? - low?) / (2.0 * STEP))
        };
        own.clone().chain(others).map(|slot| (slot, slope(slot))).collect()
    }
}

/// The corner of a box that is worst to first order.
fn uphill(tolerance: &[(Slot, f64)], gradient: &[(Slot, Option<f64>)]) -> Moves {
    let slope = |slot: Slot| gradient.iter().find(|(s, _)| *s == slot).and_then(|(_, g)| *g).unwrap_or(0.0);
    tolerance.iter().map(|(slot, half)| (*slot, half.copysign(slope(*slot)))).collect()
}

/// The largest scale that nothing ends; from `far` on it is not looked.
fn largest(far: f64, ends: impl Fn(f64) -> Option<Ended>) -> Largest {
    if let Some(ended) = ends(0.0) {
        return Largest { most: 0.0, ended: Some(ended) };
    }
    let (mut most, mut first) = (0.0, None);
    for stride in (0..=STRIDES).rev() {
        let scale = far / STRIDE.powi(stride);
        match ends(scale) {
            Some(ended) => {
                first = Some((scale, ended));
                break;
            }
            None => most = scale,
        }
    }
    let Some((mut beyond, mut ended)) = first else { return Largest { most, ended: None } };
    for _ in 0..HALVINGS {
        let middle = (most + beyond) / 2.0;
        match ends(middle) {
            Some(sooner) => (beyond, ended) = (middle, sooner),
            None => most = middle,
        }
    }
    Largest { most, ended: Some(ended) }
}
