//! `teach_mm`: three points of a work surface that teach its frame.

use super::place::{extent_in_words, is_on};
use crate::cell::Rectangle;
use crate::cell::TEACH_HEIGHT;
use crate::files::toml::document::Library;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::units;
use nalgebra::Vector2;

/// Reads the points; without the surface not whether they lie on it.
pub fn read(node: &Node, surface: Option<Rectangle>, lib: &mut Library<'_>) -> Option<[(f64, f64); 3]> {
    let items = match &node.value {
        Value::Array(items) if items.len() == 3 => items,
        other => {
            let given = match other {
                Value::Array(items) => items.len().to_string(),
                other => other.kind().to_string(),
            };
            let help = "write for example teach_mm = [[-500, -200], [500, -200], [-500, 200]]";
            lib.error(node.at, format!("`teach_mm` must be a list of 3 points, not {given}"), help);
            return None;
        }
    };
    let read = |(i, item)| read_point(i, item, surface, lib);
    let points: Vec<_> = items.iter().enumerate().map(read).collect();
    let [a, b, c] = points[..] else { return None };
    let (a, b, c) = (a?, b?, c?);
    let height = height(a, b, c);
    if height < TEACH_HEIGHT {
        let [is, least] = [height, TEACH_HEIGHT].map(|h| plain(units::rounded(units::mm_from_m(h), 1)));
        let message = format!("the points of `teach_mm` lie nearly in line: their triangle is {is} mm high");
        lib.error(node.at, message, format!("spread them out: at least {least} mm; the farther, the better"));
    }
    Some([a, b, c].map(|p| (p.x, p.y)))
}

fn read_point(
    i: usize,
    node: &Node,
    surface: Option<Rectangle>,
    lib: &mut Library<'_>,
) -> Option<Vector2<f64>> {
    let what = format!("point {} of `teach_mm`", i + 1);
    let point = value::numbers(node, &what, 2, Must::BeFinite, lib)?;
    let point = Vector2::from_iterator(point).map(units::m_from_mm);
    if let Some(surface) = surface.filter(|s| !is_on(s, (point.x, point.y))) {
        lib.error(node.at, format!("{what} is not on the surface"), extent_in_words(&surface));
    }
    Some(point)
}

/// The smallest height of a triangle.
fn height(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>) -> f64 {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    if longest > 0.0 { (b - a).perp(&(c - a)).abs() / longest } else { 0.0 }
}
