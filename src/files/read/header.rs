//! Reader of the header of every file: `schema` and `units`.

use crate::files::fault::shown;
use crate::files::keys::key::{Key, ValueKind};
use crate::files::keys::parts::{UNITS, units};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Node;
use crate::files::toml::value;

/// Reads `schema` and `units`.
///
/// Returns None for a file of another kind. The other keys of such a file are not read. A robot, tool or
/// piece of equipment inside a cell file needs neither key, because the keys of the cell file apply.
pub fn header(t: &mut Table, schema: &Key) -> Option<()> {
    let given = t.get(schema);
    if given.is_some_and(|node| !is_schema(node, t, schema)) {
        t.give_up();
        return None;
    }
    let units = if given.is_some() { UNITS.required() } else { UNITS };
    t.table(&units, |t| {
        for key in [units::LENGTH, units::ANGLE] {
            let (Some(node), ValueKind::Exactly(wanted)) = (t.get(&key), key.kind) else { continue };
            let given = value::text(node, key.name, t.lib).filter(|given| given != wanted);
            let Some(given) = given else { continue };
            let name = key.name;
            let message = format!("`{name}` must be in \"{wanted}\", not in \"{}\"", shown(&given));
            let help = format!("convert the numbers of the file, then write {name} = \"{wanted}\"");
            t.error(node.at, message, help);
        }
        Some(())
    });
    Some(())
}

/// Returns whether the file is of the required kind; records a fault if not.
///
/// If a file included with `from` has another kind, the fault is at the table that contains this `from`.
fn is_schema(node: &Node, t: &mut Table, schema: &Key) -> bool {
    let ValueKind::Exactly(wanted) = schema.kind else { return false };
    let Some(given) = value::text(node, "schema", t.lib) else { return false };
    if given == wanted {
        return true;
    }
    let file = shown(&t.lib.sources[node.at.file].path);
    let named = if node.at.file == t.at.file { node.at } else { t.at };
    let (at, message) = match KINDS.iter().find(|(kind, _)| given == format!("sweetspot/{kind}/1")) {
        Some((_, what)) => (named, format!("`{file}` is {what} file")),
        None => (node.at, format!("`{}` is not a known schema", shown(&given))),
    };
    t.error(at, message, format!("a file with schema = \"{wanted}\" is expected here"));
    false
}

/// Kinds of files: the word in `schema`, and this word with the indefinite article.
const KINDS: [(&str, &str); 4] =
    [("cell", "a cell"), ("robot", "a robot"), ("tool", "a tool"), ("equipment", "an equipment")];
