//! Tolerances: how each plus-or-minus spreads.

use super::covariance;
use super::rows::Arm;
use crate::cell::*;
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::Must;

/// How the numbers of an error set are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Signed,
    Tolerance,
}

impl Kind {
    pub fn read(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<Self> {
        let name = |k| if k == Kind::Signed { "signed" } else { "tolerance" };
        t.choice("kind", &[Kind::Signed, Kind::Tolerance], name, None, lib)
    }

    /// What the numbers must be.
    pub fn must(kind: Option<Self>) -> Must {
        if kind == Some(Kind::Tolerance) { Must::BePlusMinus } else { Must::BeFinite }
    }
}

/// The rest of a tolerance of the robot, whose plus-or-minus are `values`.
pub fn read(
    t: &mut Table<'_>,
    values: Option<SignedErrors>,
    arm: Arm<'_>,
    lib: &mut Library<'_>,
) -> Option<Tolerance> {
    let distributions = read_distributions(t, arm.axes, lib);
    let sigmas = read_sigmas(t, lib);
    let node = t.get("covariance");
    let covariance = node.map(|node| covariance::read(node, arm, values.as_ref(), lib));
    let (values, mut distributions, sigmas) = (values?, distributions?, sigmas?);
    arm.in_order(&mut distributions);
    let plus_minus = values.values().into_iter().zip(distributions);
    let mut spreads: Vec<_> =
        plus_minus.map(|(plus_minus, distribution)| Spread { plus_minus, distribution, sigmas }).collect();
    // A covariance that was refused is none of no covariance.
    let covariance = covariance.map_or(Some(None), |read| read.map(Some))?;
    for (k, &place) in covariance.iter().flat_map(|c| c.parameters.iter().enumerate()) {
        let deviation = covariance.as_ref().map_or(0.0, |c| c.matrix[(k, k)].sqrt());
        let plus_minus = sigmas * deviation;
        spreads[place] = Spread { plus_minus, distribution: Distribution::Normal, sigmas };
    }
    Some(Tolerance { name: values.name, spreads, covariance })
}

/// Says of what only a tolerance has that a signed set has it not; of a set of no known kind nothing.
pub fn refuse(t: &mut Table<'_>, kind: Option<Kind>, lib: &mut Library<'_>) {
    for key in ["distribution", "sigmas", "covariance"] {
        if let Some(node) = t.get(key)
            && kind == Some(Kind::Signed)
        {
            let message = format!("a signed set has no `{key}`: it is one sample");
            let help = "write kind = \"tolerance\" if its numbers are plus-or-minus";
            lib.error(node.at, message, help);
        }
    }
}

/// How many standard deviations of a normal its plus-or-minus is.
pub fn read_sigmas(t: &mut Table<'_>, lib: &mut Library<'_>) -> Option<f64> {
    t.number_or("sigmas", Spread::SIGMAS, Must::BePositive, lib)
}

/// `distribution` of a robot: a word for all, or a table with words for its rows and frames. In the
/// order of [`Parameter::of_robot`].
fn read_distributions(t: &mut Table<'_>, axes: usize, lib: &mut Library<'_>) -> Option<Vec<Distribution>> {
    let all = |d: Distribution| vec![d; Parameter::count(axes)];
    let Some(node) = t.get("distribution") else { return Some(all(Distribution::Normal)) };
    if !matches!(node.value, Value::Table(_)) {
        return value::choice(node, "distribution", &Distribution::ALL, Distribution::name, lib).map(all);
    }
    Table::read(node, "`distribution`", lib, |t, lib| {
        let normal = Distribution::Normal;
        let default = t.choice("default", &Distribution::ALL, Distribution::name, Some(normal), lib);
        let default = default.unwrap_or(normal);
        let links = ["dq", "dr", "dl", "dalpha", "dbeta"].map(|key| read_words(t, key, axes, default, lib));
        // The words of `joints` are those of every joint.
        let frames = ["base", "tool", "joints"].map(|key| read_words(t, key, PER_FRAME, default, lib));
        let [links, frames] =
            [links.to_vec(), frames.to_vec()].map(|w| w.into_iter().collect::<Option<Vec<_>>>());
        let (links, frames) = (links?, frames?);
        let by_link = (0..axes).flat_map(|i| links.iter().map(move |row| row[i]));
        let joints = frames[2].repeat(axes.saturating_sub(1));
        Some(by_link.chain(frames.into_iter().flatten()).chain(joints).collect())
    })
}

/// One word for `len` parameters, or a list of a word for each.
pub fn read_words(
    t: &mut Table<'_>,
    key: &'static str,
    len: usize,
    default: Distribution,
    lib: &mut Library<'_>,
) -> Option<Vec<Distribution>> {
    let Some(node) = t.get(key) else { return Some(vec![default; len]) };
    let word =
        |n: &Node, lib: &mut Library<'_>| value::choice(n, key, &Distribution::ALL, Distribution::name, lib);
    let Value::Array(items) = &node.value else { return word(node, lib).map(|d| vec![d; len]) };
    if items.len() != len {
        let message = format!("`{key}` must be a word or a list of {len} words, not of {}", items.len());
        let all = value::any_of(&Distribution::ALL, Distribution::name);
        lib.error(node.at, message, format!("write one word for all, or {len} in [ ]: {all}"));
        return None;
    }
    let words: Vec<_> = items.iter().map(|n| word(n, lib)).collect();
    words.into_iter().collect()
}
