//! Typed reading of the tree of values: every fault is recorded, and reading continues.
//!
//! A table is read through its [`KeyTable`], which gives name, kind, range, unit and default of every key. No
//! other key can be read.
//!
//! The result of a reader is valid only if no fault was recorded; [`crate::files::load`] checks that.

use super::document::Library;
use super::tree::{At, Entry, Node, Value};
use super::value;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::key::{Key, KeyTable, Literal, Need, NumberRange, Rule, ValueKind, Word};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Table that is being read.
///
/// Missing and unknown keys are reported at the end of [`Table::read`]. All missing keys are then known, so
/// that an unknown key can be recognized as a misspelling of a missing key.
pub struct Table<'n, 'l, 'a> {
    pub at: At,
    pub lib: &'l mut Library<'a>,
    keys: &'static KeyTable,
    entries: &'n [Entry],
    /// Keys that do not apply, such as the limits in mm of a revolute joint.
    excluded: Vec<&'static str>,
    /// Groups of keys, each with a remedy. The table needs one key of each group, but all keys of the group
    /// are missing.
    missing: Vec<(Vec<&'static str>, String)>,
    /// Whether keys may be missing because a file could not be read, or because [`Self::give_up`] was called.
    pub partial: bool,
}

impl<'n, 'l, 'a> Table<'n, 'l, 'a> {
    /// Reads a table with `read` and reports its missing and unknown keys.
    pub fn read<T>(
        node: &'n Node,
        what: &str,
        keys: &'static KeyTable,
        lib: &'l mut Library<'a>,
        read: impl FnOnce(&mut Self) -> Option<T>,
    ) -> Option<T> {
        let entries = match &node.value {
            Value::Table(entries) => entries,
            Value::Unread => return None,
            other => {
                let message = format!("{what} must be a TOML table, not {}", other.kind());
                lib.error(
                    node.at,
                    message,
                    "write its keys below a header in [ ], or write { KEY = VALUE, ... }",
                );
                return None;
            }
        };
        let (excluded, missing, partial) = (Vec::new(), Vec::new(), node.value.is_partial());
        let mut table = Self { at: node.at, lib, keys, entries, excluded, missing, partial };
        let result = read(&mut table);
        table.finish();
        result
    }

    /// Returns whether this kind of table has the key.
    pub fn has(&self, key: &Key) -> bool {
        self.keys.key(key.name).is_some()
    }

