//! Scripts, styles and templates of the pages. The scripts use no library and make no network requests.

use crate::drawing::{GlyphRing, NodeGlyph, node_glyph};
use crate::error_map::NodeSign;
use serde_json::{Map, Value, json};

const VIEWER_PARTS: &str = concat!(
    include_str!("viewer/maths.js"),
    include_str!("viewer/format.js"),
    include_str!("viewer/elements.js"),
    include_str!("viewer/node_signs.js"),
    include_str!("viewer/shaders.js"),
    include_str!("viewer/webgl.js"),
    include_str!("viewer/batches.js"),
    include_str!("viewer/model.js"),
    include_str!("viewer/values.js"),
    include_str!("viewer/camera.js"),
    include_str!("viewer/picking.js"),
    include_str!("viewer/glyphs.js"),
    include_str!("viewer/looks.js"),
    include_str!("viewer/render_map.js"),
    include_str!("viewer/render.js"),
    include_str!("viewer/label_places.js"),
    include_str!("viewer/labels.js"),
    include_str!("viewer/axes.js"),
    include_str!("viewer/legend.js"),
    include_str!("viewer/tip.js"),
    include_str!("viewer/controls.js"),
    include_str!("viewer/timeline.js"),
    include_str!("viewer/pointer.js"),
    include_str!("viewer/scales.js"),
    include_str!("viewer/camera_control.js"),
    include_str!("viewer/picture.js"),
    include_str!("viewer/view.js"),
    include_str!("viewer/viewer.js"),
    include_str!("viewer/factory.js"),
);

#[cfg(feature = "view")]
const LIVE_PARTS: &str = concat!(
    include_str!("live/server.js"),
    include_str!("live/geometry.js"),
    include_str!("live/plan.js"),
    include_str!("live/plan_frame.js"),
    include_str!("live/plan_map.js"),
    include_str!("live/form.js"),
    include_str!("live/verdict.js"),
    include_str!("live/search.js"),
    include_str!("live/view_3d.js"),
    include_str!("live/page.js"),
);

pub const VIEWER_CSS: &str = include_str!("viewer/viewer.css");

#[cfg(feature = "view")]
pub const LIVE_HTML: &str = include_str!("live/page.html");
#[cfg(feature = "view")]
pub const LIVE_CSS: &str = include_str!("live/page.css");

/// Template of the sections of a page: paragraphs, figures, tables.
pub const SECTIONS_HTML: &str = include_str!("sections.html");

/// Template of the report. The style of the report includes the viewer's style, and the script of the report
/// follows the viewer's script.
pub const REPORT_HTML: &str = include_str!("report.html");
pub const REPORT_CSS: &str = concat!(include_str!("viewer/viewer.css"), include_str!("report.css"));
pub const REPORT_JS: &str = include_str!("report.js");

/// Template of the page that compares layouts, in the style of the report.
pub const COMPARE_HTML: &str = include_str!("compare.html");
pub const COMPARE_CSS: &str = include_str!("compare.css");
pub const COMPARE_JS: &str = include_str!("compare.js");

/// Returns the script of the 3-D viewer. The script defines `sweetspotViewer(host, document, options)` and no
/// other global name. The script begins with the table of [`node_signs`].
pub fn viewer_js() -> String {
    let table = node_signs();
    format!("\"use strict\";\n(() => {{\nconst NODE_SIGN_TABLE = {table};\n{VIEWER_PARTS}}})();\n")
}

/// Returns the script of the live page. This script must follow the script of the viewer.
#[cfg(feature = "view")]
pub fn live_js() -> String {
    format!("\"use strict\";\n(() => {{\n{LIVE_PARTS}}})();\n")
}

/// Returns the label and the symbol of each class of nodes (`NodeSignRecord` in records.d.ts). The keys are
/// the names of the classes in documents.
pub fn node_signs() -> Value {
    let glyph = |glyph: NodeGlyph| {
        let is_dashed = glyph.ring == GlyphRing::Dashed;
        let has_ring = glyph.ring != GlyphRing::None;
        json!({ "ring": has_ring, "dashed": is_dashed, "strokes": glyph.strokes, "tone": glyph.tone.name() })
    };
    let entry = |sign: NodeSign| {
        let record = json!({ "label": sign.label(), "glyph": node_glyph(sign).map(glyph) });
        (sign.name().to_string(), record)
    };
    Value::Object(NodeSign::ALL.into_iter().map(entry).collect::<Map<_, _>>())
}
