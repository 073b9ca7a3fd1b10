//! First page: picture, placements, errors against limits, yield, and room (allowed displacement of each
//! piece).

use super::flow::{LEFT, PageFlow, WIDTH, opened, size};
use crate::cell::Unit;
use crate::drawing::Drawing;
use crate::files::shown;
use crate::raster::{Shot, isometric};
use crate::record::{RequirementState, VerdictDocument, VerdictPlacement, VerdictSpot};
use crate::report::page::{NOTHING, PageTable, Subject, told, verdict};
use crate::report::sheet::ink::TextStyle;
use crate::report::sheet::title::{BlockEntries, block, layout_name};
use crate::report::sheet::{Paper, PaperSheet, SheetNumber};

/// Top of the content, mm.
const TOP: f64 = 13.0;
/// Lowest point of the content, above the title block, mm.
const BOTTOM: f64 = 244.0;
/// Share of the width of the frame that the content occupies.
const INSET: f64 = 0.95;
/// Least and greatest height of the picture, mm.
const PICTURE: (f64, f64) = (70.0, 112.0);

/// Returns the first page of the PDF: picture, placements, errors against limits, yield and room.
///
/// # Errors
/// Fails if the picture cannot be drawn.
pub fn page(
    subject: &Subject<'_>,
    drawing: &Drawing<'_>,
    operation: Option<usize>,
    sheet: SheetNumber,
) -> Result<PaperSheet, String> {
    let verdict = verdict(subject);
    let shot = Shot { context: operation, width: 1200, height: 760, ..Shot::default() };
    let picture = isometric(drawing, &shot)?;
    // The picture fills the space that the text leaves.
    let words = content(&verdict, &picture, 0.0).1;
    let high = ((BOTTOM - TOP) / INSET - words).clamp(PICTURE.0, PICTURE.1);
    let (body, end) = content(&verdict, &picture, high);
    // The content keeps a distance from the frame. The content for many operations or pieces of
    // equipment is scaled down to one page.
    let scale = ((BOTTOM - TOP) / end).min(INSET);
    let aside = LEFT + WIDTH / 2.0 * (1.0 - scale) - LEFT * scale;
    let mut svg = opened(&drawing.cell.name);
    svg += &format!("<g transform=\"translate({aside:.3} {TOP}) scale({scale:.4})\">{body}</g>\n");
    let entries = BlockEntries {
        cell: drawing.cell,
        sheet,
        kind: format!("answer, {}", layout_name(&drawing.name)),
        scale: "none".into(),
        notes: vec![
            crate::report::text::headline(drawing.cell),
            match drawing.is_feasible {
                true => "placements are in the frame of the robot base; set them out from the drawing on sheet 2",
                false => "placements are in the frame of the robot base; the layout is not feasible: do not build it",
            }
            .into(),
        ],
    };
    block(&mut svg, &Paper::A4, &entries);
    svg.push_str("</svg>\n");
    Ok(PaperSheet { svg, paper: Paper::A4 })
}

/// Returns the content above the title block, and its height, mm.
fn content(verdict: &VerdictDocument, picture: &str, high: f64) -> (String, f64) {
    let mut flow = PageFlow::endless();
    flow.lines(&verdict.headline, TextStyle::plain(4.0).bold(), 5.2);
    flow.space(1.0);
    if high > 0.0 {
        let width = size(picture).map_or(WIDTH, |(wide, tall)| (high * wide / tall).min(WIDTH));
        flow.picture(picture, width, high);
    }
    verdict.reasons.iter().for_each(|reason| flow.paragraph(reason));
    if !verdict.operations.is_empty() {
        flow.table(&errors(verdict));
    }
    if !verdict.placements.is_empty() {
        flow.table(&placements(verdict));
    }
    let facts =
        verdict.facts.iter().map(|fact| vec![fact.label.clone(), fact.text.clone(), fact.note.clone()]);
    let mut table = PageTable::new("", &["", "", ""], facts.collect());
    table.is_number = vec![false; 3];
    flow.table(&table);
    let end = flow.y;
    (flow.finish().into_iter().map(|page| page.body).collect(), end)
}

fn errors(verdict: &VerdictDocument) -> PageTable {
    let unit = verdict.unit;
    let value = |value: Option<f64>| value.map_or(NOTHING.into(), |value| told(unit, value));
    let row = |spot: &VerdictSpot| {
        let [x, y, z] = match spot.position_mm {
            Some(at) => at.map(|v| format!("{v:.1}")),
            None => [(); 3].map(|()| NOTHING.to_string()),
        };
        let (name, equipment) = (shown(&spot.name), shown(&spot.equipment));
        let margin = match spot.requirement {
            RequirementState::NotGuaranteed => "not guaranteed".into(),
            _ => value(spot.margin),
        };
        let values = [value(spot.value), value(spot.worst), value(spot.limit), margin];
        let row = [name, equipment, shown(&spot.sense)].into_iter().chain(values);
        row.chain([x, y, z]).collect()
    };
    let word = if unit == Unit::Share { "share" } else { verdict.quantity.as_str() };
    let head = [
        "operation",
        "on",
        "sense",
        word,
        "misplaced at most",
        "limit",
        "margin",
        "spot x mm (world)",
        "y mm",
        "z mm",
    ];
    PageTable::new("Errors against limits", &head, verdict.operations.iter().map(row).collect())
}

fn placements(verdict: &VerdictDocument) -> PageTable {
    let row = |placed: &VerdictPlacement| {
        let at = &placed.at;
        let room = |room: Option<f64>, scale: f64| match room {
            // The room is rounded down, because a larger displacement may not be feasible.
            Some(room) => format!("{}", (room * scale).floor() / scale),
            None => NOTHING.into(),
        };
        vec![
            shown(&placed.equipment),
            format!("{:.1}", at.x_mm),
            format!("{:.1}", at.y_mm),
            format!("{:.1}", at.z_mm),
            format!("{:.2}", at.yaw_deg),
            room(placed.room_mm, 10.0),
            room(placed.room_deg, 100.0),
            placed.ends_with.clone().unwrap_or_default(),
        ]
    };
    let head = [
        "placement from the robot base",
        "x mm",
        "y mm",
        "z mm",
        "yaw deg",
        "room mm",
        "room deg",
        "limit of the room",
    ];
    PageTable::new("Placements", &head, verdict.placements.iter().map(row).collect())
}
