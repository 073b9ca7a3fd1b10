//! `from = "other.toml"`: the keys of another file laid under those that stand beside it.
//!
//! `from` is a key like any other and the nearest one wins: a cell made `from` another cell that
//! names its own robot file takes nothing from the robot file of the other. It may stand at the top
//! of a file, in the robot, in its tool, in an equipment and in an obstacle; elsewhere it is an unknown key.

use super::document::Library;
use super::setting;
use super::setting::Setting;
use super::tree::{At, Entry, Node, Value, laid_over};
use crate::files::fault::shown;

/// Longest chain of files.
const MAX_CHAIN: usize = 16;

/// The tree of a file with every `from` followed and the settings laid over it, or None with the faults
/// recorded.
pub fn load(path: &str, settings: &[Setting], lib: &mut Library<'_>) -> Option<Node> {
    let file = lib.text(path, None)?;
    let at = At { file, offset: 0 };
    let mut root = Node { at, value: Value::Table(lib.entries(file)?) };
    let mut chain = vec![path.to_string()];
    lay(&mut root, &mut chain, lib);
    has_schema(&root, at, lib);
    setting::apply(&mut root, settings, lib);
    let Value::Table(entries) = &mut root.value else { return None };
    for (key, _, node) in entries {
        match (key.as_str(), &mut node.value) {
            ("robot", _) => lay_robot(node, &chain, lib),
            ("equipment" | "obstacle", Value::Table(parts)) => {
                parts.iter_mut().for_each(|(.., part)| lay_part(part, &chain, lib));
            }
            _ => {}
        }
    }
    Some(root)
}

/// A robot and its tool. A tool that is `from` a file beside the robot's own `from` takes the place of
/// that of the robot file: half of one and half of the other would be neither.
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
    if let Some(lowest) = lay(node, &mut chain, lib) {
        has_schema(node, At { file: lowest, offset: 0 }, lib);
    }
}

/// Lays under a table the file that its `from` names, then the one that this names, and so on;
/// returns the lowest. A `from` that cannot be followed stays, unread.
fn lay(node: &mut Node, chain: &mut Vec<String>, lib: &mut Library<'_>) -> Option<usize> {
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

/// The file that a `from` names, and its entries.
fn follow(from: &Node, chain: &mut Vec<String>, lib: &mut Library<'_>) -> Option<(usize, Vec<Entry>)> {
    let Value::Text(name) = &from.value else {
        let message = format!("`from` must be the path of a file, not {}", from.value.kind());
        lib.error(from.at, message, "write from = \"file.toml\"");
        return None;
    };
    let path = lib.relative(name, from.at)?;
    if let Some(start) = chain.iter().position(|p| *p == path) {
        let names: Vec<_> = chain[start..].iter().chain([&path]).map(|p| shown(p)).collect();
        let message = format!("`from` goes round in a circle: {}", names.join(" -> "));
        lib.error(from.at, message, "let one of these files stand on its own");
        return None;
    }
    if chain.len() >= MAX_CHAIN {
        let message = format!("`from` goes through more than {MAX_CHAIN} files");
        lib.error(from.at, message, "let this file stand on its own");
        return None;
    }
    let file = lib.text(&path, Some(from.at))?;
    let entries = lib.entries(file)?;
    chain.push(path);
    Some((file, entries))
}

/// Every file says what it is, itself or through its `from`.
fn has_schema(root: &Node, at: At, lib: &mut Library<'_>) {
    if root.value.get("schema").is_none() && !root.value.is_partial() {
        let help = "start it with schema = \"sweetspot/cell/1\", sweetspot/robot/1, sweetspot/tool/1 or sweetspot/equipment/1";
        lib.error(at, "the file does not say what it is: `schema` is missing".into(), help);
    }
}
