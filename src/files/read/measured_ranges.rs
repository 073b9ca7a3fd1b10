//! Reader of the joint ranges that a calibration has measured.

use super::row_order::ErrorRows;
use crate::files::keys::errors::error_set;
use crate::files::keys::key::NumberRange;
use crate::files::toml::reader::Table;
use crate::files::toml::value::{self, plain};
use crate::units::{m_from_mm, rad_from_deg};

/// Reads `measured_ranges`: the least and the largest coordinate of every joint, rad or m.
///
/// Returns Some(None) if the key is not given, and None after a fault.
pub fn read(t: &mut Table, arm: ErrorRows<'_>) -> Option<Option<Vec<(f64, f64)>>> {
    let Some(node) = t.get(&error_set::RANGES) else { return Some(None) };
    let items = value::items(node, &error_set::RANGES, t.lib)?;
    if items.len() != arm.axes {
        let message =
            format!("`measured_ranges` has {} ranges, but the robot has {} joints", items.len(), arm.axes);
        t.error(node.at, message, "write [least, largest] for every joint, in the order of the rows");
        return None;
    }
    let mut ranges = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let what = format!("range {} of `measured_ranges`", i + 1);
        let Some(range) = value::numbers(item, &what, 2, NumberRange::Finite, t.lib) else { continue };
        let (low, high) = (range[0], range[1]);
        if low > high {
            let message = format!("{what} is reversed: {} is above {}", plain(low), plain(high));
            t.error(item.at, message, format!("write [{}, {}]", plain(high), plain(low)));
            continue;
        }
        let si = if arm.slides(i) { m_from_mm } else { rad_from_deg };
        ranges.push((si(low), si(high)));
    }
    (ranges.len() == items.len()).then_some(Some(ranges))
}

/// Refuses `measured_ranges` in an error set that is not measured.
pub fn refuse(t: &mut Table) {
    if let Some(node) = t.get(&error_set::RANGES) {
        let message = "only measured errors have `measured_ranges`";
        t.error(node.at, message, "write kind = \"measured\" if a calibration identified these errors");
    }
}
