//! Reader of `teach_mm`: three points of a work surface that the robot touches to teach the surface frame.

use super::place::{extent_in_words, is_on};
use crate::cell::Rectangle;
use crate::cell::TEACH_HEIGHT;
use crate::files::keys::key::NumberRange;
use crate::files::keys::operation::operation;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Node;
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units;
use nalgebra::Vector2;

/// Reads the points, m. Checks that the points span a triangle and, if `surface` is known, that they lie on
/// the surface.
pub fn read(t: &mut Table, surface: Option<Rectangle>) -> Option<[(f64, f64); 3]> {
    let node = t.get(&operation::TEACH)?;
    let items = t.items(&operation::TEACH)?;
    let read = |(i, item)| read_point(i, item, surface, t);
    let points: Vec<_> = items.iter().enumerate().map(read).collect();
    let [a, b, c] = points[..] else { return None };
    let (a, b, c) = (a?, b?, c?);
    let height = height(a, b, c);
    if height < TEACH_HEIGHT {
        let [is, least] = [height, TEACH_HEIGHT].map(|h| plain(units::rounded(units::mm_from_m(h), 1)));
        let message = format!("the points of `teach_mm` lie nearly in line: their triangle is {is} mm high");
        t.error(node.at, message, format!("make the triangle at least {least} mm high; higher is better"));
    }
    Some([a, b, c].map(|p| (p.x, p.y)))
}

fn read_point(i: usize, node: &Node, surface: Option<Rectangle>, t: &mut Table) -> Option<Vector2<f64>> {
    let what = format!("point {} of `teach_mm`", i + 1);
    let point = value::numbers(node, &what, 2, NumberRange::Finite, t.lib)?;
    let point = Vector2::from_iterator(point).map(units::m_from_mm);
    if let Some(surface) = surface.filter(|s| !is_on(s, (point.x, point.y))) {
        t.error(node.at, format!("{what} is not on the surface"), extent_in_words(&surface));
    }
    Some(point)
}

/// Returns the smallest height of a triangle, which is the height over its longest side.
fn height(a: Vector2<f64>, b: Vector2<f64>, c: Vector2<f64>) -> f64 {
    let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
    if longest > 0.0 { (b - a).perp(&(c - a)).abs() / longest } else { 0.0 }
}
