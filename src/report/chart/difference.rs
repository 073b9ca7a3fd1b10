//! Differences between two layouts, node by node.

use super::axes;
use super::canvas::{Anchor, ChartCanvas, EDGE, Ink, LegendEntry, SMALL};
use super::plane_view::{PlaneView, longer_side, widened};
use super::{WIDTH, words};
use crate::assess::{NodePair, OperationDifference};
use crate::cell::{Cell, Unit};
use crate::geometry::bounding_box;
use crate::svg_text::escaped;
use crate::units::mm_from_m;

/// Left end, right end and greatest height of the plot, px.
const PLOT: (f64, f64, f64) = (62.0, WIDTH - EDGE - 112.0, 420.0);
/// Colour of the largest decrease of the error (blue); [`WORSE`] is the colour of the largest increase.
/// Colour-blind readers can distinguish the two colours.
const BETTER: [f64; 3] = [0.0, 90.0, 160.0];
const EQUAL: [f64; 3] = [240.0, 240.0, 236.0];
const WORSE: [f64; 3] = [190.0, 75.0, 0.0];
/// Number of steps of the colour bar.
const STEPS: usize = 24;

/// Draws the nodes of an operation in the frame of its equipment. Blue nodes have less error in the layout
/// `names.1` than in `names.0`; orange nodes have more. The scale goes from `-most` to `most`. These
/// values are in m or rad, or are costs or shares of failures.
pub fn difference(cell: &Cell, d: &OperationDifference, names: (&str, &str), most: f64) -> String {
    let (operation, unit) = (&cell.operations[d.operation], cell.unit());
    let heading = format!("{}: {} against {} in {}", operation.name, names.1, names.0, operation.sense.name);
    let mut canvas = ChartCanvas::new(&heading, &remarks(d, names));
    let in_mm = |p: &NodePair| (mm_from_m(p.at.0), mm_from_m(p.at.1));
    let bounds = bounding_box(d.pairs.iter().map(in_mm)).unwrap_or_default();
    let bounds = widened(bounds, 0.06 * longer_side(bounds).max(100.0));
    let view = PlaneView::fitted(bounds, (PLOT.1 - PLOT.0, PLOT.2), (PLOT.0, canvas.y + 26.0));
    let (x, y) = view.scales();
    let of = &cell.equipment[operation.equipment].name;
    axes::draw(&mut canvas, &x, &y, (&format!("x of {of} / mm"), &format!("y of {of} / mm")));
    let r = (0.42 * apart(&d.pairs) * view.scale).clamp(2.5, 16.0);
    for pair in &d.pairs {
        let at = view.at(&in_mm(pair));
        let (mark, said) = (mark(pair, most, at, r), told(pair, unit));
        canvas.put(&format!("<g><title>({}, {}): {}</title>{mark}</g>", pair.i, pair.j, escaped(&said)));
    }
    let foot = draw_bar(&mut canvas, unit, most, (view.right() + 26.0, view.top));
    canvas.y = canvas.y.max(foot);
    canvas.legend(&legend(d, names));
    canvas.finish()
}

fn remarks(d: &OperationDifference, names: (&str, &str)) -> Vec<String> {
    let ((better, worse), (gained, lost)) = (d.better_and_worse(), d.gained_and_lost());
    let (a, b) = names;
    let mut said = vec![format!(
        "{b} is better at {better} and worse at {worse} of the nodes that are usable in both layouts"
    )];
    if gained + lost > 0 {
        said.push(format!("{gained} nodes are usable only in {b}, and {lost} only in {a}"));
    }
    said
}

