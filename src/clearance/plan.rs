//! Floor space in plan: which equipment stands in another, in the robot's base or where it may not.

use super::fence;
use crate::cell::{Cell, Equipment, Fence, KeepOut, Layout, Placement, Rectangle, Role, Shape, extent};
use crate::units::mm_from_m;

/// Who takes part in an overlap.
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

/// Two parties share floor space; pulling them apart takes `depth` (m), clearance included. Of the fence:
/// the first stands outside it by `depth`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    pub a: Party,
    pub b: Party,
    pub depth: f64,
}

/// How two floor spaces lie to each other: `a` leaves `b` fastest along `direction` (unit, plan),
/// by `depth` (m; negative if they are apart already).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Separation {
    pub a: usize,
    pub b: Option<usize>,
    pub direction: (f64, f64),
    pub depth: f64,
}

/// Things that stand side by side touch, m: rounding must not make that an overlap.
const TOUCHING: f64 = 1e-9;

impl Overlap {
    /// Whether this equipment takes part; a robot that stands outside the fence concerns all.
    pub fn concerns(&self, equipment: usize) -> bool {
        let parties = [self.a, self.b];
        parties.contains(&Party::Equipment(equipment)) || parties == [Party::RobotBase, Party::Fence]
    }

    /// In words, with the names of the cell.
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

/// A rectangle placed in plan: centre, half size, directions of its sides.
#[derive(Clone, Copy)]
pub(super) struct Placed {
    centre: (f64, f64),
    half: (f64, f64),
    cos: f64,
    sin: f64,
}

impl Placed {
    pub(super) fn new(rectangle: &Rectangle, at: &Placement) -> Self {
        let (sin, cos) = at.yaw.sin_cos();
        let (x, y) = rectangle.centre;
        Self {
            centre: (at.x + cos * x - sin * y, at.y + sin * x + cos * y),
            half: (rectangle.size.0 / 2.0, rectangle.size.1 / 2.0),
            cos,
            sin,
        }
    }

    pub(super) fn corners(&self) -> [(f64, f64); 4] {
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(|(i, j)| {
            let (x, y) = (i * self.half.0, j * self.half.1);
            (self.centre.0 + self.cos * x - self.sin * y, self.centre.1 + self.sin * x + self.cos * y)
        })
    }

