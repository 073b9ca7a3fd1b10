//! Cheap checks of XML text before it is parsed. The checks refuse text that would make the parser slow,
//! recurse deeply or use much memory.

use super::fault_list::{Faults, UrdfFault};

/// Largest size of a URDF file, bytes.
const MAX_BYTES: usize = 4_000_000;

const MAX_TAGS: usize = 150_000;
const MAX_EQUALS: usize = 300_000;
const MAX_NAMESPACES: usize = 100;

/// Deepest nesting of elements. A collision shape is at depth 5.
const MAX_NESTING: usize = 64;

/// Largest number of attributes of one tag.
const MAX_ATTRIBUTES: usize = 64;
/// Largest size of a tag, bytes.
const MAX_TAG: usize = 4_000;

const LARGE: &str = "is this the URDF of one robot? remove everything but its links and joints";

/// Returns the first reason why the text must not be parsed; None if the text may be parsed.
pub fn refuse(text: &str, faults: &Faults) -> Option<UrdfFault> {
    let many = |what: &str, most: usize| {
        Some(faults.wrong(0, format!("the file has more than {most} {what}"), LARGE)) // the file as a whole
    };
    let count = |byte: u8| text.bytes().filter(|b| *b == byte).count();
    if text.len() > MAX_BYTES {
        return many("bytes", MAX_BYTES);
    } else if count(b'<') > MAX_TAGS {
        return many("tags", MAX_TAGS);
    } else if count(b'=') > MAX_EQUALS {
        return many("attributes", MAX_EQUALS);
    } else if text.matches("xmlns").nth(MAX_NAMESPACES).is_some() {
        return many("namespaces", MAX_NAMESPACES);
    }
    walk(text).err().map(|(at, message, help)| faults.wrong(at, message, help))
}

type Refusal = (usize, String, &'static str);

/// Checks tags and nesting depth. Unclosed tags are left to the parser.
fn walk(text: &str) -> Result<(), Refusal> {
    let (mut at, mut depth) = (0, 0usize);
    while let Some(start) = text[at..].find('<').map(|i| at + i) {
        let rest = &text[start..];
        let end = if rest.starts_with("<!--") {
            rest.find("-->")
        } else if rest.starts_with("<![CDATA[") {
            rest.find("]]>")
        } else if rest.starts_with("<?") {
            rest.find("?>")
        } else if rest.starts_with("<!") {
            let help = "remove it: entities and document types are not read";
            return Err((start, "the file has a document type declaration".into(), help));
        } else {
            let end = end_of_tag(rest).map_err(|(message, help)| (start, message, help))?;
            if rest.starts_with("</") {
                depth = depth.saturating_sub(1);
            } else if end.is_some_and(|end| !rest[..end].ends_with('/')) {
                depth += 1;
            }
            if depth > MAX_NESTING {
                let message = format!("the elements are nested more than {MAX_NESTING} deep");
                return Err((start, message, "no element of a URDF is nested so deeply"));
            }
            end
        };
        let Some(end) = end else { return Ok(()) };
        at = start + end + 1;
    }
    Ok(())
}

/// Returns the offset of the `>` that closes the tag at the start of `rest`.
fn end_of_tag(rest: &str) -> Result<Option<usize>, (String, &'static str)> {
    let (mut quote, mut attributes) = (None, 0);
    for (i, byte) in rest.bytes().enumerate() {
        if i > MAX_TAG {
            return Err((format!("a tag has more than {MAX_TAG} bytes"), "shorten its attributes"));
        }
        match (quote, byte) {
            (None, b'>') => return Ok(Some(i)),
            (None, b'"' | b'\'') => quote = Some(byte),
            (None, b'=') => attributes += 1,
            (Some(open), _) if open == byte => quote = None,
            _ => {}
        }
        if attributes > MAX_ATTRIBUTES {
            let message = format!("a tag has more than {MAX_ATTRIBUTES} attributes");
            return Err((message, "no element of a URDF has that many"));
        }
    }
    Ok(None)
}
