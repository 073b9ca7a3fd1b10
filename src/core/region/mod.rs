//! Regions: the alternative placements of each piece of a found layout.
//!
//! A placement belongs to the region of a piece if two conditions hold. The layout must stay feasible and
//! within every limit at all misplacements within the placement tolerances. The objective may grow by at most
//! the indifference. All other pieces keep their placements. Every operation keeps its branch, and its spot
//! on its equipment ([`HeldLayout`]).
//!
//! The room of a piece is the largest distance by which it may be displaced in every direction in plan.
//!
//! A cell file without search variables, such as a layout that a search wrote, also has regions. In this
//! case, every piece with a placement tolerance has a region within a window around its placement.
//!
//! | file | content |
//! |---|---|
//! | `effort` | resolution of a region |
//! | `outline` | outline of a region in plan |
//! | `piece` | region of one piece |
//! | `standing` | placements of a piece that a user moves by hand |
//! | `whole_cell` | rotation of all pieces about the base axis |

mod effort;
mod outline;
mod piece;
mod standing;
mod whole_cell;

pub use effort::RegionEffort;
pub use outline::{Domain, Inside, TwoLattices};
pub use standing::standing;
pub use whole_cell::WholeTurn;

use crate::cell::{Cell, Coordinate, Layout};
use crate::geometry::PlanePoint;
use crate::layout::{Ending, HeldLayout, HeldMemory, Workcell};
use rayon::prelude::*;

/// Body that can have a region: the robot base or a piece of equipment.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MovableBody {
    Base,
    /// Piece of equipment, given by its index in the cell.
    Equipment(usize),
}

impl MovableBody {
    /// Returns the name of this body as it appears in documents and pictures, for example `robot base`.
    pub fn name(self, cell: &Cell) -> &str {
        match self {
            Self::Base => "robot base",
            Self::Equipment(k) => &cell.equipment[k].name,
        }
    }
}

/// Reason why the room of a piece, or the range of a rotation, is not larger. The room is the largest
/// distance by which the piece may be displaced in every direction in plan. The rotation is a rotation of one
/// piece, or of all pieces together ([`WholeTurn`]).
#[derive(Debug, Clone, PartialEq)]
pub enum RoomEnd {
    /// A piece reaches an end of the range of a search variable. This is also the value if the computation
    /// finds no reason.
    Range,
    /// The piece reaches the edge of the window that is examined around the found placement. If all pieces
    /// rotate together, the window extends half a revolution in each direction.
    Window,
    Held(Ending),
}

impl RoomEnd {
    /// Describes the reason in words, with names from the cell. The text continues the words "limited by".
    pub fn in_words(&self, cell: &Cell) -> String {
        match self {
            Self::Range => "the range of the search".into(),
            Self::Window => "nothing within the examined range".into(),
            Self::Held(ending) => ending.in_words(cell),
        }
    }
}

/// Region of one piece: the placements in the world frame at which the layout remains feasible and within
/// every limit.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    pub body: MovableBody,
    /// Closed rings in plan, m; a point is inside if it lies in an odd number of rings. If only x or only y
    /// may vary ([`Self::room`]), the ring is a line of two points. The list is empty if neither x nor y may
    /// vary.
    pub rings: Vec<Vec<PlanePoint>>,
    /// Interval of z (world frame, m) around the found value. The piece remains in its region everywhere in
    /// this interval if no other coordinate changes.
    pub z: (f64, f64),
    /// Interval of the yaw (world frame, rad) around the found value. The piece remains in its region
    /// everywhere in this interval if no other coordinate changes.
    pub yaw: (f64, f64),
    /// Largest distance, m, by which the piece may be displaced in every direction in plan. If only x or only
    /// y may vary, only the two directions along this axis count. None if neither x nor y may vary.
    ///
    /// A coordinate may vary if the search varies it over a range. In a cell without search variables, a
    /// coordinate with a placement tolerance may vary within a window.
    pub room: Option<f64>,
    /// Largest angle, rad, by which the piece may be rotated in either direction. None if the yaw is not a
    /// coordinate that may vary ([`Self::room`]).
    pub turn: Option<f64>,
    /// Reason why [`Self::room`] is not larger. If neither x nor y may vary, this is the reason why
    /// [`Self::turn`] is not larger. If only z may vary, the value is [`RoomEnd::Range`].
    pub ended: RoomEnd,
    /// Width of the rim, m. The rim is a zone along the outline in which the computation can miss details of
    /// the region.
    pub rim: f64,
}

/// Regions of a layout.
#[derive(Debug, Clone, PartialEq)]
pub struct Regions {
    /// Regions of the pieces with a coordinate that the search varies over a range. A cell without search
    /// variables has a region for each piece with a placement tolerance.
    pub pieces: Vec<Region>,
    /// Angles by which the pieces may be rotated as one body about the base axis. Only pieces whose x, y and
    /// yaw have ranges are rotated. If equipment stands on other equipment, the lowest piece of the stack
    /// must have these ranges. None if x, y or yaw of the equipment under an operation has no range.
    pub whole: Option<WholeTurn>,
}

impl Regions {
    /// Computes the regions of a layout. In a region, the objective grows by at most the indifference of the
    /// cell.
    ///
    /// The result is None if the layout is not feasible or misses a limit.
    pub fn new(workcell: &Workcell, layout: &Layout) -> Option<Self> {
        let held = HeldLayout::new(workcell, layout)?;
        let most = held.objective * (1.0 + workcell.cell.search.indifference);
        let bodies = piece::movable(&workcell.cell);
        let region = |body| piece::MovablePiece::new(&held, most, body).region();
        let (pieces, whole) =
            rayon::join(|| bodies.into_par_iter().map(region).collect(), || whole_cell::turn(&held, most));
        Some(Self { pieces, whole })
    }
}

/// Settings of an estimate of the room of a layout ([`estimated_room`]).
pub struct RoomScale {
    /// Room below which the estimate need not be accurate, m.
    pub poor: f64,
    /// Upper limit of the estimated room, m.
    pub widest: f64,
    /// Whether the estimate checks only operations that move with the displaced piece of equipment. Such an
    /// estimate is several times faster.
    pub is_rough: bool,
}

/// Estimates the room of a layout, m: the least of the rooms of all pieces.
///
/// Every operation keeps its spot, and the objective may grow by the indifference of the cell.
pub fn estimated_room(held: &HeldLayout<'_>, scale: &RoomScale, memory: &mut HeldMemory) -> f64 {
    let cell = &held.workcell().cell;
    let most = held.objective * (1.0 + cell.search.indifference);
    let pieces = piece::movable(cell).into_iter().map(|body| piece::MovablePiece::new(held, most, body));
    let mut room = scale.widest;
    for piece in pieces {
        room = piece.estimated_room(&RoomScale { widest: room, ..*scale }, memory);
        if room < scale.poor {
            break;
        }
    }
    room
}

/// Returns whether x or y of the robot base or of any equipment has a range. A list of values does not count
/// as a range.
pub fn can_move(cell: &Cell) -> bool {
    let in_plan = |c: &[Coordinate; 4]| c[..2].iter().any(|c| matches!(c, Coordinate::Range { .. }));
    in_plan(&cell.base) || cell.equipment.iter().any(|e| in_plan(&e.placement))
}
