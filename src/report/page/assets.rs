//! Scripts, styles and templates of the pages. All of them are ours: no library, no request.

use crate::drawing::{GlyphRing, node_glyph};
use crate::error_map::NodeSign;
use serde_json::{Map, Value, json};

const GLYPH_PATH_JS: &str = include_str!("glyph_path.js");

const VIEWER_PARTS: &str = concat!(
    include_str!("viewer/maths.js"),
    include_str!("viewer/shaders.js"),
    include_str!("viewer/draw.js"),
    include_str!("viewer/model.js"),
    include_str!("viewer/camera.js"),
    include_str!("viewer/glyphs.js"),
    include_str!("viewer/render.js"),
    include_str!("viewer/labels.js"),
    include_str!("viewer/legend.js"),
    include_str!("viewer/controls.js"),
    include_str!("viewer/hand.js"),
    include_str!("viewer/viewer.js"),
);

#[cfg(feature = "view")]
const LIVE_PARTS: &str = concat!(
    include_str!("live/ask.js"),
    include_str!("live/plan.js"),
    include_str!("live/map.js"),
    include_str!("live/form.js"),
    include_str!("live/search.js"),
    include_str!("live/solid.js"),
    include_str!("live/page.js"),
);

/// Returns the viewer: it defines `sweetspotViewer(host, document, options)` on the window and nothing else.
pub fn viewer_js() -> String {
    script(VIEWER_PARTS)
}

/// Returns the script of the live page, which runs after the viewer.
#[cfg(feature = "view")]
pub fn live_js() -> String {
    script(LIVE_PARTS)
}

/// Returns a script in a scope of its own, after the table of node signs.
fn script(parts: &str) -> String {
    let table = node_signs();
    format!("\"use strict\";\n(() => {{\nconst NODE_SIGNS = {table};\n{GLYPH_PATH_JS}{parts}}})();\n")
}

/// Returns the signs of nodes as the scripts know them: by the name in documents, the label and the glyph.
pub fn node_signs() -> Value {
    let glyph = |sign| {
        node_glyph(sign).map(|glyph| {
            let ring = match glyph.ring {
                GlyphRing::None => "none",
                GlyphRing::Full => "full",
                GlyphRing::Dashed => "dashed",
            };
            json!({ "ring": ring, "strokes": glyph.strokes, "tone": glyph.tone.name() })
        })
    };
    let entry =
        |sign: NodeSign| (sign.name().to_string(), json!({ "label": sign.label(), "glyph": glyph(sign) }));
    Value::Object(NodeSign::ALL.into_iter().map(entry).collect::<Map<_, _>>())
}

pub const VIEWER_CSS: &str = include_str!("viewer/viewer.css");

#[cfg(feature = "view")]
pub const LIVE_HTML: &str = include_str!("live/page.html");
#[cfg(feature = "view")]
pub const LIVE_CSS: &str = include_str!("live/page.css");

/// The sections of a page: paragraphs, figures, tables.
pub const SECTIONS_HTML: &str = include_str!("sections.html");

/// The report: its template, its style after that of the viewer, its script after the viewer.
pub const REPORT_HTML: &str = include_str!("report.html");
pub const REPORT_CSS: &str = concat!(include_str!("viewer/viewer.css"), include_str!("report.css"));
pub const REPORT_JS: &str = include_str!("report.js");

/// Layouts side by side; in the style of the report.
pub const COMPARE_HTML: &str = include_str!("compare.html");
pub const COMPARE_CSS: &str = include_str!("compare.css");
pub const COMPARE_JS: &str = include_str!("compare.js");
