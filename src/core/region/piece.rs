//! Region of one piece: outline in plan, ranges of z and yaw, and room (largest displacement in every
//! direction).

use super::outline::{Domain, Inside, TwoLattices};
use super::{MovableBody, Region, RegionEffort, RoomEnd, RoomScale};
use crate::cell::{Cell, Coordinate, Placement, Slot};
use crate::geometry::PlanePoint;
use crate::layout::{HeldLayout, HeldMemory, Moves, Uncarried};
use crate::units::{m_from_mm, rad_from_deg};
use std::f64::consts::{PI, TAU};

/// Largest displacement that is examined for a layout without search variables, mm.
const WINDOW_MM: f64 = 250.0;
/// Largest rotation that is examined for a layout without search variables, degrees.
const WINDOW_DEG: f64 = 15.0;
/// Largest number of steps of a scan, and of the fine lattice along the longer side of the domain. If the
/// range needs more steps, the steps become longer.
const MAX_STEPS: f64 = 10_000.0;
/// Number of bisection steps at the end of a scan.
const BISECTIONS: usize = 8;
/// Relative accuracy of an estimate of the room.
const ESTIMATE_SHARE: f64 = 0.02;
/// Threshold of the room, m. A room up to this value counts as 0. To find what limits a room, the piece is
/// displaced beyond the room by at least this distance.
const OVERSHOOT: f64 = 1e-4;
/// Factor by which the room is multiplied until the layout is accepted in all directions.
const SHRINK: f64 = 0.98;
/// Ratio of a test displacement to the room, before [`OVERSHOOT`] is added. The test displacement shows what
/// limits the room.
const BEYOND: f64 = 1.02;

/// Returns the bodies with a coordinate that the search varies over a range.
///
/// If no coordinate and no attitude angle is a search variable, the function returns the bodies with a
/// placement tolerance.
pub fn movable(cell: &Cell) -> Vec<MovableBody> {
    let bodies = [MovableBody::Base].into_iter().chain((0..cell.equipment.len()).map(MovableBody::Equipment));
    bodies.filter(|body| (0..4).any(|axis| domain(cell, *body, axis).is_some())).collect()
}

/// Returns the interval in which a coordinate of a body may lie, and the reason that limits the interval;
/// None if the coordinate may not vary over an interval.
fn domain(cell: &Cell, body: MovableBody, axis: usize) -> Option<((f64, f64), RoomEnd)> {
    let (coordinates, tolerance) = match body {
        MovableBody::Base => (&cell.base, &cell.base_tolerance),
        MovableBody::Equipment(k) => (&cell.equipment[k].placement, &cell.equipment[k].tolerance),
    };
    match coordinates[axis] {
        Coordinate::Range { min, max, .. } => Some(((min, max), RoomEnd::Range)),
        Coordinate::Fixed(at) if tolerance.0[axis] > 0.0 && cell.free().is_empty() => {
            let by = if axis == 3 { rad_from_deg(WINDOW_DEG) } else { m_from_mm(WINDOW_MM) };
            Some(((at - by, at + by), RoomEnd::Window))
        }
        _ => None,
    }
}

/// One piece of a layout, prepared for the computation of its region.
pub struct MovablePiece<'a> {
    held: &'a HeldLayout<'a>,
    /// Upper limit of the objective in the region.
    most: f64,
    body: MovableBody,
    /// Placement in the frame in which the cell file states it.
    own: Placement,
    effort: RegionEffort,
    /// Values of the operations that the piece does not carry. If given, every check of a placement begins
    /// with a cheap estimate from these values. The field is None for the robot base. It is also None if a
    /// check of a placement takes microseconds.
    uncarried: Option<Uncarried>,
}

