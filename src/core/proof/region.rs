//! Region of the TCP of an operation over all layouts: bounds of height, elevation and distance from the base
//! axis.

use super::planar_arm::Lean;
use crate::cell::{Cell, Coordinate, Operation, Place, Rectangle};
use crate::clearance::FloorPlan;
use crate::geometry::PlanePoint;
use crate::layout::Workcell;
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// Margin of the bounds of a region, m and rad. The margin is far above the errors of the inverse kinematics,
/// and far below all sizes that matter.
const SLACK: f64 = 1e-6;

/// Region that contains the TCP position and the tool elevation of one operation in every layout. Azimuth
/// and spin are not limited.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperationRegion {
    pub operation: usize,
    /// Range of the height of the TCP above the robot base, m.
    pub height: (f64, f64),
    /// Range of the elevation of the tool axis, rad; None if the construction of the arm fixes this
    /// elevation.
    pub elevation: Option<(f64, f64)>,
    /// Direction in which the tool leans; None for both directions. Only planar arms distinguish them.
    pub lean: Option<Lean>,
    /// Range of the distance of the TCP from the z axis of the robot base, m; None if this distance is not
    /// limited.
    pub radius: Option<(f64, f64)>,
}

impl OperationRegion {
    /// Returns the regions of an operation. There is one region for each combination of listed heights of its
    /// equipment and of the equipment that carries it, or a single region if no heights are listed.
    ///
    /// `kept` is the tool elevation (rad) that the arm fixes by construction; None if the arm can change it.
    pub fn all(cell: &Cell, operation: usize, kept: Option<f64>) -> Vec<Self> {
        let mut pieces =
            std::iter::successors(Some(cell.operations[operation].equipment), |e| cell.equipment[*e].on);
        let listed = pieces.find_map(|e| match &cell.equipment[e].placement[2] {
            Coordinate::List(heights) => Some((e, heights)),
            _ => None,
        });
        let Some((equipment, heights)) = listed else { return vec![Self::new(cell, operation, kept)] };
        let mut one = cell.clone();
        let at = |height: &f64| {
            one.equipment[equipment].placement[2] = Coordinate::Fixed(*height);
            Self::all(&one, operation, kept)
        };
        heights.iter().flat_map(at).collect()
    }

    /// Returns the region of an operation over all layouts of a cell.
    ///
    /// `kept` is the tool elevation (rad) that the arm fixes by construction; None if the arm can change it.
    pub fn new(cell: &Cell, operation: usize, kept: Option<f64>) -> Self {
        let asked = &cell.operations[operation];
        let stand = EquipmentRange::new(cell, asked.equipment);
        let [low, high] = [stand.z.0, stand.z.1].map(|z| z + asked.standoff);
        Self {
            operation,
            height: (low - SLACK, high + SLACK),
            elevation: kept.is_none().then(|| with_tolerance(asked, chosen_elevations(asked))),
            lean: None,
            radius: Some(stand.distances(farthest(&asked.place))),
        }
    }

    /// Returns the regions of an operation of `cell`, without the part in which its equipment overlaps the
    /// robot base in plan. `workcell` holds the robot and the floor plan of this cell.
    pub(super) fn beside_base(cell: &Cell, operation: usize, workcell: &Workcell) -> Vec<Self> {
        let all = Self::all(cell, operation, workcell.inverse().fixed_elevation()).into_iter();
        all.map(|region| region.off_base(cell, workcell.floor_plan())).collect()
    }

    /// Returns the part of this region in which the equipment of the operation does not overlap the robot
    /// base in plan.
    fn off_base(self, cell: &Cell, plan: &FloorPlan) -> Self {
        let asked = &cell.operations[self.operation];
        let z = (self.height.0 - asked.standoff, self.height.1 - asked.standoff);
        let from_base = |point| plan.least_distance_from_base(asked.equipment, z, point) - SLACK;
        let least = extreme_points(&asked.place).into_iter().map(from_base).fold(f64::INFINITY, f64::min);
        Self { radius: self.radius.map(|(low, high)| (low.max(least), high)), ..self }
    }

    /// Returns the constraints on the height, the tool axis and the distance from the base axis.
    ///
    /// `facing` is a horizontal unit vector in the plane of a planar arm; None for other arms.
    pub(super) fn constraints(&self, facing: Option<Vector3<f64>>) -> Vec<Constraint> {
        let mut all =
            vec![Constraint { of: ConstrainedQuantity::Height, low: self.height.0, high: self.height.1 }];
        if let Some((low, high)) = self.elevation {
            // Near the vertical, the z component of the axis does not change to first order.
            let flat = low.cos().max(high.cos());
            if low <= -FRAC_PI_2 + SLACK || high >= FRAC_PI_2 - SLACK {
                let flat = if low <= 0.0 && high >= 0.0 { 1.0 } else { flat } + SLACK;
                all.extend([Vector3::x(), Vector3::y()].map(|along| Constraint {
                    of: ConstrainedQuantity::Axis(along),
                    low: -flat,
                    high: flat,
                }));
            }
            let (low, high) = (low.sin() - SLACK, high.sin() + SLACK);
            all.push(Constraint { of: ConstrainedQuantity::Axis(Vector3::z()), low, high });
        }
        if let Some((lean, facing)) = self.lean.zip(facing) {
            let (low, high) = if lean == Lean::Forwards { (-SLACK, 1.0) } else { (-1.0, SLACK) };
            all.push(Constraint { of: ConstrainedQuantity::Axis(facing), low, high });
        }
        if let Some((low, high)) = self.radius {
            // The gradient of the squared distance is 0 on the axis, so a lower limit of 0 must not act as a
            // constraint.
            let low = if low > 0.0 { low * low } else { -high * high };
            all.push(Constraint { of: ConstrainedQuantity::RadiusSquared, low, high: high * high });
        }
        all
    }
}

