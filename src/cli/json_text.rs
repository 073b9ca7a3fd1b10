//! Texts of JSON documents. A sealed text ends with its own hash, so that a damaged file is never read as a
//! result.

use super::loading::sha256;
use super::{Exit, output};
use erased_serde::Serialize;
use std::io::{BufWriter, Write};

/// Message about a sealed file that [`unsealed`] refuses.
pub const DAMAGED: &str = "it is damaged: its text does not match the hash in its key sha256";

/// End of the text of a JSON object.
const END: &[u8] = b"\n}\n";

/// Returns a document as the text of a JSON file.
///
/// The document is a trait object, so that each document type is compiled for one serializer only.
pub fn pretty(document: &dyn Serialize) -> Result<Vec<u8>, Exit> {
    let mut bytes = serde_json::to_vec_pretty(document).map_err(not_json)?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// Returns a document as one line of JSON.
pub fn line(document: &dyn Serialize) -> Result<String, Exit> {
    Ok(serde_json::to_string(document).map_err(not_json)? + "\n")
}

/// Writes a document to stdout as one line of JSON, piece by piece. A closed pipe (`| head`) is not an
/// error.
pub fn print(document: &dyn Serialize) -> Result<(), Exit> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    let written = serde_json::to_writer(&mut out, document).map_err(std::io::Error::from);
    output::written(written.and_then(|()| out.write_all(b"\n")).and_then(|()| out.flush()))
}

fn not_json(e: serde_json::Error) -> Exit {
    output::error(&format!("cannot write JSON: {e}"));
    Exit::Io
}

/// Returns a document as the text of a JSON file. The last key, `sha256`, is the hash of the text before the
/// key.
///
/// The SHA-256 hash covers all bytes before the comma in front of the key.
pub fn sealed(document: &dyn Serialize) -> Result<Vec<u8>, Exit> {
    let mut bytes = pretty(document)?;
    bytes.truncate(bytes.len().saturating_sub(END.len()));
    let seal = seal(&bytes);
    bytes.extend(seal);
    Ok(bytes)
}

/// Returns the text of a sealed file without the hash; None if the hash does not match the text.
pub fn unsealed(bytes: &[u8]) -> Option<Vec<u8>> {
    let start = bytes.len().checked_sub(seal(b"").len())?;
    let (content, end) = bytes.split_at(start);
    (end == seal(content)).then(|| [content, END].concat())
}

/// Returns the end of a sealed text: the key `sha256` with the hash of `content`, and the closing brace.
fn seal(content: &[u8]) -> Vec<u8> {
    let mut seal = format!(",\n  \"sha256\": \"{}\"", sha256(content)).into_bytes();
    seal.extend(END);
    seal
}
