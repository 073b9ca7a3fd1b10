//! Human-readable reference of all keys, in Markdown: one document for each kind of file.

use super::FileKind;
use crate::files::keys::key::{
    Key, KeyTable, KeyUnit, Need, NumberRange, Rule, UNBOUNDED, ValueKind, quoted,
};
use std::fmt::Write;

/// Returns the reference of all keys of a kind of file, in Markdown.
pub fn reference(kind: FileKind) -> String {
    let mut document = Document { text: String::new(), known: Vec::new(), next: Vec::new() };
    let name = kind.name();
    let _ = writeln!(document.text, "# Keys of {name} files\n");
    let _ = writeln!(document.text, "A file is TOML and begins with `schema = \"sweetspot/{name}/1\"` and");
    let _ = writeln!(
        document.text,
        "`units = {{ length = \"mm\", angle = \"deg\" }}`. Keys that this page does not list are refused."
    );
    document.find(kind.keys(), "Top of the file");
    let mut at = 0;
    while let Some((table, place)) = document.next.get(at).cloned() {
        document.add(table, &place);
        at += 1;
    }
    document.text
}

struct Document {
    text: String,
    /// Tables that have a description or will get one, each with the heading of this description.
    known: Vec<(&'static KeyTable, String)>,
    /// Tables to describe, in the order of the document, each with the heading of its description.
    next: Vec<(&'static KeyTable, String)>,
}

impl Document {
    /// Returns the heading under which a table is described. A new table will be described under `place`.
    fn find(&mut self, table: &'static KeyTable, place: &str) -> String {
        if let Some((_, known)) = self.known.iter().find(|(known, _)| known.help == table.help) {
            return known.clone();
        }
        self.known.push((table, place.to_string()));
        self.next.push((table, place.to_string()));
        place.to_string()
    }

    /// Adds the description of a table.
    fn add(&mut self, table: &'static KeyTable, place: &str) {
        let _ = writeln!(self.text, "\n## {place}\n\n{}\n", table.help);
        let _ = writeln!(self.text, "| Key | Value | Default | Meaning | Example |");
        let _ = writeln!(self.text, "|---|---|---|---|---|");
        let inside = if place.starts_with('`') { place.trim_matches(['`', '[', ']']) } else { "" };
        for key in table.keys() {
            let value = self.value(key, inside);
            let default = match key.need {
                Need::Required => "required".to_string(),
                Need::Unless(other) => format!("required without `{other}`"),
                Need::Optional => "none".to_string(),
                Need::Default(value) => format!("`{}`", value.json()),
            };
            let (name, help, example) = (key.name, key.help, key.shown_example());
            let row =
                [format!("`{name}`"), value, default, help.to_string(), format!("`{name} = {example}`")];
            let cells: Vec<_> = row.iter().map(|cell| cell.replace('|', "\\|")).collect();
            let _ = writeln!(self.text, "| {} |", cells.join(" | "));
        }
        let rules: Vec<_> = table.rules_of_keys().map(in_words).collect();
        if !rules.is_empty() {
            let _ = writeln!(self.text, "\n{}", rules.join("\n"));
        }
    }

    /// Returns the kind of value of a key, with range and unit.
    fn value(&mut self, key: &Key, inside: &str) -> String {
        let path = if inside.is_empty() { key.name.to_string() } else { format!("{inside}.{}", key.name) };
        let kind = self.kind(&key.kind, &path);
        match key.unit() {
            KeyUnit::None => kind,
            unit => format!("{kind}; {}", unit.name()),
        }
    }

    fn kind(&mut self, kind: &ValueKind, path: &str) -> String {
        match kind {
            ValueKind::Number(range) => format!("number{}", range_in_words(*range)),
            ValueKind::Whole(least, u64::MAX) => format!("whole number, {least} or greater"),
            ValueKind::Whole(least, most) => format!("whole number from {least} to {most}"),
            ValueKind::Boolean => "`true` or `false`".into(),
            ValueKind::Text => "text".into(),
            ValueKind::Name => "name, at most 60 printable characters".into(),
            ValueKind::Path => "path relative to the folder of the file".into(),
            ValueKind::Word(words) if words().len() > 12 => {
                let words = words();
                format!("`\"{}\"` and {} more words", words[0], words.len() - 1)
            }
            ValueKind::Word(words) => format!("`{}`", quoted(&words()).replace("\" or \"", "\"`, `\"")),
            ValueKind::Exactly(word) => format!("`\"{word}\"`"),
            ValueKind::Coordinate(low, high) => {
                format!("number from {low} to {high}, `{{ min, max, start }}`, or list of numbers")
            }
            ValueKind::Table(table) => {
                let place = self.find(table, &format!("`[{path}]`"));
                format!("table, see {place}")
            }
            ValueKind::Named(ValueKind::Table(table), _) => {
                let place = self.find(table, &format!("`[{path}.NAME]`"));
                format!("named tables, see {place}")
            }
            ValueKind::Named(kind, _) => format!("table of named values, each a {}", self.kind(kind, path)),
            ValueKind::List(ValueKind::Table(table), count, noun) => {
                let place = self.find(table, &format!("`[[{path}]]`"));
                format!("list of {}{noun}, see {place}", count_in_words(*count))
            }
            ValueKind::List(kind, count, noun) => {
                let each = self.kind(kind, path);
                let each = if each == "number" { String::new() } else { format!(" ({each} each)") };
                format!("list of {}{noun}{each}", count_in_words(*count))
            }
            ValueKind::Either(kinds) => {
                let ways: Vec<_> = kinds.iter().map(|kind| self.kind(kind, path)).collect();
                ways.join("; or ")
            }
            ValueKind::Checked(kind, _) => self.kind(kind, path),
        }
    }
}

fn range_in_words(range: NumberRange) -> String {
    match range {
        NumberRange::Finite => String::new(),
        NumberRange::Positive => " greater than 0".into(),
        NumberRange::NotNegative | NumberRange::PlusMinus => ", not negative".into(),
        NumberRange::UpTo(most) => format!(" from 0 to {most}"),
        NumberRange::Below(end) => format!(", at least 0 and less than {end}"),
    }
}

fn count_in_words(count: (usize, usize)) -> String {
    match count {
        (0, UNBOUNDED) => String::new(),
        (least, UNBOUNDED) => format!("{least} or more "),
        (least, most) if least == most => format!("{least} "),
        (0, most) => format!("at most {most} "),
        (least, most) => format!("{least} to {most} "),
    }
}

/// Returns a rule in words, as an item of a Markdown list.
fn in_words(rule: &Rule) -> String {
    let list = |keys: &[&str]| format!("`{}`", keys.join("`, `"));
    match rule {
        Rule::AnyOf(keys) => format!("- At least one of {} is required.", list(keys)),
        Rule::OneAtMost(keys) => format!("- At most one of {} may be given.", list(keys)),
        Rule::Excludes(key, others) => {
            format!("- If `{key}` is given, none of {} may be given.", list(others))
        }
        Rule::OnlyWith(key, others) => format!("- Without `{key}`, none of {} may be given.", list(others)),
        Rule::Needs(key, other) => format!("- `{key}` requires `{other}`."),
        Rule::When { key, words, needs, never } => {
            let mut rule = format!("- If `{key}` is {},", quoted(&words()));
            if !needs.is_empty() {
                let _ = write!(rule, " then {} must be given, and", list(needs));
            }
            if !never.is_empty() {
                let _ = write!(rule, " none of {} may be given", list(never));
            }
            rule + "."
        }
        Rule::NotNegativeWhen(key, word) => format!("- If `{key}` is \"{word}\", no number may be negative."),
    }
}
