//! Reader of the elastic errors of a robot: deflections of its joints by gravity.

use super::frame_error::read_joint;
use super::row_order::ErrorRows;
use crate::cell::{ErrorSet, JointKind, MAX_ERRORS, Parameter, SignedErrors, Spread};
use crate::files::fault::shown;
use crate::files::keys::errors::{elastic_term, error_set};
use crate::files::keys::key::NumberRange;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node};
use crate::files::toml::value;

/// Reads `elastic` and `compliance_deg_per_Nm`. Returns one value per parameter of [`Parameter::elastic`], 0
/// for a missing value.
pub fn read(t: &mut Table, arm: ErrorRows<'_>, range: NumberRange) -> Option<Vec<f64>> {
    let mut all = vec![0.0; Parameter::elastic(arm.axes).count()];
    let terms = read_terms(t, arm, range);
    let compliances = t.numbers_of(&error_set::COMPLIANCE, arm.axes, range)?;
    if let Some(node) = t.get(&error_set::COMPLIANCE) {
        refuse_sliding(node.at, &compliances, arm, t);
    }
    let first = all.len() - 2 * arm.axes;
    all[first..][..arm.axes].copy_from_slice(&compliances);
    terms?.into_iter().for_each(|(place, value)| all[place] = value);
    Some(all)
}

/// Reads the terms of `elastic`. Returns the index of each term among [`Parameter::elastic`], and its value.
fn read_terms(t: &mut Table, arm: ErrorRows<'_>, range: NumberRange) -> Option<Vec<(usize, f64)>> {
    if t.get(&error_set::ELASTIC).is_none() {
        return Some(Vec::new());
    }
    let before = t.lib.errors();
    let mut given = Vec::new();
    let read = t.tables(&error_set::ELASTIC, |t| {
        let value = t.get(&elastic_term::VALUE);
        let value = value.and_then(|node| value::number(node, "`deg_per_m`", range, t.lib));
        let value = value.map(|value| elastic_term::VALUE.unit().si(value));
        let (joint_node, link_node) = (t.get(&elastic_term::JOINT), t.get(&elastic_term::LINK));
        let joint = joint_node.and_then(|node| Some((node, read_joint(node, arm, t)?)));
        let link = link_node.and_then(|node| {
            Some((node, value::whole(node, "`link`", (1, arm.axes as u64), t.lib)? as usize - 1))
        });
        let place = place(joint?, link?, arm, &mut given, t)?;
        Some((place, value?))
    });
    let read = read?.into_iter().flatten().collect();
    (t.lib.errors() == before).then_some(read)
}

/// Returns the index of a term among [`Parameter::elastic`]; records a fault if there is no such term,
/// or if the term is among those in `given`.
fn place(
    (joint_node, joint): (&Node, usize),
    (link_node, link): (&Node, usize),
    arm: ErrorRows<'_>,
    given: &mut Vec<usize>,
    t: &mut Table,
) -> Option<usize> {
    if arm.slides(joint) {
        let name = arm.joints.get(joint).map_or("", |j| j.name.as_str());
        let message = format!("joint `{}` slides: only a revolute joint has elastic terms", shown(name));
        t.error(joint_node.at, message, "leave out this term");
        return None;
    }
    if link < joint {
        let message = format!("joint {} does not carry link {}, which comes before it", joint + 1, link + 1);
        t.error(link_node.at, message, format!("write a link number from {} to {}", joint + 1, arm.axes));
        return None;
    }
    let place = Parameter::elastic(arm.axes).position(|p| p == Parameter::Elastic(joint, link))?;
    if given.contains(&place) {
        let message = format!("the term of joint {} and link {} is given twice", joint + 1, link + 1);
        t.error(joint_node.at, message, "write the sum as one term");
    }
    given.push(place);
    Some(place)
}

/// Records a fault for every nonzero compliance of a prismatic joint.
fn refuse_sliding(at: At, compliances: &[f64], arm: ErrorRows<'_>, t: &mut Table) {
    let pairs = arm.joints.iter().zip(compliances).enumerate();
    for (i, (joint, _)) in pairs.filter(|(_, (j, v))| j.kind == JointKind::Prismatic && **v != 0.0) {
        let name = shown(&joint.name);
        let message =
            format!("entry {} of `{}` must be 0: joint `{name}` slides", i + 1, error_set::COMPLIANCE.name);
        t.error(at, message, "only revolute joints deflect");
    }
}

/// Records a fault if an error set has more errors than one set may have.
///
/// For a set of measured errors, the mean of the errors counts as one additional error. The worst case treats
/// this mean as a parameter.
pub fn refuse_too_many(set: &ErrorSet, t: &mut Table) {
    let mean = set.mean().map(SignedErrors::values);
    let is_used = |(k, spread): &(usize, &Spread)| {
        spread.plus_minus > 0.0 || mean.as_ref().is_some_and(|mean| mean[*k] != 0.0)
    };
    let count = set.tolerance().spreads.iter().enumerate().filter(is_used).count();
    let most = MAX_ERRORS - usize::from(mean.is_some());
    if count > most {
        let message = format!("the error set has {count} errors, but at most {most} are possible");
        t.error(
            t.at,
            message,
            "leave out errors (such as those of joint frames) that have the same effect as other errors",
        );
    }
}
