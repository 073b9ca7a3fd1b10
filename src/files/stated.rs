//! Readers of robot calibrations from other programs: the YAML file that the driver of Universal Robots
//! writes, and `calibration.conf` from a controller of Universal Robots.

use super::fault::{Fault, did_you_mean, listed, shown};
use crate::pose::Pose;
use nalgebra::Vector3;
use std::collections::HashMap;

/// Calibration of an arm of Universal Robots.
#[derive(Debug, Clone, PartialEq)]
pub enum StatedCalibration {
    /// Pose of each joint frame in the frame of the link before that joint. The variant also holds the hash
    /// of the calibration.
    Frames { frames: Vec<Pose>, hash: Option<String> },
    /// Differences of theta (rad), a (m), d (m) and alpha (rad) from the nominal Denavit-Hartenberg rows.
    Rows { theta: Vec<f64>, a: Vec<f64>, d: Vec<f64>, alpha: Vec<f64> },
}

/// Keys of the joint frames in the YAML of the driver, from base to tool.
const JOINTS: [&str; 6] = ["shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3"];

/// Keys of one joint frame.
const COMPONENTS: [&str; 6] = ["x", "y", "z", "roll", "pitch", "yaw"];

/// Keys of the rows in `calibration.conf`.
const DELTAS: [&str; 4] = ["delta_theta", "delta_a", "delta_d", "delta_alpha"];

/// Magnitude at and above which a number cannot be a length (m) or an angle (rad) of an arm.
const TOO_LARGE: f64 = 1e4;

/// Largest number of lines of a file that contains a calibration.
const MAX_LINES: usize = 1000;

/// Largest number of faults listed for one file.
const MAX_FAULTS: usize = 20;

/// Reads the entry `kinematics:` of the YAML file that the driver of Universal Robots writes.
///
/// The reader supports only what the driver writes: maps of maps of numbers, without lists, anchors or tags.
///
/// # Errors
///
/// Returns the faults of the file.
pub fn read_yaml(file: &str, text: &str) -> Result<StatedCalibration, Vec<Fault>> {
    let mut faults = FaultList::new(file, text)?;
    let (mut joint, mut hash) = (None, None);
    let mut numbers: HashMap<(usize, usize), f64> = HashMap::new();
    for (number, line) in lines(text) {
        let depth = line.len() - line.trim_start().len();
        let Some((key, value)) = line.trim().split_once(':') else {
            faults.add(
                number,
                format!("`{}` is not a key with a value", shown(line.trim())),
                "write KEY: VALUE",
            );
            continue;
        };
        let (key, value) = (key.trim(), value.trim());
        match (depth, value) {
            (0, "") if key == "kinematics" => {}
            (1.., "") => {
                joint = JOINTS.iter().position(|name| *name == key);
                if joint.is_none() {
                    faults.add_unknown(number, key, &JOINTS);
                }
            }
            (_, value) if key == "hash" => hash = Some(value.to_string()),
            (1.., value) => {
                let component = COMPONENTS.iter().position(|name| *name == key);
                match (joint, component, number_of(value)) {
                    (_, None, _) => faults.add_unknown(number, key, &COMPONENTS),
                    (None, ..) => faults.add(number, "the number belongs to no joint".into(), LAYOUT),
                    (_, _, None) => faults.add_number(number, value),
                    (Some(joint), Some(component), Some(value)) => {
                        if numbers.insert((joint, component), value).is_some() {
                            let message = format!("`{key}` of {} is given twice", JOINTS[joint]);
                            faults.add(number, message, "remove one of the two");
                        }
                    }
                }
            }
            _ => faults.add_unknown(number, key, &["kinematics"]),
        }
    }
    let mut get = |joint: usize, component: usize| {
        let number = numbers.get(&(joint, component)).copied();
        if number.is_none() {
            let message = format!("`{}` of {} is missing", COMPONENTS[component], JOINTS[joint]);
            faults.add(1, message, LAYOUT);
        }
        number.unwrap_or(0.0)
    };
    let frames = (0..JOINTS.len()).map(|joint| {
        let [x, y, z, roll, pitch, yaw] = [0, 1, 2, 3, 4, 5].map(|component| get(joint, component));
        Pose::from_translation_rpy(Vector3::new(x, y, z), Vector3::new(roll, pitch, yaw))
    });
    let frames = frames.collect();
    faults.or(StatedCalibration::Frames { frames, hash })
}

