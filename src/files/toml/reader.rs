//! Typed reading of the located tree: every fault is recorded and reading goes on.
//!
//! What a reader returns is only good if no fault was recorded: [`crate::files::load`] sees to that.

use super::document::Library;
use super::tree::{At, Entry, Node, Value};
use super::value;
use super::value::Must;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::pose::Pose;
use crate::units;
use nalgebra::Vector3;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};

/// Keys that readers asked for, by the name of their table.
pub type AskedKeys = BTreeMap<String, BTreeSet<&'static str>>;

thread_local! {
    static ASKED: RefCell<Option<AskedKeys>> = const { RefCell::new(None) };
}

/// Returns the keys that `read` asks for in this thread. The test of the schema compares them with its keys;
/// no message lists more than 20 keys of a table, so that no other way shows them all.
pub fn keys_asked_by(read: impl FnOnce()) -> AskedKeys {
    ASKED.set(Some(AskedKeys::new()));
    read();
    ASKED.take().unwrap_or_default()
}

/// A table being read. Keys that are missing, and keys that nobody asked for, are reported at the end
/// of [`Table::read`]: only then is it known which of them is a misspelling of which.
pub struct Table<'n> {
    pub at: At,
    entries: &'n [Entry],
    asked: Vec<&'static str>,
    /// Keys of which one must be there, and what to do about it.
    missing: Vec<(Vec<&'static str>, String)>,
    /// Some keys were lost with a file that could not be read, or it is not the table it should be.
    pub partial: bool,
}

