//! Prior of a calibration: the unknowns and their standard deviations before the measurement.

use crate::calibration::{Unknown, unknowns};
use crate::cell::{Parameter, Robot};
use crate::cli::arguments::CalibrateArguments;
use crate::cli::{Exit, lookup, output};
use crate::files::shown;
use crate::robot::Chain;

/// Returns the unknowns and their standard deviations before the measurement.
pub fn assumed(
    robot: &Robot,
    chain: &Chain,
    a: &CalibrateArguments,
) -> Result<(Vec<Unknown>, Vec<f64>), Exit> {
    let all = unknowns(chain, a.elastic);
    let Some(name) = &a.prior else {
        return Ok(all.into_iter().map(|unknown| (unknown, unknown.default_prior(chain))).unzip());
    };
    let Some(set) = robot.errors.iter().find(|set| set.name() == name) else {
        let names = robot.errors.iter().map(|set| set.name());
        return Err(lookup::unknown(&format!("the robot has no error set `{}`", shown(name)), name, names));
    };
    let spreads = set.tolerance().spreads;
    let deviation = |unknown: &Unknown| match unknown {
        Unknown::Row(parameter) => {
            let place = Parameter::of_robot(robot.axes()).position(|p| p == *parameter);
            place.map_or(0.0, |k| spreads[k].deviation())
        }
        Unknown::Elastic { .. } | Unknown::Harmonic { .. } => unknown.default_prior(chain),
    };
    let with_prior = all.into_iter().map(|unknown| (unknown, deviation(&unknown)));
    let known: (Vec<_>, Vec<_>) = with_prior.filter(|(_, deviation)| *deviation > 0.0).unzip();
    if known.0.is_empty() {
        output::error(&format!(
            "the error set `{}` has no tolerance for any parameter of the D-H rows",
            shown(name)
        ));
        output::talk("  help: leave out --prior, or state tolerances in the error set");
        return Err(Exit::BadInput);
    }
    Ok(known)
}
