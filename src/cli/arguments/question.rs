//! Flags that override keys of the cell file. Each flag becomes a [`Setting`], which the reader of the cell
//! file validates.

use super::value_parsers::{number, setting};
use crate::cell::{Model, Quantity, Reading, Registration};
use crate::cli::output::word as shell_word;
use crate::files::{Setting, toml_string};
use clap::Args;
use clap::builder::PossibleValuesParser;

/// Flags that choose error set, error model, sense and limit, or set any key of the cell file.
#[derive(Args, Default)]
pub struct ErrorFlags {
    /// Use this error set of the robot
    #[arg(long, value_name = "NAME")]
    pub errors: Option<String>,
    /// Use this error model
    #[arg(long, value_parser = PossibleValuesParser::new(Model::ALL.map(Model::name)))]
    pub model: Option<String>,
    /// Judge every operation by this component of the error (sense): x, y, z, xy, xyz, rx, ry, rz or rotation
    /// in world axes, or a sense defined in the cell file. Append @surface or @tool for the axes of the
    /// surface or the tool
    #[arg(long, value_name = "SENSE")]
    pub sense: Option<String>,
    /// Largest allowed error of every operation, in mm, or in degrees if the sense is a rotation
    #[arg(long, value_name = "MM", value_parser = number, allow_hyphen_values = true)]
    pub limit: Option<f64>,
    /// Set any key of the cell file, for example --set clearance_mm=10; can be given several times
    #[arg(long = "set", value_name = "PATH=VALUE", value_parser = setting)]
    pub sets: Vec<Setting>,
}

/// Flags that choose the errors and their interpretation.
#[derive(Args, Default)]
pub struct QuestionFlags {
    #[command(flatten)]
    pub errors: ErrorFlags,
    /// Interpret the errors as one signed sample, as worst-case tolerances or as random variables
    #[arg(long, value_parser = PossibleValuesParser::new(Reading::ALL.map(Reading::name)))]
    pub reading: Option<String>,
    /// Summarize the random error by this statistic; implies --reading statistical
    #[arg(long, value_parser = PossibleValuesParser::new(Quantity::ALL.map(Quantity::name)))]
    pub quantity: Option<String>,
    /// Frames that were measured with the robot itself: none, the base frame (best-fit) or the surface frames
    /// (taught)
    #[arg(long, value_parser = PossibleValuesParser::new(Registration::ALL.map(Registration::name)))]
    pub registration: Option<String>,
}

/// Returns the setting of the flag `name` (without `--`). The setting gives the key `path` the text `value`.
/// Returns None if `value` is None.
pub fn word(name: &str, path: &str, value: Option<&String>) -> Option<Setting> {
    value.map(|value| Setting::of_flag(&format!("--{name} {value}"), path, toml_string(value)))
}

/// Formats a number as a TOML float, for example `10.0` or `inf`.
pub fn toml_number(value: f64) -> String {
    format!("{value:?}").to_lowercase()
}

impl ErrorFlags {
    /// Returns the settings of these flags.
    pub fn settings(&self) -> Vec<Setting> {
        let Self { errors, model, sense, limit, sets } = self;
        let mut settings = sets.clone();
        settings.extend(word("errors", "errors", errors.as_ref()));
        settings.extend(word("model", "model", model.as_ref()));
        if let Some(sense) = sense {
            settings.push(Setting::of_every_operation(
                &format!("--sense {sense}"),
                "sense",
                toml_string(sense),
            ));
        }
        if let Some(limit) = limit {
            // Both keys are set; the reader uses the key in the unit of the sense.
            let (flag, value) = (format!("--limit {}", typed(*limit)), toml_number(*limit));
            let keys = ["limit_mm", "limit_deg"];
            settings.extend(keys.map(|key| Setting::of_every_operation(&flag, key, value.clone())));
        }
        settings
    }
}

impl QuestionFlags {
    /// Returns the settings of these flags.
    pub fn settings(&self) -> Vec<Setting> {
        let Self { errors, reading, quantity, registration } = self;
        let mut settings = errors.settings();
        settings.extend(word("reading", "reading", reading.as_ref()));
        settings.extend(word("quantity", "quantity", quantity.as_ref()));
        if reading.is_none() && quantity.is_some() {
            let statistical = toml_string(Reading::Statistical.name());
            settings.extend(
                quantity.as_ref().map(|quantity| {
                    Setting::of_flag(&format!("--quantity {quantity}"), "reading", statistical)
                }),
            );
        }
        settings.extend(word("registration", "registration", registration.as_ref()));
        settings
    }
}

impl QuestionFlags {
    /// Returns the given flags and their values as one text for a shell; a space precedes each flag.
    pub fn words(&self) -> String {
        let Self {
            errors: ErrorFlags { errors, model, sense, limit, sets },
            reading,
            quantity,
            registration,
        } = self;
        let limit = limit.map(typed);
        let given = [
            ("errors", errors),
            ("model", model),
            ("sense", sense),
            ("limit", &limit),
            ("reading", reading),
            ("quantity", quantity),
            ("registration", registration),
        ];
        let flags = given.into_iter().filter_map(|(name, value)| Some((name, value.clone()?)));
        let sets = sets.iter().map(|set| ("set", set.words()));
        flags.chain(sets).map(|(name, value)| format!(" --{name} {}", shell_word(&value))).collect()
    }
}

/// Formats a number as a user types it: a whole number below 1e15 has no decimal point.
pub fn typed(value: f64) -> String {
    if value.fract() == 0.0 && value.abs() < 1e15 { value.to_string() } else { toml_number(value) }
}
