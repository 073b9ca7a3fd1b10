//! JSON files that end with the hash of their own text, so that a damaged file is never read as a result.

use super::Exit;
use super::loading::sha256;
use super::results::pretty;
use serde::Serialize;

/// Description of a sealed file that [`unsealed`] refuses.
pub const DAMAGED: &str = "it is damaged: its text has not the hash of its last line";

/// End of the text of a JSON object.
const END: &[u8] = b"\n}\n";

/// Returns a document as the text of a JSON file whose last key is `sha256`.
///
/// Its value is the SHA-256 of all bytes before that key and its comma.
pub fn sealed(document: &impl Serialize) -> Result<Vec<u8>, Exit> {
    let mut bytes = pretty(document)?;
    bytes.truncate(bytes.len().saturating_sub(END.len()));
    let seal = seal(&bytes);
    bytes.extend(seal);
    Ok(bytes)
}

/// Returns the text of a sealed file without its seal; None if any byte of the file is damaged.
pub fn unsealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let start = bytes.len().checked_sub(seal(b"").len())?;
    let (content, end) = bytes.split_at(start);
    (end == seal(content)).then(|| [content, END].concat())
}

/// Returns the text after the content: the key `sha256`, and the end of the object.
fn seal(content: &[u8]) -> Vec<u8> {
    let mut seal = format!(",\n  \"sha256\": \"{}\"", sha256(content)).into_bytes();
    seal.extend(END);
    seal
}
