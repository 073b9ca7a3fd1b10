//! Floor plan: overlaps of equipment with other equipment, the robot base, keep-out boxes, floor and fence.
//!
//! Two objects do not overlap if the vertical distance between their solids is at least the clearance. So a
//! lamp may hang over a table. The check in plan comes first, because it is cheap and usually decisive.

use super::fence;
use super::floor_heights::{HeightRange, Heights, base_bottom, base_top, rise};
use super::floor_rectangle::{AxisDepth, PlacedRectangle, least_overlap, overlap_depth};
use super::overlap::{Overlap, Party};
use crate::cell::{
    BaseSupport, Cell, Equipment, Fence, Layout, Placement, PlacementTolerance, Rectangle, Role,
};
use crate::geometry::PlanePoint;

/// Shortest way to separate two floor spaces in plan: move equipment `a` along `direction` (unit) by `depth`
/// (m).
///
/// `depth` is negative if the floor spaces are already apart. `b` is None for the robot base, a keep-out box
/// or an edge of the fence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    pub a: usize,
    pub b: Option<usize>,
    pub direction: (f64, f64),
    pub depth: f64,
}

/// Largest computed overlap, m, that counts as touching. This value exceeds the effect of rounding.
const TOUCHING: f64 = 1e-9;

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

    /// Returns how far a floor space reaches beyond the fence, m; 0 if the floor space is inside and keeps
    /// the clearance.
    ///
    /// The result is the largest of the following lengths, each plus the clearance:
    ///
    /// - for each corner of the floor space that lies outside the fence, its distance from the fence;
    /// - for each edge of the fence, the depth by which the edge enters the floor space.
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
struct EquipmentFootprint {
    footprint: Rectangle,
    role: Role,
    heights: Heights,
    /// Placement in the cell file, and the floor space at this placement. An obstacle always has this
    /// placement.
    drawn: (Placement, PlacedRectangle),
}

impl EquipmentFootprint {
    /// Returns the floor space at a placement.
    fn placed(&self, at: &Placement) -> PlacedRectangle {
        if *at == self.drawn.0 { self.drawn.1 } else { PlacedRectangle::new(&self.footprint, at) }
    }
}

/// Floor spaces of a cell, prepared once for all layouts.
///
/// [`Self::with_tolerances`] adds the distance by which misplacements may bring floor spaces closer together.
/// A layout without an overlap in such a plan has no overlap at any misplacement within the placement
/// tolerances.
pub struct FloorPlan {
    equipment: Vec<EquipmentFootprint>,
    /// For each piece of equipment, the index of the equipment on which it stands, if any.
    on: Vec<Option<usize>>,
    base: Rectangle,
    /// Height of the highest point of the robot base above the origin of its frame, m.
    base_top: f64,
    /// Height of the lowest point of a hung base above the origin of its frame, m. None means that the base,
    /// or its pedestal, stands on the floor.
    base_bottom: Option<f64>,
    /// Keep-out boxes with their heights in the world.
    pub(super) keep_out: Vec<(PlacedRectangle, HeightRange)>,
    clearance: f64,
    /// Extra distance that each piece of equipment keeps because of misplacements, m.
    room: Vec<Room>,
    base_room: Room,
    floor: f64,
    fence: Option<FencePolygon>,
    pub(super) enabled: bool,
}

