//! Scan of TOML text for deep nesting of brackets, before the text is parsed.
//!
//! The TOML parser limits its own recursion, but not while it recovers from a fault inside an inline table.
//! One line of 130 kB can then overflow the stack of a thread.

/// Returns the byte offset of the first bracket that is nested deeper than `deepest`.
///
/// A bracket closes only an opening bracket of its own kind. So the depth of faulty text is never
/// underestimated.
pub fn too_deep(text: &str, deepest: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    let (mut open, mut at) = (Vec::new(), 0);
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'[' | b'{' if open.len() == deepest => return Some(at),
            // In ASCII, the code of a closing bracket is the code of the opening bracket plus 2.
            b'[' | b'{' => open.push(byte + 2),
            b']' | b'}' if open.last() == Some(&byte) => drop(open.pop()),
            b'#' => at = end_of_line(bytes, at),
            b'"' | b'\'' => at = end_of_string(bytes, at, byte),
            _ => {}
        }
        at += 1;
    }
    None
}

/// Returns the offset of the line break at or after `at`, or the end of the text.
fn end_of_line(bytes: &[u8], at: usize) -> usize {
    bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |end| at + end)
}

/// Returns the offset of the last byte of the string that begins at `start`.
///
/// A single-line string that is not closed ends at the end of its line.
fn end_of_string(bytes: &[u8], start: usize, quote: u8) -> usize {
    let is_long = bytes[start..].starts_with(&[quote; 3]);
    let mut at = start + if is_long { 3 } else { 1 };
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'\\' if quote == b'"' && bytes.get(at + 1) != Some(&b'\n') => at += 1,
            b'\n' if !is_long => return at,
            _ if is_long && bytes[at..].starts_with(&[quote; 3]) => return at + 2,
            _ if !is_long && byte == quote => return at,
            _ => {}
        }
        at += 1;
    }
    at
}
