//! The page of `view`: it holds no word of the cell, which its script asks for.

use super::assets::{LIVE_CSS, LIVE_HTML, VIEWER_CSS, live_js, viewer_js};

/// The page; its scripts and styles are marked with `nonce`, and no other may run.
pub fn live(nonce: &str) -> String {
    let style = [VIEWER_CSS, LIVE_CSS].concat();
    let script = viewer_js() + &live_js();
    LIVE_HTML.replace("{{nonce}}", nonce).replace("{{style}}", &style).replace("{{script}}", &script)
}
