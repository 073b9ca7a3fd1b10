//! Reader of equipment: work surface, solids, floor space and placement.

use super::frame_error;
use super::header::header;
use super::placement;
use super::solid;
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::cell::cell;
use crate::files::keys::equipment::{BODY, body, equipment, keep_out, obstacle};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Value;
use crate::files::toml::value::plain;
use crate::units;
use nalgebra::Vector3;

/// Reads `[equipment.NAME]` or `[obstacle.NAME]`. Most keys usually come from an equipment file that `from`
/// names.
pub fn read(name: &str, t: &mut Table, role: Role) -> Option<Equipment> {
    header(t, &body::SCHEMA)?;
    t.if_given(&body::NAME, Table::text);
    t.if_given(&body::SOURCE, Table::text);
    let before = t.lib.errors();
    let surface = t.table(&body::SURFACE, solid::read_rectangle);
    let solids = solid::read_all(t, &body::SOLID);
    let drawn = extent_of(solids.iter().map(|s| &s.shape));
    let extents = [drawn, surface.map(|s| top(&s))].into_iter().flatten();
    let extent = extents.reduce(|(a, b), (c, d)| (a.inf(&c), b.sup(&d)));
    let needed: &[_] = if t.lib.errors() == before { &BODY } else { &[] };
    let footprint = solid::read_footprint(t, &body::FOOTPRINT, extent, needed);
    let placement = match role {
        Role::Equipment => t.table(&equipment::PLACEMENT, placement::read),
        Role::Obstacle => t.table(&obstacle::PLACEMENT, placement::read_fixed),
    };
    // [`tie`] resolves the name after all equipment has been read.
    t.if_given(&equipment::STANDS_ON, Table::text);
    let errors = t.if_given(&equipment::ERRORS, |t, key| t.table(key, frame_error::read_errors));
    let exact = PlacementTolerance::default();
    let tolerance = t.table_or(&equipment::TOLERANCE, exact, placement::read_tolerance);
    let (footprint, placement, tolerance) = (footprint?, placement?, tolerance?);
    let (name, (errors, error_costs)) = (name.to_string(), errors?.unzip());
    let error_costs = error_costs.unwrap_or_default();
    Some(Equipment {
        name,
        role,
        surface,
        footprint,
        solids,
        on: None,
        placement,
        errors,
        error_costs,
        tolerance,
    })
}

/// Returns the extent of a work surface, m.
fn top(surface: &Rectangle) -> Extent {
    let half = Vector3::new(surface.size.0, surface.size.1, 0.0) / 2.0;
    let centre = Vector3::new(surface.centre.0, surface.centre.1, 0.0);
    (centre - half, centre + half)
}

/// Resolves the names in `stands_on`; records a fault for unknown names and loops.
pub fn tie(root: &mut Table, all: &mut [Equipment]) {
    let names: Vec<String> = all.iter().map(|e| e.name.clone()).collect();
    let entries = root.get(&cell::EQUIPMENT).into_iter().flat_map(|node| node.value.entries());
    for (name, _, node) in entries {
        let Some(k) = names.iter().position(|n| n == name) else { continue };
        let Some(tied) = node.value.get(equipment::STANDS_ON.name) else { continue };
        let Value::Text(under) = &tied.value else { continue };
        match names.iter().position(|n| n == under) {
            Some(found) if found != k => all[k].on = Some(found),
            Some(_) => {
                root.error(tied.at, format!("`{}` cannot stand on itself", shown(name)), "remove stands_on")
            }
            None if !root.partial => {
                let others = || names.iter().filter(|n| *n != name).map(String::as_str);
                let help = match did_you_mean(under, others()) {
                    Some(near) => format!("did you mean \"{}\"?", shown(near)),
                    None => format!("the cell has: {}", listed(others())),
                };
                root.error(tied.at, format!("there is no equipment `{}`", shown(under)), help);
            }
            None => {}
        }
        if circular(all, k) {
            all[k].on = None;
            let message = format!("`{}` would stand on itself by way of `{}`", shown(name), shown(under));
            root.error(tied.at, message, "let one of them stand on the floor");
        }
    }
}

/// Returns whether equipment `k` stands, directly or indirectly, on itself.
fn circular(all: &[Equipment], k: usize) -> bool {
    let mut under = all[k].on;
    while let Some(next) = under {
        if next == k {
            return true;
        }
        under = all[next].on;
    }
    false
}

/// Reads `[keep_out.NAME]`: low and high corner of a box in the world frame.
pub fn read_keep_out(name: &str, t: &mut Table) -> Option<KeepOut> {
    let (min, max) = (t.vector(&keep_out::MIN), t.vector(&keep_out::MAX));
    let (min, max) = (min?, max?);
    if let Some(axis) = (0..3).find(|&i| min[i] >= max[i]) {
        let (low, high) = (units::mm_from_m(min[axis]), units::mm_from_m(max[axis]));
        let (axis, low, high) = (["x", "y", "z"][axis], plain(low), plain(high));
        let message = format!("the box is empty: in {axis}, min_mm {low} is not below max_mm {high}");
        t.error(t.at, message, "give the low corner as min_mm, the high corner as max_mm");
    }
    Some(KeepOut { name: name.to_string(), min, max })
}
