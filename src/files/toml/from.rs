//! The key `from = "other.toml"` names a file from which a table takes every key that it lacks.
//!
//! A table that states its own `from` does not take the `from` of the included table. So a cell may include
//! another cell and name a different robot file. The cell then takes nothing from the robot file of the
//! included cell. `from` is allowed at the top of a file, in the robot and its tool, in equipment and in
//! obstacles.

use super::document::Library;
use super::setting;
use super::setting::Setting;
use super::tree::{At, Entry, Node, Value, laid_over};
use crate::files::fault::shown;

/// Largest number of files in a chain, in which each file includes the next file through `from`.
const MAX_CHAIN: usize = 16;

/// Returns the tree of a file, with every `from` followed and the settings applied.
///
/// Returns None if the file cannot be read or parsed. Other faults are only recorded.
pub fn load(path: &str, settings: &[Setting], lib: &mut Library<'_>) -> Option<Node> {
    let file = lib.toml(path, None)?;
    let at = At { file, offset: 0 };
    let mut root = Node { at, value: Value::Table(lib.entries(file)?) };
    let mut chain = vec![path.to_string()];
    merge_over(&mut root, &mut chain, lib);
    has_schema(&root, at, lib);
    setting::apply(&mut root, settings, lib);
    let Value::Table(entries) = &mut root.value else { return None };
    for (key, _, node) in entries {
        match (key.as_str(), &mut node.value) {
            ("robot", _) => lay_robot(node, &chain, lib),
            // The tool of a robot file that is read on its own.
            ("tool", value) if value.get("from").is_some() => lay_part(node, &chain, lib),
            ("equipment" | "obstacle", Value::Table(parts)) => {
                parts.iter_mut().for_each(|(.., part)| lay_part(part, &chain, lib));
            }
            _ => {}
        }
    }
    Some(root)
}

/// Takes the missing keys of a robot and of its tool from the files that their `from` keys name.
///
/// A tool with its own `from` replaces the tool of the robot file completely. A mix of both tools would
/// describe neither tool.
fn lay_robot(node: &mut Node, chain: &[String], lib: &mut Library<'_>) {
    let Value::Table(entries) = &mut node.value else { return lay_part(node, chain, lib) };
    let is_own = |e: &Entry| e.0 == "tool" && e.2.value.get("from").is_some();
    let own = entries.iter().position(is_own).map(|k| entries.remove(k));
    lay_part(node, chain, lib);
    let Value::Table(entries) = &mut node.value else { return };
    if let Some(own) = own {
        entries.retain(|(key, ..)| key != "tool");
        entries.push(own);
    }
    for (.., tool) in entries.iter_mut().filter(|(key, ..)| key == "tool") {
        if tool.value.get("from").is_some() {
            lay_part(tool, chain, lib);
        }
    }
}

fn lay_part(node: &mut Node, chain: &[String], lib: &mut Library<'_>) {
    let mut chain = chain.to_vec();
    if let Some(lowest) = merge_over(node, &mut chain, lib) {
        has_schema(node, At { file: lowest, offset: 0 }, lib);
    }
}

/// Adds the entries of the file that the `from` of a table names; entries of the table take precedence. Then
/// follows the `from` of that file in the same way, until no `from` is left.
///
/// Returns the index of the last file of the chain; None if there is no `from` that can be followed. A
/// `from` that cannot be followed becomes [`Value::Unread`].
fn merge_over(node: &mut Node, chain: &mut Vec<String>, lib: &mut Library<'_>) -> Option<usize> {
    let Value::Table(entries) = &mut node.value else { return None };
    let mut lowest = None;
    while let Some(place) = entries.iter().position(|(k, ..)| k == "from") {
        let (key, at, from) = entries.remove(place);
        let Some((file, under)) = follow(&from, chain, lib) else {
            entries.push((key, at, Node { at: from.at, value: Value::Unread }));
            break;
        };
        *entries = laid_over(std::mem::take(entries), under);
        lowest = Some(file);
    }
    lowest
}

/// Returns the index of the file that a `from` names, and the entries of that file.
fn follow(from: &Node, chain: &mut Vec<String>, lib: &mut Library<'_>) -> Option<(usize, Vec<Entry>)> {
    let Value::Text(name) = &from.value else {
        let message = format!("`from` must be the path of a file, not {}", from.value.kind());
        lib.error(from.at, message, "write from = \"file.toml\"");
        return None;
    };
    let path = lib.relative(name, from.at)?;
    if let Some(start) = chain.iter().position(|p| *p == path) {
        let names: Vec<_> = chain[start..].iter().chain([&path]).map(|p| shown(p)).collect();
        let message = format!("the `from` keys form a loop: {}", names.join(" -> "));
        lib.error(from.at, message, "remove `from` from one of these files");
        return None;
    }
    if chain.len() >= MAX_CHAIN {
        let message = format!("the chain of `from` keys has more than {MAX_CHAIN} files");
        lib.error(from.at, message, "remove this `from`");
        return None;
    }
    let file = lib.toml(&path, Some(from.at))?;
    let entries = lib.entries(file)?;
    chain.push(path);
    Some((file, entries))
}

/// Checks that a file or one of the files in its chain of `from` states a `schema`.
fn has_schema(root: &Node, at: At, lib: &mut Library<'_>) {
    if root.value.get("schema").is_none() && !root.value.is_partial() {
        let help = "start it with schema = \"sweetspot/cell/1\", sweetspot/robot/1, sweetspot/tool/1 or sweetspot/equipment/1";
        lib.error(at, "the file does not say what it is: `schema` is missing".into(), help);
    }
}