impl<'n> Table<'n> {
    /// Reads a table with `read` and reports its missing and unknown keys.
    pub fn read<T>(
        node: &'n Node,
        what: &str,
        lib: &mut Library<'_>,
        read: impl FnOnce(&mut Self, &mut Library<'_>) -> Option<T>,
    ) -> Option<T> {
        let entries = match &node.value {
            Value::Table(entries) => entries,
            Value::Unread => return None,
            other => {
                let message = format!("{what} must be a table, not {}", other.kind());
                lib.error(node.at, message, "write its keys under a header in [ ], or in { }");
                return None;
            }
        };
        let partial = node.value.is_partial();
        let mut table = Self { at: node.at, entries, asked: Vec::new(), missing: Vec::new(), partial };
        let result = read(&mut table, lib);
        ASKED.with_borrow_mut(|all| {
            if let Some(all) = all {
                all.entry(what.to_string()).or_default().extend(&table.asked);
            }
        });
        table.finish(lib);
        result
    }

    /// The node of a key that may be missing.
    pub fn get(&mut self, key: &'static str) -> Option<&'n Node> {
        if !self.asked.contains(&key) {
            self.asked.push(key);
        }
        self.entries.iter().find(|(k, ..)| k == key).map(|(.., node)| node)
    }

    /// The node of a key that must be there; `help` says what to write.
    pub fn need(&mut self, key: &'static str, help: impl Into<String>) -> Option<&'n Node> {
        let found = self.get(key);
        if found.is_none() {
            self.missing.push((vec![key], help.into()));
        }
        found
    }

    /// Says that one of these keys must be there and is not; none of none.
    pub fn need_one_of(&mut self, keys: &[&'static str], help: impl Into<String>) {
        if !keys.is_empty() {
            self.missing.push((keys.to_vec(), help.into()));
        }
    }

    /// The rest cannot be judged: report nothing more.
    pub fn give_up(&mut self) {
        self.partial = true;
        self.entries = &[];
    }

    pub fn number(&mut self, key: &'static str, must: Must, lib: &mut Library<'_>) -> Option<f64> {
        let node = self.need(key, format!("add {key} = {}", must.example()))?;
        value::number(node, &format!("`{key}`"), must, lib)
    }

    pub fn number_or(
        &mut self,
        key: &'static str,
        default: f64,
        must: Must,
        lib: &mut Library<'_>,
    ) -> Option<f64> {
        self.get(key).map_or(Some(default), |n| value::number(n, &format!("`{key}`"), must, lib))
    }

    /// A length given in mm, in m.
    pub fn length(&mut self, key: &'static str, must: Must, lib: &mut Library<'_>) -> Option<f64> {
        self.number(key, must, lib).map(units::m_from_mm)
    }

    /// An angle given in degrees, in rad.
    pub fn angle(&mut self, key: &'static str, lib: &mut Library<'_>) -> Option<f64> {
        self.number(key, Must::BeFinite, lib).map(units::rad_from_deg)
    }

    pub fn numbers(
        &mut self,
        key: &'static str,
        len: usize,
        must: Must,
        lib: &mut Library<'_>,
    ) -> Option<Vec<f64>> {
        let node = self.need(key, format!("add {key} = {}", must.examples(len)))?;
        value::numbers(node, &format!("`{key}`"), len, must, lib)
    }

    pub fn numbers_or_zero(
        &mut self,
        key: &'static str,
        len: usize,
        must: Must,
        lib: &mut Library<'_>,
    ) -> Option<Vec<f64>> {
        let Some(node) = self.get(key) else { return Some(vec![0.0; len]) };
        value::numbers(node, &format!("`{key}`"), len, must, lib)
    }

    /// Three lengths in mm, in m.
    pub fn vector(&mut self, key: &'static str, must: Must, lib: &mut Library<'_>) -> Option<Vector3<f64>> {
        let v = self.numbers(key, 3, must, lib)?;
        Some(Vector3::from_iterator(v).map(units::m_from_mm))
    }

    /// A pose: a position (mm) under `key` and an optional `rpy_deg`.
    pub fn pose(&mut self, key: &'static str, lib: &mut Library<'_>) -> Option<Pose> {
        let position = self.vector(key, Must::BeFinite, lib);
        let rpy = self.numbers_or_zero("rpy_deg", 3, Must::BeFinite, lib);
        let rpy = rpy.map(|v| Vector3::from_iterator(v).map(units::rad_from_deg));
        Some(Pose::from_translation_rpy(position?, rpy?))
    }

    pub fn text(&mut self, key: &'static str, lib: &mut Library<'_>) -> Option<String> {
        value::text(self.need(key, format!("add {key} = \"...\""))?, key, lib)
    }

    pub fn text_or(&mut self, key: &'static str, default: &str, lib: &mut Library<'_>) -> Option<String> {
        self.get(key).map_or(Some(default.to_string()), |n| value::text(n, key, lib))
    }

    /// A text under `name` that can be shown and written to files.
    pub fn name(&mut self, lib: &mut Library<'_>) -> Option<String> {
        let node = self.need("name", "add name = \"...\"")?;
        value::checked_name(&value::text(node, "name", lib)?, node.at, lib)
    }

    pub fn boolean_or(&mut self, key: &'static str, default: bool, lib: &mut Library<'_>) -> Option<bool> {
        let Some(node) = self.get(key) else { return Some(default) };
        if let Value::Boolean(b) = node.value {
            return Some(b);
        }
        let message = format!("`{key}` must be true or false, not {}", node.value.kind());
        lib.error(node.at, message, format!("write {key} = true or {key} = false, without quotes"));
        None
    }

    /// A whole number of `min` to `max`.
    pub fn integer_or(
        &mut self,
        key: &'static str,
        default: u64,
        (min, max): (u64, u64),
        lib: &mut Library<'_>,
    ) -> Option<u64> {
        let Some(node) = self.get(key) else { return Some(default) };
        value::integer(node, &format!("`{key}`"), (min, max), lib)
    }

    /// One of a closed set of words.
    pub fn choice<T: Copy>(
        &mut self,
        key: &'static str,
        all: &[T],
        name: impl Fn(T) -> &'static str,
        default: Option<T>,
        lib: &mut Library<'_>,
    ) -> Option<T> {
        match (self.get(key), default) {
            (None, Some(value)) => Some(value),
            (None, None) => {
                self.need(key, format!("add {key} = {}", value::any_of(all, name)));
                None
            }
            (Some(node), _) => value::choice(node, key, all, name, lib),
        }
    }

    fn finish(self, lib: &mut Library<'_>) {
        // Each key that was asked for, with the file that gives it.
        let given = |key: &str| self.entries.iter().find(|(k, ..)| k == key).map(|(_, at, _)| at.file);
        let asked: Vec<_> = self.asked.iter().map(|&key| (key, given(key))).collect();
        let mut missing = if self.partial { Vec::new() } else { self.missing };
        for (key, at, node) in self.entries {
            if self.asked.contains(&key.as_str()) || matches!(node.value, Value::Unread) {
                continue;
            }
            // A key given in the same file was not meant again.
            let meant = asked.iter().filter(|(_, file)| *file != Some(at.file));
            let near = did_you_mean(key, meant.map(|(k, _)| *k));
            missing.retain(|(keys, _)| !near.is_some_and(|n| keys.contains(&n)));
            let help = match near {
                _ if key == "from" => FROM_PLACES.into(),
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", listed(self.asked.iter().copied())),
            };
            lib.error(*at, format!("unknown key `{}`", shown(key)), help);
        }
        for (keys, help) in missing {
            let message = match &keys[..] {
                [key] => format!("`{key}` is missing"),
                keys => format!("one of `{}` is missing", keys.join("`, `")),
            };
            lib.error(self.at, message, help);
        }
    }
}

const FROM_PLACES: &str =
    "it works at the top of a file, in the robot and its tool, in an equipment and in an obstacle";

/// Reads a table of named tables, each with its checked name; a missing one is empty.
pub fn read_named<'n, T>(
    table: &mut Table<'n>,
    key: &'static str,
    lib: &mut Library<'_>,
    mut read: impl FnMut(&'n str, &'n Node, &mut Library<'_>) -> Option<T>,
) -> Vec<T> {
    let Some(node) = table.get(key) else { return Vec::new() };
    if !matches!(node.value, Value::Table(_)) {
        let message = format!("`{key}` must be tables with names, not {}", node.value.kind());
        lib.error(node.at, message, format!("write [{key}.NAME] above the keys of each"));
    }
    let read_one = |(name, at, node): &'n Entry| {
        let known = value::checked_name(name, *at, lib).is_some();
        read(name, node, lib).filter(|_| known)
    };
    node.value.entries().iter().filter_map(read_one).collect()
}
