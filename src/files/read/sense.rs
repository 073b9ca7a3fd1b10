//! Reader of the senses that a cell defines: `[sense.NAME]`, with one or several terms.

use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::cell::cell;
use crate::files::keys::key::{Key, NumberRange};
use crate::files::keys::sense::{WAYS, WAYS_OF_SENSE, any_term, sense};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node};
use crate::files::toml::value;
use nalgebra::Vector3;

const ROWS_OF: &str = "a term with rotation or xyz has 3 components, a term with xy or a plane has 2, and any \
other term has 1";

/// Reads every `[sense.NAME]`.
pub fn read_all(t: &mut Table) -> Vec<Sense> {
    t.named(&cell::SENSE, |name, t| {
        if PLAIN.contains(&name) || name.contains('@') {
            let message = format!("`{}` cannot be the name of a sense", shown(name));
            t.error(t.at, message, format!("choose a name without @ that is not one of {}", listed(PLAIN)));
        }
        read(name, t)
    })
}

fn read(name: &str, t: &mut Table) -> Option<Sense> {
    let frame = t.word(&sense::FRAME);
    let point = t.vector(&sense::POINT);
    let terms = match t.get(&sense::TERM) {
        Some(_) => {
            t.exclude_beside(&sense::TERM);
            t.tables(&sense::TERM, |t| read_term(t, &WAYS))?.into_iter().collect()
        }
        None => read_term(t, &WAYS_OF_SENSE).map(|term| vec![term]),
    }?;
    let rows: usize = terms.iter().map(|term: &Term| term.rows.len()).sum();
    if rows > MAX_ROWS {
        let message = format!("the sense has {rows} components, but at most {MAX_ROWS} are possible");
        t.error(t.at, message, ROWS_OF);
    }
    let unit = unit_of(&terms);
    for term in terms.iter().filter(|term| unit == Unit::Length && term.lever.is_none() && term.turns()) {
        let help =
            "add mm_per_deg, the length in mm that counts as much as one degree; mm_per_deg replaces weight";
        t.error(term.at, "a rotation cannot be added to lengths", help);
    }
    Some(Sense::new(name, frame?, point?, unit, &weighted(&terms)))
}

/// Term of a sense. Each [`Row`] of the term is one component of the error. The direction of a row is a unit
/// vector, not yet weighted.
struct Term {
    at: At,
    rows: Vec<Row>,
    weight: f64,
    /// Factor that converts a rotation to a length, m per rad.
    lever: Option<f64>,
}

impl Term {
    fn turns(&self) -> bool {
        self.rows.iter().any(|row| row.turns)
    }
}

/// Returns the unit of a sense: an angle if all terms are rotations without `mm_per_deg`, otherwise a length.
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

/// Reads the keys of one term.
///
/// A term needs one of the keys `ways`. If none is given, the fault names these keys.
fn read_term(t: &mut Table, ways: &[&'static str]) -> Option<Term> {
    let keys = [any_term::OF, any_term::DIRECTION, any_term::PLANE, any_term::AXIS];
    let given: Vec<_> = keys.into_iter().filter_map(|key| t.get(&key).map(|node| (key, node))).collect();
    let weight = t.number(&any_term::WEIGHT);
    let lever = t.get(&any_term::LEVER);
    let [(way, node)] = given[..] else {
        if given.is_empty() {
            t.miss_one_of(ways, "add one of these keys, such as of = \"xy\" or direction = [0, 0, 1]");
        } else {
            let names: Vec<_> = given.iter().map(|(key, _)| key.name).collect();
            let message = format!("a term may have only one of the keys `{}`", names.join("` and `"));
            t.error(t.at, message, "write term = [{ ... }, { ... }], with one of these keys in each { ... }");
        }
        return None;
    };
    let rows = if way.name == "of" { read_axes(node, t) } else { read_rows(&way, node, t) }?;
    let lever = match lever {
        Some(lever) => Some(read_lever(lever, rows.iter().any(|row| row.turns), t)?),
        None => None,
    };
    Some(Term { at: t.at, rows, weight: weight?, lever })
}

/// Reads `mm_per_deg` and returns the value in m per rad.
fn read_lever(node: &Node, turns: bool, t: &mut Table) -> Option<f64> {
    if !turns {
        let message = "`mm_per_deg` applies to a rotation, but this term is a length";
        t.error(node.at, message, "write weight instead");
        return None;
    }
    if t.get(&any_term::WEIGHT).is_some() {
        let help = "remove the key `weight`, because `mm_per_deg` already says how much the rotation counts";
        t.error(node.at, "a rotation has `weight` or `mm_per_deg`, not both", help);
    }
    t.number(&any_term::LEVER)
}

/// Reads `of`, the name of a built-in sense such as "xy", and returns the [`Row`]s of this sense.
fn read_axes(node: &Node, t: &mut Table) -> Option<Vec<Row>> {
    let word = value::text(node, any_term::OF.name, t.lib)?;
    let rows = Sense::plain_rows(&word);
    if rows.is_none() {
        let help = match did_you_mean(&word, PLAIN) {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => format!("one of: {}", listed(PLAIN)),
        };
        t.error(node.at, format!("`of` cannot be \"{}\"", shown(&word)), help);
    }
    rows
}

/// Reads a vector and returns the [`Row`]s of a term. The rows measure the error along the vector
/// (`direction`), in the plane perpendicular to it (`plane`), or about it (`axis`).
fn read_rows(key: &Key, node: &Node, t: &mut Table) -> Option<Vec<Row>> {
    let way = key.name;
    let vector = value::numbers(node, &format!("`{way}`"), 3, NumberRange::Finite, t.lib)?;
    let Some(unit) = Vector3::from_iterator(vector).try_normalize(1e-9) else {
        t.error(
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

/// Returns two unit vectors that form a right-handed orthogonal frame with `normal` as the third axis.
fn in_plane(normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[normal.iamin()] = 1.0;
    let first = (axis - normal * normal.dot(&axis)).normalize();
    [first, normal.cross(&first)]
}