impl<'a> MovablePiece<'a> {
    /// Prepares a body of a layout; in its region, the objective is at most `most`.
    pub fn new(held: &'a HeldLayout<'a>, most: f64, body: MovableBody) -> Self {
        let cell = &held.workcell().cell;
        let own = match body {
            MovableBody::Base => held.layout().base,
            MovableBody::Equipment(k) => cell.own_placement(held.layout(), k),
        };
        let effort = RegionEffort::of(held.workcell());
        let uncarried = match body {
            MovableBody::Equipment(k) if effort.is_dear() => held.uncarried(k, &mut HeldMemory::default()),
            _ => None,
        };
        Self { held, most, body, own, effort, uncarried }
    }

    /// Computes the region.
    pub fn region(&self) -> Region {
        let [z, yaw] = [2, 3].map(|axis| self.scan(axis));
        let turn = self.variable(3).map(|_| yaw.nearest(self.own.yaw));
        let mut rim = m_from_mm(self.effort.fine_mm);
        let (rings, room) = match (self.variable(0), self.variable(1)) {
            (Some(x), Some(y)) => {
                let lattices = self.lattices(Domain { x, y });
                rim = lattices.step;
                let rings = lattices.trace(self);
                let room = self.room(&rings);
                (rings, Some(room))
            }
            (None, None) => (Vec::new(), None),
            (x, _) => {
                let axis = if x.is_some() { 0 } else { 1 };
                let line = self.scan(axis);
                let end = |(at, _): &(f64, RoomEnd)| {
                    if axis == 0 { (*at, self.own.y) } else { (self.own.x, *at) }
                };
                (vec![vec![end(&line.low), end(&line.high)]], Some(line.nearest(self.own.values()[axis])))
            }
        };
        let ended = room.as_ref().or(turn.as_ref()).map_or(RoomEnd::Range, |(_, ended)| ended.clone());
        let world = self.carrier();
        let in_world = |p: &PlanePoint| {
            let at = world.carrying(&Placement { x: p.0, y: p.1, ..self.own });
            (at.x, at.y)
        };
        Region {
            body: self.body,
            rings: rings.iter().map(|ring| ring.iter().map(in_world).collect()).collect(),
            z: (z.low.0 + world.z, z.high.0 + world.z),
            yaw: (yaw.low.0 + world.yaw, yaw.high.0 + world.yaw),
            room: room.map(|(room, _)| room),
            turn: turn.map(|(turn, _)| turn),
            ended,
            rim,
        }
    }

    fn slot(&self, axis: usize) -> Slot {
        match self.body {
            MovableBody::Base => Slot::Base(axis),
            MovableBody::Equipment(k) => Slot::Equipment(k, axis),
        }
    }

    /// Returns the interval in which a coordinate may lie; None if the coordinate may not vary over an
    /// interval.
    fn variable(&self, axis: usize) -> Option<(f64, f64)> {
        domain(&self.held.workcell().cell, self.body, axis).map(|(interval, _)| interval)
    }

    /// Returns the world placement of the frame in which the cell file states the placement of the piece.
    fn carrier(&self) -> Placement {
        let under = match self.body {
            MovableBody::Base => None,
            MovableBody::Equipment(k) => self.held.workcell().cell.equipment[k].on,
        };
        under.map_or(Placement::from_values([0.0; 4]), |under| self.held.layout().placements[under])
    }

    /// Checks the layout with some coordinates of the piece changed. Each entry of `at` is an axis and its
    /// value, m or rad. Returns the objective of this layout.
    ///
    /// The result is an estimate if `uncarried` is given.
    fn judge(
        &self,
        at: &[(usize, f64)],
        uncarried: Option<&Uncarried>,
        memory: &mut HeldMemory,
    ) -> Result<f64, RoomEnd> {
        let (cell, layout) = (&self.held.workcell().cell, self.held.layout());
        let own = self.own.values();
        let moves: Moves = at.iter().map(|(axis, value)| (self.slot(*axis), value - own[*axis])).collect();
        let layout = cell.misplaced(layout, &moves);
        let judged = match (uncarried, &self.uncarried) {
            (Some(known), _) => self.held.estimate_moved(&layout, self.most, known, memory),
            (None, Some(known)) => self.held.judge_moved(&layout, self.most, known, memory),
            (None, None) => self.held.judge(&layout, self.most, memory),
        };
        judged.map_err(RoomEnd::Held)
    }

