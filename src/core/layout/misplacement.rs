//! Misplacements that are checked: points of the boxes of placement tolerances.

use crate::cell::{Cell, Equipment, Rectangle, Shape, Slot};

/// Coordinates of a layout that are misplaced, and by how much (m, rad).
pub type Moves = Vec<(Slot, f64)>;

/// Largest number of dimensions of a box whose corners are all checked; a larger box is checked body by body.
const MAX_WHOLE_BOX: usize = 8;

/// A point of a box: low (-1), middle (0) or high (1) in each dimension.
type BoxSigns = Vec<i8>;

/// Selection of points of a box.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum BoxPoints {
    Corners,
    /// Corners, and the middles of all edges and faces.
    Surface,
}

/// Boxes of placement tolerances, one for each body (robot base or piece of equipment) that has tolerances.
///
/// There are two groups: the boxes of the bodies on which one operation depends, and all other boxes.
///
/// An operation depends on the robot base, on its equipment and on the equipment that carries it. An
/// operation relative to a pick also depends on the equipment of the pick and its carriers.
pub struct ToleranceBoxes {
    /// One tolerance box for each body on which the operation depends.
    pub own: Vec<Moves>,
    /// One tolerance box for each body on which the operation does not depend.
    pub others: Vec<Moves>,
}

impl ToleranceBoxes {
    /// Separates the placement tolerances of the bodies on which an operation depends from those of all other
    /// bodies.
    pub fn of(cell: &Cell, operation: usize) -> Self {
        let operation = &cell.operations[operation];
        let pick = operation.relative_to.map(|pick| cell.operations[pick].equipment);
        let carriers: Vec<usize> = [Some(operation.equipment), pick].into_iter().flatten().collect();
        let carries = |body: &Moves| match body.first() {
            Some((Slot::Equipment(k, _), _)) => carriers.iter().any(|carrier| cell.rides_on(*carrier, *k)),
            _ => true,
        };
        let (own, others) = cell.placement_tolerances().into_iter().partition(carries);
        Self { own, others }
    }

    /// Returns the misplacements to check: points of all tolerance boxes, multiplied by `scale`.
    ///
    /// First the bodies that the operation depends on are misplaced: together, or one at a time if their box
    /// has more than [`MAX_WHOLE_BOX`] dimensions. Then every other body is misplaced alone, because it may
    /// get in the way.
    pub fn moves(&self, scale: f64, points: BoxPoints) -> Vec<Moves> {
        let own: Moves = self.own.concat();
        let mut all = match own.len() {
            0..=MAX_WHOLE_BOX => points_of(&own, scale, points),
            _ => self.own.iter().flat_map(|body| points_of(body, scale, points)).collect(),
        };
        all.extend(self.others.iter().flat_map(|body| points_of(body, scale, points)));
        all
    }

    /// Returns whether the bodies that the operation depends on are misplaced together, to every corner of
    /// their box.
    pub fn is_whole(&self) -> bool {
        self.own.concat().len() <= MAX_WHOLE_BOX
    }
}

/// Returns the selected points of one box, multiplied by `scale`; none if the box has no dimensions.
pub fn points_of(axes: &[(Slot, f64)], scale: f64, points: BoxPoints) -> Vec<Moves> {
    let n = axes.len();
    let wanted = |signs: &BoxSigns| {
        let middles = signs.iter().filter(|s| **s == 0).count();
        middles < n && (middles == 0 || points == BoxPoints::Surface && (middles == 1 || middles == n - 1))
    };
    let patterns = (0..3usize.pow(n as u32))
        .map(|pattern| (0..n).map(|k| [1, -1, 0][pattern / 3usize.pow(k as u32) % 3]).collect::<BoxSigns>());
    let moves =
        |s: BoxSigns| axes.iter().zip(s).map(|((slot, half), sign)| (*slot, scale * half * f64::from(sign)));
    patterns.filter(wanted).map(|signs| moves(signs).collect()).collect()
}

/// Returns the misplacements of one body, and of two bodies at once, that can make floor spaces overlap.
///
/// If both bodies of a pair reach down to the floor, the pair is misplaced only in plan, because neither body
/// can pass over the other.
pub fn overlapping_moves(cell: &Cell) -> Vec<Moves> {
    let bodies = cell.placement_tolerances();
    let alone = bodies.iter().flat_map(|body| points_of(body, 1.0, BoxPoints::Corners));
    let pairs = bodies.iter().enumerate().flat_map(|(k, a)| bodies[k + 1..].iter().map(move |b| (a, b)));
    let both = pairs.flat_map(|(a, b)| {
        let flat = on_floor(cell, a) && on_floor(cell, b);
        let kept = |body: &Moves| -> Moves {
            body.iter().filter(|(slot, _)| !(flat && is_height(*slot))).copied().collect()
        };
        let (a, b) = (kept(a), kept(b));
        match a.is_empty() || b.is_empty() {
            true => Vec::new(),
            false => points_of(&[a, b].concat(), 1.0, BoxPoints::Corners),
        }
    });
    alone.chain(both).collect()
}

/// Returns whether a body reaches down to the floor: the robot base, or equipment with legs or without solids.
///
/// Equipment that carries other equipment does not count, because what it carries moves with it.
fn on_floor(cell: &Cell, body: &Moves) -> bool {
    let Some((Slot::Equipment(k, _), _)) = body.first() else { return true };
    let carries = (0..cell.equipment.len()).any(|rider| rider != *k && cell.rides_on(rider, *k));
    let solids = &cell.equipment[*k].solids;
    !carries && (solids.is_empty() || solids.iter().any(|s| matches!(s.shape, Shape::Leg { .. })))
}

/// Returns the distance from the origin to the farthest point of a rectangle, m.
fn farthest(r: &Rectangle) -> f64 {
    (r.centre.0.abs() + r.size.0 / 2.0).hypot(r.centre.1.abs() + r.size.1 / 2.0)
}

fn is_height(slot: Slot) -> bool {
    matches!(slot, Slot::Base(2) | Slot::Equipment(_, 2))
}

/// Returns an upper bound of the distance, m, by which misplacements bring two floor spaces nearer together.
pub fn slack(cell: &Cell) -> f64 {
    let of =
        |tolerance: [f64; 4], far: f64| tolerance[0].hypot(tolerance[1]) + tolerance[2] + far * tolerance[3];
    let base = of(cell.base_tolerance.0, farthest(&cell.robot.footprint));
    let equipment = cell.equipment.iter().enumerate().map(|(k, e)| of(e.tolerance.0, farthest_on(cell, k)));
    base + equipment.sum::<f64>()
}

/// Returns an upper bound of the distance, m, from the origin of a piece of equipment to its farthest point
/// in plan.
///
/// The points of all equipment that stands on it count, too.
fn farthest_on(cell: &Cell, k: usize) -> f64 {
    let riders = cell.equipment.iter().enumerate().filter(|(_, e)| e.on == Some(k));
    let of = |(rider, e): (usize, &Equipment)| {
        let most = |axis: usize| e.placement[axis].range().0.abs().max(e.placement[axis].range().1.abs());
        most(0).hypot(most(1)) + farthest_on(cell, rider)
    };
    riders.map(of).fold(farthest(&cell.equipment[k].footprint), f64::max)
}
