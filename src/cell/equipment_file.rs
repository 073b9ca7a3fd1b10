//! Equipment: work surface, solids, floor space and placement.

use super::document::{Library, Node};
use super::fault::shown;
use super::model::*;
use super::reader::{Must, Table, number};
use super::solid;
use crate::units;
use nalgebra::Vector3;

/// Reads `[equipment.NAME]` or `[obstacle.NAME]`, usually `from` an equipment file.
pub fn read(name: &str, node: &Node, role: Role, lib: &mut Library<'_>) -> Option<Equipment> {
    let mut t = Table::of(node, "an equipment", lib)?;
    let named = solid::checked_name(name.to_string(), node.at, lib);
    super::header(&mut t, "equipment", lib);
    t.text_or("name", name, lib);
    t.text_or("source", "", lib);
    let surface = match t.get("surface") {
        Some(node) => Some(solid::read_rectangle(node, "surface", lib)?),
        None => None,
    };
    let solids = read_solids(&mut t, lib);
    let drawn = solids.as_ref().and_then(|s| solid::extent_of(s.iter().map(|s| &s.shape)));
    let top = surface.map(|s| {
        let half = Vector3::new(s.size.0, s.size.1, 0.0) / 2.0;
        let centre = Vector3::new(s.centre.0, s.centre.1, 0.0);
        (centre - half, centre + half)
    });
    let extent = [drawn, top].into_iter().flatten().reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
    let footprint = solid::read_footprint(&mut t, extent, lib);
    let placement = read_placement(&mut t, role, lib);
    t.finish(lib);
    Some(Equipment {
        name: named?,
        role,
        surface,
        footprint: footprint?,
        solids: solids?,
        placement: placement?,
    })
}

fn read_solids(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Vec<Solid>> {
    let nodes = solid::list(t, lib);
    let mut solids: Vec<Solid> = Vec::new();
    let mut sound = true;
    for node in nodes {
        let read = Table::of(node, "a solid", lib).and_then(|mut t| {
            let read = solid::read(&mut t, solid::Carrier::Equipment, lib);
            t.finish(lib);
            read
        });
        match read {
            Some(s) if solids.iter().any(|k| k.name == s.name) => {
                super::duplicate_solid(&s.name, node.at, lib);
                sound = false;
            }
            Some(s) => solids.push(s),
            None => sound = false,
        }
    }
    sound.then_some(solids)
}

fn read_placement(t: &mut Table<'_>, role: Role, lib: &mut Library<'_>) -> Option<[Coordinate; 4]> {
    let node = t.need("placement", lib)?;
    let mut t = Table::of(node, "`placement`", lib)?;
    let length = units::m_from_mm as fn(f64) -> f64;
    let x = read_coordinate(&mut t, "x_mm", length, role, lib);
    let y = read_coordinate(&mut t, "y_mm", length, role, lib);
    let z = read_coordinate(&mut t, "z_mm", length, role, lib);
    let yaw = match t.get("yaw_deg") {
        Some(_) => read_coordinate(&mut t, "yaw_deg", units::rad_from_deg, role, lib),
        None => Some(Coordinate::Fixed(0.0)),
    };
    t.finish(lib);
    Some([x?, y?, z?, yaw?])
}

/// A number (fixed) or `{ min, max, start }` (a search variable; it starts in the middle by default).
fn read_coordinate(
    t: &mut Table<'_>,
    key: &'static str,
    si: fn(f64) -> f64,
    role: Role,
    lib: &mut Library<'_>,
) -> Option<Coordinate> {
    let node = t.need(key, lib)?;
    if !matches!(node.value, super::document::Value::Table(_)) {
        return number(node, &format!("`{key}`"), Must::BeFinite, lib).map(|v| Coordinate::Fixed(si(v)));
    }
    let mut t = Table::of(node, key, lib)?;
    let min = t.number("min", Must::BeFinite, lib);
    let max = t.number("max", Must::BeFinite, lib);
    let middle = min.zip(max).map_or(0.0, |(a, b)| (a + b) / 2.0);
    let start = t.number_or("start", middle, Must::BeFinite, lib);
    t.finish(lib);
    let (min, max, start) = (min?, max?, start?);
    if role == Role::Obstacle {
        lib.error(
            node.at,
            format!("`{key}` of an obstacle cannot be a range"),
            "move it to [equipment.NAME]",
        );
        return None;
    }
    if min >= max {
        let message = format!("range of `{key}` reversed: min {min} is not below max {max}");
        lib.error(
            node.at,
            message,
            format!("write {{ min = {}, max = {} }}, or one number", max.min(min), max.max(min)),
        );
        return None;
    }
    if !(min..=max).contains(&start) {
        lib.error(
            node.at,
            format!("start {start} of `{key}` is outside {min} to {max}"),
            "start inside the range",
        );
        return None;
    }
    Some(Coordinate::Range { min: si(min), max: si(max), start: si(start) })
}

/// `[keep_out.NAME]`: low and high corner of a box, world frame.
pub fn read_keep_out(name: &str, node: &Node, lib: &mut Library<'_>) -> Option<KeepOut> {
    let mut t = Table::of(node, "a keep-out box", lib)?;
    let named = solid::checked_name(name.to_string(), node.at, lib);
    let min = t.vector("min_mm", Must::BeFinite, lib);
    let max = t.vector("max_mm", Must::BeFinite, lib);
    t.finish(lib);
    let (min, max) = (min?, max?);
    if (max - min).min() <= 0.0 {
        let message = format!("keep-out box `{}` is empty: min_mm is not below max_mm", shown(name));
        lib.error(node.at, message, "give the low corner first, then the high one");
        return None;
    }
    Some(KeepOut { name: named?, min, max })
}