/// Quantity that a constraint limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ConstrainedQuantity {
    /// Height of the TCP above the robot base, m.
    Height,
    /// Component of the tool axis along this unit vector in the base frame.
    Axis(Vector3<f64>),
    /// Squared distance of the TCP from the z axis of the base, m^2.
    RadiusSquared,
}

/// Constraint `low <= quantity <= high` on the posture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Constraint {
    pub of: ConstrainedQuantity,
    pub low: f64,
    pub high: f64,
}

impl Constraint {
    /// Returns the constrained quantity for a TCP position and a tool axis in the base frame.
    pub fn value(&self, tip: &Vector3<f64>, tool: &Vector3<f64>) -> f64 {
        match self.of {
            ConstrainedQuantity::Height => tip.z,
            ConstrainedQuantity::Axis(along) => tool.dot(&along),
            ConstrainedQuantity::RadiusSquared => tip.xy().norm_squared(),
        }
    }
}

/// Returns the range of tool elevations that a search may choose for an operation, rad.
pub(super) fn chosen_elevations(asked: &Operation) -> (f64, f64) {
    asked.angles[0].as_ref().map_or((asked.attitude.elevation, asked.attitude.elevation), |c| c.range())
}

/// Returns the range of the elevation of the tool axis (rad) for a range of chosen elevations. The attitude
/// tolerance extends this range.
pub(super) fn with_tolerance(asked: &Operation, chosen: (f64, f64)) -> (f64, f64) {
    let by = asked.attitude.tolerance + SLACK;
    let (low, high) = (chosen.0 - by, chosen.1 + by);
    // Beyond the vertical, the tool leans to the other side, and the size of its elevation decreases again.
    let ends = [low, high].map(|e| e.sin().clamp(-1.0, 1.0).asin());
    let (least, most) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    (if low <= -FRAC_PI_2 { -FRAC_PI_2 } else { least }, if high >= FRAC_PI_2 { FRAC_PI_2 } else { most })
}

/// Returns the corners of the area of an operation, or its listed points, in the frame of the equipment, m.
fn extreme_points(place: &Place) -> Vec<PlanePoint> {
    match place {
        Place::Grid { area: Rectangle { centre, size }, .. } => {
            [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
                .map(|(i, j)| (centre.0 + i * size.0 / 2.0, centre.1 + j * size.1 / 2.0))
                .to_vec()
        }
        Place::Points(points) => points.clone(),
    }
}

/// Returns the distance of the farthest node from the origin of the equipment's frame, m.
fn farthest(place: &Place) -> f64 {
    extreme_points(place).iter().map(|(x, y)| x.hypot(*y)).fold(0.0, f64::max)
}

/// Ranges of the position of a piece of equipment relative to the robot base, along world axes, m.
///
/// If other equipment carries the piece, `x` and `y` are the ranges of the lowest carrier.
struct EquipmentRange {
    x: (f64, f64),
    y: (f64, f64),
    z: (f64, f64),
    /// Upper bound of the distance in plan, m, between the origins of the equipment and its lowest carrier.
    /// The bound is 0 without a carrier.
    aside: f64,
}

impl EquipmentRange {
    fn new(cell: &Cell, equipment: usize) -> Self {
        let [x, y, z, _] = cell.equipment[equipment].placement.each_ref().map(Coordinate::range);
        match cell.equipment[equipment].on {
            Some(under) => {
                let below = Self::new(cell, under);
                let far = |r: (f64, f64)| r.0.abs().max(r.1.abs());
                let aside = below.aside + far(x).hypot(far(y));
                Self { z: (below.z.0 + z.0, below.z.1 + z.1), aside, ..below }
            }
            None => {
                let base = cell.base.each_ref().map(Coordinate::range);
                let seen = |r: (f64, f64), base: (f64, f64)| (r.0 - base.1, r.1 - base.0);
                Self { x: seen(x, base[0]), y: seen(y, base[1]), z: seen(z, base[2]), aside: 0.0 }
            }
        }
    }

    /// Returns a lower and an upper bound of the distance (m) of a node from the base axis, for any yaw of
    /// equipment and base.
    ///
    /// `around` is the distance of the farthest node from the origin of the frame of the equipment, m.
    fn distances(&self, around: f64) -> (f64, f64) {
        let around = around + self.aside;
        let near = |r: (f64, f64)| r.0.max(-r.1).max(0.0);
        let far = |r: (f64, f64)| r.0.abs().max(r.1.abs());
        let (nearest, most) = (near(self.x).hypot(near(self.y)), far(self.x).hypot(far(self.y)));
        ((nearest - around - SLACK).max(0.0), most + around + SLACK)
    }
}
