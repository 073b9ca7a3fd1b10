//! Paper space: a sheet with title block and a viewport on the plan.

use super::file::DxfFile;
use super::layers::{TITLE, VIEWPORT};
use crate::drawing::Drawing;
use crate::report::dxf::text::width;
use crate::report::sheet::{
    BLOCK, BlockEntries, FILING_MARGIN, MARGIN, Paper, SheetNumber, block_fields, kind_of_set_out,
};
use crate::report::sheet::{SCALES, drawing_title};
use crate::units::{m_from_mm, mm_from_m};
use nalgebra::Vector3;

/// Distance between the frame and the viewport, mm.
const INSIDE: f64 = 5.0;
/// Greatest and least height of the texts in the title block, mm.
const TEXT: (f64, f64) = (3.5, 1.2);
/// Height of the labels in the title block, mm.
const LABEL: f64 = 1.8;

/// Draws the sheet: A3 with the plan at the largest scale of ISO 5455 that fits. Lengths are in mm.
pub fn write(file: &mut DxfFile, drawing: &Drawing<'_>) {
    let paper = Paper::A3;
    let (low, high) = file.extents();
    let model = (high - low).map(mm_from_m);
    let room = (
        paper.width - FILING_MARGIN - MARGIN - 2.0 * INSIDE,
        paper.height - 2.0 * (MARGIN + INSIDE) - BLOCK.1,
    );
    let fits = |ratio: &f64| 1.02 * model.x <= room.0 * ratio && 1.02 * model.y <= room.1 * ratio;
    let ratio = SCALES.into_iter().find(fits).unwrap_or(SCALES[SCALES.len() - 1]);
    let middle = (low + high) / 2.0;
    let size = (m_from_mm(paper.width), m_from_mm(paper.height));
    file.paper(size, |file| {
        let point = |x: f64, y: f64| Vector3::new(m_from_mm(x), m_from_mm(y), 0.0);
        let centre = point(FILING_MARGIN + INSIDE + room.0 / 2.0, MARGIN + BLOCK.1 + INSIDE + room.1 / 2.0);
        let wide = (m_from_mm(room.0), m_from_mm(room.1));
        file.viewport(VIEWPORT, (&centre, wide), (&middle, wide.1 * ratio));
        rectangle(file, [FILING_MARGIN, MARGIN, paper.width - MARGIN, paper.height - MARGIN]);
        let entries = BlockEntries {
            cell: drawing.cell,
            sheet: SheetNumber::ALONE,
            kind: kind_of_set_out(drawing),
            scale: format!("1:{ratio}"),
            notes: vec![crate::report::text::headline(drawing.cell)],
        };
        block(file, &paper, &entries);
    });
}

/// Draws the title block, with the origin of the paper at the lower left.
fn block(file: &mut DxfFile, paper: &Paper, entries: &BlockEntries<'_>) {
    let (left, top) = (paper.width - MARGIN - BLOCK.0, MARGIN + BLOCK.1);
    rectangle(file, [left, MARGIN, left + BLOCK.0, top]);
    for ([x, y, wide, high], label, said) in block_fields(entries, paper) {
        let (x, y) = (left + x, top - y);
        rectangle(file, [x, y - high, x + wide, y]);
        write_fitted(file, (x + 1.0, y - 2.8), (label, wide - 2.0), LABEL);
        write_fitted(file, (x + 1.0, y - high + 1.6), (&said, wide - 2.0), TEXT.0);
    }
    let title = drawing_title(entries.cell).to_string();
    write_fitted(file, (left + 2.0, top - 18.5), (&title, 102.0), 5.0);
    write_fitted(file, (left + 2.0, top - 25.0), (&entries.kind, 102.0), 3.0);
    let projection = entries.cell.title_block.projection.name();
    write_fitted(file, (left + 151.0, top - 38.0), (projection, 28.0), 3.5);
    for (k, note) in entries.notes.iter().enumerate() {
        write_fitted(file, (left + 2.0, top - 32.0 - 4.0 * k as f64), (note, 146.0), 2.5);
    }
}

/// Writes a text that starts at a point (mm). The text has the height `height`, or less if its space is too
/// narrow.
fn write_fitted(file: &mut DxfFile, (x, y): (f64, f64), (said, room): (&str, f64), height: f64) {
    if said.is_empty() {
        return;
    }
    let fitted = height.min(height * room / width(said, height)).max(TEXT.1.min(height));
    file.height = m_from_mm(fitted);
    file.text(TITLE, &Vector3::new(m_from_mm(x), m_from_mm(y), 0.0), said, (0.0, false));
}

/// Draws a rectangle from left, bottom, right and top, mm.
fn rectangle(file: &mut DxfFile, [left, bottom, right, top]: [f64; 4]) {
    let corners = [(left, bottom), (right, bottom), (right, top), (left, top)];
    file.outline(TITLE, &corners.map(|(x, y)| (m_from_mm(x), m_from_mm(y))), 0.0);
}
