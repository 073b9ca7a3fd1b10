//! Readers of the maximum speeds and accelerations of joints.

use super::frame_error::read_joint;
use super::row_order::ErrorRows;
use crate::cell::{Joint, JointKind, RateLimits};
use crate::files::fault::{Severity, shown};
use crate::files::keys::key::Key;
use crate::files::keys::robot::{joint, joint_rate, robot};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::At;
use crate::files::toml::value::plain;
use crate::units::{deg_from_rad, mm_from_m, rad_from_deg, rounded};
use std::ops::RangeInclusive;

/// Plausible speeds of revolute joints, degrees per s. At any other speed, a warning questions the unit.
const PLAUSIBLE_DEG_S: RangeInclusive<f64> = 0.1..=10_000.0;
/// Plausible speeds of prismatic joints, mm per s. At any other speed, a warning questions the unit.
const PLAUSIBLE_MM_S: RangeInclusive<f64> = 1.0..=20_000.0;
/// Speed, degrees per s. If no revolute joint is faster, the speeds are probably in rad per s.
const SUSPICIOUS_DEG_S: f64 = 15.0;
/// Plausible times from rest to full speed, s. At any other time, a warning questions the unit of the
/// acceleration.
const PLAUSIBLE_TIME: RangeInclusive<f64> = 0.005..=10.0;

/// Reads the maximum speed and acceleration of a joint of this kind from its row.
pub fn read_row(t: &mut Table, kind: JointKind) -> RateLimits {
    let [velocity, acceleration] = match kind {
        JointKind::Revolute => [joint::MAX_VELOCITY_DEG, joint::MAX_ACCELERATION_DEG],
        JointKind::Prismatic => [joint::MAX_VELOCITY_MM, joint::MAX_ACCELERATION_MM],
    };
    read_limits(t, [&velocity, &acceleration], kind)
}

/// Reads the list `rate` of a robot into its joints, and warns of implausible speeds.
pub fn read_list(t: &mut Table, joints: &mut [Joint]) {
    if t.get(&robot::RATE).is_some() {
        let mut given = vec![false; joints.len()];
        let named = joints.to_vec();
        let arm = ErrorRows { axes: named.len(), joints: &named, modified: false, is_coupled: false };
        let read = t.tables(&robot::RATE, |t| {
            let node = t.get(&joint_rate::JOINT);
            let number = node.and_then(|node| read_joint(node, arm, t));
            let Some((node, number)) = node.zip(number) else {
                t.give_up();
                return None;
            };
            if std::mem::replace(&mut given[number], true) {
                let message = format!("joint {} is given twice", number + 1);
                t.error(node.at, message, "state its speed and its acceleration in one entry");
            }
            Some((number, read_rate(t, &named[number])))
        });
        for (number, rates) in read.into_iter().flatten().flatten() {
            joints[number].rates = rates.or(joints[number].rates);
        }
    }
    let at = [&robot::RATE, &robot::JOINT].into_iter().find_map(|key| t.given(key)).map(|node| node.at);
    if let Some(at) = at {
        warn_of_radians(joints, at, t);
    }
}

/// Reads an entry of `rate`, whose keys must fit the kind of its joint.
fn read_rate(t: &mut Table, of: &Joint) -> RateLimits {
    let turns = [&joint_rate::MAX_VELOCITY_DEG, &joint_rate::MAX_ACCELERATION_DEG];
    let slides = [&joint_rate::MAX_VELOCITY_MM, &joint_rate::MAX_ACCELERATION_MM];
    let name = shown(&of.name);
    if of.is_passive() {
        let message = format!("the passive joint `{name}` has no separate speed");
        t.error(t.at, message, "state the speeds of the joints that it follows");
        t.give_up();
        return RateLimits::default();
    }
    let (keys, others, verb) = match of.kind {
        JointKind::Revolute => (turns, slides, "turns"),
        JointKind::Prismatic => (slides, turns, "slides"),
    };
    for (other, key) in others.into_iter().zip(keys) {
        if let Some(node) = t.get(other) {
            let message = format!("joint `{name}` {verb}, so `{}` does not apply to it", other.name);
            t.error(node.at, message, format!("write {}", key.name));
        }
    }
    if keys.into_iter().chain(others).all(|key| t.get(key).is_none()) {
        t.miss_one_of(&keys.map(|key| key.name), format!("add {} = {}", keys[0].name, keys[0].example));
    }
    read_limits(t, keys, of.kind)
}

fn read_limits(t: &mut Table, [velocity, acceleration]: [&Key; 2], kind: JointKind) -> RateLimits {
    let rates = RateLimits { velocity: t.number(velocity), acceleration: t.number(acceleration) };
    let (to_file, plausible): (fn(f64) -> f64, _) = match kind {
        JointKind::Revolute => (deg_from_rad, PLAUSIBLE_DEG_S),
        JointKind::Prismatic => (mm_from_m, PLAUSIBLE_MM_S),
    };
    if let (Some(speed), Some(node)) = (rates.velocity, t.get(velocity))
        && !plausible.contains(&rounded(to_file(speed), 9))
    {
        let unit = velocity.unit().name();
        let message = format!("`{}` is {} {unit}", velocity.name, plain(rounded(to_file(speed), 9)));
        t.lib.fault(node.at, Severity::Warning, message, format!("is it really in {unit}?"));
    }
    if let (Some(speed), Some(rate), Some(node)) = (rates.velocity, rates.acceleration, t.get(acceleration))
        && !PLAUSIBLE_TIME.contains(&(speed / rate))
    {
        let time = plain(rounded(speed / rate, 5));
        let message =
            format!("with this `{}`, the joint needs {time} s to reach full speed", acceleration.name);
        let help = format!("is it really in {}?", acceleration.unit().name());
        t.lib.fault(node.at, Severity::Warning, message, help);
    }
    rates
}

/// Warns if no revolute joint is faster than [`SUSPICIOUS_DEG_S`].
fn warn_of_radians(joints: &[Joint], at: At, t: &mut Table) {
    let turning = joints.iter().filter(|joint| joint.kind == JointKind::Revolute);
    let fastest = turning.filter_map(|joint| joint.rates.velocity).reduce(f64::max);
    if fastest.is_some_and(|fastest| fastest <= rad_from_deg(SUSPICIOUS_DEG_S)) {
        let message = format!("no revolute joint is faster than {SUSPICIOUS_DEG_S} degrees per s");
        let help = "are the speeds in rad per s? they are read in degrees per s";
        t.lib.fault(at, Severity::Warning, message, help);
    }
}