/// Help text that states which keys the YAML file needs.
const LAYOUT: &str = "give `kinematics:` with shoulder, upper_arm, forearm, wrist_1, wrist_2 and wrist_3, each \
                      with x, y, z, roll, pitch and yaw, as the driver of Universal Robots writes it";

/// Reads the differences from the nominal Denavit-Hartenberg rows that a `calibration.conf` states. The file
/// has one line `delta_theta = [ ... ]`, and one such line for each of a, d and alpha.
///
/// # Errors
///
/// Returns the faults of the file.
pub fn read_conf(file: &str, text: &str) -> Result<StatedCalibration, Vec<Fault>> {
    let mut faults = FaultList::new(file, text)?;
    let mut rows: [Option<Vec<f64>>; 4] = [const { None }; 4];
    for (number, line) in lines(text) {
        let Some((key, value)) = line.split_once('=') else { continue };
        let Some(row) = DELTAS.iter().position(|name| *name == key.trim()) else { continue };
        let inside = value.trim().trim_start_matches('[').trim_end_matches(']');
        let fields = inside.split([',', ' ', '\t']).filter(|field| !field.is_empty());
        let values: Vec<_> = fields.map(|field| (field, number_of(field))).collect();
        values.iter().filter(|(_, v)| v.is_none()).for_each(|(field, _)| faults.add_number(number, field));
        if values.len() != JOINTS.len() {
            let message = format!("{} has {} numbers", DELTAS[row], values.len());
            faults.add(number, message, "give one number for each of the six joints");
        }
        rows[row] = Some(values.into_iter().map(|(_, value)| value.unwrap_or(0.0)).collect());
    }
    let [theta, a, d, alpha] = [0, 1, 2, 3].map(|k| {
        rows[k].take().unwrap_or_else(|| {
            faults.add(
                1,
                format!("`{}` is missing", DELTAS[k]),
                "give the calibration.conf of the controller",
            );
            Vec::new()
        })
    });
    faults.or(StatedCalibration::Rows { theta, a, d, alpha })
}

/// Returns the lines that are not empty, each with its number and without its comment.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let bare = |line: &'_ str| line.find('#').unwrap_or(line.len());
    let all = text.lines().enumerate().map(move |(k, line)| (k + 1, line[..bare(line)].trim_end()));
    all.filter(|(_, line)| !line.trim().is_empty() && *line != "---")
}

fn number_of(text: &str) -> Option<f64> {
    text.parse().ok().filter(|number: &f64| number.abs() < TOO_LARGE)
}

struct FaultList<'f> {
    file: &'f str,
    faults: Vec<Fault>,
}

impl<'f> FaultList<'f> {
    /// Returns a list that has no faults yet. If the text is too long for a calibration, the function fails
    /// with a fault.
    fn new(file: &'f str, text: &str) -> Result<Self, Vec<Fault>> {
        if text.lines().count() > MAX_LINES {
            let message = format!("the file has more than {MAX_LINES} lines");
            return Err(vec![Fault::of_file(file, message, LAYOUT)]);
        }
        Ok(Self { file, faults: Vec::new() })
    }

    fn add(&mut self, line: usize, message: String, help: &str) {
        if self.faults.len() < MAX_FAULTS {
            self.faults.push(Fault { line, ..Fault::of_file(self.file, message, help) });
        }
    }

    fn add_number(&mut self, line: usize, value: &str) {
        let message = format!("`{}` is not a number in m or rad", shown(value));
        self.add(line, message, "lengths are in m and angles in rad");
    }

    fn add_unknown(&mut self, line: usize, key: &str, known: &[&str]) {
        let near = did_you_mean(key, known.iter().copied());
        let help = near.map_or_else(
            || format!("the keys are {}", listed(known.iter().copied())),
            |near| format!("did you mean `{near}`?"),
        );
        self.add(line, format!("unknown key `{}`", shown(key)), &help);
    }

    fn or(self, calibration: StatedCalibration) -> Result<StatedCalibration, Vec<Fault>> {
        if self.faults.is_empty() { Ok(calibration) } else { Err(self.faults) }
    }
}
