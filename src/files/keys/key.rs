//! An entry of the tables of keys: name, kind of value, need, default, help and example.

pub use super::range::{LARGEST, NumberRange, SMALLEST};
pub use super::unit::KeyUnit;
pub(crate) use super::word::words;
pub use super::word::{Word, quoted, words_of};
use serde_json::{Value, json};
use std::iter::successors;

/// Longest name, characters.
pub const MAX_NAME: usize = 60;

/// Most allowed values of a coordinate.
pub const MAX_VALUES: usize = 1000;

/// Number of items that stands for "any number of them".
pub const MANY: usize = usize::MAX;

/// Kind of value that a key has.
#[derive(Debug, Clone, Copy)]
pub enum ValueKind {
    Number(NumberRange),
    /// Whole number from the first to the second.
    Whole(u64, u64),
    Boolean,
    Text,
    /// Text that can be shown and written to files: short, printable, not blank.
    Name,
    /// Path of a file beside or below the one that names it.
    Path,
    /// One of a closed set of words.
    Word(fn() -> Vec<String>),
    /// This one word.
    Exactly(&'static str),
    /// Number that may be searched, within these bounds: fixed, a range, or a list of values.
    Coordinate(f64, f64),
    Table(&'static KeyTable),
    /// At least so many values, each under a name that somebody chose.
    Named(&'static ValueKind, usize),
    /// List of so many items, from the first number to the second, with their noun.
    List(&'static ValueKind, (usize, usize), &'static str),
    Either(&'static [ValueKind]),
    /// Kind whose JSON Schema says more about the value.
    Checked(&'static ValueKind, fn() -> Value),
}

/// Whether a key must be given, and what holds if it is not.
#[derive(Debug, Clone, Copy)]
pub enum Need {
    Required,
    /// Required in a table without this other key.
    Unless(&'static str),
    Optional,
    Default(Literal),
}

/// Default value of a key, in the unit of the file.
#[derive(Debug, Clone, Copy)]
pub enum Literal {
    Number(f64),
    Whole(u64),
    Boolean(bool),
    Word(&'static str),
    /// List of so many zeros.
    Zeros(usize),
}

/// One key of a table in the files.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    pub name: &'static str,
    pub kind: ValueKind,
    pub need: Need,
    /// Sentence for people, without the unit.
    pub help: &'static str,
    /// Value to show, as TOML; empty: any value of the kind.
    pub example: &'static str,
    /// What to do if the key is missing; empty: add the example.
    pub remedy: &'static str,
}

impl Key {
    /// An optional key.
    pub const fn new(name: &'static str, kind: ValueKind, help: &'static str) -> Self {
        Self { name, kind, need: Need::Optional, help, example: "", remedy: "" }
    }

    pub const fn required(self) -> Self {
        Self { need: Need::Required, ..self }
    }

    pub const fn required_unless(self, other: &'static str) -> Self {
        Self { need: Need::Unless(other), ..self }
    }

    pub const fn default(self, value: Literal) -> Self {
        Self { need: Need::Default(value), ..self }
    }

    pub const fn example(self, example: &'static str) -> Self {
        Self { example, ..self }
    }

    pub const fn remedy(self, remedy: &'static str) -> Self {
        Self { remedy, ..self }
    }

    /// Returns the unit that the ending of the name tells.
    pub fn unit(&self) -> KeyUnit {
        let endings = [
            ("mm_per_deg", KeyUnit::MillimetresPerDegree),
            ("_mm", KeyUnit::Millimetres),
            ("_deg", KeyUnit::Degrees),
            ("_percent", KeyUnit::Percent),
        ];
        endings.into_iter().find(|(end, _)| self.name.ends_with(end)).map_or(KeyUnit::None, |(_, unit)| unit)
    }

    /// Returns a value to show, as TOML.
    pub fn shown_example(&self) -> String {
        if self.example.is_empty() { self.kind.example() } else { self.example.to_string() }
    }

    /// Returns what to do about the missing key.
    pub fn remedy_in_words(&self) -> String {
        match self.remedy {
            "" => format!("add {} = {}", self.name, self.shown_example()),
            remedy => remedy.to_string(),
        }
    }
}

/// Keys of one kind of table: nothing else is read from such a table.
#[derive(Debug)]
pub struct KeyTable {
    /// What messages call such a table, with its article.
    pub what: &'static str,
    /// Sentence for people.
    pub help: &'static str,
    own: &'static [Key],
    extends: Option<&'static KeyTable>,
    own_rules: &'static [Rule],
    own_refused: &'static [Refused],
}

impl KeyTable {
    pub const fn new(what: &'static str, help: &'static str, own: &'static [Key]) -> Self {
        Self { what, help, own, extends: None, own_rules: &[], own_refused: &[] }
    }

    /// Adds the keys and rules of another table.
    pub const fn extends(self, other: &'static KeyTable) -> Self {
        Self { extends: Some(other), ..self }
    }

    pub const fn rules(self, own_rules: &'static [Rule]) -> Self {
        Self { own_rules, ..self }
    }

    pub const fn refused(self, own_refused: &'static [Refused]) -> Self {
        Self { own_refused, ..self }
    }

    /// Returns all keys.
    pub fn keys(&'static self) -> impl Iterator<Item = &'static Key> {
        self.and_extended().flat_map(|table| table.own)
    }

    /// Returns all rules.
    pub fn rules_of_keys(&'static self) -> impl Iterator<Item = &'static Rule> {
        self.and_extended().flat_map(|table| table.own_rules)
    }

    /// Returns a key that somebody might expect in the table, but that it has not.
    pub fn refused_key(&'static self, name: &str) -> Option<&'static Refused> {
        self.and_extended().flat_map(|table| table.own_refused).find(|refused| refused.name == name)
    }

    fn and_extended(&'static self) -> impl Iterator<Item = &'static KeyTable> {
        successors(Some(self), |table| table.extends)
    }

    pub fn key(&'static self, name: &str) -> Option<&'static Key> {
        self.keys().find(|key| key.name == name)
    }
}

/// Key that a table has not, although somebody might expect it.
#[derive(Debug)]
pub struct Refused {
    pub name: &'static str,
    /// Why the table has no such key.
    pub message: &'static str,
    pub remedy: &'static str,
}

/// Rule about several keys of a table.
#[derive(Debug)]
pub enum Rule {
    /// At least one of the keys must be given.
    AnyOf(&'static [&'static str]),
    /// No two of the keys stand together.
    OneAtMost(&'static [&'static str]),
    /// Beside the first key none of the others stands.
    Excludes(&'static str, &'static [&'static str]),
    /// None of the others stands without the first key.
    OnlyWith(&'static str, &'static [&'static str]),
    /// The first key needs the second.
    Needs(&'static str, &'static str),
    /// If `key` has one of `words`, `needs` must be given and `never` must not.
    When {
        key: &'static str,
        words: fn() -> Vec<String>,
        needs: &'static [&'static str],
        never: &'static [&'static str],
    },
    /// If the key has this word, no number of the table is negative.
    NotNegativeWhen(&'static str, &'static str),
}

impl ValueKind {
    /// Kind of a word out of a closed set.
    pub const fn word<W: Word>() -> Self {
        ValueKind::Word(words_of::<W>)
    }

    /// Returns the kind without what its JSON Schema says more.
    pub fn plain(&self) -> &ValueKind {
        if let ValueKind::Checked(kind, _) = self { kind.plain() } else { self }
    }

    /// Returns the table in a value of this kind, or in its items.
    pub fn table(&self) -> Option<&'static KeyTable> {
        match self {
            ValueKind::Table(table) => Some(table),
            ValueKind::Named(kind, _) | ValueKind::List(kind, ..) | ValueKind::Checked(kind, _) => {
                kind.table()
            }
            ValueKind::Either(kinds) => kinds.iter().find_map(ValueKind::table),
            _ => None,
        }
    }

    /// Returns a value of this kind, as TOML.
    pub fn example(&self) -> String {
        match self {
            ValueKind::Number(range) => range.example().into(),
            ValueKind::Coordinate(..) => "0".into(),
            ValueKind::Whole(least, _) => least.to_string(),
            ValueKind::Boolean => "true".into(),
            ValueKind::Text | ValueKind::Name | ValueKind::Path => "\"...\"".into(),
            ValueKind::Word(words) => quoted(&words()),
            ValueKind::Exactly(word) => format!("\"{word}\""),
            ValueKind::Table(table) => {
                let required = table.keys().filter(|key| matches!(key.need, Need::Required));
                let entries = required.map(|key| format!("{} = {}", key.name, key.shown_example()));
                format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
            }
            ValueKind::Named(of, _) => format!("{{ NAME = {} }}", of.example()),
            ValueKind::List(of, (least, _), _) => {
                format!("[{}]", vec![of.example(); (*least).clamp(1, 8)].join(", "))
            }
            ValueKind::Either(kinds) => kinds.first().map(ValueKind::example).unwrap_or_default(),
            ValueKind::Checked(kind, _) => kind.example(),
        }
    }
}

impl Literal {
    pub fn json(self) -> Value {
        match self {
            Literal::Number(value) if value.fract() == 0.0 => json!(value as i64),
            Literal::Number(value) => json!(value),
            Literal::Whole(value) => json!(value),
            Literal::Boolean(value) => json!(value),
            Literal::Word(word) => json!(word),
            Literal::Zeros(count) => json!(vec![0; count]),
        }
    }
}
