//! Reader of the place of an operation on its surface: `grid`, `region`, `points_mm`, `over`.

use super::solid;
use crate::cell::{NodeAggregation, Place, Rectangle};
use crate::files::keys::key::NumberRange;
use crate::files::keys::operation::{MAX_NODES, operation};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Node;
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units;

/// Largest distance (m) by which rounding may put a point beyond the edge of its surface.
const EDGE_ROUNDING: f64 = 1e-9;

/// Time (s) and memory (bytes) that `map --json` takes per node. The two values were measured on
/// `hitachi_cell.toml` with a quarter of a million nodes.
const NODE_COST: (f64, f64) = (1.2e-4, 1600.0);

/// Reads the nodes of an operation, and how the errors at the nodes become one value.
///
/// `surface` is the work surface of the equipment, if it could be read.
pub fn read(t: &mut Table, surface: Option<Rectangle>) -> Option<(Place, NodeAggregation)> {
    let points = t.get(&operation::POINTS_MM);
    let default = if points.is_some() { NodeAggregation::Max } else { NodeAggregation::Best };
    let over = t.if_given(&operation::OVER, Table::word).map(|over| over.unwrap_or(default));
    if let Some(node) = points {
        let points = read_points(t, surface);
        for key in [operation::GRID, operation::REGION] {
            // The points replace a grid or region of an included file (`from`).
            if let Some(besides) = t.get(&key).filter(|besides| besides.at.file == node.at.file) {
                let name = key.name;
                let message = format!("`{name}` cannot be given with `points_mm`: the points are the nodes");
                t.error(besides.at, message, format!("remove {name}, or points_mm"));
            }
        }
        return Some((Place::Points(points?), over?));
    }
    let divisions = read_grid(t);
    // If the surface is unknown, its fault is already recorded.
    let whole = surface.unwrap_or(Rectangle { centre: (0.0, 0.0), size: (1.0, 1.0) });
    let area = t.if_given(&operation::REGION, |t, _| read_region(t, surface));
    Some((Place::Grid { area: area?.unwrap_or(whole), divisions: divisions? }, over?))
}

/// Reads a rectangle that must lie in the work surface.
fn read_region(t: &mut Table, surface: Option<Rectangle>) -> Option<Rectangle> {
    let node = t.get(&operation::REGION)?;
    let region = t.table(&operation::REGION, solid::read_rectangle)?;
    let Some(surface) = surface else { return Some(region) };
    let corner = |sx: f64, sy: f64| {
        (region.centre.0 + sx * region.size.0 / 2.0, region.centre.1 + sy * region.size.1 / 2.0)
    };
    if [corner(-1.0, -1.0), corner(1.0, 1.0)].iter().any(|c| !is_on(&surface, *c)) {
        t.error(node.at, "`region` leaves the surface", extent_in_words(&surface));
    }
    Some(region)
}

fn read_points(t: &mut Table, surface: Option<Rectangle>) -> Option<Vec<(f64, f64)>> {
    let items = t.items(&operation::POINTS_MM)?;
    let read = |(i, item): (usize, &Node)| {
        let what = format!("point {} of `points_mm`", i + 1);
        let point = value::numbers(item, &what, 2, NumberRange::Finite, t.lib)?;
        let point = (units::m_from_mm(point[0]), units::m_from_mm(point[1]));
        if let Some(surface) = surface.filter(|s| !is_on(s, point)) {
            t.error(item.at, format!("{what} is not on the surface"), extent_in_words(&surface));
        }
        Some(point)
    };
    let points: Vec<_> = items.iter().enumerate().map(read).collect();
    points.into_iter().collect()
}

/// Reads `grid = [m, n]`: divisions along x and y, (m + 1)(n + 1) nodes.
fn read_grid(t: &mut Table) -> Option<(usize, usize)> {
    let node = t.get(&operation::GRID)?;
    let [along_x, along_y] = t.items(&operation::GRID)? else { return None };
    let m = value::whole(along_x, "entry 1 of `grid`", (1, u64::MAX), t.lib);
    let n = value::whole(along_y, "entry 2 of `grid`", (1, u64::MAX), t.lib);
    let (m, n) = (m?, n?);
    let nodes = (m as f64 + 1.0) * (n as f64 + 1.0);
    if nodes > MAX_NODES as f64 {
        let (minutes, gigabytes) = (about(nodes * NODE_COST.0 / 60.0), about(nodes * NODE_COST.1 / 1e9));
        let nodes = plain(nodes);
        let message = format!(
            "a grid of {nodes} nodes takes about {minutes} minutes and {gigabytes} GB \
        per map"
        );
        t.error(node.at, message, format!("use at most {MAX_NODES} nodes; [10, 8] makes 99 nodes"));
        return None;
    }
    Some((m as usize, n as usize))
}

fn about(value: f64) -> String {
    if value < 1e6 { format!("{value:.1}") } else { format!("{value:.1e}") }
}

/// Returns whether a point (m, frame of the equipment) lies on the surface.
pub fn is_on(surface: &Rectangle, (x, y): (f64, f64)) -> bool {
    let Rectangle { centre, size } = surface;
    let beyond = |v: f64, centre: f64, size: f64| (v - centre).abs() - size / 2.0;
    beyond(x, centre.0, size.0).max(beyond(y, centre.1, size.1)) <= EDGE_ROUNDING
}

/// Returns the extent of a surface (mm) in words, for example "the surface covers x from -750 to 750 and y
/// from -350 to 350".
pub fn extent_in_words(surface: &Rectangle) -> String {
    let end = |centre: f64, half: f64| plain(units::rounded(units::mm_from_m(centre + half), 6));
    let range = |c: f64, s: f64| format!("{} to {}", end(c, -s / 2.0), end(c, s / 2.0));
    let (x, y) = (range(surface.centre.0, surface.size.0), range(surface.centre.1, surface.size.1));
    format!("the surface covers x from {x} and y from {y}")
}
