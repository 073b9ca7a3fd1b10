//! Opening of the page in the user's browser.
//!
//! All users of the machine can read command lines, so the command line of the browser must not contain the
//! secret of the URL.

use std::io::Write;
use tempfile::TempPath;

/// Opens a URL in the user's browser through a temporary file that redirects to the URL. Only the user can
/// read this file.
///
/// Dropping the returned path deletes the file. The caller must keep the path until the browser has read
/// the file.
///
/// # Errors
/// Fails with the reason if the file cannot be written or no browser can be started.
pub fn open_in_browser(url: &str) -> Result<TempPath, String> {
    // tempfile gives the file a random name and, on Unix, mode 0600.
    let file = tempfile::Builder::new().prefix("sweetspot-view-").suffix(".html").tempfile();
    let mut file = file.map_err(|e| format!("a temporary file cannot be made: {e}"))?;
    // The URL consists of letters, digits and `:/.`, so nothing needs an escape.
    let page = format!(
        "<!doctype html>\n<meta charset=\"utf-8\">\n<meta name=\"referrer\" content=\"no-referrer\">\n\
         <meta http-equiv=\"refresh\" content=\"0; url={url}\">\n<title>sweetspot view</title>\n\
         <p><a href=\"{url}\">sweetspot view</a></p>\n"
    );
    file.write_all(page.as_bytes()).map_err(|e| format!("a temporary file cannot be written: {e}"))?;
    let path = file.into_temp_path();
    open::that_detached(&path).map_err(|e| e.to_string())?;
    Ok(path)
}
