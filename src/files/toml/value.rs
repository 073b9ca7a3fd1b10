//! Readers of single values: numbers of a plausible size, texts, words, names, lists.

use super::document::Library;
use super::tree::{At, Node, Value};
use crate::files::fault::{did_you_mean, shown};
use crate::files::keys::key::{Key, MAX_NAME, NumberRange, UNBOUNDED, ValueKind, Word, quoted, words_of};

/// Returns a number as text, with an exponent only if the number is very large or very small.
pub fn plain(value: f64) -> String {
    let exponent = value != 0.0 && value.is_finite() && !(1e-6..1e15).contains(&value.abs());
    if value.is_nan() {
        "nan".into()
    } else if exponent {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}

/// Reads a finite number of a plausible size, in the unit of the file.
pub fn number(node: &Node, what: &str, range: NumberRange, lib: &mut Library) -> Option<f64> {
    let value = match &node.value {
        Value::Integer(i) => *i as f64,
        Value::Float(f) => *f,
        other => {
            let help = match other {
                Value::Text(t) if t.trim().parse::<f64>().is_ok() => "write it without quotes",
                _ => "write a plain number, without unit and quotes",
            };
            lib.error(node.at, format!("{what} must be a number, not {}", other.kind()), help);
            return None;
        }
    };
    if let Some((wrong, help)) = range.refuses(value) {
        lib.error(node.at, format!("{what} {wrong}, not {}", plain(value)), help);
        return None;
    }
    Some(value)
}

/// Reads a list of exactly `len` numbers, in the unit of the file.
pub fn numbers(
    node: &Node,
    what: &str,
    len: usize,
    range: NumberRange,
    lib: &mut Library,
) -> Option<Vec<f64>> {
    let wanted = if len == 1 { "1 number".to_string() } else { format!("{len} numbers") };
    let Some(items) = node.value.items().filter(|items| items.len() == len) else {
        let help = format!("write {wanted} in [ ], with commas");
        let message = format!("{what} must be a list of {wanted}, not {}", node.value.count_or_kind());
        lib.error(node.at, message, help);
        return None;
    };
    let numbered = items.iter().enumerate();
    let read = |(i, n)| number(n, &format!("entry {} of {what}", i + 1), range, lib);
    let values: Vec<_> = numbered.map(read).collect();
    values.into_iter().collect()
}

/// Returns the items of a list. Records a fault if the value is not a list, or if the key does not allow
/// its length.
pub fn items<'n>(node: &'n Node, key: &Key, lib: &mut Library) -> Option<&'n [Node]> {
    let (count, noun) = match key.kind.plain() {
        ValueKind::List(_, count, noun) => (*count, *noun),
        _ => ((0, UNBOUNDED), "items"),
    };
    let items = node.value.items().filter(|items| (count.0..=count.1).contains(&items.len()));
    if items.is_none() {
        let many = match count {
            (0, UNBOUNDED) => String::new(),
            (least, UNBOUNDED) => format!("{least} or more "),
            (least, most) if least == most => format!("{least} "),
            (0, most) => format!("at most {most} "),
            (least, most) => format!("{least} to {most} "),
        };
        let given = node.value.count_or_kind();
        let header = || format!("[[{}]]", lib.path(node.at).unwrap_or_else(|| key.name.to_string()));
        let help = match (key.kind.table(), node.value.items().map(<[Node]>::len)) {
            (Some(_), Some(len)) if len > count.1 => {
                format!("remove entries until at most {} are left", count.1)
            }
            (Some(_), Some(_)) if key.example.is_empty() => {
                format!("in place of this list, add {many}entries, each under its own header {}", header())
            }
            (Some(_), None) if key.example.is_empty() => {
                format!("write each entry under its own header {}", header())
            }
            _ => format!("write for example {} = {}", key.name, key.shown_example()),
        };
        lib.error(node.at, format!("`{}` must be a list of {many}{noun}, not {given}", key.name), help);
    }
    items
}

pub fn text(node: &Node, key: &str, lib: &mut Library) -> Option<String> {
    match &node.value {
        Value::Text(s) => Some(s.clone()),
        other => {
            let message = format!("`{key}` must be text, not {}", other.kind());
            lib.error(node.at, message, format!("write {key} = \"...\""));
            None
        }
    }
}

/// Reads one word of a closed set; records a fault for any other word.
pub fn word<W: Word>(node: &Node, key: &str, lib: &mut Library) -> Option<W> {
    let given = text(node, key, lib)?;
    let found = W::all().iter().copied().find(|value| value.word() == given);
    if found.is_none() {
        let help = match did_you_mean(&given, W::all().iter().map(|value| value.word())) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("write {key} = {}", quoted(&words_of::<W>())),
        };
        lib.error(node.at, format!("`{key}` cannot be \"{}\"", shown(&given)), help);
    }
    found
}

/// Reads a whole number from `min` to `max`.
pub fn whole(node: &Node, what: &str, (min, max): (u64, u64), lib: &mut Library) -> Option<u64> {
    let range = match max {
        u64::MAX => format!("write a whole number, {min} or greater"),
        _ => format!("write a whole number from {min} to {max}"),
    };
    let (wrong, help) = match &node.value {
        Value::Integer(i) => match u64::try_from(*i) {
            Ok(value) if (min..=max).contains(&value) => return Some(value),
            _ if *i > i128::from(max) => (format!("at most {max}, not {i}"), range),
            _ => (format!("at least {min}, not {i}"), range),
        },
        Value::Float(f) if f.fract() == 0.0 && f.abs() < 1e15 => (
            format!("a whole number, not {f:?}"),
            format!("write {f:.0}, without a decimal point or an exponent"),
        ),
        Value::Float(f) => (format!("a whole number, not {}", plain(*f)), range),
        other => (format!("a whole number, not {}", other.kind()), range),
    };
    lib.error(node.at, format!("{what} must be {wrong}"), help);
    None
}

/// Checks that a name can be shown and written to files: short, printable, not blank.
pub fn checked_name(name: &str, at: At, lib: &mut Library) -> Option<String> {
    if is_name(name) {
        return Some(name.to_string());
    }
    let message = format!("`{}` cannot be a name", shown(name));
    lib.error(
        at,
        message,
        format!("write 1 to {MAX_NAME} printable characters, without a blank at the start or end"),
    );
    None
}

pub fn is_name(name: &str) -> bool {
    name.chars().count() <= MAX_NAME && shown(name) == name && name.trim() == name && !name.is_empty()
}