fn mark(pair: &NodePair, most: f64, (x, y): (f64, f64), r: f64) -> String {
    let s = 0.6 * r;
    match (pair.difference(), pair.first, pair.other) {
        (Some(by), ..) => {
            let fill = colour(by / most.max(f64::MIN_POSITIVE));
            format!(
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" fill=\"{fill}\" stroke=\"#57606a\" stroke-width=\"0.6\"/>"
            )
        }
        (None, None, Some(_)) => {
            let line = Ink::Blue.line(2.0);
            format!(
                "<path d=\"M{:.1} {y:.1}h{:.1}M{x:.1} {:.1}v{:.1}\" {line}/>",
                x - s,
                2.0 * s,
                y - s,
                2.0 * s
            )
        }
        (None, Some(_), None) => {
            let line = Ink::Vermilion.line(2.0);
            format!("<path d=\"M{:.1} {y:.1}h{:.1}\" {line}/>", x - s, 2.0 * s)
        }
        _ => format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{s:.1}\" {}/>", Ink::Grid.line(1.6)),
    }
}

fn told(pair: &NodePair, unit: Unit) -> String {
    let value = |v: Option<f64>| {
        v.map_or("not usable".to_string(), |v| format!("{} {}", words::figure(unit.from_si(v)), unit.word()))
    };
    let by = pair.difference().map(|d| format!(", {:+.4} {}", unit.from_si(d), unit.word()));
    format!("{} against {}{}", value(pair.other), value(pair.first), by.unwrap_or_default())
}

/// Returns the colour of `share`. A share is a difference divided by the upper end of the scale, from -1
/// (better) to 1 (worse).
pub fn colour(share: f64) -> String {
    let t = share.clamp(-1.0, 1.0);
    let end = if t < 0.0 { BETTER } else { WORSE };
    let [r, g, b] = [0, 1, 2].map(|c| (EQUAL[c] + (end[c] - EQUAL[c]) * t.abs()).round() as u8);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Draws the colour bar. The colour of the largest increase of the error is at the top. Returns the position
/// of the lower end of the bar, px.
fn draw_bar(canvas: &mut ChartCanvas, unit: Unit, most: f64, (left, top): (f64, f64)) -> f64 {
    let tall = 8.0 * STEPS as f64;
    for k in 0..STEPS {
        let share = 1.0 - 2.0 * (k as f64 + 0.5) / STEPS as f64;
        let y = top + 8.0 * k as f64;
        canvas.path(&format!("M{left:.1} {y:.1}h16v8.3h-16z"), &format!("fill=\"{}\"", colour(share)));
    }
    let most = words::figure(unit.from_si(most));
    let mut say = |y: f64, ink: Ink, said: &str| canvas.text((left + 22.0, y), Anchor::Start, ink, said);
    say(top + 10.0, Ink::Text, &format!("+{most}"));
    say(top + 26.0, Ink::Faint, "worse");
    say(top + tall / 2.0 + 4.5, Ink::Text, &format!("0 {}", unit.word()));
    say(top + tall - 14.0, Ink::Faint, "better");
    say(top + tall + 2.0, Ink::Text, &format!("-{most}"));
    top + tall + SMALL
}

fn legend(d: &OperationDifference, names: (&str, &str)) -> Vec<LegendEntry> {
    let pair = |first, other| NodePair { i: 0, j: 0, at: (0.0, 0.0), first, other };
    let all = [
        (pair(None, Some(0.0)), format!("usable only in {}", names.1)),
        (pair(Some(0.0), None), format!("usable only in {}", names.0)),
        (pair(None, None), "usable in neither layout".to_string()),
    ];
    let is_there = |kind: &NodePair| {
        let same = |p: &NodePair| {
            (p.first.is_some(), p.other.is_some()) == (kind.first.is_some(), kind.other.is_some())
        };
        d.pairs.iter().any(same)
    };
    let there = all.into_iter().filter(|(kind, _)| is_there(kind));
    there.map(|(kind, said)| LegendEntry { mark: mark(&kind, 1.0, (0.0, 0.0), 8.0), said }).collect()
}

/// Returns the least distance between neighbouring nodes, mm; 100 mm if there is only one node.
fn apart(pairs: &[NodePair]) -> f64 {
    let steps = pairs.windows(2).map(|w| (w[0].at.0 - w[1].at.0).hypot(w[0].at.1 - w[1].at.1));
    let least = steps.filter(|d| *d > 0.0).fold(f64::MAX, f64::min);
    if least < f64::MAX { mm_from_m(least) } else { mm_from_m(0.1) }
}
