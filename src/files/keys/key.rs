//! Key of a TOML table in the files: name, kind of value, whether it is required, default, help and example.

pub use super::range::{LARGEST, NumberRange, SMALLEST};
pub use super::unit::KeyUnit;
pub(crate) use super::word::words;
pub use super::word::{Word, quoted, words_of};
use serde_json::{Value, json};
use std::iter::successors;

/// Largest number of characters of a name.
pub const MAX_NAME: usize = 60;

/// Largest number of allowed values of a coordinate.
pub const MAX_VALUES: usize = 1000;

/// Value that stands for "no upper limit" in the number of items of a list.
pub const UNBOUNDED: usize = usize::MAX;

/// Kind of value that a key has.
#[derive(Debug, Clone, Copy)]
pub enum ValueKind {
    Number(NumberRange),
    /// Whole number from the first bound to the second.
    Whole(u64, u64),
    Boolean,
    Text,
    /// Text that can be shown and written to files: short, printable, not blank.
    Name,
    /// Path of a file, relative to the folder of the file that has the key. The path must not leave the
    /// folder of the cell file.
    Path,
    /// One of a closed set of words.
    Word(fn() -> Vec<String>),
    /// Fixed text; no other value is accepted.
    Exactly(&'static str),
    /// Coordinate within these bounds: a fixed number, a range to search, or a list of values to choose from.
    Coordinate(f64, f64),
    Table(&'static KeyTable),
    /// Table whose keys are names chosen by the user. The fields are the kind of the values and the least
    /// number of entries.
    Named(&'static ValueKind, usize),
    /// List of items. The fields are the kind of the items, their least and greatest number, and the noun for
    /// items in messages.
    List(&'static ValueKind, (usize, usize), &'static str),
    Either(&'static [ValueKind]),
    /// Value of the kind that the first field states. The second field returns additions to the JSON Schema
    /// of the value.
    Checked(&'static ValueKind, fn() -> Value),
}

/// Requirement of a key: whether the key must be given, and its default if it may be left out.
#[derive(Debug, Clone, Copy)]
pub enum Need {
    Required,
    /// Required if this other key is missing.
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
    /// List of this many zeros.
    Zeros(usize),
}

/// Key of a table in the files.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    pub name: &'static str,
    pub kind: ValueKind,
    pub need: Need,
    /// Explanation of the key for users: a sentence, without the unit.
    pub help: &'static str,
    /// Example of a value, as TOML. If this text is empty, [`ValueKind::example`] replaces it.
    pub example: &'static str,
    /// Help text for a missing key. If this text is empty, the help says to add the example.
    pub remedy: &'static str,
}

impl Key {
    /// Returns an optional key.
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

    /// Returns the unit that the ending of the key's name states.
    pub fn unit(&self) -> KeyUnit {
        let endings = [
            ("mm_per_deg", KeyUnit::MillimetresPerDegree),
            ("deg_per_m", KeyUnit::DegreesPerMetre),
            ("deg_per_Nm", KeyUnit::DegreesPerNewtonMetre),
            ("_deg_s2", KeyUnit::DegreesPerSecondSquared),
            ("_deg_s", KeyUnit::DegreesPerSecond),
            ("_mm_s2", KeyUnit::MillimetresPerSecondSquared),
            ("_mm_s", KeyUnit::MillimetresPerSecond),
            ("_s", KeyUnit::Seconds),
            ("_kg", KeyUnit::Kilograms),
            ("_mm", KeyUnit::Millimetres),
            ("_deg", KeyUnit::Degrees),
            ("_percent", KeyUnit::Percent),
        ];
        endings.into_iter().find(|(end, _)| self.name.ends_with(end)).map_or(KeyUnit::None, |(_, unit)| unit)
    }

    /// Returns an example of a value, as TOML.
    pub fn shown_example(&self) -> String {
        if self.example.is_empty() { self.kind.example() } else { self.example.to_string() }
    }

    /// Returns the help text for the missing key.
    pub fn remedy_in_words(&self) -> String {
        match self.remedy {
            "" => format!("add {} = {}", self.name, self.shown_example()),
            remedy => remedy.to_string(),
        }
    }
}

/// Keys of one kind of table: no other key is accepted in such a table.
#[derive(Debug)]
pub struct KeyTable {
    /// Name of this kind of table in messages, with the indefinite article.
    pub what: &'static str,
    /// Explanation of the table for users: a sentence.
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

    /// Returns all keys of the table and of the tables that it extends.
    pub fn keys(&'static self) -> impl Iterator<Item = &'static Key> {
        self.and_extended().flat_map(|table| table.own)
    }

    /// Returns all rules of the table and of the tables that it extends.
    pub fn rules_of_keys(&'static self) -> impl Iterator<Item = &'static Rule> {
        self.and_extended().flat_map(|table| table.own_rules)
    }

    /// Returns the refused key of this name: a key that users might expect, but that the table does not have.
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

/// Key that a table does not have, although users might expect it.
#[derive(Debug)]
pub struct Refused {
    pub name: &'static str,
    /// Message that says why the table has no such key.
    pub message: &'static str,
    pub remedy: &'static str,
}

/// Rule about several keys of a table.
#[derive(Debug)]
pub enum Rule {
    /// At least one of these keys must be given.
    AnyOf(&'static [&'static str]),
    /// At most one of these keys may be given.
    OneAtMost(&'static [&'static str]),
    /// If the first key is given, none of the other keys may be given.
    Excludes(&'static str, &'static [&'static str]),
    /// If the first key is missing, none of the other keys may be given.
    OnlyWith(&'static str, &'static [&'static str]),
    /// If the first key is given, the second must be given.
    Needs(&'static str, &'static str),
    /// If the value of `key` is one of `words`, the keys `needs` must be given and the keys `never` must not
    /// be given.
    When {
        key: &'static str,
        words: fn() -> Vec<String>,
        needs: &'static [&'static str],
        never: &'static [&'static str],
    },
    /// If the key has this word as its value, no number of the table may be negative.
    NotNegativeWhen(&'static str, &'static str),
}

impl ValueKind {
    /// Returns whether the value is a table whose keys are names chosen by the user.
    pub fn is_named(&self) -> bool {
        match self {
            ValueKind::Named(..) => true,
            ValueKind::Checked(kind, _) => kind.is_named(),
            _ => false,
        }
    }

    /// Returns the kind of value that is one word of a closed set.
    pub const fn word<W: Word>() -> Self {
        ValueKind::Word(words_of::<W>)
    }

    /// Returns the kind inside [`Self::Checked`]; returns any other kind unchanged.
    pub fn plain(&self) -> &ValueKind {
        if let ValueKind::Checked(kind, _) = self { kind.plain() } else { self }
    }

    /// Returns the key table of a value of this kind, or of its items; None if neither the value nor the
    /// items are tables.
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
