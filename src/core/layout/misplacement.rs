//! Misplacements that are checked: points of the boxes of placement tolerances.

use crate::cell::{Cell, Slot};

/// Coordinates of a layout, each with a signed misplacement or the half width of a tolerance (m or rad).
pub type Moves = Vec<(Slot, f64)>;

/// Largest number of dimensions of a box whose corners are all checked. A larger box is checked body by
/// body.
const MAX_WHOLE_BOX: usize = 8;

/// Point of a box: low (-1), middle (0) or high (1) in each dimension.
type BoxSigns = Vec<i8>;

/// Selection of points of a box.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum BoxPoints {
    Corners,
    /// Corners of the box, and the middles of its edges and facets, without the centre of the box.
    ///
    /// A facet of a box with n dimensions has n - 1 dimensions. The middles of faces with 2 to n - 2
    /// dimensions are left out. Such faces exist from n = 4 on.
    Surface,
}

/// Boxes of placement tolerances, one for each body (robot base or piece of equipment) that has tolerances.
///
/// There are two groups: the boxes of the bodies on which one operation depends, and all other boxes.
///
/// An operation depends on the robot base, on its own equipment, and on the equipment that carries this
/// equipment. An operation relative to a pick also depends on the equipment of the pick and its carriers.
pub struct ToleranceBoxes {
    /// One tolerance box for each body on which the operation depends.
    pub own: Vec<Moves>,
    /// One tolerance box for each body on which the operation does not depend.
    pub others: Vec<Moves>,
}

impl ToleranceBoxes {
    /// Separates the placement tolerances of the bodies on which an operation depends from the placement
    /// tolerances of all other bodies.
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
    /// The bodies on which the operation depends are misplaced first. These bodies are misplaced all
    /// together, or one at a time if their common box has more than [`MAX_WHOLE_BOX`] dimensions. Then every
    /// other body is misplaced alone, because this body may obstruct the robot.
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

/// Returns the selected points of one box, multiplied by `scale`. The list is empty if the box has no
/// dimensions.
fn points_of(axes: &[(Slot, f64)], scale: f64, points: BoxPoints) -> Vec<Moves> {
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
