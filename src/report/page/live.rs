//! The page of `view`: it holds no word of the cell, which its script asks for.

use super::assets::{LIVE_CSS, LIVE_HTML, LIVE_JS};

/// The page; its scripts and styles are marked with `nonce`, and no other may run.
pub fn live(nonce: &str) -> String {
    LIVE_HTML.replace("{{nonce}}", nonce).replace("{{style}}", LIVE_CSS).replace("{{script}}", LIVE_JS)
}
