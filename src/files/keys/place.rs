//! Where on its surface an operation happens: `grid`, `region`, `points_mm`, `over`.

use super::operation::{MAX_NODES, read_grid};
use super::solid;
use crate::cell::Over;
use crate::cell::Place;
use crate::cell::Rectangle;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::{Must, plain};
use crate::units;

/// What rounding may put a point beyond the edge of its surface, m.
const EDGE: f64 = 1e-9;

/// Reads where the nodes are and what of them counts; `surface`: that of the equipment, if it could be
/// read.
pub fn read(t: &mut Table<'_>, surface: Option<Rectangle>, lib: &mut Library<'_>) -> Option<(Place, Over)> {
    let region = t.get("region");
    let points = t.get("points_mm");
    let over = match t.get("over") {
        Some(node) => value::choice(node, "over", &Over::ALL, Over::name, lib),
        None if points.is_some() => Some(Over::Max),
        None => Some(Over::Best),
    };
    if let Some(node) = points {
        let points = read_points(node, surface, lib);
        for key in ["grid", "region"] {
            // A grid of the file that this one is made from is replaced by the points.
            if let Some(besides) = t.get(key).filter(|besides| besides.at.file == node.at.file) {
                let message = format!("`{key}` besides `points_mm`: the points are the nodes");
                lib.error(besides.at, message, format!("remove {key}, or points_mm"));
            }
        }
        return Some((Place::Points(points?), over?));
    }
    let divisions = read_grid(t, lib);
    let area = match region {
        Some(node) => read_region(node, surface, lib),
        // Not known: the fault of the equipment has been told.
        None => Some(surface.unwrap_or(Rectangle { centre: (0.0, 0.0), size: (1.0, 1.0) })),
    };
    Some((Place::Grid { area: area?, divisions: divisions? }, over?))
}

/// A rectangle in the surface.
fn read_region(node: &Node, surface: Option<Rectangle>, lib: &mut Library<'_>) -> Option<Rectangle> {
    let region = solid::read_rectangle(node, "`region`", lib)?;
    let Some(surface) = surface else { return Some(region) };
    let corner = |sx: f64, sy: f64| {
        (region.centre.0 + sx * region.size.0 / 2.0, region.centre.1 + sy * region.size.1 / 2.0)
    };
    if [corner(-1.0, -1.0), corner(1.0, 1.0)].iter().any(|c| !is_on(&surface, *c)) {
        lib.error(node.at, "`region` leaves the surface".into(), extent_in_words(&surface));
    }
    Some(region)
}

fn read_points(node: &Node, surface: Option<Rectangle>, lib: &mut Library<'_>) -> Option<Vec<(f64, f64)>> {
    let help = "write for example points_mm = [[-100, 0], [100, 0]]";
    let Value::Array(items) = &node.value else {
        let message = format!("`points_mm` must be a list of points, not {}", node.value.kind());
        lib.error(node.at, message, help);
        return None;
    };
    if items.is_empty() || items.len() as u64 > MAX_NODES {
        let message = format!("`points_mm` must be 1 to {MAX_NODES} points, not {}", items.len());
        lib.error(node.at, message, help);
        return None;
    }
    let read = |(i, item): (usize, &Node)| {
        let what = format!("point {} of `points_mm`", i + 1);
        let point = value::numbers(item, &what, 2, Must::BeFinite, lib)?;
        let point = (units::m_from_mm(point[0]), units::m_from_mm(point[1]));
        if let Some(surface) = surface.filter(|s| !is_on(s, point)) {
            lib.error(item.at, format!("{what} is not on the surface"), extent_in_words(&surface));
        }
        Some(point)
    };
    let points: Vec<_> = items.iter().enumerate().map(read).collect();
    points.into_iter().collect()
}

/// Whether a point of the frame of the equipment (m) lies on the surface.
pub fn is_on(surface: &Rectangle, (x, y): (f64, f64)) -> bool {
    let Rectangle { centre, size } = surface;
    let beyond = |v: f64, centre: f64, size: f64| (v - centre).abs() - size / 2.0;
    beyond(x, centre.0, size.0).max(beyond(y, centre.1, size.1)) <= EDGE
}

/// "x from -750 to 750, y from -350 to 350".
pub fn extent_in_words(surface: &Rectangle) -> String {
    let end = |centre: f64, half: f64| plain(units::rounded(units::mm_from_m(centre + half), 6));
    let range = |c: f64, s: f64| format!("{} to {}", end(c, -s / 2.0), end(c, s / 2.0));
    let (x, y) = (range(surface.centre.0, surface.size.0), range(surface.centre.1, surface.size.1));
    format!("x from {x}, y from {y}")
}
