//! Readers of the frame errors of the robot's base, tool and joints, and of the errors of equipment.

use super::cost::{self, CostedParameter, CostedUnit};
use super::row_order::ErrorRows;
use super::tolerance;
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::errors::{ErrorForm, error_set, errors_of_equipment, frame_error, joint_frame_error};
use crate::files::keys::key::{Key, NumberRange};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;

/// Reads the frame error under a key of an error set; zeros if the key is missing.
pub fn read_part(t: &mut Table, key: &Key, range: NumberRange) -> Option<[f64; PER_FRAME]> {
    t.table_or(key, [0.0; PER_FRAME], |t| read_values(t, range))
}

/// Reads `position_mm` and `rotation_deg`, each 0 if missing.
fn read_values(t: &mut Table, range: NumberRange) -> Option<[f64; PER_FRAME]> {
    let position = t.numbers_of(&frame_error::POSITION, 3, range);
    let rotation = t.numbers_of(&frame_error::ROTATION, 3, range);
    let (position, rotation) = (position?, rotation?);
    let mut all = position.into_iter().chain(rotation);
    Some([(); PER_FRAME].map(|()| all.next().unwrap_or(0.0)))
}

/// Reads `joints` of an error set: the frame errors of all joints, zeros for joints that are not listed.
pub fn read_joints(t: &mut Table, arm: ErrorRows<'_>, range: NumberRange) -> Option<Vec<[f64; PER_FRAME]>> {
    let mut all = vec![[0.0; PER_FRAME]; arm.axes];
    if t.get(&error_set::JOINTS).is_none() {
        return Some(all);
    }
    let before = t.lib.errors();
    let mut given = vec![false; arm.axes];
    let read = t.tables(&error_set::JOINTS, |t| {
        let values = read_values(t, range);
        let node = t.get(&joint_frame_error::JOINT)?;
        let joint = read_joint(node, arm, t)?;
        if std::mem::replace(&mut given[joint], true) {
            let message = format!("joint {} is given twice", joint + 1);
            t.error(node.at, message, "state all its errors in one entry");
        }
        Some((joint, values?))
    });
    read?.into_iter().flatten().for_each(|(joint, values)| all[joint] = values);
    (t.lib.errors() == before).then_some(all)
}

/// Reads a joint by its name, or by its number from 1; returns its index.
pub fn read_joint(node: &Node, arm: ErrorRows<'_>, t: &mut Table) -> Option<usize> {
    let Value::Text(name) = &node.value else {
        let number = value::whole(node, "`joint`", (1, arm.axes as u64), t.lib)?;
        return Some(number as usize - 1);
    };
    let names = || arm.joints.iter().map(|joint| joint.name.as_str());
    let found = names().position(|n| n == name);
    // If the joints could not be read, their names are unknown.
    if found.is_none() && !arm.joints.is_empty() {
        let help = match did_you_mean(name, names()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("the robot has: {}", listed(names())),
        };
        t.error(node.at, format!("the robot has no joint `{}`", shown(name)), help);
    }
    found
}

/// Reads `errors` of a piece of equipment.
///
/// Returns the errors and the cost of each component; no costs if the file states none.
pub fn read_errors(t: &mut Table) -> Option<(FrameErrors, Vec<ToleranceCost>)> {
    let form = t.word(&errors_of_equipment::FORM);
    let values = read_values(t, tolerance::range_of(form));
    if form != Some(ErrorForm::Tolerance) {
        tolerance::refuse(t, form);
        return values.map(|values| (FrameErrors::Signed(values), Vec::new()));
    }
    let normal = Distribution::Normal;
    let distributions = tolerance::read_words(t, &errors_of_equipment::DISTRIBUTION, PER_FRAME, normal);
    let sigmas = t.number(&errors_of_equipment::SIGMAS);
    let (values, distributions, sigmas) = (values?, distributions?, sigmas?);
    let mut spreads = values.map(Spread::of_magnitude);
    for (spread, distribution) in spreads.iter_mut().zip(distributions) {
        (spread.distribution, spread.sigmas) = (distribution, sigmas);
    }
    let costed = |c: usize| CostedParameter {
        name: COMPONENTS[c].to_string(),
        plus_minus: spreads[c].plus_minus,
        unit: if c < PER_FRAME / 2 { CostedUnit::Length } else { CostedUnit::Angle },
    };
    let costs = cost::read_all(t, &[0, 1, 2, 3, 4, 5].map(costed))?;
    Some((FrameErrors::Tolerance(spreads), costs))
}
