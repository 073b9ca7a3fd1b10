//! Reader of tolerances: the distribution of each plus-or-minus value, and the spread of measured errors.

use super::cost::{self, CostedParameter, CostedUnit};
use super::covariance;
use super::measured_ranges;
use super::row_order::ErrorRows;
use crate::cell::*;
use crate::files::keys::errors::{ErrorForm, distribution, error_set};
use crate::files::keys::key::{Key, NumberRange};
use crate::files::toml::reader::Table;
use crate::files::toml::tree::Value;
use crate::files::toml::value;

/// Returns the range of the numbers in an error set. In a tolerance, no number may be negative.
pub fn range_of(form: Option<ErrorForm>) -> NumberRange {
    if form == Some(ErrorForm::Tolerance) { NumberRange::PlusMinus } else { NumberRange::Finite }
}

/// Reads distributions, sigmas and covariance of a robot's tolerance. `values` are the plus-or-minus values
/// of all parameters.
pub fn read(t: &mut Table, values: Option<SignedErrors>, arm: ErrorRows<'_>) -> Option<Tolerance> {
    let distributions = read_distributions(t, arm.axes);
    let sigmas = t.number(&error_set::SIGMAS);
    let covariance = t.if_given(&error_set::COVARIANCE, |t, key| {
        t.table(key, |t| covariance::read(t, arm, values.as_ref()))
    });
    let (values, mut distributions, sigmas) = (values?, distributions?, sigmas?);
    arm.in_order(&mut distributions);
    let plus_minus = values.values().into_iter().zip(distributions);
    let mut spreads: Vec<_> =
        plus_minus.map(|(plus_minus, distribution)| Spread { plus_minus, distribution, sigmas }).collect();
    // If the covariance was refused, the whole set counts as unreadable.
    let covariance = covariance?;
    let costs = cost::read_all(t, &costed(arm, &spreads));
    set_variances(&mut spreads, covariance.as_ref(), sigmas);
    Some(Tolerance { name: values.name, spreads, covariance, costs: costs? })
}

/// Returns the parameters of a robot whose tolerances may have costs.
///
/// The caller calls this function before [`set_variances`]. So `spreads` still has the tolerance 0 for every
/// parameter of the covariance.
fn costed(arm: ErrorRows<'_>, spreads: &[Spread]) -> Vec<CostedParameter> {
    let names = covariance::names_of(arm);
    let each = Parameter::of_robot(arm.axes).zip(spreads).zip(names).map(|((parameter, spread), name)| {
        let unit = match parameter {
            Parameter::Elastic(..) | Parameter::Compliance(_) => CostedUnit::Deflection,
            _ if covariance::is_length(parameter, arm) => CostedUnit::Length,
            _ => CostedUnit::Angle,
        };
        CostedParameter { name, plus_minus: spread.plus_minus, unit }
    });
    each.collect()
}

/// Reads sigmas, covariance and measured ranges of measured errors. `values` are the signed errors.
pub fn read_measured(
    t: &mut Table,
    values: Option<SignedErrors>,
    arm: ErrorRows<'_>,
) -> Option<MeasuredErrors> {
    if let Some(node) = t.get(&error_set::DISTRIBUTION) {
        let message = "measured errors cannot have `distribution`: a covariance implies normal distributions";
        t.error(node.at, message, "leave it out, or write kind = \"tolerance\"");
    }
    if let Some(node) = t.get(&error_set::COST) {
        let message =
            "measured errors cannot have `cost`: they are known, so there is no tolerance to choose";
        t.error(node.at, message, "leave it out, or write kind = \"tolerance\"");
    }
    let sigmas = t.number(&error_set::SIGMAS);
    let covariance =
        t.if_given(&error_set::COVARIANCE, |t, key| t.table(key, |t| covariance::read(t, arm, None)));
    let ranges = measured_ranges::read(t, arm);
    let (mean, sigmas, covariance, ranges) = (values?, sigmas?, covariance?, ranges?);
    let none = Spread { plus_minus: 0.0, distribution: Distribution::Normal, sigmas };
    let mut spreads = vec![none; Parameter::count(arm.axes)];
    set_variances(&mut spreads, covariance.as_ref(), sigmas);
    let spread = Tolerance { name: mean.name.clone(), spreads, covariance, costs: Vec::new() };
    Some(MeasuredErrors { mean, spread, ranges })
}

