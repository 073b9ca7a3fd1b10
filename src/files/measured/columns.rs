//! Columns of a table: which of them hold joints, positions, orientations and uncertainties.

use super::name::{ColumnWords, StatedUnit};
use super::positions::{ReflectorColumns, positions};
use crate::files::fault::{did_you_mean, listed, shown};

/// Pairs of a quantity (`q1`, `q2` ..., `x`, `y` or `z`) and the name or number of the column that holds it.
pub type ColumnNames = [(String, String)];

/// Kind of the numbers that state an orientation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RotationForm {
    /// Three angles.
    Angles,
    /// Quaternion whose scalar part is the first number.
    ScalarFirst,
    /// Quaternion whose column names do not say which number is the scalar part.
    Quaternion,
    /// Nine numbers of a matrix, row by row.
    Matrix,
}

/// Columns of a table by their indices, counted from 0.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundColumns {
    pub joints: Vec<usize>,
    pub reflectors: Vec<ReflectorColumns>,
    pub rotation: Option<(RotationForm, Vec<usize>)>,
    /// Columns of the uncertainty, and the coverage factor (number of standard deviations) of its values.
    pub uncertainty: Option<(Vec<usize>, f64)>,
    /// Column that names the reflector of a row.
    pub reflector: Option<usize>,
    /// Unit of the joints, if the column names or a line of units state it.
    pub angle_unit: Option<StatedUnit>,
    /// Unit of the positions, if the column names or a line of units state it.
    pub length_unit: Option<StatedUnit>,
    /// Factors that convert the joint columns to the units of the table. A factor is 1 unless both the column
    /// and the positions have stated units of length.
    pub joint_factors: Vec<f64>,
    /// Factor that converts the positions to [`Self::length_unit`].
    pub position_factor: f64,
    /// Factor that converts the uncertainty to [`Self::length_unit`].
    pub uncertainty_factor: f64,
    /// Unit of the angles of orientations, if the column names or a line of units state it.
    pub rotation_unit: Option<StatedUnit>,
}

/// Message and help of a column that is missing.
pub type ColumnFault = (String, String);

/// Names of a column that states the reflector of a row.
const REFLECTOR_NAMES: [&str; 5] = ["reflector", "target", "smr", "point", "marker"];

/// Words before a number in the name of a joint.
const JOINT_WORDS: [&str; 10] = ["q", "j", "joint", "jnt", "axis", "ax", "a", "theta", "th", "jt"];

/// Words before a number in the name of a joint, if the numbers count from 0. Some controllers name joints
/// like this, for example `actual_q_0`.
const JOINT_OF_ZERO: [&str; 4] = ["q", "joint", "j", "axis"];

/// Names of the joints of Motoman arms.
const MOTOMAN: [&str; 7] = ["s", "l", "e", "u", "r", "b", "t"];

/// Names of the three angles of an orientation.
const ANGLES: [[&str; 3]; 7] = [
    ["rx", "ry", "rz"],
    ["roll", "pitch", "yaw"],
    ["a", "b", "c"],
    ["w", "p", "r"],
    ["rotx", "roty", "rotz"],
    ["alpha", "beta", "gamma"],
    ["phi", "theta", "psi"],
];

/// Names of the numbers of a quaternion, the scalar part first.
const QUATERNIONS: [[&str; 4]; 2] = [["qw", "qx", "qy", "qz"], ["quatw", "quatx", "quaty", "quatz"]];

/// Names of the columns of a table, split into words once.
pub struct TableNames<'h> {
    header: &'h [String],
    words: Vec<ColumnWords>,
    columns: &'h ColumnNames,
    robot_joints: &'h [&'h str],
}

