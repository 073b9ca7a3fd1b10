//! Reader of the periodic errors of joints.

use super::frame_error::read_joint;
use super::row_order::ErrorRows;
use crate::cell::PeriodicError;
use crate::files::fault::shown;
use crate::files::keys::errors::{error_set, periodic_error};
use crate::files::keys::key::{Key, NumberRange};
use crate::files::toml::reader::Table;
use crate::files::toml::value;
use crate::units::rad_from_deg;

/// Reads `periodic`: the periodic errors of joints; none if the key is not given.
pub fn read(t: &mut Table, arm: ErrorRows<'_>) -> Option<Vec<PeriodicError>> {
    let Some(node) = t.get(&error_set::PERIODIC) else { return Some(Vec::new()) };
    let (at, before) = (node.at, t.lib.errors());
    if arm.is_coupled {
        let message = "a robot with joint coupling cannot have `periodic` errors";
        t.error(at, message, "leave them out; errors of coupled joints depend on several coordinates");
    }
    let mut given = Vec::new();
    let read = t.tables(&error_set::PERIODIC, |t| read_one(t, arm, &mut given))?;
    (t.lib.errors() == before).then(|| read.into_iter().flatten().collect())
}

fn read_one(t: &mut Table, arm: ErrorRows<'_>, given: &mut Vec<usize>) -> Option<PeriodicError> {
    let joint = t.get(&periodic_error::JOINT);
    let [cos, sin] = [periodic_error::COS, periodic_error::SIN].map(|key| coefficients(t, &key));
    let node = joint?;
    let joint = read_joint(node, arm, t)?;
    if arm.slides(joint) {
        let name = arm.joints.get(joint).map_or("", |j| j.name.as_str());
        let message = format!("joint `{}` slides: only a revolute joint has periodic errors", shown(name));
        t.error(node.at, message, "leave out this entry");
        return None;
    }
    if given.contains(&joint) {
        let message = format!("the periodic error of joint {} is given twice", joint + 1);
        t.error(node.at, message, "write all orders of a joint as one entry");
        return None;
    }
    given.push(joint);
    let [cos, sin] = [cos?, sin?].map(|list| list.into_iter().map(rad_from_deg).collect::<Vec<_>>());
    if cos.len() != sin.len() {
        let message = format!("`cos_deg` has {} numbers and `sin_deg` has {}", cos.len(), sin.len());
        t.error(node.at, message, "write one number for each order, beginning with order 1, in both lists");
        return None;
    }
    Some(PeriodicError { joint, cos, sin })
}

/// Reads the coefficients of all orders from 1, degrees.
fn coefficients(t: &mut Table, key: &Key) -> Option<Vec<f64>> {
    let node = t.get(key)?;
    let count = value::items(node, key, t.lib)?.len();
    value::numbers(node, &format!("`{}`", key.name), count, NumberRange::Finite, t.lib)
}

/// Refuses periodic errors in a set of tolerances.
pub fn refuse(t: &mut Table) {
    if let Some(node) = t.get(&error_set::PERIODIC) {
        let message = "tolerances cannot have `periodic` errors";
        t.error(node.at, message, "write kind = \"measured\" if a calibration identified these errors");
    }
}
