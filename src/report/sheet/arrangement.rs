//! Paper, scale and places of the two views on a sheet.

use super::{Bounds, SheetView, size};
use crate::cell::Projection;

/// Scales of ISO 5455; the entry `n` means 1:n.
pub const SCALES: [f64; 13] = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1e3, 2e3, 5e3, 1e4];
/// Paper formats of ISO 216: name, width and height, mm. Smaller formats come first.
const PAPERS: [Paper; 4] = [
    Paper { name: "A4", width: 297.0, height: 210.0 },
    Paper::A4,
    Paper::A3,
    Paper { name: "A3", width: 297.0, height: 420.0 },
];
/// Margin at the left of the frame, with space for holes (ISO 5457), mm.
pub const FILING_MARGIN: f64 = 20.0;
/// Margin at the right, the top and the bottom of the frame (ISO 5457), mm.
pub const MARGIN: f64 = 10.0;
/// Width and height of the title block (ISO 7200), mm. The block is as wide as the frame of an upright A4.
pub const BLOCK: (f64, f64) = (210.0 - FILING_MARGIN - MARGIN, 40.0);
/// Distance between the frame and its content, mm.
const INSIDE: f64 = 5.0;
/// Height of the heading of a view, mm.
pub const HEADING: f64 = 7.0;
/// Height of the scale bar with the axes, mm.
const BAR: f64 = 15.0;
/// Distance from a view and its dimension lines to the heading of the view below, mm.
const VIEW_GAP: f64 = 4.0;

/// Format of a sheet, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paper {
    pub name: &'static str,
    pub width: f64,
    pub height: f64,
}

impl Paper {
    /// A4 in portrait orientation.
    pub const A4: Self = Self { name: "A4", width: 210.0, height: 297.0 };

    /// A3 in landscape orientation.
    pub const A3: Self = Self { name: "A3", width: 420.0, height: 297.0 };

    fn is_upright(&self) -> bool {
        self.height > self.width
    }

    /// Returns the top left corner of the title block on the paper, mm.
    pub fn block(&self) -> (f64, f64) {
        (self.width - MARGIN - BLOCK.0, self.height - MARGIN - BLOCK.1)
    }
}

/// Sizes for which the sheet must have space.
pub struct Needs {
    /// Bounds of the plan and of the front view; both have the same range of x, m.
    pub plan: Bounds,
    pub front: Bounds,
    /// Space for dimension lines left of and below the plan, and left of the front view, mm.
    pub below: f64,
    pub beside: f64,
    /// Height of the list of placements, mm.
    pub list: f64,
}

/// Sheet with the places of its views.
pub struct Arrangement {
    pub paper: Paper,
    /// Scale 1:ratio.
    pub ratio: f64,
    pub plan: SheetView,
    pub front: SheetView,
    /// Top left corner of the list, and its height, mm.
    pub list: (f64, f64, f64),
    /// Top left corner of the scale bar, mm.
    pub bar: (f64, f64),
}

/// Returns the arrangement with the largest scale that fits on A3. The paper is the smallest on which this
/// scale fits.
pub fn arranged(needs: &Needs, projection: Projection) -> Arrangement {
    let last = SCALES[SCALES.len() - 1];
    let fits = |ratio: f64| PAPERS.into_iter().find(|paper| fits(needs, paper, ratio));
    let found = SCALES.into_iter().find_map(|ratio| Some((fits(ratio)?, ratio)));
    let (paper, ratio) = found.unwrap_or((PAPERS[2], last));
    placed(needs, paper, ratio, projection)
}

/// Returns the size of both views with headings and dimension lines, mm.
fn stack(needs: &Needs, ratio: f64) -> (f64, f64) {
    let (plan, front) = (size(&needs.plan, ratio), size(&needs.front, ratio));
    (needs.beside + plan.0.max(front.0), 2.0 * HEADING + front.1 + VIEW_GAP + plan.1 + needs.below + BAR)
}

/// Returns the space for the views, mm.
fn room(paper: &Paper, list: f64) -> (f64, f64) {
    let inside =
        (paper.width - FILING_MARGIN - MARGIN - 2.0 * INSIDE, paper.height - 2.0 * (MARGIN + INSIDE));
    match paper.is_upright() {
        true => (inside.0, inside.1 - BLOCK.1 - list),
        false => (inside.0 - BLOCK.0, inside.1),
    }
}

fn fits(needs: &Needs, paper: &Paper, ratio: f64) -> bool {
    let (wide, high) = stack(needs, ratio);
    let room = room(paper, needs.list);
    let listed = paper.height - 2.0 * (MARGIN + INSIDE) - BLOCK.1;
    wide <= room.0 && high <= room.1 && needs.list <= listed
}

fn placed(needs: &Needs, paper: Paper, ratio: f64, projection: Projection) -> Arrangement {
    let (left, top) = (FILING_MARGIN + INSIDE + needs.beside, MARGIN + INSIDE);
    let (plan, front) = (size(&needs.plan, ratio), size(&needs.front, ratio));
    let (wide, high) = stack(needs, ratio);
    let room = room(&paper, needs.list);
    // The views are centred horizontally. A third of the free height is above the views.
    let left = left + ((room.0 - wide) / 2.0).max(0.0);
    let top = top + ((room.1 - high) / 3.0).max(0.0);
    let (front_top, plan_top) = match projection {
        Projection::FirstAngle => (top + HEADING, top + 2.0 * HEADING + front.1 + VIEW_GAP),
        Projection::ThirdAngle => (top + 2.0 * HEADING + plan.1 + needs.below + VIEW_GAP, top + HEADING),
    };
    let view = |bounds: &Bounds, top: f64| {
        let high = size(bounds, ratio).1;
        SheetView { low: bounds.0, high: bounds.1, left, bottom: top + high, ratio }
    };
    let block = paper.block();
    let list = match paper.is_upright() {
        true => (block.0, block.1 - needs.list, needs.list),
        false => (block.0, MARGIN + INSIDE, (block.1 - MARGIN - 2.0 * INSIDE).min(needs.list)),
    };
    let lowest = (plan_top + plan.1 + needs.below).max(front_top + front.1);
    Arrangement {
        paper,
        ratio,
        plan: view(&needs.plan, plan_top),
        front: view(&needs.front, front_top),
        list,
        bar: (left, lowest),
    }
}
