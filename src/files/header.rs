//! The header that every kind of file begins with: `schema` and `units`.

use super::fault::shown;
use super::toml::document::Library;
use super::toml::reader::Table;
use super::toml::tree::Node;
use super::toml::value;

/// `schema` and `units`, the same in every kind of file; None if it is a file of another kind, of
/// which nothing more is read. A part written inside a cell has neither: those of the cell hold.
pub fn header(t: &mut Table<'_>, kind: &'static str, lib: &mut Library<'_>) -> Option<()> {
    let help = "add units = { length = \"mm\", angle = \"deg\" }";
    let units = if let Some(node) = t.get("schema") {
        if !is_schema(node, t, kind, lib) {
            t.give_up();
            return None;
        }
        t.need("units", help)
    } else {
        t.get("units")
    };
    let Some(node) = units else { return Some(()) };
    Table::read(node, "`units`", lib, |t, lib| {
        for (key, want, help) in
            [("length", "mm", "add length = \"mm\""), ("angle", "deg", "add angle = \"deg\"")]
        {
            let Some(node) = t.need(key, help) else { continue };
            let Some(given) = value::text(node, key, lib).filter(|given| given != want) else { continue };
            let message = format!("`{key}` must be in \"{want}\", not in \"{}\"", shown(&given));
            lib.error(
                node.at,
                message,
                format!("convert the numbers of the file, then write {key} = \"{want}\""),
            );
        }
        Some(())
    });
    Some(())
}

/// Whether the file is of the wanted kind; if another file brought the wrong one, the fault is where
/// that file was named.
fn is_schema(node: &Node, t: &Table<'_>, kind: &str, lib: &mut Library<'_>) -> bool {
    let want = format!("sweetspot/{kind}/1");
    let Some(given) = value::text(node, "schema", lib) else { return false };
    if given == want {
        return true;
    }
    let file = shown(&lib.sources[node.at.file].path);
    let named = if node.at.file == t.at.file { node.at } else { t.at };
    let (at, message) = match KINDS.iter().find(|(k, _)| given == format!("sweetspot/{k}/1")) {
        Some((_, what)) => (named, format!("`{file}` is the file of {what}")),
        None => (node.at, format!("`{}` is no schema that is read", shown(&given))),
    };
    lib.error(at, message, format!("a file with schema = \"{want}\" is wanted here"));
    false
}

/// With the article.
const KINDS: [(&str, &str); 4] =
    [("cell", "a cell"), ("robot", "a robot"), ("tool", "a tool"), ("equipment", "an equipment")];
