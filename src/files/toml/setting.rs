//! Settings: keys of a cell stated on the command line instead of in the file, by `--set` or by another flag.
//!
//! The settings are read like a small file that overrides the cell file, before anything is checked. So every
//! check of the cell applies to the settings. A fault in a setting names the flag as its place.

use super::document::{Library, Source};
use super::quoted::toml_string;
use super::tree::{Entry, Node, Value, is_range, parse};
use crate::files::fault::{Fault, did_you_mean, listed, shown};
use crate::files::keys::cell::cell;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Path of the settings among the sources. A cell cannot name a file with this path, because it has a colon.
const PLACE: &str = "--set:";

/// Name that selects every entry of a table whose keys are names chosen by the user.
const EVERY: &str = "*";

const SHAPE: &str = "write --set PATH=VALUE or PATH=VALUE,VALUE,..., for example clearance_mm=0,10";

/// Key of a cell with its value, stated on the command line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Setting {
    /// Dotted path, as in TOML: `equipment.worktable.placement.z_mm`.
    pub path: String,
    /// Value, as in TOML; a text may be written without quotes.
    pub value: String,
    /// Flag that states the setting, as typed: `--limit 5`; None for `--set`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flag: Option<String>,
}

impl Setting {
    /// Returns the setting that `--set PATH=VALUE` states.
    pub fn new(path: impl Into<String>, value: impl Into<String>) -> Self {
        Self { path: path.into(), value: value.into(), flag: None }
    }

    /// Returns the setting that a flag states; `value` is TOML.
    pub fn of_flag(flag: &str, path: &str, value: impl Into<String>) -> Self {
        Self { flag: Some(flag.to_string()), ..Self::new(path, value) }
    }

    /// Returns the setting that the flag `flag` states: in every operation, the key `key` gets the value
    /// `value` (TOML).
    pub fn of_every_operation(flag: &str, key: &str, value: impl Into<String>) -> Self {
        Self::of_flag(flag, &format!("operation.\"{EVERY}\".{key}"), value)
    }

    /// Returns path and value as they are typed after `--set`.
    pub fn words(&self) -> String {
        format!("{}={}", self.path, self.value)
    }

    /// Returns the setting as typed. Faults of the setting state this text instead of a file name.
    fn place(&self) -> String {
        self.flag.clone().unwrap_or_else(|| format!("--set {}", self.words()))
    }

    /// Returns the setting as a line of a TOML file.
    pub fn line(&self) -> String {
        let is_toml = parse(0, &format!("v = {}", self.value)).is_ok();
        match is_toml {
            true => format!("{} = {}", self.path, self.value),
            false => format!("{} = {}", self.path, toml_string(&self.value)),
        }
    }
}

/// Key of a cell, with the values that a sweep sets one after the other.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Choices {
    pub path: String,
    pub values: Vec<String>,
}

impl Choices {
    /// Reads `PATH=a,b,c`; commas in brackets, braces and quotes do not separate values.
    ///
    /// # Errors
    /// Returns the fault of the setting.
    pub fn parse(text: &str) -> Result<Self, Vec<Fault>> {
        let fault = |message: &str, help: &str| Err(vec![of_setting(text, message.to_string(), help)]);
        if text.chars().any(char::is_control) {
            return fault("the setting has a line break or another control character", SHAPE);
        }
        let [path, values] = &parted(text, '=', 2)[..] else { return fault("there is no =", SHAPE) };
        let path = path.trim().to_string();
        let keys = keys(&path);
        if keys.is_empty() {
            let help =
                "separate keys with dots; quote a name with characters other than a-z, A-Z, 0-9, _ and -";
            return fault("the text before the = is not the path of a key", help);
        }
        if keys == ["from"] {
            return fault(
                "a sweep cannot set the key `from` of the cell",
                "run a separate sweep for each cell file",
            );
        }
        let values: Vec<_> = parted(values, ',', usize::MAX).iter().map(|v| v.trim().to_string()).collect();
        if values.iter().any(String::is_empty) {
            return fault("a value is missing", SHAPE);
        }
        Ok(Self { path, values })
    }

    /// Returns whether both choices set the same key, or one choice sets a key inside the table that the
    /// other choice sets.
    pub fn meets(&self, other: &Self) -> bool {
        let (a, b) = (keys(&self.path), keys(&other.path));
        a.iter().zip(&b).all(|(a, b)| a == b)
    }
}

/// Returns a fault of the option `--set WORDS`, without line and column.
pub fn of_setting(words: &str, message: String, help: &str) -> Fault {
    without_line(&format!("--set {words}"), message, help)
}

fn without_line(place: &str, message: String, help: &str) -> Fault {
    Fault { line: 0, column: 0, ..Fault::of_file(place, message, help) }
}

/// Returns the keys of a dotted path; none if the path is invalid.
fn keys(path: &str) -> Vec<String> {
    let Ok(entries) = parse(0, &format!("{path} = 0")) else { return Vec::new() };
    let (mut keys, mut entries) = (Vec::new(), &entries[..]);
    while let [(key, _, node)] = entries {
        keys.push(key.clone());
        entries = node.value.entries();
    }
    keys
}