impl FloorPlan {
    /// Prepares the floor spaces of a cell.
    pub fn new(cell: &Cell) -> Self {
        let stand = |(e, at): (&Equipment, Placement)| EquipmentFootprint {
            footprint: e.footprint,
            role: e.role,
            heights: Heights::of(e),
            drawn: (at, PlacedRectangle::new(&e.footprint, &at)),
        };
        Self {
            equipment: cell.equipment.iter().zip(cell.start().placements).map(stand).collect(),
            base: cell.robot.footprint,
            base_top: base_top(&cell.robot),
            base_bottom: (cell.base_support == BaseSupport::Hung).then(|| base_bottom(&cell.robot)),
            on: cell.equipment.iter().map(|e| e.on).collect(),
            keep_out: cell
                .keep_out
                .iter()
                .map(|k| (PlacedRectangle::of_keep_out(k), (k.min.z, k.max.z)))
                .collect(),
            clearance: cell.clearance,
            room: vec![Room::NONE; cell.equipment.len()],
            base_room: Room::NONE,
            floor: cell.floor,
            fence: cell.fence.as_ref().map(FencePolygon::new),
            enabled: cell.collision,
        }
    }

    /// Prepares the floor spaces of a cell, each with an extra distance for misplacements.
    pub fn with_tolerances(cell: &Cell) -> Self {
        let room = (0..cell.equipment.len()).map(|k| Room::of_equipment(cell, k)).collect();
        let base_room = Room::NONE.plus(&cell.base_tolerance, farthest(&cell.robot.footprint));
        Self { room, base_room, ..Self::new(cell) }
    }

    /// Returns whether `equipment` stands on `other`, directly or through equipment between them.
    fn rides(&self, equipment: usize, other: usize) -> bool {
        self.on[equipment].is_some_and(|under| under == other || self.rides(under, other))
    }

    /// Returns the vertical distance between two pieces of equipment, each given by index and placement, m.
    ///
    /// The distance is negative if the height ranges of the two pieces overlap.
    pub(super) fn rise(&self, (i, at): (usize, &Placement), (j, there): (usize, &Placement)) -> f64 {
        rise(self.equipment[i].heights.at(at.z), self.equipment[j].heights.at(there.z))
    }

    /// Returns the vertical distance of a piece of equipment from the robot base, m; negative if their height
    /// ranges overlap.
    ///
    /// A base that is not hung occupies everything from its top down to the floor.
    pub(super) fn rise_from_base(&self, i: usize, at: &Placement, base: &Placement) -> f64 {
        let bottom = self.base_bottom.map_or(f64::NEG_INFINITY, |bottom| base.z + bottom);
        rise(self.equipment[i].heights.at(at.z), (bottom, base.z + self.base_top))
    }

    /// Returns the vertical distance of a piece of equipment from the height range `heights`, m.
    ///
    /// The distance is negative if the height range of the piece overlaps `heights`.
    pub(super) fn rise_from(&self, i: usize, at: &Placement, heights: HeightRange) -> f64 {
        rise(self.equipment[i].heights.known_at(at.z), heights)
    }

    /// Returns a lower bound, m, of the distance in plan between the axis of the robot base and a point on a
    /// piece of equipment, over all layouts without an overlap of the two. The point is given in the frame of
    /// the equipment. `z` is the range of the height of this frame above the base frame, m.
    ///
    /// A strip whose sides are parallel to a side of one of the two floor spaces lies between them. The width
    /// of this strip is at least the required distance. The axis and the point are at least as far from the
    /// strip as from the border of their floor space. The bound is 0 if the equipment may stand above or
    /// below the base.
    pub fn least_distance_from_base(&self, equipment: usize, z: (f64, f64), point: PlanePoint) -> f64 {
        let room = self.room[equipment] + self.base_room;
        // The vertical distance is a convex function of the height, so it is greatest at an end of the range.
        let is_level = [z.0, z.1].iter().all(|z| {
            let [at, base] = [*z, 0.0].map(|z| Placement::from_values([0.0, 0.0, z, 0.0]));
            self.is_near(self.rise_from_base(equipment, &at, &base), room)
        });
        let axis = depth_of(&self.base, (0.0, 0.0));
        if !self.enabled || !is_level || axis < 0.0 {
            return 0.0;
        }
        let strip = self.wanted(room) - TOUCHING;
        (axis + strip + depth_of(&self.equipment[equipment].footprint, point)).max(0.0)
    }

