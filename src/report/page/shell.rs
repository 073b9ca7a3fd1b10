//! Rendering of templates, and protection against markup in names.

use super::assets::SECTIONS_HTML;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use minijinja::value::Serde;
use minijinja::{AutoEscape, Environment};
use serde::Serialize;
use sha2::{Digest, Sha256};

/// Renders a template of HTML. Every value is escaped, except those that the template declares to be markup.
///
/// # Errors
/// Fails if the template uses a value that does not exist.
pub fn rendered(template: &str, page: &impl Serialize) -> Result<String, String> {
    let mut environment = Environment::new();
    environment.set_auto_escape_callback(|_| AutoEscape::Html);
    environment.add_filter("tied", tied);
    environment.set_undefined_behavior(minijinja::UndefinedBehavior::Strict);
    environment.add_template("sections.html", SECTIONS_HTML).map_err(|e| format!("{e:#}"))?;
    environment.render_str(template, Serde(page)).map_err(|e| format!("{e:#}"))
}

/// Returns the Content-Security-Policy (W3C, Level 3) of a page. The policy blocks all network requests. It
/// allows one script, one style and images in `data:` URLs. The script and the style must have the hashes
/// that the policy states.
pub fn policy(script: &str, style: &str) -> String {
    format!(
        "default-src 'none'; script-src '{}'; style-src '{}'; img-src data:; base-uri 'none'; form-action 'none'",
        source(script),
        source(style)
    )
}

/// Returns the hash of an inline script or style as a source expression of the policy.
fn source(text: &str) -> String {
    format!("sha256-{}", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// Returns a picture with `number` added to its ids, because two pictures in a page must not share ids.
pub fn scoped(svg: &str, number: usize) -> String {
    svg.replace(" id=\"", &format!(" id=\"p{number}-"))
        .replace("url(#", &format!("url(#p{number}-"))
        .replace("href=\"#", &format!("href=\"#p{number}-"))
}

/// Returns a text in which a no-break space keeps a unit on the line of its number.
fn tied(text: String) -> String {
    let mut out = String::with_capacity(text.len());
    for (k, word) in text.split(' ').enumerate() {
        let is_unit = UNITS.contains(&word.trim_end_matches([',', ';', ':', '.', ')']));
        let after_number = out.ends_with(|c: char| c.is_ascii_digit());
        if k > 0 {
            out.push(if is_unit && after_number { '\u{a0}' } else { ' ' });
        }
        out.push_str(word);
    }
    out
}

const UNITS: [&str; 4] = ["mm", "deg", "%", "m2"];