/// Splits a text at every `mark` outside of brackets, braces and quotes, into at most `most` parts.
fn parted(text: &str, mark: char, most: usize) -> Vec<&str> {
    let (mut parts, mut start, mut depth, mut quote) = (Vec::new(), 0, 0, None);
    let mut characters = text.char_indices();
    while let Some((at, c)) = characters.next() {
        match (c, quote) {
            // TOML escapes the next character in double quotes only.
            ('\\', Some('"')) => drop(characters.next()),
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

/// Applies the settings to the tree of a cell.
///
/// Before this call, the caller must follow the `from` at the top of the cell. After the call, the caller
/// follows every other `from`.
pub fn apply(root: &mut Node, settings: &[Setting], lib: &mut Library<'_>) {
    if settings.is_empty() {
        return;
    }
    let lines: Vec<_> = settings.iter().map(Setting::line).collect();
    lib.sources.push(Source { path: PLACE.into(), bytes: lines.join("\n").into_bytes() });
    let file = lib.sources.len() - 1;
    lib.flags = Some((file, settings.iter().map(|s| s.flag.is_some()).collect()));
    let Some(entries) = lib.entries(file) else { return };
    let Value::Table(under) = &mut root.value else { return };
    take_back_signed(settings, under);
    let entries = entries.into_iter().map(|entry| without_strangers(entry, settings, under, lib)).collect();
    merge_over(entries, under);
}

/// Removes `reading = "signed"` of the file if a flag chooses the error set or the registration. The key
/// is kept if a setting states a reading.
///
/// Without the key, the kind of the error sets decides the reading. The word "signed" would be wrong for
/// tolerances, which have no signed sample.
fn take_back_signed(settings: &[Setting], under: &mut Vec<Entry>) {
    let is_set = |key: &str| settings.iter().any(|s| s.path == key);
    let chooses = |s: &Setting| s.flag.is_some() && (s.path == "errors" || s.path == "registration");
    if settings.iter().any(chooses) && !is_set("reading") {
        let is_signed = |node: &Node| matches!(&node.value, Value::Text(word) if word == "signed");
        under.retain(|(key, _, node)| key != "reading" || !is_signed(node));
    }
}

/// Checks the named tables of a setting. A table that the cell does not have is removed and recorded as
/// a fault.
///
/// A table remains if a setting has the path of the whole table, such as `equipment.NAME`. Such a setting
/// adds a missing table to the cell.
fn without_strangers(entry: Entry, settings: &[Setting], under: &[Entry], lib: &mut Library<'_>) -> Entry {
    let (key, at, mut node) = entry;
    if !cell::TABLE.keys().any(|k| k.name == key && k.kind.is_named()) {
        return (key, at, node);
    }
    let known =
        || under.iter().filter(|e| e.0 == key).flat_map(|e| e.2.value.entries()).map(|e| e.0.as_str());
    if let Value::Table(named) = &mut node.value {
        spread(named, known());
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

/// Replaces the entry named `*` by one entry for each known name. An entry for a single name takes
/// precedence.
fn spread<'n>(named: &mut Vec<Entry>, known: impl Iterator<Item = &'n str>) {
    let Some(place) = named.iter().position(|(name, ..)| name == EVERY) else { return };
    let (_, at, every) = named.remove(place);
    for name in known {
        match named.iter_mut().find(|(own, ..)| own == name) {
            None => named.push((name.to_string(), at, every.clone())),
            Some((.., own)) => {
                let Value::Table(own) = &mut own.value else { continue };
                let missing = every.value.entries().iter().filter(|e| own.iter().all(|o| o.0 != e.0));
                let missing: Vec<_> = missing.cloned().collect();
                own.extend(missing);
            }
        }
    }
}

/// Merges settings over entries, like `from`: tables are merged, everything else is replaced.
///
/// A merged table keeps its place in the file. So the faults of keys that no setting overrides still point to
/// the file.
fn merge_over(settings: Vec<Entry>, under: &mut Vec<Entry>) {
    for (key, at, node) in settings {
        match under.iter_mut().find(|e| e.0 == key) {
            None => under.push((key, at, node)),
            Some((_, place, old)) => match (node.value, &mut old.value) {
                (Value::Table(own), Value::Table(below)) if !is_range(below) => merge_over(own, below),
                (value, _) => (*place, *old) = (at, Node { at: node.at, value }),
            },
        }
    }
}

/// Replaces the place of each fault of a setting with the flag that states the setting. Also removes the
/// settings from the sources.
pub fn put_in_words(settings: &[Setting], faults: &mut [Fault], sources: &mut Vec<Source>) {
    sources.retain(|s| s.path != PLACE);
    for fault in faults.iter_mut().filter(|f| f.file == PLACE) {
        let Some(setting) = settings.get(fault.line.saturating_sub(1)) else { continue };
        let message = std::mem::take(&mut fault.message);
        *fault = Fault { severity: fault.severity, ..without_line(&setting.place(), message, &fault.help) };
    }
}
