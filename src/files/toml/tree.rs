//! Parser of TOML text to a tree of located nodes.
//!
//! serde stops at the first fault and does not keep the place of a value. The tree keeps the place of every
//! value, and [`super::reader`] reads it.

use super::nesting::too_deep;
use super::quoted::toml_key;
use crate::files::fault::shown;
use std::collections::HashMap;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

/// Deepest nesting at which recursion over the tree is safe.
const MAX_NESTING: usize = 32;

const TOO_DEEP: (&str, &str) =
    ("the values are nested too deeply", "no key of a cell file is nested so deeply");

/// Largest number of syntax faults that are examined.
const MAX_SLIPS: usize = 5_000;

/// Help text of the fault that a key is given twice.
const TWICE: &str = "remove or rename one of the two";

/// Place in a source: index of the file and byte offset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct At {
    pub file: usize,
    pub offset: usize,
}

#[derive(Debug, Clone)]
pub struct Node {
    pub at: At,
    pub value: Value,
}

/// Key, place of the key, value.
pub type Entry = (String, At, Node);

#[derive(Debug, Clone)]
pub enum Value {
    Text(String),
    Integer(i128),
    Float(f64),
    Boolean(bool),
    Datetime,
    Array(Vec<Node>),
    /// Entries in the order of the file.
    Table(Vec<Entry>),
    /// Value that could not be read; its fault is recorded.
    ///
    /// If the unread value is the `from` of a table, any key may be missing from that table.
    Unread,
}

impl Value {
    pub fn kind(&self) -> &'static str {
        match self {
            Value::Text(_) => "a text",
            Value::Integer(_) | Value::Float(_) => "a number",
            Value::Boolean(_) => "true or false",
            Value::Datetime => "a date",
            Value::Array(_) => "a list",
            Value::Table(_) => "a table",
            Value::Unread => "unread",
        }
    }

    /// Returns the items of a list.
    pub fn items(&self) -> Option<&[Node]> {
        if let Value::Array(items) = self { Some(items) } else { None }
    }

    /// Returns the number of items of a list, or the kind of any other value.
    pub fn count_or_kind(&self) -> String {
        self.items().map_or(self.kind().to_string(), |items| items.len().to_string())
    }

    /// Returns the entries of a table; none for any other value.
    pub fn entries(&self) -> &[Entry] {
        match self {
            Value::Table(entries) => entries,
            _ => &[],
        }
    }

    pub fn get(&self, key: &str) -> Option<&Node> {
        self.entries().iter().find(|(k, ..)| k == key).map(|(.., node)| node)
    }

    /// Returns whether keys of this table may be missing because a file could not be read.
    pub fn is_partial(&self) -> bool {
        self.get("from").is_some_and(|n| matches!(n.value, Value::Unread))
    }
}

/// Parses the text of a file; returns its entries, or its faults with their byte offsets.
pub fn parse(file: usize, text: &str) -> Result<Vec<Entry>, Vec<SyntaxFault>> {
    if let Some(offset) = too_deep(text, MAX_NESTING) {
        return Err(vec![(offset, TOO_DEEP.0.into(), TOO_DEEP.1)]);
    }
    let (table, errors) = DeTable::parse_recoverable(text);
    let worth = errors.iter().take(MAX_SLIPS);
    let mut faults: Vec<_> = worth.map(|e| explained(text, e.message(), e.span())).collect();
    let mut reader = Reader { file, too_deep: None };
    let entries = reader.entries(table.get_ref(), 0);
    faults.extend(reader.too_deep.map(|offset| (offset, TOO_DEEP.0.into(), TOO_DEEP.1)));
    if faults.is_empty() { Ok(entries) } else { Err(one_each(text, faults)) }
}

/// Rewords a fault of the TOML parser for readers who do not know the terms of TOML.
fn explained(text: &str, message: &str, span: Option<Range<usize>>) -> SyntaxFault {
    let span = span.unwrap_or(0..0);
    let given = text.get(span.clone()).unwrap_or("");
    let key = shown(given.trim_matches(['"', '\'']));
    let (what, help) = if message == "duplicate key" {
        (format!("`{key}` is given twice"), TWICE)
    } else if message.starts_with("string values must be quoted") && given.is_empty() {
        ("a value is missing".into(), "write one after the =")
    } else if message.starts_with("string values must be quoted") {
        (
            format!("`{key}` is not a value"),
            "put text in quotes; write numbers without a unit and with a decimal point; put commas between \
             numbers",
        )
    } else if message.contains("recursion") {
        (TOO_DEEP.0.into(), TOO_DEEP.1)
    } else {
        (format!("not TOML: {}", shown(message)), "correct the line; https://toml.io shows the syntax")
    };
    (span.start, what, help)
}

