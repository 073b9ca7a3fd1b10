//! Floor plan: overlaps of equipment with other equipment, the robot base, keep-out boxes, floor and fence.

use super::fence;
use super::floor_rectangle::{AxisDepth, PlacedRectangle, least_overlap, overlap_depth};
use crate::cell::{Cell, Equipment, Fence, Layout, Placement, Rectangle, Role, Shape, extent};
use crate::geometry::PlanePoint;
use crate::units::mm_from_m;

/// Participant of an overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Party {
    /// Index into [`Cell::equipment`].
    Equipment(usize),
    RobotBase,
    /// Index into [`Cell::keep_out`].
    KeepOut(usize),
    Floor,
    Fence,
}

/// Overlap of two floor spaces.
///
/// A move by `depth` (m) separates them, clearance included. If `b` is the fence, `depth` is the distance by
/// which `a` reaches beyond it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    pub a: Party,
    pub b: Party,
    pub depth: f64,
}

/// Shortest way to separate two floor spaces: move `a` along `direction` (unit, plan) by `depth` (m).
///
/// `depth` is negative if the floor spaces are apart already. `b` is None for the robot base, a keep-out box
/// or an edge of the fence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    pub a: usize,
    pub b: Option<usize>,
    pub direction: (f64, f64),
    pub depth: f64,
}

/// Computed overlap, m, up to which two floor spaces only touch; it exceeds the effect of rounding.
const TOUCHING: f64 = 1e-9;

impl Overlap {
    /// Returns whether the overlap involves a piece of equipment.
    ///
    /// A robot base that reaches beyond the fence involves all equipment.
    pub fn concerns(&self, equipment: usize) -> bool {
        let parties = [self.a, self.b];
        parties.contains(&Party::Equipment(equipment)) || parties == [Party::RobotBase, Party::Fence]
    }

    /// Describes the overlap with the names that the cell gives to its objects.
    pub fn in_words(&self, cell: &Cell) -> String {
        let name = |party: Party| match party {
            Party::Equipment(i) => cell.equipment[i].name.clone(),
            Party::RobotBase => "the robot base".into(),
            Party::KeepOut(k) => format!("keep-out {}", cell.keep_out[k].name),
            Party::Floor => "the floor".into(),
            Party::Fence => "the fence".into(),
        };
        let verb = if self.b == Party::Fence { "passes" } else { "overlaps" };
        format!("{} {verb} {} by {:.1} mm", name(self.a), name(self.b), mm_from_m(self.depth))
    }
}

/// Fence of a cell, prepared once for all layouts.
struct FencePolygon {
    corners: Vec<PlanePoint>,
    /// Edges as rectangles of zero width.
    edges: Vec<PlacedRectangle>,
    is_convex: bool,
}

impl FencePolygon {
    fn new(fence: &Fence) -> Self {
        let corners = &fence.corners;
        let edge = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            let (cos, sin) = ((b.0 - a.0) / length, (b.1 - a.1) / length);
            PlacedRectangle {
                centre: ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0),
                half: (length / 2.0, 0.0),
                cos,
                sin,
            }
        };
        Self {
            edges: (0..corners.len()).map(edge).collect(),
            is_convex: fence::is_convex(corners),
            corners: corners.clone(),
        }
    }

    /// Returns how far a floor space reaches beyond the fence, m; 0 if it is inside and keeps the clearance.
    ///
    /// The result is the largest of two kinds of lengths: the distances from the fence to corners outside it,
    /// and the depths by which edges of the fence enter the floor space. The clearance is added to each
    /// length.
    fn passed_by(&self, stand: &PlacedRectangle, clearance: f64) -> f64 {
        let outside = stand.corners().map(|corner| match fence::locate(&self.corners, corner) {
            (true, _) => 0.0,
            (false, by) => by + clearance,
        });
        let edges = self.edges.iter().map(|edge| overlap_depth(stand, edge, clearance));
        outside.into_iter().chain(edges).fold(0.0, f64::max)
    }

    /// Returns, for each edge of a convex fence, the move (m) inwards that brings the floor space inside that
    /// edge.
    ///
    /// A fence that is not convex gives no moves.
    fn separations(&self, stand: &PlacedRectangle, clearance: f64) -> impl Iterator<Item = AxisDepth> {
        let edges = if self.is_convex { &self.edges[..] } else { &[] };
        edges.iter().map(move |edge| {
            let inwards = (-edge.sin, edge.cos);
            let apart =
                (stand.centre.0 - edge.centre.0) * inwards.0 + (stand.centre.1 - edge.centre.1) * inwards.1;
            AxisDepth { direction: inwards, depth: stand.half_width(inwards) + clearance - apart }
        })
    }
}

/// Floor space and heights of one piece of equipment.
pub(super) struct EquipmentFootprint {
    footprint: Rectangle,
    role: Role,
    /// Height of the lowest point of solids and surface above the origin of the equipment's frame, m.
    low: f64,
    /// Height of the highest point of solids and surface above the origin of the equipment's frame, m.
    high: f64,
    /// Whether the equipment has legs, which occupy the space down to the floor.
    legs: bool,
    /// Placement in the cell file, and the floor space there. An obstacle always stands there.
    drawn: (Placement, PlacedRectangle),
}

impl EquipmentFootprint {
    /// Returns the floor space at a placement.
    fn placed(&self, at: &Placement) -> PlacedRectangle {
        if *at == self.drawn.0 { self.drawn.1 } else { PlacedRectangle::new(&self.footprint, at) }
    }

