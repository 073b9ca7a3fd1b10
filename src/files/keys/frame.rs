//! Errors of a frame: of the robot's base, tool and joints, and of an equipment's placement or fixture.

use super::rows::Arm;
use super::tolerance;
use super::tolerance::Kind;
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::Must;
use crate::units;

/// The frame error under a key of an error set; missing: none.
pub fn read_part(
    t: &mut Table<'_>,
    key: &'static str,
    must: Must,
    lib: &mut Library<'_>,
) -> Option<[f64; PER_FRAME]> {
    let Some(node) = t.get(key) else { return Some([0.0; PER_FRAME]) };
    Table::read(node, &format!("`{key}`"), lib, |t, lib| read_values(t, must, lib))
}

/// `position_mm` and `rotation_deg`, each 0 if missing.
fn read_values(t: &mut Table<'_>, must: Must, lib: &mut Library<'_>) -> Option<[f64; PER_FRAME]> {
    let position = t.numbers_or_zero("position_mm", 3, must, lib);
    let rotation = t.numbers_or_zero("rotation_deg", 3, must, lib);
    let (position, rotation) = (position?, rotation?);
    let lengths = position.into_iter().map(units::m_from_mm);
    let mut all = lengths.chain(rotation.into_iter().map(units::rad_from_deg));
    Some([(); PER_FRAME].map(|()| all.next().unwrap_or(0.0)))
}

/// `joints` of an error set: the frame error of every joint, none of those that are not listed.
pub fn read_joints(
    t: &mut Table<'_>,
    arm: Arm<'_>,
    must: Must,
    lib: &mut Library<'_>,
) -> Option<Vec<[f64; PER_FRAME]>> {
    let mut all = vec![[0.0; PER_FRAME]; arm.axes];
    let Some(node) = t.get("joints") else { return Some(all) };
    let Value::Array(items) = &node.value else {
        let message = format!("`joints` must be a list of frame errors, not {}", node.value.kind());
        lib.error(node.at, message, "write joints = [{ joint = 1, rotation_deg = [0, 0, 0.1] }]");
        return None;
    };
    let before = lib.errors();
    let mut given = vec![false; arm.axes];
    for item in items {
        let read = Table::read(item, "a frame error of `joints`", lib, |t, lib| {
            let values = read_values(t, must, lib);
            let node = t.need("joint", "add joint = 1, the number or the name of the joint")?;
            let joint = read_joint(node, arm, lib)?;
            if std::mem::replace(&mut given[joint], true) {
                let message = format!("joint {} is given twice", joint + 1);
                lib.error(node.at, message, "write what is wrong with its frame into one of the two");
            }
            Some((joint, values?))
        });
        read.into_iter().for_each(|(joint, values)| all[joint] = values);
    }
    (lib.errors() == before).then_some(all)
}

/// A joint by its name, or by its number from 1.
fn read_joint(node: &Node, arm: Arm<'_>, lib: &mut Library<'_>) -> Option<usize> {
    let Value::Text(name) = &node.value else {
        let number = value::integer(node, "`joint`", (1, arm.axes as u64), lib)?;
        return Some(number as usize - 1);
    };
    let names = || arm.joints.iter().map(|joint| joint.name.as_str());
    let found = names().position(|n| n == name);
    // The names of a robot that could not be read are not known.
    if found.is_none() && !arm.joints.is_empty() {
        let help = match did_you_mean(name, names()) {
            Some(near) => format!("did you mean \"{}\"?", shown(near)),
            None => format!("the robot has: {}", listed(names())),
        };
        lib.error(node.at, format!("the robot has no joint `{}`", shown(name)), help);
    }
    found
}

/// `errors` of an equipment.
pub fn read_errors(node: &Node, lib: &mut Library<'_>) -> Option<FrameErrors> {
    Table::read(node, "`errors`", lib, |t, lib| {
        let kind = Kind::read(t, lib);
        let values = read_values(t, Kind::must(kind), lib);
        if kind != Some(Kind::Tolerance) {
            tolerance::refuse(t, kind, lib);
            return values.map(FrameErrors::Signed);
        }
        let distributions = tolerance::read_words(t, "distribution", PER_FRAME, Distribution::Normal, lib);
        let sigmas = tolerance::read_sigmas(t, lib);
        let (values, distributions, sigmas) = (values?, distributions?, sigmas?);
        let mut spreads = values.map(Spread::of_magnitude);
        for (spread, distribution) in spreads.iter_mut().zip(distributions) {
            (spread.distribution, spread.sigmas) = (distribution, sigmas);
        }
        Some(FrameErrors::Tolerance(spreads))
    })
}
