//! TOML files to one tree of located nodes; `from = "other.toml"` laid under what stands beside it.
//!
//! serde stops at the first fault and forgets where a value stood, so the tree keeps the place of
//! every value and [`super::reader`] reads it. A table with a key `from` takes every key it does
//! not set itself from the top of the named file, which may do the same again.

use super::fault::{Fault, Severity, shown};
use std::collections::BTreeMap;
use toml::de::{DeTable, DeValue};

/// Longest chain of `from`.
const MAX_DEPTH: usize = 16;

/// A file as it was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// Relative to the folder of the cell file, with forward slashes.
    pub path: String,
    pub text: String,
}

/// A place in one of the sources: index of the file, byte offset.
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

#[derive(Debug, Clone)]
pub enum Value {
    Text(String),
    Integer(i64),
    Float(f64),
    Boolean(bool),
    Datetime,
    Array(Vec<Node>),
    /// In the order of the file; the place is the key's.
    Table(Vec<(String, At, Node)>),
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
        }
    }
}

/// Gives the text of the file at a path relative to the cell's folder, or says why not.
/// The path has been normalized and does not leave that folder.
pub type ReadFile<'a> = dyn FnMut(&str) -> Result<String, String> + 'a;

/// All files read so far and all faults found so far.
pub struct Library<'a> {
    read: &'a mut ReadFile<'a>,
    pub sources: Vec<Source>,
    pub faults: Vec<Fault>,
    parsed: BTreeMap<String, Option<Node>>,
}

impl<'a> Library<'a> {
    pub fn new(read: &'a mut ReadFile<'a>) -> Self {
        Self { read, sources: Vec::new(), faults: Vec::new(), parsed: BTreeMap::new() }
    }

    /// Records a fault at a place.
    pub fn fault(&mut self, at: At, severity: Severity, message: String, help: impl Into<String>) {
        let source = &self.sources[at.file];
        let before = &source.text[..floor_char(&source.text, at.offset)];
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap_or("").chars().count() + 1;
        let full = source.text.lines().nth(line - 1).unwrap_or("");
        let excerpt: String = full.chars().take(160).map(|c| if c.is_control() { ' ' } else { c }).collect();
        let file = source.path.clone();
        self.faults.push(Fault { severity, file, line, column, message, help: help.into(), excerpt });
    }

    pub fn error(&mut self, at: At, message: String, help: impl Into<String>) {
        self.fault(at, Severity::Error, message, help);
    }

    /// The text of a file named at `at`, with its index among the sources.
    pub fn text(&mut self, path: &str, at: Option<At>) -> Option<usize> {
        if let Some(known) = self.sources.iter().position(|s| s.path == path) {
            return Some(known);
        }
        match (self.read)(path) {
            Ok(text) => {
                self.sources.push(Source { path: path.to_string(), text });
                Some(self.sources.len() - 1)
            }
            Err(why) => {
                let message = format!("cannot read `{}`: {why}", shown(path));
                let help = "paths are relative to the file that names them";
                match at {
                    Some(at) => self.error(at, message, help),
                    None => {
                        self.faults.push(Fault::of_file(path, message, "check the path of the cell file"))
                    }
                }
                None
            }
        }
    }

    /// The tree of a file with every `from` resolved, or None with the faults recorded.
    pub fn load(&mut self, path: &str) -> Option<Node> {
        let mut chain = vec![path.to_string()];
        self.load_chained(path, None, &mut chain)
    }

    fn load_chained(&mut self, path: &str, at: Option<At>, chain: &mut Vec<String>) -> Option<Node> {
        if let Some(known) = self.parsed.get(path) {
            return known.clone();
        }
        let file = self.text(path, at)?;
        let root = self.parse(file);
        let root = root.and_then(|node| self.resolve(node, chain));
        let root = root.filter(|node| self.has_schema(node));
        self.parsed.insert(path.to_string(), root.clone());
        root
    }

    /// Every file says what it is (itself, or through its `from`).
    fn has_schema(&mut self, root: &Node) -> bool {
        let found =
            matches!(&root.value, Value::Table(entries) if entries.iter().any(|(k, ..)| k == "schema"));
        if !found {
            let help = "start the file with schema = \"sweetspot/cell/1\", sweetspot/robot/1 or sweetspot/equipment/1";
            self.error(root.at, "`schema` is missing".into(), help);
        }
        found
    }

    fn parse(&mut self, file: usize) -> Option<Node> {
        let text = self.sources[file].text.clone();
        let (table, errors) = DeTable::parse_recoverable(&text);
        for e in &errors {
            let offset = e.span().map_or(0, |s| s.start);
            self.error(
                At { file, offset },
                format!("not TOML: {}", shown(e.message())),
                "see toml.io for the syntax",
            );
        }
        errors
            .is_empty()
            .then(|| Node { at: At { file, offset: 0 }, value: table_value(file, table.get_ref()) })
    }

    /// Lays the file named by `from` under every table that has one.
    fn resolve(&mut self, node: Node, chain: &mut Vec<String>) -> Option<Node> {
        let Node { at, value } = node;
        let value = match value {
            Value::Table(entries) => return self.resolve_table(at, entries, chain),
            Value::Array(items) => {
                let items: Vec<_> = items.into_iter().map(|n| self.resolve(n, chain)).collect();
                Value::Array(items.into_iter().collect::<Option<_>>()?)
            }
            other => other,
        };
        Some(Node { at, value })
    }