/// Sets the spreads of the parameters of a covariance from its diagonal.
fn set_variances(spreads: &mut [Spread], covariance: Option<&Covariance>, sigmas: f64) {
    for (k, &place) in covariance.iter().flat_map(|c| c.parameters.iter().enumerate()) {
        let deviation = covariance.map_or(0.0, |c| c.matrix[(k, k)].sqrt());
        let plus_minus = sigmas * deviation;
        spreads[place] = Spread { plus_minus, distribution: Distribution::Normal, sigmas };
    }
}

/// Refuses the keys of a tolerance in a signed set. A set of unknown kind gets no fault here, because another
/// fault already reports the unknown kind.
pub fn refuse(t: &mut Table, form: Option<ErrorForm>) {
    for key in [error_set::DISTRIBUTION, error_set::SIGMAS, error_set::COVARIANCE, error_set::COST] {
        if let Some(node) = t.get(&key)
            && form == Some(ErrorForm::Signed)
        {
            let message = format!("a signed set cannot have `{}`, because it is one sample", key.name);
            t.error(node.at, message, "write kind = \"tolerance\" if its numbers are plus-or-minus values");
        }
    }
}

/// Reads `distribution` of a robot: one word, or a table with words for rows and frames.
///
/// Returns the distributions of all parameters, with the D-H rows in the order of the file.
fn read_distributions(t: &mut Table, axes: usize) -> Option<Vec<Distribution>> {
    let key = error_set::DISTRIBUTION;
    let is_table = t.get(&key).is_some_and(|node| matches!(node.value, Value::Table(_)));
    if !is_table {
        return t.word(&key).map(|all| vec![all; Parameter::count(axes)]);
    }
    t.table(&key, |t| {
        let default = t.word(&distribution::DEFAULT).unwrap_or(Distribution::Normal);
        let links =
            [distribution::DQ, distribution::DR, distribution::DL, distribution::DALPHA, distribution::DBETA];
        let links = links.map(|key| read_words(t, &key, axes, default));
        // The words of `joints` apply to every joint frame.
        let frames = [distribution::BASE, distribution::TOOL, distribution::JOINTS];
        let frames = frames.map(|key| read_words(t, &key, PER_FRAME, default));
        let elastic = t.if_given(&distribution::ELASTIC, Table::word).map(|word| word.unwrap_or(default));
        let compliance = read_words(t, &distribution::COMPLIANCE, axes, default);
        let [links, frames] =
            [links.to_vec(), frames.to_vec()].map(|w| w.into_iter().collect::<Option<Vec<_>>>());
        let (links, frames) = (links?, frames?);
        let by_link = (0..axes).flat_map(|i| links.iter().map(move |row| row[i]));
        let joints = frames[2].repeat(axes.saturating_sub(1));
        let terms = vec![elastic?; axes * (axes + 1) / 2];
        let frames = frames.into_iter().flatten().chain(joints);
        let shares = vec![default; axes];
        Some(by_link.chain(frames).chain(terms).chain(compliance?).chain(shares).collect())
    })
}

/// Reads one word for all `len` parameters, or a list with one word for each parameter.
pub fn read_words(t: &mut Table, key: &Key, len: usize, default: Distribution) -> Option<Vec<Distribution>> {
    let Some(node) = t.get(key) else { return Some(vec![default; len]) };
    let Value::Array(items) = &node.value else {
        return value::word(node, key.name, t.lib).map(|word| vec![word; len]);
    };
    if items.len() != len {
        let message =
            format!("`{}` must be a word or a list of {len} words, not a list of {}", key.name, items.len());
        let all = key.kind.example();
        t.error(
            node.at,
            message,
            format!("write one word for all {len} parameters, or a list of {len} words; each word is {all}"),
        );
        return None;
    }
    let words: Vec<_> = items.iter().map(|item| value::word(item, key.name, t.lib)).collect();
    words.into_iter().collect()
}