    /// Half the width of the shadow on the unit direction (ux, uy).
    fn shadow(&self, (ux, uy): (f64, f64)) -> f64 {
        self.half.0 * (self.cos * ux + self.sin * uy).abs()
            + self.half.1 * (self.cos * uy - self.sin * ux).abs()
    }
}

/// Directions of the sides of two rectangles: the separating axes.
fn axes(a: &Placed, b: &Placed) -> [(f64, f64); 4] {
    [(a.cos, a.sin), (-a.sin, a.cos), (b.cos, b.sin), (-b.sin, b.cos)]
}

/// The sense of an axis from `b` to `a`, and by how much less than `clearance` they are apart along it.
fn along(u: (f64, f64), a: &Placed, b: &Placed, clearance: f64) -> ((f64, f64), f64) {
    let apart = (a.centre.0 - b.centre.0) * u.0 + (a.centre.1 - b.centre.1) * u.1;
    let towards = if apart < 0.0 { (-u.0, -u.1) } else { u };
    (towards, a.shadow(u) + b.shadow(u) + clearance - apart.abs())
}

/// Along which unit direction (from `b` to `a`) two rectangles are best apart, and by how much less
/// than `clearance` (negative: more). At corners this asks for a little more than the clearance, never
/// for less.
fn best_separated(a: &Placed, b: &Placed, clearance: f64) -> ((f64, f64), f64) {
    let shallower =
        |best: ((f64, f64), f64), next: ((f64, f64), f64)| if next.1 < best.1 { next } else { best };
    let all = axes(a, b).into_iter().map(|u| along(u, a, b, clearance));
    all.fold(((1.0, 0.0), f64::INFINITY), shallower)
}

/// How deep two rectangles overlap when each keeps `clearance`, or 0: the first axis along which they
/// do not settles it.
pub(super) fn depth(a: &Placed, b: &Placed, clearance: f64) -> f64 {
    let mut least = f64::INFINITY;
    for u in axes(a, b) {
        least = least.min(along(u, a, b, clearance).1);
        if least <= 0.0 {
            return 0.0;
        }
    }
    least
}

/// The fence, made ready once.
struct Bounds {
    corners: Vec<(f64, f64)>,
    /// Its edges, as rectangles of no width.
    edges: Vec<Placed>,
    is_convex: bool,
}

impl Bounds {
    fn new(fence: &Fence) -> Self {
        let corners = &fence.corners;
        let edge = |k: usize| {
            let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
            let length = (b.0 - a.0).hypot(b.1 - a.1);
            let (cos, sin) = ((b.0 - a.0) / length, (b.1 - a.1) / length);
            Placed { centre: ((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0), half: (length / 2.0, 0.0), cos, sin }
        };
        Self {
            edges: (0..corners.len()).map(edge).collect(),
            is_convex: fence::is_convex(corners),
            corners: corners.clone(),
        }
    }

    /// How far a floor space passes the fence (m): its farthest corner outside, or what an edge reaches
    /// into it; 0 if it stands inside by the clearance.
    fn passed_by(&self, stand: &Placed, clearance: f64) -> f64 {
        let outside = stand.corners().map(|corner| match fence::place(&self.corners, corner) {
            (true, _) => 0.0,
            (false, by) => by + clearance,
        });
        let edges = self.edges.iter().map(|edge| depth(stand, edge, clearance));
        outside.into_iter().chain(edges).fold(0.0, f64::max)
    }

    /// The way into a convex fence from each of its edges, and how much of it is missing (m).
    fn separations(&self, stand: &Placed, clearance: f64) -> impl Iterator<Item = ((f64, f64), f64)> {
        let edges = if self.is_convex { &self.edges[..] } else { &[] };
        edges.iter().map(move |edge| {
            let inwards = (-edge.sin, edge.cos);
            let apart =
                (stand.centre.0 - edge.centre.0) * inwards.0 + (stand.centre.1 - edge.centre.1) * inwards.1;
            (inwards, stand.shadow(inwards) + clearance - apart)
        })
    }
}

/// What the floor plan knows of an equipment.
pub(super) struct Stand {
    footprint: Rectangle,
    role: Role,
    /// Lowest and highest point of the solids and the surface over the equipment's frame, m.
    low: f64,
    high: f64,
    /// Legs take the space down to the floor.
    legs: bool,
    /// Where the cell as drawn has it, as obstacles always stand, and its footprint there.
    drawn: (Placement, Placed),
}

impl Stand {
    /// Its footprint at a placement.
    fn placed(&self, at: &Placement) -> Placed {
        if *at == self.drawn.0 { self.drawn.1 } else { Placed::new(&self.footprint, at) }
    }