impl<'h> TableNames<'h> {
    pub fn new(
        header: &'h [String],
        units: &[String],
        columns: &'h ColumnNames,
        robot_joints: &'h [&'h str],
    ) -> Self {
        let unit = |k: usize| units.get(k).map(|unit| unit.to_lowercase());
        let names = header.iter().enumerate();
        let words = names.map(|(k, name)| ColumnWords::new(name, unit(k).as_deref())).collect();
        Self { header, words, columns, robot_joints }
    }

    /// Finds all columns. If `is_numbered` is true, the table has no column names: the first columns are the
    /// joints, and the next three columns are the position.
    ///
    /// # Errors
    ///
    /// Returns what is missing and what to do.
    pub fn find(&self, is_numbered: bool) -> Result<FoundColumns, ColumnFault> {
        let (joints, _) = self.find_joints(is_numbered)?;
        self.find_besides(joints, is_numbered)
    }

    /// Finds the columns of the joints, and the unit of the joint coordinates. The unit is None if neither
    /// the column names nor a line of units states it.
    ///
    /// # Errors
    ///
    /// Returns what is missing and what to do.
    pub fn find_joints(&self, is_numbered: bool) -> Result<(Vec<usize>, Option<StatedUnit>), ColumnFault> {
        self.refuse_unknown_quantities()?;
        let joints = self.joints(is_numbered)?;
        let unit = self.angle_unit(&joints);
        Ok((joints, unit))
    }

    /// Finds all columns except the columns of the joints. `joints` is empty if a second table holds the
    /// joints.
    ///
    /// # Errors
    ///
    /// Returns what is missing and what to do.
    pub fn find_besides(&self, joints: Vec<usize>, is_numbered: bool) -> Result<FoundColumns, ColumnFault> {
        let reflectors = self.reflectors(&joints, is_numbered)?;
        let place = reflectors.first().map_or([0; 3], |first| first.position);
        let rotation =
            if reflectors.len() == 1 && !is_numbered { self.rotation(&joints, place[0]) } else { None };
        let unit = |places: &[usize]| places.iter().find_map(|&k| self.words[k].unit);
        let length = |unit: Option<StatedUnit>| unit.and_then(StatedUnit::length);
        let stated = unit(&place).filter(|unit| unit.length().is_some());
        let length_unit = stated.map(StatedUnit::of_table);
        let factor =
            |k: usize| length(self.words[k].unit).zip(length(length_unit)).map_or(1.0, |(a, b)| a / b);
        let uncertainty = self.uncertainty();
        let uncertainty_factor = match &uncertainty {
            Some((places, _)) if self.words[places[0]].unit.is_some() => factor(places[0]),
            _ => factor(place[0]),
        };
        let reflector = self.header.iter().position(|name| REFLECTOR_NAMES.contains(&&*name.to_lowercase()));
        Ok(FoundColumns {
            uncertainty,
            uncertainty_factor,
            joint_factors: joints.iter().map(|&k| factor(k)).collect(),
            position_factor: factor(place[0]),
            reflector: reflector.filter(|k| !joints.contains(k)),
            angle_unit: self.angle_unit(&joints),
            length_unit,
            rotation_unit: rotation.as_ref().and_then(|(_, places)| unit(places)),
            joints,
            reflectors,
            rotation,
        })
    }

    /// Returns the unit of angles that a joint column states.
    fn angle_unit(&self, joints: &[usize]) -> Option<StatedUnit> {
        joints.iter().find_map(|&k| self.words[k].unit.filter(|unit| unit.length().is_none()))
    }

    fn quantities(&self) -> impl Iterator<Item = String> {
        (1..=self.robot_joints.len()).map(|k| format!("q{k}")).chain(["x", "y", "z"].map(String::from))
    }

    fn refuse_unknown_quantities(&self) -> Result<(), ColumnFault> {
        let known: Vec<String> = self.quantities().collect();
        match self.columns.iter().find(|(name, _)| !known.contains(name)) {
            Some((unknown, _)) => Err((
                format!("`{}` is neither a joint of this arm nor x, y or z", shown(unknown)),
                format!("the allowed names are {}", known.join(", ")),
            )),
            None => Ok(()),
        }
    }

    /// Returns the column that the user states for a quantity, by its name or by its number from 1. Returns
    /// None if the user states no column.
    fn stated(&self, quantity: &str) -> Option<Result<usize, ColumnFault>> {
        let (_, name) = self.columns.iter().find(|(of, _)| of == quantity)?;
        let named = self.header.iter().position(|column| column == name);
        let number = || name.parse::<usize>().ok()?.checked_sub(1).filter(|k| *k < self.header.len());
        Some(named.or_else(number).ok_or_else(|| {
            let near = did_you_mean(name, self.header.iter().map(String::as_str));
            let near = near.map_or(String::new(), |near| format!("did you mean `{}`? ", shown(near)));
            (format!("no column `{}`", shown(name)), format!("{near}{}", self.remedy(quantity)))
        }))
    }

    fn remedy(&self, quantity: &str) -> String {
        let columns = listed(self.header.iter().map(String::as_str));
        format!(
            "name the column with --column {quantity}=NAME, or by its number, --column {quantity}=1; the columns \
             are {columns}"
        )
    }

    fn missing(&self, quantity: &str) -> ColumnFault {
        let is_joint = quantity.starts_with('q');
        let other =
            if is_joint { "; if another table holds the joint coordinates, add --joints FILE" } else { "" };
        (format!("no column is recognized as `{quantity}`"), format!("{}{other}", self.remedy(quantity)))
    }

    fn joints(&self, is_numbered: bool) -> Result<Vec<usize>, ColumnFault> {
        let guessed = if is_numbered { None } else { self.guessed_joints() };
        let mut joints = Vec::new();
        for k in 0..self.robot_joints.len() {
            let quantity = format!("q{}", k + 1);
            joints.push(match self.stated(&quantity) {
                Some(stated) => stated?,
                None if is_numbered && k < self.header.len() => k,
                None => match &guessed {
                    Some(guessed) => guessed[k],
                    None => return Err(self.missing(&self.first_missing_joint())),
                },
            });
        }
        Ok(joints)
    }

    /// Returns the first joint, such as `q3`, for which no column is found and the user states no column.
    fn first_missing_joint(&self) -> String {
        let numbers = 0..self.robot_joints.len();
        let is_named = |k: usize| {
            let quantity = format!("q{}", k + 1);
            self.stated(&quantity).is_some() || self.numbered(k + 1, &JOINT_WORDS).is_some()
        };
        numbers.into_iter().find(|k| !is_named(*k)).map_or("q1".into(), |k| format!("q{}", k + 1))
    }

    /// Returns the columns of the joints. The rules are tried in this order: joint names of the robot,
    /// numbers from 1, numbers from 0, letters of Motoman, the word joint. The first rule that gives a column
    /// for every joint applies.
    fn guessed_joints(&self) -> Option<Vec<usize>> {
        let axes = self.robot_joints.len();
        let by_name = || {
            let lower: Vec<String> = self.header.iter().map(|name| name.to_lowercase()).collect();
            let own = |joint: &&str| lower.iter().position(|name| *name == joint.to_lowercase());
            self.robot_joints.iter().map(own).collect::<Option<Vec<_>>>()
        };
        let by_number = || (1..=axes).map(|n| self.numbered(n, &JOINT_WORDS)).collect::<Option<Vec<_>>>();
        let from_zero = || {
            let all = (0..axes).map(|n| self.numbered(n, &JOINT_OF_ZERO)).collect::<Option<Vec<_>>>();
            all.filter(|_| self.numbered(axes, &JOINT_OF_ZERO).is_none())
        };
        let motoman = || {
            let letters = MOTOMAN.iter().filter(|letter| axes == 7 || **letter != "e");
            let place = |letter: &&str| self.header.iter().position(|name| name.eq_ignore_ascii_case(letter));
            let all = letters.map(place).collect::<Option<Vec<_>>>();
            all.filter(|all| all.len() == axes)
        };
        let by_word = || {
            let is_joint = |name: &String| name.to_lowercase().contains("joint");
            let all: Vec<usize> = (0..self.header.len()).filter(|&k| is_joint(&self.header[k])).collect();
            (all.len() == axes).then_some(all)
        };
        by_name().or_else(by_number).or_else(from_zero).or_else(motoman).or_else(by_word)
    }

    /// Returns the column of joint number `n`.
    fn numbered(&self, n: usize, words: &[&str]) -> Option<usize> {
        let number = n.to_string();
        self.best(|parts| match parts {
            [word, k] => words.contains(word) && *k == number,
            ["joint", word, k] => words.contains(word) && *k == number,
            ["rob" | "robot", .., word, k] => words.contains(word) && *k == number,
            _ => false,
        })
    }

    /// Returns the column whose words fit. The order of preference is: measured values, values without a
    /// stated origin, commanded values.
    fn best(&self, fits: impl Fn(&[&str]) -> bool) -> Option<usize> {
        let names = self.words.iter().enumerate();
        let fitting = names.filter(|(_, name)| name.uncertain.is_none() && fits(&name.parts()));
        fitting.min_by_key(|(k, name)| (name.origin, name.fillers, *k)).map(|(k, _)| k)
    }

    fn reflectors(&self, joints: &[usize], is_numbered: bool) -> Result<Vec<ReflectorColumns>, ColumnFault> {
        let axes = ["x", "y", "z"];
        let stated: Vec<_> = axes.iter().map(|axis| self.stated(axis)).collect();
        if stated.iter().any(Option::is_some) || is_numbered {
            let mut position = [0; 3];
            let guess = positions(&self.words).into_iter().next();
            for (k, (place, stated)) in position.iter_mut().zip(stated).enumerate() {
                *place = match (stated, &guess) {
                    (Some(stated), _) => stated?,
                    (None, _) if is_numbered && joints.len() + k < self.header.len() => joints.len() + k,
                    (None, Some(guess)) => guess.position[k],
                    (None, None) => return Err(self.missing(axes[k])),
                };
            }
            return Ok(vec![ReflectorColumns { name: String::new(), position }]);
        }
        let found = positions(&self.words);
        if found.is_empty() {
            let named = |axis: &&&str| self.best(|words| words.last() == Some(axis)).is_none();
            return Err(self.missing(axes.iter().find(named).unwrap_or(&"x")));
        }
        Ok(found)
    }

    fn rotation(&self, joints: &[usize], near: usize) -> Option<(RotationForm, Vec<usize>)> {
        let origin = self.words.get(near)?.origin;
        let find = |word: &str, digits: &str| {
            let fits = |name: &ColumnWords| name.words.concat() == format!("{word}{digits}");
            let names = self.words.iter().enumerate();
            let free =
                names.filter(|(k, name)| name.uncertain.is_none() && !joints.contains(k) && fits(name));
            free.filter(|(_, name)| name.origin == origin).map(|(k, _)| k).next()
        };
        let all = |words: &[&str]| words.iter().map(|word| find(word, "")).collect::<Option<Vec<_>>>();
        let numbered = |word: &str, numbers: &[&str]| {
            numbers.iter().map(|number| find(word, number)).collect::<Option<Vec<_>>>()
        };
        let matrix = ["11", "12", "13", "21", "22", "23", "31", "32", "33"];
        let matrix = numbered("r", &matrix).map(|places| (RotationForm::Matrix, places));
        let named = QUATERNIONS.iter().find_map(|names| all(names));
        let quaternion = named.map(|places| (RotationForm::ScalarFirst, places)).or_else(|| {
            numbered("q", &["0", "1", "2", "3"]).map(|places| (RotationForm::Quaternion, places))
        });
        let angles =
            || ANGLES.iter().find_map(|names| all(names)).map(|places| (RotationForm::Angles, places));
        matrix.or(quaternion).or_else(angles)
    }

    /// Returns the columns of the uncertainty of the position: one column for each axis, or one column for
    /// all axes.
    fn uncertainty(&self) -> Option<(Vec<usize>, f64)> {
        let column = |wanted: &[&str]| {
            let names = self.words.iter().enumerate();
            let fits = |name: &ColumnWords| name.uncertain.is_some() && name.parts() == wanted;
            names.filter(|(_, name)| fits(name)).map(|(k, _)| k).next()
        };
        let axes = ["x", "y", "z"].iter().map(|axis| column(&[axis])).collect::<Option<Vec<_>>>();
        let places = axes.or_else(|| column(&[]).map(|k| vec![k]))?;
        // The GUM writes a standard uncertainty as u, and an expanded uncertainty (two standard deviations)
        // as U. An uncertainty in words is usually the expanded uncertainty of a certificate.
        let word = self.words[places[0]].uncertain.as_deref()?;
        let is_error = ["error", "err", "dev", "residual", "rms"].contains(&word);
        let is_standard = word == "u" && self.header[places[0]].contains('u');
        let is_expanded = word.starts_with('u') && !is_standard;
        (!is_error).then_some((places, if is_expanded { 2.0 } else { 1.0 }))
    }
}
