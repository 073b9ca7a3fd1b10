//! The texts that run in the browser. All of them are ours: no library, no request.

/// Script of the 3-D viewer. It defines `sweetspotViewer(host, document, options)` and no other global name.
pub const VIEWER_JS: &str = concat!(
    "\"use strict\";\n(() => {\n",
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
    "})();\n"
);

pub const VIEWER_CSS: &str = include_str!("viewer/viewer.css");

#[cfg(feature = "view")]
pub const LIVE_HTML: &str = include_str!("live/page.html");
#[cfg(feature = "view")]
pub const LIVE_CSS: &str = include_str!("live/page.css");

/// Script of the page of `view`. It comes after [`VIEWER_JS`].
#[cfg(feature = "view")]
pub const LIVE_JS: &str = concat!(
    "\"use strict\";\n(() => {\n",
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
