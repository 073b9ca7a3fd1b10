//! Width, shortening and line breaks of texts.

/// Returns an upper estimate of the width of a text, px; the font is not known. Wide characters (Chinese,
/// Japanese, Korean, emoji) count double.
pub fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|c| ems(c) * size).sum()
}

fn ems(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.34,
        ' ' | 't' | 'f' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.42,
        'm' | 'w' | 'M' | 'W' | '%' | '@' => 0.95,
        'A'..='Z' => 0.72,
        _ if is_wide(c) => 1.16,
        _ => 0.6,
    }
}

fn is_wide(c: char) -> bool {
    matches!(u32::from(c),
        0x1100..=0x115f | 0x2e80..=0xa4cf | 0xac00..=0xd7a3 | 0xf900..=0xfaff | 0xfe30..=0xfe6f
        | 0xff00..=0xff60 | 0xffe0..=0xffe6 | 0x1f300..=0x1faff | 0x20000..=0x3fffd)
}

/// Returns the text. A text wider than `room` (px) is cut and gets an ellipsis.
pub fn shortened(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_string();
    }
    let mut kept = String::new();
    let mut used = size;
    for c in text.chars() {
        used += ems(c) * size;
        if used > room {
            break;
        }
        kept.push(c);
    }
    kept.trim_end().to_string() + "\u{2026}"
}

/// Returns a text broken into at most `most` lines. Lines end at spaces, after wide characters, or inside a
/// word longer than a line. The last line is shortened if the text does not fit.
pub fn wrapped(text: &str, size: f64, room: f64, most: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if lines.len() + 1 == most {
            lines.push(shortened(rest, size, room));
            break;
        }
        let end = line_end(rest, size, room);
        lines.push(rest[..end].trim_end().to_string());
        rest = rest[end..].trim_start();
    }
    lines
}

/// Returns the byte index at which the first line ends. The line has at least one character.
///
/// The line ends after the last space or wide character (Chinese, Japanese, Korean, emoji) that fits. If
/// there is none, the line ends inside a word.
fn line_end(text: &str, size: f64, room: f64) -> usize {
    let (mut used, mut space) = (0.0, None);
    for (at, c) in text.char_indices() {
        used += ems(c) * size;
        if used > room && at > 0 {
            return space.unwrap_or(at);
        }
        if c == ' ' || is_wide(c) {
            space = Some(at + c.len_utf8());
        }
    }
    text.len()
}

/// Returns a number with enough decimals to distinguish multiples of `step`. Very large and very small
/// numbers are written with a power of ten.
pub fn number(value: f64, step: f64) -> String {
    if value == 0.0 || value.abs() < step * 1e-6 {
        return "0".into();
    }
    let digits = if step > 0.0 { (-(step.log10() + 1e-9).floor()).max(0.0) } else { 3.0 };
    if digits > 6.0 || value.abs() >= 1e7 {
        return format!("{value:.1e}");
    }
    format!("{:.*}", digits as usize, crate::units::rounded(value, digits as i32))
}

/// Returns a number with four significant digits, or "0" for infinity and NaN.
pub fn figure(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || !size.is_finite() {
        return "0".into();
    }
    number(value, 10f64.powf(size.log10().floor() - 3.0))
}