    /// Returns the node of a key. A required key that is missing is reported.
    pub fn get(&mut self, key: &Key) -> Option<&'n Node> {
        if self.keys.key(key.name).is_none() || self.excluded.contains(&key.name) {
            return None;
        }
        let found = self.entry(key.name);
        if found.is_none() && self.is_required(key) {
            self.miss(key);
        }
        found
    }

    /// Returns the node of a key; None if the key is not given. Unlike [`Self::get`], this method does not
    /// report a missing key.
    pub fn given(&self, key: &Key) -> Option<&'n Node> {
        self.entry(key.name)
    }

    fn entry(&self, name: &str) -> Option<&'n Node> {
        self.entries.iter().find(|(k, ..)| k == name).map(|(.., node)| node)
    }

    fn is_required(&self, key: &Key) -> bool {
        match key.need {
            Need::Required => true,
            Need::Unless(other) => self.entry(other).is_none(),
            Need::Optional | Need::Default(_) => false,
        }
    }

    /// Records that a required key is missing.
    fn miss(&mut self, key: &Key) {
        if !self.missing.iter().any(|(names, _)| *names == [key.name]) {
            self.missing.push((vec![key.name], key.remedy_in_words()));
        }
    }

    /// Records that none of these keys is given although one is required.
    pub fn miss_one_of(&mut self, names: &[&'static str], remedy: impl Into<String>) {
        self.missing.push((names.to_vec(), remedy.into()));
    }

    /// Applies every [`Rule::When`] for the value `word` of the key `chosen`: some keys become required,
    /// others are excluded.
    pub fn apply_rules(&mut self, chosen: &Key, word: &str) {
        for rule in self.keys.rules_of_keys() {
            let Rule::When { key, words, needs, never } = rule else { continue };
            if *key != chosen.name || !words().iter().any(|w| w == word) {
                continue;
            }
            self.excluded.extend(*never);
            let needed = needs.iter().filter_map(|name| self.keys.key(name));
            let missing: Vec<_> = needed.filter(|key| self.entry(key.name).is_none()).collect();
            missing.into_iter().for_each(|key| self.miss(key));
        }
    }

    /// Excludes every key that the rules of the table forbid beside the key `given`.
    pub fn exclude_beside(&mut self, given: &Key) {
        for rule in self.keys.rules_of_keys() {
            if let Rule::Excludes(key, others) = rule
                && *key == given.name
            {
                self.excluded.extend(*others);
            }
        }
    }

    /// Stops the reading of a table whose keys cannot be checked. No missing or unknown key of this table is
    /// then reported.
    pub fn give_up(&mut self) {
        self.partial = true;
        self.entries = &[];
    }

    pub fn error(&mut self, at: At, message: impl Into<String>, help: impl Into<String>) {
        self.lib.error(at, message.into(), help);
    }

    /// Reads a key with `read` if the key is given; returns Some(None) if not.
    pub fn if_given<T>(
        &mut self,
        key: &Key,
        read: impl FnOnce(&mut Self, &Key) -> Option<T>,
    ) -> Option<Option<T>> {
        if self.get(key).is_none() { Some(None) } else { read(self, key).map(Some) }
    }

    /// Reads a number and converts it to SI units.
    pub fn number(&mut self, key: &Key) -> Option<f64> {
        let range = if let ValueKind::Number(range) = key.kind { range } else { NumberRange::Finite };
        let value = match (self.get(key), key.need) {
            (Some(node), _) => value::number(node, &format!("`{}`", key.name), range, self.lib),
            (None, Need::Default(Literal::Number(value))) => Some(value),
            (None, _) => None,
        };
        value.map(|value| key.unit().si(value))
    }

    /// Reads a list of numbers and converts them to SI units. The kind of the key states how many there must
    /// be.
    pub fn numbers(&mut self, key: &Key) -> Option<Vec<f64>> {
        match key.kind.plain() {
            ValueKind::List(ValueKind::Number(range), (len, _), _) => self.numbers_of(key, *len, *range),
            _ => None,
        }
    }

    /// Reads a list of `len` numbers and converts them to SI units. If the key is neither given nor required,
    /// returns zeros.
    pub fn numbers_of(&mut self, key: &Key, len: usize, range: NumberRange) -> Option<Vec<f64>> {
        let Some(node) = self.get(key) else { return (!self.is_required(key)).then(|| vec![0.0; len]) };
        let values = value::numbers(node, &format!("`{}`", key.name), len, range, self.lib)?;
        Some(values.into_iter().map(|value| key.unit().si(value)).collect())
    }

    /// Reads a vector of three numbers and converts them to SI units.
    pub fn vector(&mut self, key: &Key) -> Option<Vector3<f64>> {
        self.numbers(key).map(Vector3::from_iterator)
    }

    /// Reads two numbers, along x and y, and converts them to SI units.
    pub fn plan(&mut self, key: &Key) -> Option<(f64, f64)> {
        self.numbers(key).map(|v| (v[0], v[1]))
    }

    /// Reads a pose: its position, and its orientation as roll, pitch and yaw.
    pub fn pose(&mut self, position: &Key, rpy: &Key) -> Option<Pose> {
        let (position, rpy) = (self.vector(position), self.vector(rpy));
        Some(Pose::from_translation_rpy(position?, rpy?))
    }

    pub fn text(&mut self, key: &Key) -> Option<String> {
        value::text(self.get(key)?, key.name, self.lib)
    }

    pub fn text_or(&mut self, key: &Key, default: &str) -> Option<String> {
        if self.get(key).is_none() { Some(default.to_string()) } else { self.text(key) }
    }

    /// Reads a text that can be shown and written to files.
    pub fn name(&mut self, key: &Key) -> Option<String> {
        let node = self.get(key)?;
        value::checked_name(&value::text(node, key.name, self.lib)?, node.at, self.lib)
    }

    pub fn boolean(&mut self, key: &Key) -> Option<bool> {
        match (self.get(key), key.need) {
            (Some(Node { value: Value::Boolean(given), .. }), _) => Some(*given),
            (Some(node), _) => {
                let message = format!("`{}` must be true or false, not {}", key.name, node.value.kind());
                let help = format!("write {0} = true or {0} = false, without quotes", key.name);
                self.error(node.at, message, help);
                None
            }
            (None, Need::Default(Literal::Boolean(value))) => Some(value),
            (None, _) => None,
        }
    }

    /// Reads a whole number.
    pub fn whole(&mut self, key: &Key) -> Option<u64> {
        let range = if let ValueKind::Whole(least, most) = key.kind { (least, most) } else { (0, u64::MAX) };
        match (self.get(key), key.need) {
            (Some(node), _) => value::whole(node, &format!("`{}`", key.name), range, self.lib),
            (None, Need::Default(Literal::Whole(value))) => Some(value),
            (None, _) => None,
        }
    }

    /// Reads one word of a closed set.
    pub fn word<W: Word>(&mut self, key: &Key) -> Option<W> {
        match (self.get(key), key.need) {
            (Some(node), _) => value::word(node, key.name, self.lib),
            (None, Need::Default(Literal::Word(word))) => {
                W::all().iter().copied().find(|value| value.word() == word)
            }
            (None, _) => None,
        }
    }

    /// Returns the items of a list.
    pub fn items(&mut self, key: &Key) -> Option<&'n [Node]> {
        value::items(self.get(key)?, key, self.lib)
    }

    /// Reads a table under a key.
    pub fn table<T>(
        &mut self,
        key: &Key,
        read: impl FnOnce(&mut Table<'n, '_, 'a>) -> Option<T>,
    ) -> Option<T> {
        let (node, keys) = (self.get(key)?, key.kind.table()?);
        Table::read(node, &format!("`{}`", key.name), keys, self.lib, read)
    }

    /// Reads a table under a key; returns `default` if the key is missing.
    pub fn table_or<T>(
        &mut self,
        key: &Key,
        default: T,
        read: impl FnOnce(&mut Table<'n, '_, 'a>) -> Option<T>,
    ) -> Option<T> {
        if self.get(key).is_none() { Some(default) } else { self.table(key, read) }
    }

    /// Reads a list of tables. The entry of a table that could not be read is None.
    pub fn tables<T>(
        &mut self,
        key: &Key,
        mut read: impl FnMut(&mut Table<'n, '_, 'a>) -> Option<T>,
    ) -> Option<Vec<Option<T>>> {
        let (items, keys) = (self.items(key)?, key.kind.table()?);
        Some(items.iter().map(|item| Table::read(item, keys.what, keys, self.lib, &mut read)).collect())
    }

    /// Reads a table of named tables. Returns the tables that have a valid name and could be read; none if
    /// the key is missing.
    pub fn named<T>(
        &mut self,
        key: &Key,
        mut read: impl FnMut(&'n str, &mut Table<'n, '_, 'a>) -> Option<T>,
    ) -> Vec<T> {
        let (Some(node), Some(keys)) = (self.get(key), key.kind.table()) else { return Vec::new() };
        if !matches!(node.value, Value::Table(_)) {
            let message = format!("`{}` must be TOML tables with names, not {}", key.name, node.value.kind());
            self.error(node.at, message, format!("write [{}.NAME] above every entry", key.name));
        }
        let read_one = |(name, at, node): &'n Entry| {
            let known = value::checked_name(name, *at, self.lib).is_some();
            Table::read(node, keys.what, keys, self.lib, |t| read(name, t)).filter(|_| known)
        };
        node.value.entries().iter().filter_map(read_one).collect()
    }

    fn finish(self) {
        let given = |key: &str| self.entries.iter().find(|(k, ..)| k == key).map(|(_, at, _)| at.file);
        let names = self.keys.keys().map(|key| key.name).filter(|name| !self.excluded.contains(name));
        // Each known key, with the file that gives it.
        let known: Vec<_> = names.map(|name| (name, given(name))).collect();
        let mut missing = if self.partial { Vec::new() } else { self.missing };
        for (key, at, node) in self.entries {
            if known.iter().any(|(name, _)| name == key) || matches!(node.value, Value::Unread) {
                continue;
            }
            if let Some(refused) = self.keys.refused_key(key) {
                // Users give a refused key in place of one of several keys, so the absence of these keys
                // is not a second fault.
                missing.retain(|(names, _)| names.len() == 1);
                self.lib.error(node.at, refused.message.into(), refused.remedy);
                continue;
            }
            // A key that the same file also gives cannot be the misspelt key.
            let meant = known.iter().filter(|(_, file)| *file != Some(at.file));
            let near = did_you_mean(key, meant.map(|(name, _)| *name));
            missing.retain(|(names, _)| !near.is_some_and(|n| names.contains(&n)));
            let help = match near {
                _ if key == "from" => FROM_PLACES.into(),
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("allowed here: {}", listed(known.iter().map(|(name, _)| *name))),
            };
            self.lib.error(*at, format!("unknown key `{}`", shown(key)), help);
        }
        for (names, help) in missing {
            let message = match &names[..] {
                [name] => format!("`{name}` is missing"),
                names => format!("one of the keys `{}` is required", names.join("`, `")),
            };
            self.lib.error(self.at, message, help);
        }
    }
}

const FROM_PLACES: &str =
    "`from` is allowed at the top of a file, in the robot and its tool, in equipment and in obstacles";
