//! The texts that run in the browser. All of them are ours: no library, no request.

pub const LIVE_HTML: &str = include_str!("live/page.html");
pub const LIVE_CSS: &str = include_str!("live/page.css");

/// The page of `view`, after the viewer.
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
