//! Limit of the size of a page.

use crate::drawing::Detail;

/// Largest size of a page, bytes.
const MAX_BYTES: usize = 8 << 20;

/// Page, with a note on the details that are left out to limit its size.
pub struct SizedPage {
    pub html: String,
    pub note: Option<String>,
}

/// Returns the most detailed page that is not larger than 8 MB. If no page fits, returns the least detailed
/// page, and its note is a warning.
///
/// # Errors
/// Returns the reason why `page` cannot render the page.
pub fn sized(mut page: impl FnMut(&Detail) -> Result<String, String>) -> Result<SizedPage, String> {
    let plain = Detail { nodes: 400, ..Detail::PLAIN };
    let mut html = String::new();
    for (k, detail) in [Detail::FULL, Detail { lenses: false, ..Detail::FULL }, plain].iter().enumerate() {
        html = page(detail)?;
        if html.len() <= MAX_BYTES {
            let said = "note: the 3-D view shows less detail, to keep the page below 8 MB";
            return Ok(SizedPage { html, note: (k > 0).then(|| said.into()) });
        }
    }
    let note =
        format!("warning: the page has {} MB; use coarser meshes to make it smaller", html.len() >> 20);
    Ok(SizedPage { html, note: Some(note) })
}
