//! A number of a cell file that may be a search variable.

use crate::cell::Coordinate;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};

/// Most values of one list.
pub const MAX_VALUES: usize = 1000;

/// A number (fixed), `{ min, max, start }` (a search variable; it starts in the middle by default) or a
/// list of the values allowed (it starts at the first).
pub fn read(node: &Node, key: &'static str, si: fn(f64) -> f64, lib: &mut Library<'_>) -> Option<Coordinate> {
    match &node.value {
        Value::Table(_) => read_range(node, key, si, lib),
        Value::Array(items) => read_list(node, items, key, si, lib),
        _ => {
            let fixed = value::number(node, &format!("`{key}`"), Must::BeFinite, lib);
            fixed.map(|v| Coordinate::Fixed(si(v)))
        }
    }
}

fn read_range(
    node: &Node,
    key: &'static str,
    si: fn(f64) -> f64,
    lib: &mut Library<'_>,
) -> Option<Coordinate> {
    Table::read(node, key, lib, |t, lib| {
        let min = t.number("min", Must::BeFinite, lib);
        let max = t.number("max", Must::BeFinite, lib);
        let start = match t.get("start") {
            Some(node) => value::number(node, "`start`", Must::BeFinite, lib).map(|v| (v, node.at)),
            None => min.zip(max).map(|(min, max)| ((min + max) / 2.0, t.at)),
        };
        let (min, max, (start, start_at)) = (min?, max?, start?);
        let (low, high) = (plain(min), plain(max));
        if min >= max {
            let message = format!("range of `{key}` is empty: min {low} is not below max {high}");
            lib.error(t.at, message, "give the lower end as min, or write one number to fix it");
        } else if !(min..=max).contains(&start) {
            let message = format!("start {} of `{key}` is outside {low} to {high}", plain(start));
            lib.error(start_at, message, "start inside the range");
        }
        Some(Coordinate::Range { min: si(min), max: si(max), start: si(start) })
    })
}

fn read_list(
    node: &Node,
    items: &[Node],
    key: &'static str,
    si: fn(f64) -> f64,
    lib: &mut Library<'_>,
) -> Option<Coordinate> {
    if items.is_empty() || items.len() > MAX_VALUES {
        let message = format!("`{key}` must list 1 to {MAX_VALUES} allowed values, not {}", items.len());
        lib.error(node.at, message, format!("write for example {key} = [0, 90], or {{ min = 0, max = 90 }}"));
        return None;
    }
    let values = value::numbers(node, &format!("`{key}`"), items.len(), Must::BeFinite, lib)?;
    let twice = (1..values.len()).find(|&k| values[..k].contains(&values[k]));
    if let Some(k) = twice {
        let message = format!("`{key}` lists {} twice", plain(values[k]));
        lib.error(items[k].at, message, "name every allowed value once");
    }
    Some(match values[..] {
        [one] => Coordinate::Fixed(si(one)),
        _ => Coordinate::List(values.into_iter().map(si).collect()),
    })
}
