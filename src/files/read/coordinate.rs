//! Reader of numbers of a cell file that may be search variables.

use crate::cell::Coordinate;
use crate::files::keys::key::{Key, MAX_VALUES, NumberRange};
use crate::files::keys::parts::range;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::plain;

/// Reads a coordinate and converts it to SI units.
///
/// A number, or a list of one number, is fixed. `{ min, max, start }` is a search variable; by default, it
/// starts in the middle. A list of allowed values is a search variable that starts at the first value.
pub fn read(node: &Node, key: &Key, t: &mut Table) -> Option<Coordinate> {
    match &node.value {
        Value::Table(_) => read_range(node, key, t),
        Value::Array(items) => read_list(node, items, key, t),
        _ => {
            let fixed = value::number(node, &format!("`{}`", key.name), NumberRange::Finite, t.lib);
            fixed.map(|v| Coordinate::Fixed(key.unit().si(v)))
        }
    }
}

fn read_range(node: &Node, key: &Key, t: &mut Table) -> Option<Coordinate> {
    let name = key.name;
    Table::read(node, name, &range::TABLE, t.lib, |t| {
        let (min, max) = (t.number(&range::MIN), t.number(&range::MAX));
        let start = match t.get(&range::START) {
            Some(node) => t.number(&range::START).map(|v| (v, node.at)),
            None => min.zip(max).map(|(min, max)| ((min + max) / 2.0, t.at)),
        };
        let (min, max, (start, start_at)) = (min?, max?, start?);
        let (low, high) = (plain(min), plain(max));
        if min >= max {
            let message = format!("range of `{name}` is empty: min {low} is not below max {high}");
            t.error(t.at, message, "give the lower end as min, or write one number for a fixed coordinate");
        } else if !(min..=max).contains(&start) {
            let message = format!("the start value {} of `{name}` is outside {low} to {high}", plain(start));
            t.error(start_at, message, "give a start value inside the range");
        }
        let si = |value| key.unit().si(value);
        Some(Coordinate::Range { min: si(min), max: si(max), start: si(start) })
    })
}

fn read_list(node: &Node, items: &[Node], key: &Key, t: &mut Table) -> Option<Coordinate> {
    let name = key.name;
    if items.is_empty() || items.len() > MAX_VALUES {
        let message = format!("`{name}` must list 1 to {MAX_VALUES} allowed values, not {}", items.len());
        t.error(node.at, message, format!("write for example {name} = [0, 90], or {{ min = 0, max = 90 }}"));
        return None;
    }
    let values = value::numbers(node, &format!("`{name}`"), items.len(), NumberRange::Finite, t.lib)?;
    let twice = (1..values.len()).find(|&k| values[..k].contains(&values[k]));
    if let Some(k) = twice {
        let message = format!("`{name}` lists {} twice", plain(values[k]));
        t.error(items[k].at, message, "name every allowed value once");
    }
    Some(match values[..] {
        [one] => Coordinate::Fixed(key.unit().si(one)),
        _ => Coordinate::List(values.into_iter().map(|value| key.unit().si(value)).collect()),
    })
}
