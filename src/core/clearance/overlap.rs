//! Overlaps of floor spaces and distances below the clearance, with the messages that report them.

use crate::cell::Cell;
use crate::units::mm_from_m;

/// Rounding error of a sum of distances, m.
const ROUNDING: f64 = 1e-9;

/// Object that takes part in an overlap.
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

/// Overlap of two floor spaces, or a distance between them that is below the clearance.
///
/// If one object moves away from the other by `depth` (m) in plan, their distance becomes the clearance. If
/// `b` is the fence, `depth` is the clearance plus the distance by which `a` reaches beyond the fence. If `b`
/// is the floor, the move is upwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Overlap {
    pub a: Party,
    pub b: Party,
    pub depth: f64,
    /// Part of `depth` that is the required clearance, m.
    pub clearance: f64,
    /// Vertical distance between `a` and `b`, m; 0 if their height ranges overlap or if a height is not
    /// known.
    pub rise: f64,
}

impl Overlap {
    /// Returns whether the overlap concerns a piece of equipment.
    ///
    /// If the robot base reaches beyond the fence, the overlap concerns every piece of equipment.
    pub fn concerns(&self, equipment: usize) -> bool {
        let parties = [self.a, self.b];
        parties.contains(&Party::Equipment(equipment)) || parties == [Party::RobotBase, Party::Fence]
    }

    /// Describes the overlap with the names that the cell gives to its objects.
    ///
    /// If `a` and `b` do not overlap, the text states how near they are to each other.
    pub fn in_words(&self, cell: &Cell) -> String {
        let name = |party: Party| match party {
            Party::Equipment(i) => cell.equipment[i].name.clone(),
            Party::RobotBase => "the robot base".into(),
            Party::KeepOut(k) => format!("keep-out {}", cell.keep_out[k].name),
            Party::Floor => "the floor".into(),
            Party::Fence => "the fence".into(),
        };
        let (a, b) = (name(self.a), name(self.b));
        // Distance between the floor spaces in plan; negative if they overlap in plan.
        let aside = self.clearance - self.depth;
        let verb = if self.b == Party::Fence { "reaches beyond" } else { "overlaps" };
        if aside < 0.0 && self.rise == 0.0 {
            return format!("{a} {verb} {b} by {:.1} mm", mm_from_m(-aside));
        }
        let how = if self.rise > aside { "in height" } else { "along a side" };
        let (near, clearance) = (mm_from_m(self.rise.max(aside)), mm_from_m(self.clearance));
        // The distance and the clearance could look equal with one decimal.
        let near =
            if clearance - near < 0.05 { "just below".into() } else { format!("{near:.1} mm instead of") };
        // The placement tolerances enlarge the distance that is demanded.
        let with =
            if self.clearance > cell.clearance + ROUNDING { " with the placement tolerances" } else { "" };
        format!("{a} is nearer to {b} than the clearance{with}: {near} {clearance:.1} mm {how}")
    }
}