    /// Whether an equipment placed at height `z` reaches into a box between two heights.
    pub(super) fn meets(&self, z: f64, (bottom, top): (f64, f64), clearance: f64) -> bool {
        let above = !self.legs && z + self.low >= top + clearance - TOUCHING;
        let below = z + self.high + clearance <= bottom + TOUCHING;
        !(above || below)
    }
}

/// The floor space of a cell, made ready once.
pub struct FloorPlan {
    pub(super) equipment: Vec<Stand>,
    /// What each stands on.
    on: Vec<Option<usize>>,
    base: Rectangle,
    pub(super) keep_out: Vec<(Placed, (f64, f64))>,
    clearance: f64,
    floor: f64,
    fence: Option<Bounds>,
    pub(super) enabled: bool,
}

impl FloorPlan {
    pub fn new(cell: &Cell) -> Self {
        let stand = |(e, at): (&Equipment, Placement)| {
            let heights = || e.solids.iter().map(|s| extent(&s.shape)).map(|(lo, hi)| (lo.z, hi.z));
            Stand {
                footprint: e.footprint,
                role: e.role,
                low: heights().map(|h| h.0).fold(0.0, f64::min),
                high: heights().map(|h| h.1).fold(0.0, f64::max),
                legs: e.solids.iter().any(|s| matches!(s.shape, Shape::Leg { .. })),
                drawn: (at, Placed::new(&e.footprint, &at)),
            }
        };
        Self {
            equipment: cell.equipment.iter().zip(cell.start().placements).map(stand).collect(),
            base: cell.robot.footprint,
            on: cell.equipment.iter().map(|e| e.on).collect(),
            keep_out: cell.keep_out.iter().map(|k| (plan_of(k), (k.min.z, k.max.z))).collect(),
            clearance: cell.clearance,
            floor: cell.floor,
            fence: cell.fence.as_ref().map(Bounds::new),
            enabled: cell.collision,
        }
    }

    /// Whether one equipment stands on another.
    fn rides(&self, equipment: usize, other: usize) -> bool {
        self.on[equipment].is_some_and(|under| under == other || self.rides(under, other))
    }

    /// Every pair of floor spaces of which the layout may move one, whether it overlaps or not; a
    /// partner that stands still is None.
    pub fn separations(&self, layout: &Layout) -> Vec<Separation> {
        let mut pairs = Vec::new();
        let all = || self.equipment.iter().zip(&layout.placements).enumerate();
        for (i, (stand, at)) in all().filter(|(_, (stand, _))| stand.role == Role::Equipment) {
            let here = stand.placed(at);
            let mut note = |b: Option<usize>, there: &Placed| {
                let (direction, depth) = best_separated(&here, there, self.clearance);
                pairs.push(Separation { a: i, b, direction, depth });
            };
            for (j, (other, there)) in all() {
                let apart = !self.rides(i, j) && !self.rides(j, i);
                if apart && (j > i || other.role == Role::Obstacle) {
                    note(Some(j), &other.placed(there));
                }
            }
            note(None, &Placed::new(&self.base, &layout.base));
            for (keep_out, heights) in &self.keep_out {
                if stand.meets(at.z, *heights, self.clearance) {
                    note(None, keep_out);
                }
            }
            if let Some(fence) = &self.fence {
                let sides = fence.separations(&here, self.clearance);
                pairs.extend(sides.map(|(direction, depth)| Separation { a: i, b: None, direction, depth }));
            }
        }
        pairs
    }

    /// All overlaps of a layout into `found`: per equipment with those after it, the robot base,
    /// the keep-out boxes and the floor. Two obstacles may overlap.
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
        let base = Placed::new(&self.base, &layout.base);
        for (i, (stand, at)) in all() {
            let party = Party::Equipment(i);
            let here = stand.placed(at);
            for (j, (other, there)) in all().skip(i + 1) {
                let both_still = (stand.role, other.role) == (Role::Obstacle, Role::Obstacle);
                if !both_still && !self.rides(i, j) && !self.rides(j, i) {
                    note(party, Party::Equipment(j), depth(&here, &other.placed(there), clearance));
                }
            }
            note(party, Party::RobotBase, depth(&here, &base, clearance));
            for (k, (box_plan, heights)) in self.keep_out.iter().enumerate() {
                if stand.meets(at.z, *heights, clearance) {
                    note(party, Party::KeepOut(k), depth(&here, box_plan, clearance));
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

pub(super) fn plan_of(keep_out: &KeepOut) -> Placed {
    let (lo, hi) = (keep_out.min, keep_out.max);
    Placed {
        centre: ((lo.x + hi.x) / 2.0, (lo.y + hi.y) / 2.0),
        half: ((hi.x - lo.x) / 2.0, (hi.y - lo.y) / 2.0),
        cos: 1.0,
        sin: 0.0,
    }
}