    fn resolve_table(
        &mut self,
        at: At,
        entries: Vec<(String, At, Node)>,
        chain: &mut Vec<String>,
    ) -> Option<Node> {
        let mut own = Vec::new();
        let mut base = None;
        let mut sound = true;
        for (key, key_at, node) in entries {
            if key == "from" {
                base = self.load_from(&node, chain);
                sound &= base.is_some();
            } else if let Some(node) = self.resolve(node, chain) {
                own.push((key, key_at, node));
            } else {
                sound = false;
            }
        }
        let value = match base {
            Some(Node { value: Value::Table(under), .. }) => Value::Table(laid_over(own, under)),
            _ => Value::Table(own),
        };
        sound.then_some(Node { at, value })
    }

    fn load_from(&mut self, node: &Node, chain: &mut Vec<String>) -> Option<Node> {
        let Value::Text(name) = &node.value else {
            let message = format!("`from` must be the path of a file, not {}", node.value.kind());
            self.error(node.at, message, "write from = \"file.toml\"");
            return None;
        };
        let path = self.relative(name, node.at)?;
        if let Some(start) = chain.iter().position(|p| *p == path) {
            let mut names: Vec<_> = chain[start..].iter().map(|p| shown(p)).collect();
            names.push(shown(&path));
            let message = format!("`from` goes round in a circle: {}", names.join(" -> "));
            self.error(node.at, message, "let one of these files stand on its own");
            return None;
        }
        if chain.len() >= MAX_DEPTH {
            let message = format!("`from` is nested more than {MAX_DEPTH} files deep");
            self.error(node.at, message, "flatten the chain of files");
            return None;
        }
        chain.push(path.clone());
        let loaded = self.load_chained(&path, Some(node.at), chain);
        chain.pop();
        loaded
    }

    /// A path named in the file at `at`, made relative to the cell's folder; a fault if it leaves it.
    pub fn relative(&mut self, name: &str, at: At) -> Option<String> {
        let rooted = name.starts_with('/') || name.contains(['\\', ':', '\0']);
        let naming = self.sources[at.file].path.clone();
        let mut parts: Vec<&str> = naming.split('/').collect();
        parts.pop();
        let mut leaves = rooted || name.is_empty();
        for part in name.split('/') {
            match part {
                "" | "." => {}
                ".." => leaves |= parts.pop().is_none(),
                _ => parts.push(part),
            }
        }
        if leaves {
            let message = format!("`{}` leaves the folder of the cell file", shown(name));
            self.error(
                at,
                message,
                "put the file beside the cell (or below it) and name it by a relative path with /",
            );
            return None;
        }
        Some(parts.join("/"))
    }
}

/// `own` over `under`: own keys win, tables in both are merged, lists are replaced whole.
fn laid_over(own: Vec<(String, At, Node)>, mut under: Vec<(String, At, Node)>) -> Vec<(String, At, Node)> {
    for (key, at, node) in own {
        match under.iter_mut().find(|(k, ..)| *k == key) {
            Some((_, under_at, existing)) => {
                *under_at = at;
                *existing = match (node, std::mem::replace(&mut existing.value, Value::Datetime)) {
                    (Node { at, value: Value::Table(a) }, Value::Table(b)) if !is_range(&b) => {
                        Node { at, value: Value::Table(laid_over(a, b)) }
                    }
                    (node, _) => node,
                };
            }
            None => under.push((key, at, node)),
        }
    }
    under
}

/// A range `{ min, max, start }` is one value: it is replaced, never merged.
fn is_range(table: &[(String, At, Node)]) -> bool {
    table.iter().any(|(k, ..)| k == "min" || k == "max")
}

fn table_value(file: usize, table: &DeTable<'_>) -> Value {
    let entry = |(k, v): (&toml::Spanned<toml::de::DeString<'_>>, &toml::Spanned<DeValue<'_>>)| {
        let at = At { file, offset: k.span().start };
        let offset = v.span().start;
        // A table under a header has its place there; the key is the better one to show.
        let node_at = if v.get_ref().is_table() { at } else { At { file, offset } };
        (k.get_ref().to_string(), at, Node { at: node_at, value: value_of(file, v.get_ref()) })
    };
    Value::Table(table.iter().map(entry).collect())
}

fn value_of(file: usize, value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(s) => Value::Text(s.to_string()),
        DeValue::Integer(i) => match i64::from_str_radix(i.as_str(), i.radix()) {
            Ok(n) => Value::Integer(n),
            Err(_) => {
                Value::Float(if i.as_str().starts_with('-') { f64::NEG_INFINITY } else { f64::INFINITY })
            }
        },
        DeValue::Float(f) => Value::Float(f.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(b) => Value::Boolean(*b),
        DeValue::Datetime(_) => Value::Datetime,
        DeValue::Array(items) => Value::Array(
            items
                .iter()
                .map(|n| Node { at: At { file, offset: n.span().start }, value: value_of(file, n.get_ref()) })
                .collect(),
        ),
        DeValue::Table(t) => table_value(file, t),
    }
}

fn floor_char(text: &str, offset: usize) -> usize {
    (0..=offset.min(text.len())).rev().find(|&i| text.is_char_boundary(i)).unwrap_or(0)
}