type SyntaxFault = (usize, String, &'static str);

/// Keeps the first fault of each line, because the parser reports several faults for one mistake.
///
/// If a table is given twice, the faults of its repeated keys are dropped.
fn one_each(text: &str, mut faults: Vec<SyntaxFault>) -> Vec<SyntaxFault> {
    faults.sort_by_key(|f| f.0);
    let bytes = text.as_bytes();
    // End of the line of the last kept fault.
    let mut end: Option<usize> = None;
    // Equal to `end` if that fault is in a table that is given twice.
    let mut repeated: Option<usize> = None;
    faults.retain(|(offset, _, help)| {
        let offset = *offset.min(&bytes.len());
        if end.is_some_and(|end| offset <= end) {
            return false;
        }
        let start = bytes[..offset].iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
        let line_end = bytes[offset..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |i| offset + i);
        let is_header = bytes[start..].starts_with(b"[");
        let inside = repeated.is_some_and(|from| !bytes[from..offset].windows(2).any(|w| w == b"\n["));
        end = Some(line_end);
        repeated = ((is_header || inside) && *help == TWICE).then_some(line_end);
        is_header || !inside || *help != TWICE
    });
    faults
}

struct Reader {
    file: usize,
    too_deep: Option<usize>,
}

impl Reader {
    fn entries(&mut self, table: &DeTable<'_>, depth: usize) -> Vec<Entry> {
        table.iter().map(|(key, value)| self.entry(key, value, depth)).collect()
    }

    fn entry(&mut self, key: &Spanned<DeString<'_>>, value: &Spanned<DeValue<'_>>, depth: usize) -> Entry {
        let at = At { file: self.file, offset: key.span().start };
        let mut node = self.node(value, depth);
        // The parser places a table at its header or brace; messages show the place of its key.
        if matches!(node.value, Value::Table(_)) {
            node.at = at;
        }
        (key.get_ref().to_string(), at, node)
    }

    fn node(&mut self, value: &Spanned<DeValue<'_>>, depth: usize) -> Node {
        let at = At { file: self.file, offset: value.span().start };
        if depth >= MAX_NESTING {
            self.too_deep.get_or_insert(at.offset);
            return Node { at, value: Value::Unread };
        }
        let value = match value.get_ref() {
            DeValue::String(s) => Value::Text(s.to_string()),
            DeValue::Integer(i) => match i128::from_str_radix(i.as_str(), i.radix()) {
                Ok(n) => Value::Integer(n),
                Err(_) => Value::Float(i.as_str().parse().unwrap_or(f64::INFINITY)),
            },
            DeValue::Float(f) => Value::Float(f.as_str().parse().unwrap_or(f64::NAN)),
            DeValue::Boolean(b) => Value::Boolean(*b),
            DeValue::Datetime(_) => Value::Datetime,
            DeValue::Array(items) => Value::Array(items.iter().map(|n| self.node(n, depth + 1)).collect()),
            DeValue::Table(table) => Value::Table(self.entries(table, depth + 1)),
        };
        Node { at, value }
    }
}

/// Returns the dotted keys that lead from `entries` to the value at a place; None if no value is there.
pub fn path_to(entries: &[Entry], at: At) -> Option<String> {
    entries.iter().find_map(|(key, _, node)| {
        let below = || match &node.value {
            Value::Array(items) => items.iter().find_map(|item| path_to(item.value.entries(), at)),
            value => path_to(value.entries(), at),
        };
        let rest = if node.at == at { String::new() } else { format!(".{}", below()?) };
        Some(shown(&toml_key(key)) + &rest)
    })
}

/// Merges `own` over `under`: keys of `own` override equal keys of `under`. Tables in both are merged, but
/// lists and ranges are replaced as a whole.
pub fn laid_over(own: Vec<Entry>, mut under: Vec<Entry>) -> Vec<Entry> {
    let known: HashMap<String, usize> = under.iter().enumerate().map(|(i, e)| (e.0.clone(), i)).collect();
    for (key, at, node) in own {
        match known.get(&key).and_then(|&i| under.get_mut(i)) {
            Some(entry) => {
                let lower = std::mem::replace(&mut entry.2.value, Value::Unread);
                (entry.1, entry.2) = (at, merged(node, lower));
            }
            None => under.push((key, at, node)),
        }
    }
    under
}

fn merged(own: Node, under: Value) -> Node {
    match (own.value, under) {
        (Value::Table(a), Value::Table(b)) if !is_range(&b) => {
            Node { at: own.at, value: Value::Table(laid_over(a, b)) }
        }
        (value, _) => Node { at: own.at, value },
    }
}

/// Returns whether a table is a range `{ min, max, start }`, which is replaced and never merged.
pub fn is_range(table: &[Entry]) -> bool {
    table.iter().any(|(k, ..)| k == "min" || k == "max")
}
