//! `errors`: guesses the tolerances of a robot, and predicts its pose accuracy.

use super::robots::read;
use super::{suggest, suggest_with};
use crate::cell::{ErrorSet, Robot, Spread};
use crate::cli::arguments::{AccuracyBase, ErrorsArguments};
use crate::cli::output::{path_word, word};
use crate::cli::{Exit, json_text, lookup, output};
use crate::files::shown;
use crate::pose_accuracy::{GuessFault, PRESETS, PoseAccuracyTest, TestCube, guessed};
use crate::reach::Inverse;
use crate::record::{BaseChoice, ErrorOrigin, ErrorsDocument, GUESS, GuessQuestion};
use crate::report;
use crate::robot::Chain;
use crate::units::{m_from_mm, mm_from_m, rounded};
use std::path::Path;

/// Ratio of pose accuracy AP to pose repeatability RP (ISO 9283). Below this ratio, the AP of a data sheet
/// probably applies to taught poses.
const TAUGHT: f64 = 3.0;

/// Runs `sweetspot errors`.
pub fn errors(a: &ErrorsArguments) -> Result<Exit, Exit> {
    let Some(given) = &a.robot else {
        output::data(&report::text::presets(&PRESETS))?;
        suggest("errors ROBOT --preset NAME --ap MM");
        return Ok(Exit::Done);
    };
    let robot = read(given, &a.packages)?.robot;
    let chain = Chain::new(&robot);
    let (origin, origin_name, spreads, from) = origin(a, &robot, &chain)?;
    let Some(cube) = TestCube::largest(&robot, &chain, &Inverse::new(&chain)) else {
        output::error(&format!("{}: no test cube fits into the working space", path_word(given)));
        output::talk("  help: check the joint limits and the tool with `sweetspot envelope`");
        return Err(Exit::AnswerIsNo);
    };
    let test = PoseAccuracyTest::new(&chain, &cube, a.base == AccuracyBase::Fitted);
    let wanted = (a.ap.map(m_from_mm), a.rp.map(m_from_mm));
    let guess = guessed(&robot, &chain, &test, &spreads, wanted).map_err(|why| not_found(given, why))?;
    let base = match a.base {
        AccuracyBase::Fitted => BaseChoice::Fitted,
        AccuracyBase::Nominal => BaseChoice::Nominal,
    };
    let question = GuessQuestion { origin, origin_name, base, ap_mm: a.ap, rp_mm: a.rp };
    let (name, source) = (free_name(&robot), source(&question, &from, guess.scale));
    let total = test.accuracy(&guess.spreads);
    let document =
        ErrorsDocument::new(&robot, &question, (&guess, &total), &cube, (name.clone(), source.clone()));
    say_taught_accuracy(a);
    if a.json {
        json_text::print(&document)?;
    } else if a.toml {
        output::data(&report::error_table::table(&robot, &name, &source, &guess.spreads))?;
        suggest(&format!(
            "check CELL --set errors={name}, with this table in a copy of {}",
            path_word(given)
        ));
    } else {
        output::data(&report::text::errors(&document))?;
        suggest_with(&format!("errors {}{} --toml", path_word(given), flags(a)), &a.packages);
    }
    Ok(Exit::Done)
}

/// Returns where the tolerances come from (kind and name), the tolerances, and their source in words.
fn origin(
    a: &ErrorsArguments,
    robot: &Robot,
    chain: &Chain,
) -> Result<(ErrorOrigin, String, Vec<Spread>, String), Exit> {
    if let Some(name) = &a.preset {
        let Some(preset) = PRESETS.iter().find(|preset| preset.name == name) else {
            let names = PRESETS.iter().map(|preset| preset.name);
            return Err(lookup::unknown(&format!("there is no preset `{}`", shown(name)), name, names));
        };
        let from = format!("the preset {} ({}; {})", preset.name, preset.class, preset.source);
        return Ok((ErrorOrigin::Preset, name.clone(), preset.spreads(robot, chain), from));
    }
    let set = chosen(a, robot)?;
    let refused = |why: &str| {
        output::error(&format!("the error set `{}` {why}", shown(set.name())));
        output::talk("  help: choose a set of tolerances with --errors, or a class of arms with --preset");
        Err(Exit::BadInput)
    };
    let ErrorSet::Tolerance(t) = set else {
        return refused("is signed, so it describes one robot: it has no tolerances to scale");
    };
    if t.covariance.is_some() {
        return refused("has a covariance: it is measured, so a data sheet cannot improve it");
    }
    let from = format!("the error set {}", shown(&t.name));
    Ok((ErrorOrigin::Robot, t.name.clone(), t.spreads.clone(), from))
}

