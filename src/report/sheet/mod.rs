//! Drawing of the cell on paper: plan and front view to scale, with dimensions, list of placements and title
//! block.
//!
//! Sizes are in mm on paper. The sheet is A4 or A3 (ISO 216) with the margins of ISO 5457 and a scale of ISO
//! 5455. The views are in the projection that the cell file states (ISO 5456-2). Print the sheet at 100 %.

mod arrangement;
mod content;
mod dimensions;
pub(super) mod ink;
mod list;
pub(super) mod title;

pub use arrangement::{BLOCK, FILING_MARGIN, MARGIN, Paper, SCALES};
pub use title::{
    BlockEntries, BlockField, SheetNumber, block_fields, kind_of_set_out, layout_name, title as drawing_title,
};

use crate::drawing::round_numbers::{ONE_TWO_FIVE, round_down};
use crate::drawing::silhouette::{ABOVE, FRONT};
use crate::drawing::{Drawing, floor_corners};
use crate::files::shown;
use crate::report::chart::labels::OccupiedBoxes;
use crate::svg_text::escaped;
use crate::units::{mm_from_m, rounded};
use arrangement::{Arrangement, Needs, arranged};
use content::SheetSolid;
use ink::{TextAnchor, TextStyle, put, stroke};
use nalgebra::{Vector2, Vector3};
use title::BLACK;

/// Least and greatest coordinates of a view (right and up), m.
type Bounds = (Vector2<f64>, Vector2<f64>);

/// Mapping from the plane of a view (right and up, m) to the paper (mm).
pub struct SheetView {
    low: Vector2<f64>,
    high: Vector2<f64>,
    /// Position of the lower left corner on the paper, mm.
    left: f64,
    bottom: f64,
    /// Scale of the view, 1:ratio.
    ratio: f64,
}

impl SheetView {
    fn at(&self, p: &Vector2<f64>) -> (f64, f64) {
        let [u, v] = [p.x - self.low.x, p.y - self.low.y].map(|m| mm_from_m(m) / self.ratio);
        (self.left + u, self.bottom - v)
    }

    fn plan(&self, p: &Vector3<f64>) -> (f64, f64) {
        self.at(&p.xy())
    }

    fn top(&self) -> f64 {
        self.bottom - size(&(self.low, self.high), self.ratio).1
    }
}

fn size((low, high): &Bounds, ratio: f64) -> (f64, f64) {
    let size = (high - low).map(|m| mm_from_m(m) / ratio);
    (size.x, size.y)
}

/// SVG of a sheet, with its format.
pub struct PaperSheet {
    pub svg: String,
    pub paper: Paper,
}

/// Returns the sheet with the robot at the spot of an operation, or at home. The sheet shows the errors under
/// the model and the reading of the cell.
pub fn sheet(drawing: &Drawing<'_>, operation: Option<usize>, number: SheetNumber) -> PaperSheet {
    let [above, before] = [ABOVE, FRONT].map(|eye| content::seen(drawing, operation, &eye));
    let arrangement = arranged(&needs(drawing, &above, &before), drawing.cell.title_block.projection);
    let Arrangement { paper, ratio, plan, front, bar: place, .. } = &arrangement;
    let mut out = opened(paper, &drawing.cell.name);
    heading(&mut out, front, "front, seen along y");
    heading(&mut out, plan, "plan");
    content::draw(&mut out, plan, &above);
    content::draw(&mut out, front, &before);
    content::floor(&mut out, drawing, front);
    for (k, field) in drawing.fields.iter().enumerate() {
        content::map(&mut out, drawing, plan, (k, field));
    }
    content::regions(&mut out, drawing, plan);
    let mut taken = OccupiedBoxes::default();
    dimensions::draw(&mut out, drawing, plan, &mut taken);
    dimensions::draw_heights(&mut out, drawing, front);
    content::spots(&mut out, drawing, |p| plan.plan(p), &mut taken);
    content::names(&mut out, drawing, plan, &above, &mut taken);
    content::spots(&mut out, drawing, |p| front.at(&p.xz()), &mut OccupiedBoxes::default());
    bar(&mut out, *place, *ratio);
    list::draw(&mut out, drawing, &arrangement);
    let entries = BlockEntries {
        cell: drawing.cell,
        sheet: number,
        kind: title::kind_of_set_out(drawing),
        scale: format!("1:{ratio}"),
        notes: notes(drawing, operation),
    };
    title::block(&mut out, paper, &entries);
    out.push_str("</svg>\n");
    PaperSheet { svg: out, paper: *paper }
}