    /// Returns whether a vertical distance, m, is below the clearance plus the extra distance `room`.
    fn is_near(&self, rise: f64, room: Room) -> bool {
        rise < self.clearance + room.height - TOUCHING
    }

    /// Returns the separation of every pair of floor spaces that includes movable equipment.
    ///
    /// Pairs that are apart in height are left out.
    pub fn separations(&self, layout: &Layout) -> Vec<Separation> {
        let mut pairs = Vec::new();
        let all = || self.equipment.iter().zip(&layout.placements).enumerate();
        let base = PlacedRectangle::new(&self.base, &layout.base);
        for (i, (stand, at)) in all().filter(|(_, (stand, _))| stand.role == Role::Equipment) {
            let here = stand.placed(at);
            let own = self.room[i];
            let mut note = |b: Option<usize>, there: &PlacedRectangle, rise: f64, room: Room| {
                if self.is_near(rise, room) {
                    let clearance = self.clearance + room.plan;
                    let AxisDepth { direction, depth } = least_overlap(&here, there, clearance);
                    pairs.push(Separation { a: i, b, direction, depth });
                }
            };
            for (j, (other, there)) in all() {
                let apart = !self.rides(i, j) && !self.rides(j, i);
                if apart && (j > i || other.role == Role::Obstacle) {
                    note(Some(j), &other.placed(there), self.rise((i, at), (j, there)), own + self.room[j]);
                }
            }
            note(None, &base, self.rise_from_base(i, at, &layout.base), own + self.base_room);
            for (keep_out, heights) in &self.keep_out {
                note(None, keep_out, self.rise_from(i, at, *heights), own);
            }
            if let Some(fence) = &self.fence {
                let sides = fence.separations(&here, self.clearance + own.plan);
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

    /// Writes all overlaps of a layout to `found`. An overlap of two obstacles is allowed and left out. An
    /// overlap of a piece of equipment with a piece that carries it is also left out.
    ///
    /// Each piece of equipment is checked against every other piece, the robot base, the keep-out boxes, the
    /// floor and the fence. The robot base is checked against the fence. Obstacles are allowed to reach into
    /// keep-out boxes and beyond the fence.
    pub fn overlaps(&self, layout: &Layout, found: &mut Vec<Overlap>) {
        found.clear();
        if !self.enabled {
            return;
        }
        let all = || self.equipment.iter().zip(&layout.placements).enumerate();
        let base = PlacedRectangle::new(&self.base, &layout.base);
        for (i, (stand, at)) in all() {
            let (party, own) = (Party::Equipment(i), self.room[i]);
            let here = stand.placed(at);
            let depth = |there: &PlacedRectangle, room: Room| overlap_depth(&here, there, self.wanted(room));
            for (j, (other, there)) in all().skip(i + 1) {
                let both_still = (stand.role, other.role) == (Role::Obstacle, Role::Obstacle);
                if !both_still && !self.rides(i, j) && !self.rides(j, i) {
                    let (rise, room) = (|| self.rise((i, at), (j, there)), own + self.room[j]);
                    let depth = depth(&other.placed(there), room);
                    found.extend(self.overlap((party, Party::Equipment(j)), depth, rise, room));
                }
            }
            let (rise, room) = (|| self.rise_from_base(i, at, &layout.base), own + self.base_room);
            found.extend(self.overlap((party, Party::RobotBase), depth(&base, room), rise, room));
            let keep_out = self.keep_out.iter().enumerate().filter(|_| stand.role == Role::Equipment);
            for (k, (box_plan, heights)) in keep_out {
                let rise = || self.rise_from(i, at, *heights);
                found.extend(self.overlap((party, Party::KeepOut(k)), depth(box_plan, own), rise, own));
            }
            let sunk = self.floor - (at.z + stand.heights.low);
            let floor = Overlap { a: party, b: Party::Floor, depth: sunk, clearance: 0.0, rise: 0.0 };
            found.extend((sunk > TOUCHING).then_some(floor));
            if let Some(fence) = self.fence.as_ref().filter(|_| stand.role == Role::Equipment) {
                let depth = fence.passed_by(&here, self.wanted(own));
                found.extend(self.overlap((party, Party::Fence), depth, fence_rise, own));
            }
        }
        if let Some(fence) = &self.fence {
            let room = self.base_room;
            let depth = fence.passed_by(&base, self.wanted(room));
            found.extend(self.overlap((Party::RobotBase, Party::Fence), depth, fence_rise, room));
        }
    }

    /// Returns the distance in plan that two floor spaces must keep, m.
    fn wanted(&self, room: Room) -> f64 {
        self.clearance + room.plan
    }

    /// Returns the overlap of two objects; None if they keep the clearance and the extra distance for
    /// misplacements.
    ///
    /// `depth` is their overlap in plan (m), including the clearance and the extra distance. `rise` computes
    /// their vertical distance (m).
    fn overlap(
        &self,
        (a, b): (Party, Party),
        depth: f64,
        rise: impl Fn() -> f64,
        room: Room,
    ) -> Option<Overlap> {
        let rise = if depth > TOUCHING { rise() } else { return None };
        let clearance = self.wanted(room);
        self.is_near(rise, room).then_some(Overlap { a, b, depth, clearance, rise: rise.max(0.0) })
    }
}

/// Extra distance, m, that a floor space keeps in addition to the clearance, because the object may be
/// misplaced.
#[derive(Debug, Clone, Copy)]
struct Room {
    plan: f64,
    height: f64,
}

impl Room {
    const NONE: Self = Self { plan: 0.0, height: 0.0 };

    /// Returns the extra distance for a piece of equipment. No point of its floor space moves farther than
    /// this distance.
    fn of_equipment(cell: &Cell, equipment: usize) -> Self {
        let (mut room, mut far, mut piece) =
            (Self::NONE, farthest(&cell.equipment[equipment].footprint), equipment);
        loop {
            let Equipment { tolerance, placement, on, .. } = &cell.equipment[piece];
            room = room.plus(tolerance, far);
            let Some(under) = on else { return room };
            let most = |axis: usize| placement[axis].range().0.abs().max(placement[axis].range().1.abs());
            far += most(0).hypot(most(1));
            piece = *under;
        }
    }

    /// Returns this distance plus the extra distance for a body with a placement tolerance. `far` is the
    /// distance of the farthest point from the origin of the body, m.
    fn plus(self, tolerance: &PlacementTolerance, far: f64) -> Self {
        let [x, y, z, yaw] = tolerance.0;
        Self { plan: self.plan + x.hypot(y) + far * yaw, height: self.height + z }
    }
}

impl std::ops::Add for Room {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { plan: self.plan + other.plan, height: self.height + other.height }
    }
}

/// Returns the distance of a point inside a rectangle from its border, m. If the point is outside, the result
/// is the negative distance of the point from the rectangle.
fn depth_of(r: &Rectangle, point: PlanePoint) -> f64 {
    let outside = |at: f64, centre: f64, size: f64| (at - centre).abs() - size / 2.0;
    let (x, y) = (outside(point.0, r.centre.0, r.size.0), outside(point.1, r.centre.1, r.size.1));
    if x.max(y) <= 0.0 { -x.max(y) } else { -x.max(0.0).hypot(y.max(0.0)) }
}

/// Returns the distance from the origin to the farthest point of a rectangle, m.
fn farthest(r: &Rectangle) -> f64 {
    (r.centre.0.abs() + r.size.0 / 2.0).hypot(r.centre.1.abs() + r.size.1 / 2.0)
}

/// Returns the vertical distance from the fence: negative infinity, because the fence occupies all heights.
fn fence_rise() -> f64 {
    f64::NEG_INFINITY
}
