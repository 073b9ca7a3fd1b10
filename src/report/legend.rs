//! The legend of the map picture: colour scale, exactly the signs that are there, scale bar.

use super::chart::Ink;
use super::chart::canvas::{Anchor, BODY, Canvas, Entry};
use super::chart::{signs, words};
use super::colours::viridis_hex;
use super::view::{MARGIN, View};
use crate::assess::Assessment;
use crate::units::{m_from_mm, mm_from_m, rounded};

/// Lines of the reach of operations at different heights, in turn.
const REACH: [(Ink, &str); 4] =
    [(Ink::Blue, "7 3"), (Ink::Green, "2 3"), (Ink::Purple, "12 3 2 3"), (Ink::Orange, "14 5")];

/// How far the arm reaches: the look of the k-th line.
pub(super) fn reach_line(k: usize) -> String {
    let (ink, dash) = REACH[k % REACH.len()];
    format!("{} stroke-dasharray=\"{dash}\"", ink.line(1.4))
}

pub(super) fn fence_line() -> String {
    Ink::Text.line(2.2)
}

pub(super) fn keep_out_line() -> String {
    format!("{} stroke-dasharray=\"6 4\"", Ink::Vermilion.line(1.6))
}

/// What the map shows beside its nodes.
pub(super) struct Shown {
    /// The colour scale in the unit of the cell.
    pub range: (f64, f64),
    /// Arrows are so many times longer than what they show.
    pub enlarged: f64,
    /// The operations whose reach is drawn.
    pub reach: Vec<String>,
    /// So many nodes were mapped for one that is drawn, along both axes.
    pub every: usize,
}

pub(super) fn draw_legend(canvas: &mut Canvas, a: &Assessment<'_>, view: &View, shown: &Shown) {
    draw_scale_bar(canvas, view);
    draw_colours(canvas, a, shown);
    canvas.paragraph(&format!("arrows: error in x and y, {} times enlarged", shown.enlarged));
    if shown.every > 1 {
        canvas.paragraph(&format!(
            "drawn thinner than mapped: one node of {} along both axes; spots come from all of them",
            shown.every
        ));
    }
    let entry =
        |is_there: bool, mark: String, said: &str| is_there.then(|| Entry { mark, said: said.to_string() });
    let line = |paint: &str| format!("<path d=\"M-12 0H12\" {paint}/>");
    let has_spot = (0..a.maps.len()).any(|k| a.spot(k).is_some());
    let has_refined = (0..a.maps.len()).any(|k| a.spot(k).is_some() && a.refined[k].is_some());
    let mut entries = vec![
        entry(has_spot, signs::spot((0.0, 0.0)), "spot chosen"),
        entry(has_refined, signs::refined((0.0, 0.0)), "spot between the nodes"),
        entry(a.cell.fence.is_some(), line(&fence_line()), "fence"),
        entry(!a.cell.keep_out.is_empty(), line(&keep_out_line()), "keep-out"),
    ];
    for (k, name) in shown.reach.iter().enumerate() {
        entries.push(entry(true, line(&reach_line(k)), &format!("reach at the height of {name}")));
    }
    let nodes = a.maps.iter().flat_map(|m| &m.nodes).map(|n| n.status.name());
    let all: Vec<Entry> = entries.into_iter().flatten().chain(signs::entries(nodes)).collect();
    canvas.legend(&all);
}

fn draw_colours(canvas: &mut Canvas, a: &Assessment<'_>, shown: &Shown) {
    let mut senses: Vec<_> = a.cell.operations.iter().map(|o| o.sense.name.as_str()).collect();
    senses.dedup();
    let unit = a.cell.unit().word();
    canvas.paragraph(&format!("{} in {}", crate::record::value_word(a.cell), senses.join(", ")));
    let [low, high] = [shown.range.0, shown.range.1].map(|v| format!("{} {unit}", words::figure(v)));
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

/// A round length near a sixth of the picture, and the directions of the world axes.
fn draw_scale_bar(canvas: &mut Canvas, view: &View) {
    let (left, top, width, height) = view.frame();
    let steps = [50.0, 100.0, 200.0, 500.0, 1_000.0, 2_000.0, 5_000.0, 10_000.0].map(m_from_mm);
    let length = steps.into_iter().rev().find(|s| s * view.scale <= 160.0).unwrap_or(steps[0]);
    let (x, y, px) = (left + 10.0, top + height + 26.0, length * view.scale);
    canvas.path(&format!("M{x:.1} {:.1}v8m0 -4h{px:.1}m0 -4v8", y - 4.0), &Ink::Text.line(1.2));
    let said = format!("{} mm", rounded(mm_from_m(length), 0));
    canvas.text((x + px + 8.0, y + 4.5), Anchor::Start, Ink::Text, &said);
    let x = left + width.min(view.width() - 2.0 * MARGIN) - 60.0;
    canvas.path(
        &format!("M{x:.1} {0:.1}h26m-5 -3l5 3l-5 3M{x:.1} {0:.1}v-26m-3 5l3 -5l3 5", y + 8.0),
        &Ink::Text.line(1.2),
    );
    canvas.text((x + 30.0, y + 12.0), Anchor::Start, Ink::Text, "x");
    canvas.text((x - 12.0, y - 10.0), Anchor::Start, Ink::Text, "y");
    canvas.y = y + 12.0;
}