/// Returns the beginning of the SVG of a page.
pub(super) fn opened(paper: &Paper, name: &str) -> String {
    let Paper { width, height, .. } = paper;
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"Noto Sans, system-ui, sans-serif\" font-size=\"2.6\" \
         fill=\"{BLACK}\" stroke-linejoin=\"round\">\n<title>{}</title>\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n",
        escaped(name)
    )
}

/// Returns the sizes that the views need. Both views have the same range of x, so that one view is exactly
/// below the other view.
fn needs(drawing: &Drawing<'_>, above: &[SheetSolid], before: &[SheetSolid]) -> Needs {
    let (mut plan, mut front) = (bounds(drawing, above, true), bounds(drawing, before, false));
    let (low, high) = (plan.0.x.min(front.0.x), plan.1.x.max(front.1.x));
    for view in [&mut plan, &mut front] {
        (view.0.x, view.1.x) = (low, high);
    }
    let below = dimensions::room(drawing);
    let beside = below.max(dimensions::room_of_heights(drawing));
    Needs { plan, front, below, beside, list: list::height(drawing) }
}

/// Returns the bounds of a view. The bounds of the plan include floor spaces, working envelopes and regions.
fn bounds(drawing: &Drawing<'_>, view: &[SheetSolid], is_plan: bool) -> Bounds {
    let mut points: Vec<Vector2<f64>> =
        view.iter().flat_map(|s| s.silhouette.loops.iter().flatten()).copied().collect();
    let (cell, layout) = (drawing.cell, &drawing.layout);
    if is_plan {
        let stands = cell.equipment.iter().map(|e| &e.footprint).zip(&layout.placements);
        let all = stands.chain([(&cell.robot.footprint, &layout.base)]);
        points.extend(all.flat_map(|(f, at)| floor_corners(f, at)).map(|(x, y)| Vector2::new(x, y)));
        let reach = drawing.envelopes.iter().flat_map(|rings| &rings.at_work);
        let regions = drawing.regions.iter().flat_map(|region| &region.rings);
        points.extend(reach.chain(regions).flatten().map(Vector3::xy));
    } else {
        points.push(Vector2::new(layout.base.x, drawing.floor));
    }
    let pairs = points.iter().map(|p| (*p, *p));
    pairs.reduce(|(lo, hi), (p, q)| (lo.inf(&p), hi.sup(&q))).unwrap_or_default()
}

fn heading(out: &mut String, view: &SheetView, said: &str) {
    put(out, (view.left, view.top() - 2.5), TextStyle::plain(3.5).bold(), "", said);
}

/// Returns the remarks in the title block.
fn notes(drawing: &Drawing<'_>, operation: Option<usize>) -> Vec<String> {
    let cell = drawing.cell;
    let stands = operation.map_or("home".into(), |k| shown(&cell.operations[k].name));
    let lens = drawing.lenses.first();
    let arrows = format!(
        "arrows: {} error, enlarged {} times{}",
        lens.map_or("", |l| l.reading_word()),
        rounded(drawing.exaggeration(0), 6),
        if lens.is_some_and(|l| l.is_signed()) { "" } else { ", plus or minus" }
    );
    vec![
        crate::report::text::headline(cell),
        format!("{arrows}; robot at {stands}; corners within their tolerances keep the frame within its \
        tolerance at every allowed yaw"),
        "circles: nodes that cannot be used; dashed: reach at the height of the work; angles: yaw from the world x".into(),
    ]
}

/// Draws a scale bar of 20 to 40 mm on paper, with the axes of the plan.
fn bar(out: &mut String, (left, top): (f64, f64), ratio: f64) {
    let length = round_down(40.0 * ratio, ONE_TWO_FIVE);
    let wide = length / ratio;
    let (x, y) = (left + 20.0, top + 9.0);
    let axes =
        format!("M{left:.2} {0:.2}h9l-2 -0.8m2 0.8l-2 0.8M{left:.2} {0:.2}v-9l-0.8 2m0.8 -2l0.8 2", y + 3.0);
    stroke(out, &axes, BLACK, 0.35);
    stroke(out, &format!("M{x:.2} {:.2}v3m0 -1.5h{wide:.2}m0 -1.5v3", y - 1.5), BLACK, 0.35);
    let style = TextStyle::plain(2.6);
    put(out, (x + wide / 2.0, y + 4.6), style.anchored(TextAnchor::Middle), "", &format!("{length} mm"));
    put(out, (left + 10.0, y + 3.8), style, "", "x");
    put(out, (left + 1.5, y - 4.5), style, "", "y");
}
