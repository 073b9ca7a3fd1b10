//! What runs in the browser: our own texts, built in.

pub const LIVE_HTML: &str = include_str!("live.html");
pub const LIVE_CSS: &str = include_str!("live.css");
pub const LIVE_JS: &str = include_str!("live.js");
