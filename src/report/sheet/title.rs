//! Frame and title block of a sheet (ISO 5457, ISO 7200).

use super::arrangement::{BLOCK, FILING_MARGIN, MARGIN, Paper};
use super::ink::{TextAnchor, TextStyle, put, stroke};
use crate::cell::{Cell, Projection};
use crate::drawing::Drawing;
use crate::files::shown;
use std::fmt::Write;

/// Colour of lines and texts.
pub const BLACK: &str = "#000000";

/// Position of a sheet in a set: the number of the sheet and the total number of sheets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SheetNumber {
    pub number: usize,
    pub count: usize,
}

impl SheetNumber {
    /// Position of a single sheet.
    pub const ALONE: Self = Self { number: 1, count: 1 };

    pub fn in_words(self) -> String {
        format!("{}/{}", self.number, self.count)
    }
}

/// Entries of a title block that do not come from the cell file.
pub struct BlockEntries<'a> {
    pub cell: &'a Cell,
    pub sheet: SheetNumber,
    /// Kind of document and layout, for example "set-out drawing, best layout".
    pub kind: String,
    /// Scale, for example "1:20".
    pub scale: String,
    /// Remarks on the content of the sheet; at most three.
    pub notes: Vec<String>,
}

/// Field of the title block: place, label and text. The place is x and y of the upper left corner, then width
/// and height, mm. The origin is the upper left corner of the block, and y points down.
pub type BlockField = ([f64; 4], &'static str, String);

/// Returns the title of the drawings of a cell.
pub fn title(cell: &Cell) -> &str {
    cell.title_block.title.as_deref().unwrap_or(&cell.name)
}

/// Returns the name of a layout as it appears on drawings.
pub fn layout_name(name: &str) -> String {
    match name {
        "best" => "best layout".into(),
        "start" => "layout as drawn".into(),
        other => shown(other),
    }
}

/// Returns the kind of a set-out drawing for its title block. The text begins with a warning if the layout is
/// not feasible or misses a limit.
pub fn kind_of_set_out(drawing: &Drawing<'_>) -> String {
    let mark = match (drawing.is_feasible, drawing.meets_limits) {
        (false, _) => "NOT FEASIBLE, DO NOT BUILD: ",
        (true, false) => "A LIMIT IS NOT MET: ",
        (true, true) => "",
    };
    format!("{mark}set-out drawing, {}", layout_name(&drawing.name))
}

/// Returns the fields of the title block.
pub fn block_fields(entries: &BlockEntries<'_>, paper: &Paper) -> Vec<BlockField> {
    let given = &entries.cell.title_block;
    let text = |entry: &Option<String>| entry.clone().unwrap_or_default();
    vec![
        ([0.0, 0.0, 62.0, 9.0], "owner", text(&given.owner)),
        ([62.0, 0.0, 44.0, 9.0], "author", text(&given.author)),
        ([106.0, 0.0, 44.0, 9.0], "approved by (signature)", text(&given.approved_by)),
        ([150.0, 0.0, 30.0, 9.0], "date of issue", text(&given.date)),
        ([0.0, 9.0, 106.0, 18.0], "title", String::new()),
        ([106.0, 9.0, 44.0, 9.0], "number", text(&given.number)),
        ([150.0, 9.0, 15.0, 9.0], "revision", text(&given.revision)),
        ([165.0, 9.0, 15.0, 9.0], "sheet", entries.sheet.in_words()),
        ([106.0, 18.0, 22.0, 9.0], "scale", entries.scale.clone()),
        ([128.0, 18.0, 22.0, 9.0], "format", paper.name.into()),
        ([150.0, 18.0, 30.0, 9.0], "general tolerance", text(&given.general_tolerance)),
        ([150.0, 27.0, 30.0, 13.0], "projection", String::new()),
    ]
}

/// Draws the frame of a sheet, with its title block at the lower right corner.
pub fn block(out: &mut String, paper: &Paper, entries: &BlockEntries<'_>) {
    let frame = format!(
        "M{FILING_MARGIN} {MARGIN}H{}V{}H{FILING_MARGIN}Z",
        paper.width - MARGIN,
        paper.height - MARGIN
    );
    stroke(out, &frame, BLACK, 0.7);
    let (left, top) = paper.block();
    // The frame of the sheet is also the right and lower edge of the block.
    stroke(out, &format!("M{left} {}V{top}h{}", top + BLOCK.1, BLOCK.0), BLACK, 0.5);
    for field in &block_fields(entries, paper) {
        draw_field(out, (left, top), field);
    }
    stroke(out, &format!("M{left} {}h{}", top + 27.0, BLOCK.0), BLACK, 0.35);
    let (heading, kind) = (title(entries.cell), &entries.kind);
    let style = TextStyle::plain(5.0).bold().fitted(heading, 102.0);
    put(out, (left + 2.0, top + 18.6), style, "", heading);
    put(out, (left + 2.0, top + 24.4), TextStyle::plain(3.0).fitted(kind, 102.0), "", kind);
    for (k, note) in entries.notes.iter().take(3).enumerate() {
        let style = TextStyle::plain(2.4).fitted(note, 146.0);
        put(out, (left + 2.0, top + 31.0 + 3.6 * k as f64), style, "", note);
    }
    let maker = format!("mm, sweetspot {}", env!("CARGO_PKG_VERSION"));
    put(out, (left + 152.0, top + 38.6), TextStyle::plain(1.8), "", &maker);
    projection_symbol(out, (left + 158.0, top + 33.4), entries.cell.title_block.projection);
}

fn draw_field(out: &mut String, (left, top): (f64, f64), ([x, y, wide, high], label, said): &BlockField) {
    let (x, y) = (left + x, top + y);
    stroke(out, &format!("M{x:.2} {:.2}V{y:.2}h{wide}", y + high), BLACK, 0.25);
    put(out, (x + 1.0, y + 2.6), TextStyle::plain(1.9), " fill=\"#57606a\"", label);
    let style = TextStyle::plain(3.5).fitted(said, wide - 2.0);
    put(out, (x + 1.0, y + high - 1.8), style, "", said);
}

/// Draws the symbol of the projection method (ISO 5456-2): a truncated cone from the side and from one end.
///
/// The end view shows the smaller end. The end view is right of the side view in first-angle projection, and
/// left of the side view in third-angle projection.
fn projection_symbol(out: &mut String, (x, y): (f64, f64), projection: Projection) {
    let (cone, rings) = match projection {
        Projection::FirstAngle => (x, x + 13.0),
        Projection::ThirdAngle => (x + 8.0, x + 1.0),
    };
    // The smaller end is at the left in both methods.
    let side = format!("M{cone:.2} {:.2}l7 -1.2v5.4l-7 -1.2z", y - 1.5);
    stroke(out, &side, BLACK, 0.35);
    for radius in [1.5, 2.7] {
        let _ = writeln!(
            out,
            "<circle cx=\"{rings:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"none\" stroke=\"{BLACK}\" stroke-width=\"0.35\"/>"
        );
    }
    let axis = format!("M{:.2} {y:.2}h9M{:.2} {y:.2}h7M{rings:.2} {:.2}v7", cone - 1.0, rings - 3.5, y - 3.5);
    let _ = writeln!(
        out,
        "<path d=\"{axis}\" fill=\"none\" stroke=\"{BLACK}\" stroke-width=\"0.18\" stroke-dasharray=\"2 0.5 0.4 0.5\"/>"
    );
}

/// Returns the style of a text that ends at its point; `size` is the height of the font, mm.
pub const fn at_end(size: f64) -> TextStyle {
    TextStyle::plain(size).anchored(TextAnchor::End)
}
