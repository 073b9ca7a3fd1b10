//! `PATH=VALUE`: keys of a cell said otherwise than in its file, before anything is checked.
//!
//! The settings are read like a small file that lies over the cell file: so every check of the cell
//! applies to them, and a fault in one is told with its own words.

use super::document::{Library, Source};
use super::tree::{Entry, Node, Value, is_range, parse};
use crate::files::fault::{Fault, did_you_mean, listed, shown};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Stands for the settings among the sources; no file can have this name.
const PLACE: &str = "--set:";

/// Tables of the cell in which every key is a name that somebody chose.
const NAMED: [&str; 5] = ["equipment", "obstacle", "keep_out", "operation", "sense"];

const SHAPE: &str = "write --set PATH=VALUE or PATH=VALUE,VALUE,..., for example clearance_mm=0,10";

/// One key of a cell said otherwise.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Setting {
    /// Dotted, as in TOML: `equipment.worktable.placement.z_mm`.
    pub path: String,
    /// As in TOML, but a text may stand without quotes.
    pub value: String,
}

impl Setting {
    /// As it is typed.
    pub fn words(&self) -> String {
        format!("{}={}", self.path, self.value)
    }

    /// As a line of a TOML file.
    pub fn line(&self) -> String {
        let is_toml = parse(0, &format!("v = {}", self.value)).is_ok();
        match is_toml {
            true => format!("{} = {}", self.path, self.value),
            false => {
                let escaped = self.value.replace('\\', "\\\\").replace('"', "\\\"");
                format!("{} = \"{escaped}\"", self.path)
            }
        }
    }
}

/// A key of a cell, and every value that it is to have in turn.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Choices {
    pub path: String,
    pub values: Vec<String>,
}

impl Choices {
    /// Reads `PATH=a,b,c`; commas in brackets, braces and quotes part nothing.
    ///
    /// # Errors
    /// What is wrong with it.
    pub fn parse(text: &str) -> Result<Self, Vec<Fault>> {
        let fault = |message: &str, help: &str| Err(vec![of_setting(text, message.to_string(), help)]);
        if text.chars().any(char::is_control) {
            return fault("it has a line break or another control character", SHAPE);
        }
        let [path, values] = &parted(text, '=', 2)[..] else { return fault("there is no =", SHAPE) };
        let path = path.trim().to_string();
        let keys = keys(&path);
        if keys.is_empty() {
            let help = "write keys with points between them; quote a name of other characters than a-z, A-Z, 0-9, _ and -";
            return fault("its left side is no path of a cell file", help);
        }
        if keys == ["from"] {
            return fault("the cell file itself cannot be changed", "run a sweep for each cell file");
        }
        let values: Vec<_> = parted(values, ',', usize::MAX).iter().map(|v| v.trim().to_string()).collect();
        if values.iter().any(String::is_empty) {
            return fault("a value is missing", SHAPE);
        }
        Ok(Self { path, values })
    }

    /// Whether both set the same key, or one a key inside the table of the other.
    pub fn meets(&self, other: &Self) -> bool {
        let (a, b) = (keys(&self.path), keys(&other.path));
        a.iter().zip(&b).all(|(a, b)| a == b)
    }
}

/// A fault of a setting, told without a place in a file.
pub fn of_setting(words: &str, message: String, help: &str) -> Fault {
    Fault { line: 0, column: 0, ..Fault::of_file(&format!("--set {words}"), message, help) }
}

/// The keys of a dotted path; none if it is no path.
fn keys(path: &str) -> Vec<String> {
    let Ok(entries) = parse(0, &format!("{path} = 0")) else { return Vec::new() };
    let (mut keys, mut entries) = (Vec::new(), &entries[..]);
    while let [(key, _, node)] = entries {
        keys.push(key.clone());
        entries = node.value.entries();
    }
    keys
}

/// The parts of a text between marks that stand outside of brackets, braces and quotes.
fn parted(text: &str, mark: char, most: usize) -> Vec<&str> {
    let (mut parts, mut start, mut depth, mut quote) = (Vec::new(), 0, 0, None);
    for (at, c) in text.char_indices() {
        match (c, quote) {
            (c, Some(q)) => quote = (c != q).then_some(q),
            ('"' | '\'', None) => quote = Some(c),
            ('[' | '{', None) => depth += 1,
            (']' | '}', None) => depth -= 1,
            (c, None) if c == mark && depth == 0 && parts.len() + 1 < most => {
                parts.push(&text[start..at]);
                start = at + c.len_utf8();
            }
            _ => {}
        }
    }
    parts.push(&text[start..]);
    parts
}

/// Lays the settings over the tree of a cell, of which nothing but its own `from` was followed yet.
pub fn apply(root: &mut Node, settings: &[Setting], lib: &mut Library<'_>) {
    if settings.is_empty() {
        return;
    }
    let lines: Vec<_> = settings.iter().map(Setting::line).collect();
    lib.sources.push(Source { path: PLACE.into(), bytes: lines.join("\n").into_bytes() });
    let Some(entries) = lib.entries(lib.sources.len() - 1) else { return };
    let Value::Table(under) = &mut root.value else { return };
    let entries = entries.into_iter().map(|entry| without_strangers(entry, settings, under, lib)).collect();
    lay(entries, under);
}

/// A table of named tables without names that the cell does not have, unless a whole table is set.
fn without_strangers(entry: Entry, settings: &[Setting], under: &[Entry], lib: &mut Library<'_>) -> Entry {
    let (key, at, mut node) = entry;
    if !NAMED.contains(&key.as_str()) {
        return (key, at, node);
    }
    let known =
        || under.iter().filter(|e| e.0 == key).flat_map(|e| e.2.value.entries()).map(|e| e.0.as_str());
    if let Value::Table(named) = &mut node.value {
        named.retain(|(name, at, _)| {
            let is_whole = settings.iter().any(|s| keys(&s.path) == [key.as_str(), name]);
            if is_whole || known().any(|n| n == name) {
                return true;
            }
            let help = match did_you_mean(name, known()) {
                Some(near) => format!("did you mean {key}.{}?", shown(near)),
                None => format!("the cell has: {}", listed(known())),
            };
            lib.error(*at, format!("the cell has no {key} `{}`", shown(name)), help);
            false
        });
    }
    (key, at, node)
}

/// Like `from`: tables are merged, all else is replaced. A table keeps its place: what is wrong with
/// its other keys is no matter of the settings.
fn lay(settings: Vec<Entry>, under: &mut Vec<Entry>) {
    for (key, at, node) in settings {
        match under.iter_mut().find(|e| e.0 == key) {
            None => under.push((key, at, node)),
            Some((_, place, old)) => match (node.value, &mut old.value) {
                (Value::Table(own), Value::Table(below)) if !is_range(below) => lay(own, below),
                (value, _) => (*place, *old) = (at, Node { at: node.at, value }),
            },
        }
    }
}

/// The faults of settings in their words, and the sources without them.
pub fn put_in_words(settings: &[Setting], faults: &mut [Fault], sources: &mut Vec<Source>) {
    sources.retain(|s| s.path != PLACE);
    for fault in faults.iter_mut().filter(|f| f.file == PLACE) {
        let Some(setting) = settings.get(fault.line.saturating_sub(1)) else { continue };
        let told = of_setting(&setting.words(), std::mem::take(&mut fault.message), &fault.help);
        *fault = Fault { severity: fault.severity, ..told };
    }
}
