//! Legend of the error map: colour scale, symbols in the picture, scale bar.

use super::canvas::{Anchor, BODY, Ink, LegendEntry};
use super::error_map_picture::{ErrorMapPicture, MARGIN, MapScales};
use super::{signs, solids, words};
use crate::colours::viridis_hex;
use crate::drawing::round_numbers::{ONE_TWO_FIVE, round_down};
use crate::drawing::{ErrorView, PartKind};

use crate::units::{m_from_mm, mm_from_m, rounded};

/// Line styles of the reach outlines, used in turn for the outlines at different heights.
const REACH: [(Ink, &str); 4] =
    [(Ink::Blue, "7 3"), (Ink::Green, "2 3"), (Ink::Purple, "12 3 2 3"), (Ink::Orange, "14 5")];

/// Greatest length of the scale bar, px.
const MAX_BAR: f64 = 160.0;
/// A value counts as zero if it is at most this share of the greatest value.
const ROUNDING_SHARE: f64 = 1e-9;

/// Returns the SVG attributes of the k-th outline of the reach.
pub(super) fn reach_line(k: usize) -> String {
    let (ink, dash) = REACH[k % REACH.len()];
    format!("{} stroke-dasharray=\"{dash}\"", ink.line(1.4))
}

pub(super) fn draw_legend(plan: &mut ErrorMapPicture<'_>, scales: &MapScales) {
    draw_scale_bar(plan);
    draw_colours(plan, scales);
    let lens = ErrorView::of(plan.a.cell);
    let what = match lens.is_signed() {
        true => "error in x and y".to_string(),
        false => {
            format!("{} in x and y, drawn in both directions along the worst-case error", lens.reading_word())
        }
    };
    let canvas = &mut plan.canvas;
    canvas.paragraph(&format!("arrows: {what}, enlarged {} times", scales.enlarged));
    if scales.every > 1 {
        canvas.paragraph(&format!(
            "along each axis, one in every {} nodes is drawn; the spots are chosen from all nodes",
            scales.every
        ));
    }
    let all = entries(plan, scales);
    plan.canvas.legend(&all);
}

/// Returns the legend entries of all symbols and lines in the picture.
fn entries(plan: &ErrorMapPicture<'_>, scales: &MapScales) -> Vec<LegendEntry> {
    let a = plan.a;
    let spot = |mark: String, said: &str| LegendEntry { mark, said: said.to_string() };
    let mut entries = Vec::new();
    let has_ring = |worst: bool| {
        let of_kind = |k: &usize| a.cell.operations[a.maps[*k].operation].over.needs_every_node() == worst;
        (0..a.maps.len()).filter(of_kind).any(|k| a.spot(k).is_some())
    };
    let said = match (has_ring(false), has_ring(true)) {
        (true, false) => Some("chosen spot"),
        (false, true) => Some("worst node"),
        (true, true) => Some("chosen spot, or worst node if an operation happens at every node"),
        (false, false) => None,
    };
    entries.extend(said.map(|said| spot(signs::spot((0.0, 0.0)), said)));
    if (0..a.maps.len()).any(|k| a.spot(k).is_some() && a.refined[k].is_some()) {
        entries.push(spot(signs::refined((0.0, 0.0)), "spot between the nodes"));
    }
    let kinds = [(PartKind::Fence, a.cell.fence.is_some()), (PartKind::KeepOut, !a.cell.keep_out.is_empty())];
    entries.extend(kinds.into_iter().filter(|(_, is_there)| *is_there).map(|(kind, _)| solids::entry(kind)));
    entries.extend(scales.reach.iter().enumerate().map(|(k, name)| {
        let mark = format!("<path d=\"M-12 0H12\" {}/>", reach_line(k));
        LegendEntry { mark, said: format!("reach at the height of {name}") }
    }));
    let nodes = a.maps.iter().flat_map(|m| &m.nodes);
    entries.extend(signs::entries(nodes.map(|n| n.status.sign())));
    entries
}

fn draw_colours(plan: &mut ErrorMapPicture<'_>, scales: &MapScales) {
    let (cell, canvas) = (plan.a.cell, &mut plan.canvas);
    let mut senses: Vec<_> = cell.operations.iter().map(|o| o.sense.name.as_str()).collect();
    senses.dedup();
    let unit = cell.unit().word();
    canvas.paragraph(&format!("{} in {}", crate::record::value_word(cell), senses.join(", ")));
    // If a registration removes an error, only rounding errors remain.
    let is_rounding = |v: f64| v.abs() <= ROUNDING_SHARE * scales.range.1.abs();
    let shown = |v: f64| if is_rounding(v) { 0.0 } else { v };
    let [low, high] = [scales.range.0, scales.range.1].map(|v| format!("{} {unit}", words::figure(shown(v))));
    let (y, left) = (canvas.y + 20.0, MARGIN + words::width(&low, BODY) + 6.0);
    canvas.text((MARGIN, y), Anchor::Start, Ink::Text, &low);
    for k in 0..60 {
        let (x, fill) = (left + 4.0 * f64::from(k), viridis_hex(f64::from(k) / 59.0));
        canvas.put(&format!(
            "<rect x=\"{x:.1}\" y=\"{:.1}\" width=\"4.4\" height=\"12\" fill=\"{fill}\"/>",
            y - 11.0
        ));
    }
    canvas.text((left + 252.0, y), Anchor::Start, Ink::Text, &high);
    canvas.y = y + 4.0;
}

/// Draws a scale bar of a round length and the directions of the world axes.
fn draw_scale_bar(plan: &mut ErrorMapPicture<'_>) {
    let (view, canvas) = (plan.view, &mut plan.canvas);
    let length = m_from_mm(round_down(mm_from_m(MAX_BAR / view.scale), ONE_TWO_FIVE));
    let (x, y, px) = (view.left + 10.0, view.bottom() + 26.0, length * view.scale);
    canvas.path(&format!("M{x:.1} {:.1}v8m0 -4h{px:.1}m0 -4v8", y - 4.0), &Ink::Text.line(1.2));
    let said = format!("{} mm", rounded(mm_from_m(length), 6));
    canvas.text((x + px + 8.0, y + 4.5), Anchor::Start, Ink::Text, &said);
    let x = view.left + view.width().min(plan.width - 2.0 * MARGIN) - 60.0;
    canvas.path(
        &format!("M{x:.1} {0:.1}h26m-5 -3l5 3l-5 3M{x:.1} {0:.1}v-26m-3 5l3 -5l3 5", y + 8.0),
        &Ink::Text.line(1.2),
    );
    canvas.text((x + 30.0, y + 12.0), Anchor::Start, Ink::Text, "x");
    canvas.text((x - 12.0, y - 10.0), Anchor::Start, Ink::Text, "y");
    canvas.y = y + 12.0;
}