    /// Returns the interval around the found value of one coordinate in which the layout is accepted.
    fn scan(&self, axis: usize) -> Interval {
        let at = self.own.values()[axis];
        let Some((range, end)) = domain(&self.held.workcell().cell, self.body, axis) else {
            return Interval::point(at);
        };
        let RegionEffort { scan_deg, fine_mm, .. } = self.effort;
        let step = if axis == 3 { rad_from_deg(scan_deg) } else { m_from_mm(fine_mm) };
        let judge =
            |value: f64, memory: &mut HeldMemory| self.judge(&[(axis, value)], None, memory).map(|_| ());
        Interval::scanned(at, (range, end), step, judge)
    }

    fn lattices(&self, domain: Domain) -> TwoLattices {
        let longer = (domain.x.1 - domain.x.0).max(domain.y.1 - domain.y.0);
        let step = m_from_mm(self.effort.fine_mm).max(longer / MAX_STEPS);
        let coarse = ((longer / self.effort.divisions / step).floor() as i32).max(1);
        TwoLattices { domain, origin: (self.own.x, self.own.y), step, coarse }
    }

    /// Returns the radius, m, of a disc around the found placement, and the reason why it is not larger.
    ///
    /// The radius is first the distance from the found placement to the outline. It then shrinks until the
    /// layout is accepted in all checked directions.
    fn room(&self, rings: &[Vec<PlanePoint>]) -> (f64, RoomEnd) {
        let at = (self.own.x, self.own.y);
        let edges = rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        let nearest = edges.map(|(a, b)| nearest_on(a, b, &at));
        let Some(nearest) = nearest.min_by(|a, b| distance(a, &at).total_cmp(&distance(b, &at))) else {
            return (0.0, RoomEnd::Range);
        };
        let mut memory = HeldMemory::default();
        let heading = (nearest.1 - at.1).atan2(nearest.0 - at.0);
        let mut judged = |radius: f64| {
            let failed = (0..self.effort.directions).find_map(|k| {
                let turn = heading + TAU * k as f64 / self.effort.directions as f64;
                self.in_plan((at.0 + radius * turn.cos(), at.1 + radius * turn.sin()), None, &mut memory)
                    .err()
            });
            failed.map_or(Ok(()), Err)
        };
        let mut room = distance(&nearest, &at);
        let mut ended = judged(room * BEYOND + OVERSHOOT).err();
        while room > OVERSHOOT {
            match judged(room) {
                Ok(()) => return (room, ended.unwrap_or(RoomEnd::Range)),
                Err(why) => (room, ended) = (room * SHRINK, Some(why)),
            }
        }
        (0.0, ended.unwrap_or(RoomEnd::Range))
    }

    /// Checks the layout with the piece at a point in plan. If `uncarried` is given, the result is an
    /// estimate.
    fn in_plan(
        &self,
        at: PlanePoint,
        uncarried: Option<&Uncarried>,
        memory: &mut HeldMemory,
    ) -> Result<(), RoomEnd> {
        for (axis, value) in [(0, at.0), (1, at.1)] {
            match domain(&self.held.workcell().cell, self.body, axis) {
                Some(((min, max), end)) if !(min..=max).contains(&value) => return Err(end),
                _ => {}
            }
        }
        self.judge(&[(0, at.0), (1, at.1)], uncarried, memory).map(|_| ())
    }
}

