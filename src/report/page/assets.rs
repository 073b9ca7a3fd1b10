//! The texts that run in the browser. All of them are ours: no library, no request.

/// The viewer: defines `sweetspotViewer(host, document, options)` on the window and nothing else there.
pub const VIEWER_JS: &str = concat!(
    "\"use strict\";\n(() => {\n",
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
    "})();\n"
);

pub const VIEWER_CSS: &str = include_str!("viewer/viewer.css");

#[cfg(feature = "view")]
pub const LIVE_HTML: &str = include_str!("live/page.html");
#[cfg(feature = "view")]
pub const LIVE_CSS: &str = include_str!("live/page.css");

/// The page of `view`, after the viewer.
#[cfg(feature = "view")]
pub const LIVE_JS: &str = concat!(
    "\"use strict\";\n(() => {\n",
    include_str!("live/ask.js"),
    include_str!("live/plan.js"),
    include_str!("live/map.js"),
    include_str!("live/form.js"),
    include_str!("live/search.js"),
    include_str!("live/solid.js"),
    include_str!("live/page.js"),
    "})();\n"
);
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
