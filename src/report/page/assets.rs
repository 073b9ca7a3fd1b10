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

/// The report: its template, its style after that of the viewer, its script after the viewer.
pub const REPORT_HTML: &str = include_str!("report.html");
pub const REPORT_CSS: &str = concat!(include_str!("viewer/viewer.css"), include_str!("report.css"));
pub const REPORT_JS: &str = include_str!("report.js");