    /// Returns whether the equipment, placed at height `z`, comes nearer than `clearance` to a range of
    /// heights (m).
    pub(super) fn meets(&self, z: f64, (bottom, top): (f64, f64), clearance: f64) -> bool {
        let above = !self.legs && z + self.low >= top + clearance - TOUCHING;
        let below = z + self.high + clearance <= bottom + TOUCHING;
        !(above || below)
    }
}

/// Floor spaces of a cell, prepared once for all layouts.
pub struct FloorPlan {
    pub(super) equipment: Vec<EquipmentFootprint>,
    /// Index of the equipment on which each piece of equipment stands, if any.
    on: Vec<Option<usize>>,
    base: Rectangle,
    pub(super) keep_out: Vec<(PlacedRectangle, (f64, f64))>,
    clearance: f64,
    floor: f64,
    fence: Option<FencePolygon>,
    pub(super) enabled: bool,
}

impl FloorPlan {
    /// Prepares the floor spaces of a cell.
    pub fn new(cell: &Cell) -> Self {
        let stand = |(e, at): (&Equipment, Placement)| {
            let heights = || e.solids.iter().map(|s| extent(&s.shape)).map(|(lo, hi)| (lo.z, hi.z));
            EquipmentFootprint {
                footprint: e.footprint,
                role: e.role,
                low: heights().map(|h| h.0).fold(0.0, f64::min),
                high: heights().map(|h| h.1).fold(0.0, f64::max),
                legs: e.solids.iter().any(|s| matches!(s.shape, Shape::Leg { .. })),
                drawn: (at, PlacedRectangle::new(&e.footprint, &at)),
            }
        };
        Self {
            equipment: cell.equipment.iter().zip(cell.start().placements).map(stand).collect(),
            base: cell.robot.footprint,
            on: cell.equipment.iter().map(|e| e.on).collect(),
            keep_out: cell
                .keep_out
                .iter()
                .map(|k| (PlacedRectangle::of_keep_out(k), (k.min.z, k.max.z)))
                .collect(),
            clearance: cell.clearance,
            floor: cell.floor,
            fence: cell.fence.as_ref().map(FencePolygon::new),
            enabled: cell.collision,
        }
    }

    /// Returns whether a piece of equipment stands on another, directly or on equipment that does.
    fn rides(&self, equipment: usize, other: usize) -> bool {
        self.on[equipment].is_some_and(|under| under == other || self.rides(under, other))
    }

    /// Returns the separation of every pair of floor spaces that includes movable equipment.
    pub fn separations(&self, layout: &Layout) -> Vec<Separation> {
        let mut pairs = Vec::new();
        let all = || self.equipment.iter().zip(&layout.placements).enumerate();
        for (i, (stand, at)) in all().filter(|(_, (stand, _))| stand.role == Role::Equipment) {
            let here = stand.placed(at);
            let mut note = |b: Option<usize>, there: &PlacedRectangle| {
                let AxisDepth { direction, depth } = least_overlap(&here, there, self.clearance);
                pairs.push(Separation { a: i, b, direction, depth });
            };
            for (j, (other, there)) in all() {
                let apart = !self.rides(i, j) && !self.rides(j, i);
                if apart && (j > i || other.role == Role::Obstacle) {
                    note(Some(j), &other.placed(there));
                }
            }
            note(None, &PlacedRectangle::new(&self.base, &layout.base));
            for (keep_out, heights) in &self.keep_out {
                if stand.meets(at.z, *heights, self.clearance) {
                    note(None, keep_out);
                }
            }
            if let Some(fence) = &self.fence {
                let sides = fence.separations(&here, self.clearance);
                pairs.extend(sides.map(|AxisDepth { direction, depth }| Separation {
                    a: i,
                    b: None,
                    direction,
                    depth,
                }));
            }
        }
        pairs
    }

    /// Writes all overlaps of a layout to `found`. An overlap of two obstacles is allowed and left out.
    ///
    /// Each piece of equipment is checked against the later ones in the cell, the robot base, the keep-out
    /// boxes, the floor and the fence.
    pub fn overlaps(&self, layout: &Layout, found: &mut Vec<Overlap>) {
        found.clear();
        if !self.enabled {
            return;
        }
        let clearance = self.clearance;
        let mut note = |a, b, depth: f64| {
            if depth > TOUCHING {
                found.push(Overlap { a, b, depth });
            }
        };
        let all = || self.equipment.iter().zip(&layout.placements).enumerate();
        let base = PlacedRectangle::new(&self.base, &layout.base);
        for (i, (stand, at)) in all() {
            let party = Party::Equipment(i);
            let here = stand.placed(at);
            for (j, (other, there)) in all().skip(i + 1) {
                let both_still = (stand.role, other.role) == (Role::Obstacle, Role::Obstacle);
                if !both_still && !self.rides(i, j) && !self.rides(j, i) {
                    note(party, Party::Equipment(j), overlap_depth(&here, &other.placed(there), clearance));
                }
            }
            note(party, Party::RobotBase, overlap_depth(&here, &base, clearance));
            for (k, (box_plan, heights)) in self.keep_out.iter().enumerate() {
                if stand.meets(at.z, *heights, clearance) {
                    note(party, Party::KeepOut(k), overlap_depth(&here, box_plan, clearance));
                }
            }
            note(party, Party::Floor, self.floor - (at.z + stand.low));
            if let Some(fence) = self.fence.as_ref().filter(|_| stand.role == Role::Equipment) {
                note(party, Party::Fence, fence.passed_by(&here, clearance));
            }
        }
        if let Some(fence) = &self.fence {
            note(Party::RobotBase, Party::Fence, fence.passed_by(&base, clearance));
        }
    }
}
