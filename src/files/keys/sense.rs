//! Senses that a cell defines: `[sense.NAME]`, one term or several, to weighted rows.

use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::{Table, read_named};
use crate::files::toml::tree::{At, Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::Must;
use crate::units;
use nalgebra::Vector3;

/// What a term can measure.
const WAYS: [&str; 4] = ["of", "direction", "plane", "axis"];

const ROWS_OF: &str = "a rotation or xyz takes 3, xy or a plane 2, anything else 1";

/// Reads every `[sense.NAME]`.
pub fn read_all(t: &mut Table<'_>, lib: &mut Library<'_>) -> Vec<Sense> {
    read_named(t, "sense", lib, |name, node, lib| {
        if PLAIN.contains(&name) || name.contains('@') {
            let message = format!("`{}` cannot be the name of a sense", shown(name));
            lib.error(node.at, message, format!("choose one without @ that is none of {}", listed(PLAIN)));
        }
        Table::read(node, "a sense", lib, |t, lib| read(name, t, lib))
    })
}

fn read(name: &str, t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Sense> {
    let frame = t.choice("frame", &Frame::ALL, Frame::name, Some(Frame::World), lib);
    let point = t.numbers_or_zero("point_mm", 3, Must::BeFinite, lib);
    let terms = match t.get("term") {
        Some(node) => read_terms(node, lib),
        None => read_term(t, true, lib).map(|term| vec![term]),
    }?;
    let rows: usize = terms.iter().map(|term| term.rows.len()).sum();
    if rows > MAX_ROWS {
        let message = format!("the sense has {rows} rows: at most {MAX_ROWS} make one");
        lib.error(t.at, message, ROWS_OF);
    }
    let unit = unit_of(&terms);
    for term in terms.iter().filter(|term| unit == Unit::Length && term.lever.is_none() && term.turns()) {
        let help = "add mm_per_deg, the length that one degree counts as, in place of a weight";
        lib.error(term.at, "a rotation cannot be added to lengths".into(), help);
    }
    let point = Vector3::from_iterator(point?).map(units::m_from_mm);
    Some(Sense::new(name, frame?, point, unit, &weighted(&terms)))
}

/// A term, its rows of length 1.
struct Term {
    at: At,
    rows: Vec<Row>,
    weight: f64,
    /// What makes a rotation a length, m (per rad).
    lever: Option<f64>,
}

impl Term {
    fn turns(&self) -> bool {
        self.rows.iter().any(|row| row.turns)
    }
}

/// Rotations alone are an angle, unless they are made a length.
fn unit_of(terms: &[Term]) -> Unit {
    let angle = terms.iter().all(|term| term.turns() && term.lever.is_none());
    if angle { Unit::Angle } else { Unit::Length }
}

fn weighted(terms: &[Term]) -> Vec<Row> {
    let scaled = |term: &Term, row: &Row| {
        let weight = term.lever.unwrap_or(term.weight);
        Row { turns: row.turns, direction: row.direction * weight }
    };
    terms.iter().flat_map(|term| term.rows.iter().map(move |row| scaled(term, row))).collect()
}

fn read_terms(node: &Node, lib: &mut Library<'_>) -> Option<Vec<Term>> {
    let items = match &node.value {
        Value::Array(items) if !items.is_empty() => items,
        other => {
            let given = if let Value::Array(_) = other { "an empty one" } else { other.kind() };
            let help = "write for example term = [{ of = \"xy\" }, { of = \"rz\", mm_per_deg = 1 }]";
            lib.error(node.at, format!("`term` must be a list of tables, not {given}"), help);
            return None;
        }
    };
    let read = |item| Table::read(item, "a term", lib, |t, lib| read_term(t, false, lib));
    let terms: Vec<_> = items.iter().map(read).collect();
    terms.into_iter().collect()
}

/// The keys of one term; `alone`: they stand where a list of terms could.
fn read_term(t: &mut Table<'_>, alone: bool, lib: &mut Library<'_>) -> Option<Term> {
    let given: Vec<_> = WAYS.iter().filter_map(|&key| t.get(key).map(|node| (key, node))).collect();
    let weight = t.number_or("weight", 1.0, Must::BePositive, lib);
    let lever = t.get("mm_per_deg");
    let [(way, node)] = given[..] else {
        if given.is_empty() {
            let ways: &[_] = if alone { &["of", "direction", "plane", "axis", "term"] } else { &WAYS };
            t.need_one_of(ways, "add for example of = \"xy\", or direction = [0, 0, 1]");
        } else {
            let names: Vec<_> = given.iter().map(|(key, _)| *key).collect();
            let message = format!("a term measures one thing, not `{}`", names.join("` and `"));
            lib.error(t.at, message, "write term = [{ ... }, { ... }], with one of them in each");
        }
        return None;
    };
    let rows = if way == "of" { read_axes(node, lib) } else { read_rows(way, node, lib) }?;
    let lever = match lever {
        Some(lever) => Some(read_lever(lever, rows.iter().any(|row| row.turns), t, lib)?),
        None => None,
    };
    Some(Term { at: t.at, rows, weight: weight?, lever })
}

/// `mm_per_deg`, in m (per rad).
fn read_lever(node: &Node, turns: bool, t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<f64> {
    if !turns {
        let message = "`mm_per_deg` is of a rotation: this term is a length".to_string();
        lib.error(node.at, message, "write weight instead");
        return None;
    }
    if t.get("weight").is_some() {
        let help = "remove weight: mm_per_deg already says how much the rotation counts";
        lib.error(node.at, "a rotation has `weight` or `mm_per_deg`, not both".into(), help);
    }
    let value = value::number(node, "`mm_per_deg`", Must::BePositive, lib)?;
    Some(units::m_from_mm(value) / units::rad_from_deg(1.0))
}

/// `of = "xy"`: axes of the frame.
fn read_axes(node: &Node, lib: &mut Library<'_>) -> Option<Vec<Row>> {
    let word = value::text(node, "of", lib)?;
    let rows = Sense::plain_rows(&word);
    if rows.is_none() {
        let help = match did_you_mean(&word, PLAIN) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("one of: {}", listed(PLAIN)),
        };
        lib.error(node.at, format!("`of` cannot be \"{}\"", shown(&word)), help);
    }
    rows
}

/// The rows of a vector: along it, in the plane across it, about it.
fn read_rows(way: &str, node: &Node, lib: &mut Library<'_>) -> Option<Vec<Row>> {
    let vector = value::numbers(node, &format!("`{way}`"), 3, Must::BeFinite, lib)?;
    let Some(unit) = Vector3::from_iterator(vector).try_normalize(1e-9) else {
        lib.error(
            node.at,
            format!("`{way}` is zero"),
            format!("write a vector, for example {way} = [0, 0, 1]"),
        );
        return None;
    };
    let turns = way == "axis";
    let directions = if way == "plane" { in_plane(&unit).to_vec() } else { vec![unit] };
    Some(directions.into_iter().map(|direction| Row { turns, direction }).collect())
}

/// Two unit vectors at right angles to `normal` and to each other: (x, y) of (z).
fn in_plane(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[normal.iamin()] = 1.0;
    let first = (axis - normal * normal.dot(&axis)).normalize();
    [first, normal.cross(&first)]
}