/// Returns the error set that `--errors` names, or the first set of tolerances.
fn chosen<'r>(a: &ErrorsArguments, robot: &'r Robot) -> Result<&'r ErrorSet, Exit> {
    if let Some(name) = &a.errors {
        return robot.errors.iter().find(|set| set.name() == name).ok_or_else(|| {
            let names = robot.errors.iter().map(ErrorSet::name);
            lookup::unknown(&format!("the robot has no error set `{}`", shown(name)), name, names)
        });
    }
    let mut tolerances = robot.errors.iter().filter(|set| matches!(set, ErrorSet::Tolerance(_)));
    tolerances.next().ok_or_else(|| {
        output::error("the robot has no set of tolerances");
        let names: Vec<_> = PRESETS.iter().map(|preset| preset.name).collect();
        output::talk(&format!("  help: add --preset and one of: {}", names.join(", ")));
        Exit::BadInput
    })
}

fn not_found(robot: &Path, why: GuessFault) -> Exit {
    let robot = path_word(robot);
    match why {
        GuessFault::NoEffect => {
            output::error(&format!("{robot}: the tolerances do not move the TCP at the test poses"));
            output::talk("  help: state tolerances above 0, or choose a class of arms with --preset");
        }
        GuessFault::NotFound { nearest } => {
            let nearest = rounded(mm_from_m(nearest), 3);
            output::error(&format!(
                "{robot}: no scale of the tolerances gives this AP; the nearest possible AP is {nearest} mm"
            ));
            output::talk("  help: state a smaller --ap");
        }
    }
    Exit::BadInput
}

/// Returns a name for the new error set that no other set of the robot has.
fn free_name(robot: &Robot) -> String {
    let is_free = |name: &String| robot.errors.iter().all(|set| set.name() != name);
    let numbered = (2..).map(|k| format!("{GUESS}-{k}"));
    std::iter::once(GUESS.to_string()).chain(numbered).find(is_free).unwrap_or_else(|| GUESS.into())
}

/// Describes where the tolerances come from. The text becomes the value of the key `source` in the new error
/// set.
fn source(question: &GuessQuestion, from: &str, scale: f64) -> String {
    let mut text = format!("GUESS, not measured: {from}");
    if let Some(ap) = question.ap_mm {
        let base = match question.base {
            BaseChoice::Fitted => "base frame fitted",
            BaseChoice::Nominal => "nominal base frame",
        };
        text += &format!(
            ", scaled by {} to a predicted pose accuracy AP (ISO 9283, {base}) of {ap} mm for the median robot",
            rounded(scale, 5)
        );
    }
    if let Some(rp) = question.rp_mm {
        text += &format!("; dq includes random errors that cause a repeatability RP of {rp} mm");
    }
    text
}

/// Warns if the pose accuracy AP is near the pose repeatability RP, as it is for taught poses.
fn say_taught_accuracy(a: &ErrorsArguments) {
    if let (Some(ap), Some(rp)) = (a.ap, a.rp)
        && ap < TAUGHT * rp
    {
        output::talk(
            "warning: the AP is near the repeatability RP. Data sheets often state such an AP for taught poses. It then \
             says nothing about the errors of the arm, and the guess is too small",
        );
    }
}

/// Returns the given flags as arguments for another run.
fn flags(a: &ErrorsArguments) -> String {
    let named = [("preset", &a.preset), ("errors", &a.errors)].into_iter();
    let named = named.filter_map(|(flag, value)| Some(format!(" --{flag} {}", word(value.as_ref()?))));
    let numbers = [("ap", a.ap), ("rp", a.rp)].into_iter();
    let numbers = numbers.filter_map(|(flag, value)| Some(format!(" --{flag} {}", value?)));
    let base = if a.base == AccuracyBase::Nominal { " --base nominal" } else { "" };
    named.chain(numbers).collect::<String>() + base
}
