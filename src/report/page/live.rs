//! Live page of `view`. The page contains no data of the cell; the script of the page requests the data.

use super::assets::{LIVE_CSS, LIVE_HTML, VIEWER_CSS, live_js, viewer_js};

/// Returns the HTML of the live page. The scripts and styles of the page carry `nonce`; the browser blocks
/// all other scripts and styles.
pub fn live(nonce: &str) -> String {
    let style = [VIEWER_CSS, LIVE_CSS].concat();
    let script = viewer_js() + &live_js();
    LIVE_HTML.replace("{{nonce}}", nonce).replace("{{style}}", &style).replace("{{script}}", &script)
}