impl MovablePiece<'_> {
    /// Estimates the room, m: the largest displacement that the layout allows in all tried directions. The
    /// estimate is at most the field `widest` of `scale`.
    ///
    /// Only single displacements are checked, not all smaller ones, so the estimate may exceed the room.
    pub fn estimated_room(&self, scale: &RoomScale, memory: &mut HeldMemory) -> f64 {
        let uncarried = match (scale.is_rough, self.body) {
            (true, MovableBody::Equipment(k)) => self.held.uncarried(k, memory),
            _ => None,
        };
        let is_free = [0, 1].map(|axis| self.variable(axis).is_some());
        let headings: Vec<f64> = match is_free {
            [true, true] => {
                (0..self.effort.estimated).map(|k| TAU * k as f64 / self.effort.estimated as f64).collect()
            }
            [true, false] => vec![0.0, PI],
            [false, true] => vec![PI / 2.0, -PI / 2.0],
            [false, false] => Vec::new(),
        };
        let mut room = scale.widest;
        for heading in headings {
            let mut holds = |radius: f64| {
                let at = (self.own.x + radius * heading.cos(), self.own.y + radius * heading.sin());
                self.in_plan(at, uncarried.as_ref(), memory).is_ok()
            };
            if holds(room) {
                continue;
            }
            let mut low = 0.0;
            while room - low > ESTIMATE_SHARE * room + OVERSHOOT {
                let middle = (low + room) / 2.0;
                match holds(middle) {
                    true => low = middle,
                    false => room = middle,
                }
            }
            room = low;
            if room < scale.poor {
                break;
            }
        }
        room
    }
}

impl Inside for MovablePiece<'_> {
    type Memory = HeldMemory;

    fn inside(&self, at: PlanePoint, memory: &mut HeldMemory) -> bool {
        self.in_plan(at, None, memory).is_ok()
    }
}

/// Interval around a found value in which the layout is accepted. Each end has the reason that limits the
/// interval.
pub struct Interval {
    pub low: (f64, RoomEnd),
    pub high: (f64, RoomEnd),
}

impl Interval {
    fn point(at: f64) -> Self {
        Self { low: (at, RoomEnd::Range), high: (at, RoomEnd::Range) }
    }

    /// Scans from `at` in steps towards both ends of a range, up to the first value at which `judge` fails.
    pub fn scanned(
        at: f64,
        (range, end): ((f64, f64), RoomEnd),
        step: f64,
        mut judge: impl FnMut(f64, &mut HeldMemory) -> Result<(), RoomEnd>,
    ) -> Self {
        let mut memory = HeldMemory::default();
        let step = step.max((range.1 - range.0) / MAX_STEPS);
        let mut side = |limit: f64| {
            let steps = ((limit - at).abs() / step).ceil() as usize;
            let value = |k: usize| if k == steps { limit } else { at + step.copysign(limit - at) * k as f64 };
            let failed = (1..=steps).find_map(|k| judge(value(k), &mut memory).err().map(|why| (k, why)));
            let Some((k, mut why)) = failed else { return (limit, end.clone()) };
            let (mut inside, mut outside) = (value(k - 1), value(k));
            for _ in 0..BISECTIONS {
                let middle = (inside + outside) / 2.0;
                match judge(middle, &mut memory) {
                    Ok(()) => inside = middle,
                    Err(reason) => (outside, why) = (middle, reason),
                }
            }
            (inside, why)
        };
        Self { low: side(range.0), high: side(range.1) }
    }

    /// Returns the distance from `at` to the nearer end, and the reason for that end.
    pub fn nearest(&self, at: f64) -> (f64, RoomEnd) {
        let off = |end: &(f64, RoomEnd)| (end.0 - at).abs();
        let nearer = if off(&self.low) <= off(&self.high) { &self.low } else { &self.high };
        (off(nearer), nearer.1.clone())
    }
}

/// Returns the point of the segment from `a` to `b` that is nearest to `p`.
fn nearest_on(a: &PlanePoint, b: &PlanePoint, p: &PlanePoint) -> PlanePoint {
    let along = (b.0 - a.0, b.1 - a.1);
    let length = (along.0 * along.0 + along.1 * along.1).max(f64::MIN_POSITIVE);
    let share = (((p.0 - a.0) * along.0 + (p.1 - a.1) * along.1) / length).clamp(0.0, 1.0);
    (a.0 + share * along.0, a.1 + share * along.1)
}

fn distance(a: &PlanePoint, b: &PlanePoint) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}
