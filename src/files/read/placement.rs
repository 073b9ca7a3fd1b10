//! Reader of placements and placement tolerances.

use super::coordinate;
use crate::cell::{Coordinate, PlacementTolerance};
use crate::files::keys::equipment::fixed_placement;
use crate::files::keys::key::{Key, Literal, Need};
use crate::files::keys::parts::{placement, placement_tolerance};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Value;

/// Reads x, y, z and yaw, each fixed or a search variable.
pub fn read(t: &mut Table) -> Option<[Coordinate; 4]> {
    let [x, y, z, yaw] =
        [placement::X, placement::Y, placement::Z, placement::YAW].map(|key| match (t.get(&key), key.need) {
            (Some(node), _) => coordinate::read(node, &key, t),
            (None, Need::Default(Literal::Number(value))) => Some(Coordinate::Fixed(value)),
            (None, _) => None,
        });
    Some([x?, y?, z?, yaw?])
}

/// Reads x, y, z and yaw of an obstacle, which a search never moves.
pub fn read_fixed(t: &mut Table) -> Option<[Coordinate; 4]> {
    let keys = [fixed_placement::X, fixed_placement::Y, fixed_placement::Z, fixed_placement::YAW];
    let [x, y, z, yaw] = keys.map(|key| read_number(t, &key).map(Coordinate::Fixed));
    Some([x?, y?, z?, yaw?])
}

fn read_number(t: &mut Table, key: &Key) -> Option<f64> {
    let range = t.get(key).filter(|node| matches!(node.value, Value::Table(_) | Value::Array(_)));
    let Some(node) = range else { return t.number(key) };
    let message = format!("`{}` of an obstacle cannot be a range", key.name);
    t.error(node.at, message, "give one number, or make the obstacle an [equipment.NAME]");
    None
}

/// Reads the plus-or-minus values of x, y, z and yaw. A missing value is 0.
pub fn read_tolerance(t: &mut Table) -> Option<PlacementTolerance> {
    let keys =
        [placement_tolerance::X, placement_tolerance::Y, placement_tolerance::Z, placement_tolerance::YAW];
    let [x, y, z, yaw] = keys.map(|key| t.number(&key));
    Some(PlacementTolerance([x?, y?, z?, yaw?]))
}
