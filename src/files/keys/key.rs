//! An entry of the tables of keys: name, kind of value, need, default, help and example.

use crate::units;
use serde_json::{Value, json};
use std::iter::successors;

/// Largest length (mm) or angle (degrees) that any file can mean.
pub const LARGEST: f64 = 1e7;

/// Smallest size or weight that any file can mean.
pub const SMALLEST: f64 = 1e-6;

/// Longest name, characters.
pub const MAX_NAME: usize = 60;

/// Most allowed values of a coordinate.
pub const MAX_VALUES: usize = 1000;

/// Number of items that stands for "any number of them".
pub const MANY: usize = usize::MAX;

/// Values that a number may have, in the unit of the file. Every number is finite and within 1e7.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NumberRange {
    Finite,
    Positive,
    NotNegative,
    /// Half the width of a tolerance: not negative.
    PlusMinus,
    /// From 0 to this value.
    UpTo(f64),
    /// From 0 on, and less than this value.
    Below(f64),
}

/// Kind of value that a key has.
#[derive(Debug, Clone, Copy)]
pub enum Kind {
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
    Named(&'static Kind, usize),
    /// List of so many items, from the first number to the second, with their noun.
    List(&'static Kind, (usize, usize), &'static str),
    Either(&'static [Kind]),
    /// Kind whose JSON Schema says more about the value.
    Checked(&'static Kind, fn() -> Value),
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

/// Unit of the numbers of a key, told by the ending of its name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum KeyUnit {
    None,
    Millimetres,
    Degrees,
    Percent,
    MillimetresPerDegree,
}

/// One key of a table in the files.
#[derive(Debug, Clone, Copy)]
pub struct Key {
    pub name: &'static str,
    pub kind: Kind,
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
    pub const fn new(name: &'static str, kind: Kind, help: &'static str) -> Self {
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

/// Closed set of values, each with its word in the files.
pub trait Word: Copy + 'static {
    fn all() -> &'static [Self];
    fn word(self) -> &'static str;
}

/// Returns the words of a closed set.
pub fn words_of<W: Word>() -> Vec<String> {
    W::all().iter().map(|value| value.word().to_string()).collect()
}

/// Implements [`Word`] for types with a list `ALL` and a method `name`.
macro_rules! words {
    ($($kind:ty),* $(,)?) => { $(
        impl $crate::files::keys::key::Word for $kind {
            fn all() -> &'static [Self] {
                &<$kind>::ALL
            }
            fn word(self) -> &'static str {
                self.name()
            }
        }
    )* };
}
pub(crate) use words;

impl Kind {
    /// Kind of a word out of a closed set.
    pub const fn word<W: Word>() -> Self {
        Kind::Word(words_of::<W>)
    }

    /// Returns the kind without what its JSON Schema says more.
    pub fn plain(&self) -> &Kind {
        if let Kind::Checked(kind, _) = self { kind.plain() } else { self }
    }

    /// Returns the table in a value of this kind, or in its items.
    pub fn table(&self) -> Option<&'static KeyTable> {
        match self {
            Kind::Table(table) => Some(table),
            Kind::Named(kind, _) | Kind::List(kind, ..) | Kind::Checked(kind, _) => kind.table(),
            Kind::Either(kinds) => kinds.iter().find_map(Kind::table),
            _ => None,
        }
    }

    /// Returns a value of this kind, as TOML.
    pub fn example(&self) -> String {
        match self {
            Kind::Number(range) => range.example().into(),
            Kind::Coordinate(..) => "0".into(),
            Kind::Whole(least, _) => least.to_string(),
            Kind::Boolean => "true".into(),
            Kind::Text | Kind::Name | Kind::Path => "\"...\"".into(),
            Kind::Word(words) => quoted(&words()),
            Kind::Exactly(word) => format!("\"{word}\""),
            Kind::Table(table) => {
                let required = table.keys().filter(|key| matches!(key.need, Need::Required));
                let entries = required.map(|key| format!("{} = {}", key.name, key.shown_example()));
                format!("{{ {} }}", entries.collect::<Vec<_>>().join(", "))
            }
            Kind::Named(of, _) => format!("{{ NAME = {} }}", of.example()),
            Kind::List(of, (least, _), _) => {
                format!("[{}]", vec![of.example(); (*least).clamp(1, 8)].join(", "))
            }
            Kind::Either(kinds) => kinds.first().map(Kind::example).unwrap_or_default(),
            Kind::Checked(kind, _) => kind.example(),
        }
    }
}

/// Returns words in quotes, with "or" between them.
pub fn quoted(words: &[String]) -> String {
    format!("\"{}\"", words.join("\" or \""))
}

impl KeyUnit {
    /// Converts a number of a file to SI.
    pub fn si(self, value: f64) -> f64 {
        match self {
            KeyUnit::None => value,
            KeyUnit::Millimetres => units::m_from_mm(value),
            KeyUnit::Degrees => units::rad_from_deg(value),
            KeyUnit::Percent => units::share_from_percent(value),
            KeyUnit::MillimetresPerDegree => units::m_from_mm(value) / units::rad_from_deg(1.0),
        }
    }

    /// Returns the unit as people write it.
    pub fn name(self) -> &'static str {
        match self {
            KeyUnit::None => "",
            KeyUnit::Millimetres => "mm",
            KeyUnit::Degrees => "degrees",
            KeyUnit::Percent => "per cent",
            KeyUnit::MillimetresPerDegree => "mm per degree",
        }
    }
}

impl NumberRange {
    /// Returns what is wrong with a value, and what to do.
    pub fn refuses(self, value: f64) -> Option<(String, String)> {
        let at_least_0 = "write 0 or a number greater than 0";
        let (wrong, remedy) = match self {
            _ if !value.is_finite() => {
                ("must be a finite number", "write a plain number: nan and inf are no measures")
            }
            _ if value.abs() > LARGEST => {
                ("must be from -1e7 to 1e7", "is the unit right? lengths are in mm, angles in degrees")
            }
            Self::Positive if value <= 0.0 => ("must be greater than 0", "write a number greater than 0"),
            Self::Positive if value < SMALLEST => {
                ("must be at least 1e-6", "is the unit right? lengths are in mm")
            }
            Self::NotNegative | Self::UpTo(_) | Self::Below(_) if value < 0.0 => {
                ("must not be negative", at_least_0)
            }
            Self::PlusMinus if value < 0.0 => {
                ("must not be negative", "a plus-or-minus has no sign; a sample has: kind = \"signed\"")
            }
            Self::UpTo(most) if value > most => {
                return Some((format!("must be at most {most}"), format!("write a number from 0 to {most}")));
            }
            Self::Below(end) if value >= end => {
                return Some((
                    format!("must be less than {end}"),
                    format!("write a number from 0 on, below {end}"),
                ));
            }
            _ => return None,
        };
        Some((wrong.to_string(), remedy.to_string()))
    }

    /// Returns a number to write for a missing one.
    pub fn example(self) -> &'static str {
        if self == Self::Positive { "100" } else { "0" }
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
