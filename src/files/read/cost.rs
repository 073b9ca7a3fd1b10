//! Reader of the costs of tolerances.

use crate::cell::{
    CostLaw, DEFAULT_SCALES, FIRST_IT_GRADE, LAST_IT_GRADE, MAX_NOMINAL_MM, ToleranceCost, ToleranceGrade,
    it_half_width,
};
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::costs::{
    COST, CostForm, MAX_POWER, MAX_RATE, SCALES, tolerance_cost, tolerance_grade,
};
use crate::files::keys::key::Key;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units::{mm_from_m, rounded};

/// Grades of ISO 286 that apply if the file names none.
const DEFAULT_GRADES: std::ops::RangeInclusive<usize> = 5..=12;

/// Kind of quantity of a parameter, which determines the unit of its tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostedUnit {
    Length,
    Angle,
    /// Deflection of a joint under gravity. For such a parameter, a cost grade states a factor of the
    /// tolerance instead of a tolerance.
    Deflection,
}

/// Parameter of the robot or the equipment whose tolerance may have a cost.
#[derive(Debug, Clone)]
pub struct CostedParameter {
    /// Name in the file; empty if the file cannot name the parameter.
    pub name: String,
    /// Tolerance in SI units. The value is 0 if the file states no tolerance or states a covariance.
    pub plus_minus: f64,
    pub unit: CostedUnit,
}

/// Cost law as the file states it, not yet applied to a parameter.
enum StatedLaw {
    Continuous(CostLaw, (f64, f64)),
    Grades(Vec<StatedGrade>),
    Iso { nominal_mm: f64, grades: Vec<usize>, at: f64, power: f64 },
}

/// Grade with its place in the file.
struct StatedGrade {
    at: At,
    name: String,
    /// Tolerance (m or rad) or scale.
    size: f64,
    /// Kind of quantity of the tolerance; None for a scale.
    unit: Option<CostedUnit>,
    cost: f64,
}

/// One entry of `cost`.
struct StatedCost {
    at: At,
    /// Indices of the parameters; None if the entry names none.
    parameters: Option<Vec<usize>>,
    law: StatedLaw,
}

/// Reads `cost`. Returns one cost model per parameter, or an empty list if the key is not given.
pub fn read_all(t: &mut Table, parameters: &[CostedParameter]) -> Option<Vec<ToleranceCost>> {
    if t.get(&COST).is_none() {
        return Some(Vec::new());
    }
    let before = t.lib.errors();
    let entries = t.tables(&COST, |t| read(t, parameters))?;
    let mut costs: Vec<Option<ToleranceCost>> = vec![None; parameters.len()];
    let mut rest: Option<StatedCost> = None;
    for entry in entries.into_iter().flatten() {
        let Some(places) = &entry.parameters else {
            if rest.is_some() {
                t.error(
                    entry.at,
                    "only one entry of `cost` may leave out `parameters`",
                    "add parameters = [...]; the entry without this key applies to all other parameters",
                );
            }
            rest = Some(entry);
            continue;
        };
        for &place in places {
            let name = &parameters[place].name;
            if costs[place].is_some() {
                t.error(entry.at, format!("`{name}` has two costs"), "name it in only one entry of `cost`");
            }
            costs[place] = entry.law.of(&parameters[place], entry.at, t);
        }
    }
    if let Some(rest) = rest {
        let left = (0..parameters.len()).filter(|&k| costs[k].is_none() && parameters[k].plus_minus > 0.0);
        let left: Vec<usize> = left.collect();
        for place in left {
            let own = rest.law.of(&parameters[place], rest.at, t);
            if own.is_none() {
                break; // One fault is enough for an entry that does not suit the others.
            }
            costs[place] = own;
        }
    }
    let costs = costs.into_iter().map(Option::unwrap_or_default).collect();
    (t.lib.errors() == before).then_some(costs)
}

fn read(t: &mut Table, parameters: &[CostedParameter]) -> Option<StatedCost> {
    let form: Option<CostForm> = t.word(&tolerance_cost::FORM);
    if let Some(form) = form {
        t.apply_rules(&tolerance_cost::FORM, form.name());
    }
    let named = t.if_given(&tolerance_cost::PARAMETERS, |t, key| {
        let items = t.items(key)?;
        read_names(items, parameters, t)
    });
    let (at, power, rate) =
        (t.number(&tolerance_cost::AT), read_power(t), read_limited(t, &tolerance_cost::RATE, MAX_RATE));
    let range = t.if_given(&tolerance_cost::RANGE, |t, _| read_range(t));
    let grades = if t.get(&tolerance_cost::GRADES).is_some() { read_grades(t) } else { None };
    let nominal = read_nominal(t);
    let it_grades = t.if_given(&tolerance_cost::IT_GRADES, |t, key| {
        let items = t.items(key)?;
        let bounds = (FIRST_IT_GRADE as u64, LAST_IT_GRADE as u64);
        let grades: Vec<_> =
            items.iter().map(|item| value::whole(item, "a number of `it_grades`", bounds, t.lib)).collect();
        grades.into_iter().map(|g| g.map(|g| g as usize)).collect::<Option<Vec<_>>>()
    });
    let range = range?.unwrap_or(DEFAULT_SCALES);
    let law = match form? {
        CostForm::Reciprocal => StatedLaw::Continuous(CostLaw::Reciprocal { at: at?, power: power? }, range),
        CostForm::Exponential => StatedLaw::Continuous(CostLaw::Exponential { at: at?, rate: rate? }, range),
        CostForm::Grades => StatedLaw::Grades(grades?),
        CostForm::Iso286 => StatedLaw::Iso {
            nominal_mm: nominal?,
            grades: it_grades?.unwrap_or_else(|| DEFAULT_GRADES.collect()),
            at: at?,
            power: power?,
        },
    };
    Some(StatedCost { at: t.at, parameters: named?, law })
}

fn read_power(t: &mut Table) -> Option<f64> {
    read_limited(t, &tolerance_cost::POWER, MAX_POWER)
}

/// Reads a positive number that must not exceed `most`.
fn read_limited(t: &mut Table, key: &Key, most: f64) -> Option<f64> {
    let value = t.number(key)?;
    if value <= most {
        return Some(value);
    }
    let at = t.get(key).map_or(t.at, |node| node.at);
    let message = format!("`{}` must be at most {most}, not {}", key.name, plain(value));
    t.error(at, message, format!("write a number above 0 and at most {most}"));
    None
}

fn read_nominal(t: &mut Table) -> Option<f64> {
    let node = t.get(&tolerance_cost::NOMINAL)?;
    let nominal = mm_from_m(t.number(&tolerance_cost::NOMINAL)?);
    // The conversion to SI and back may add a rounding error.
    if nominal <= MAX_NOMINAL_MM * (1.0 + 1e-12) {
        return Some(nominal.min(MAX_NOMINAL_MM));
    }
    let message =
        format!("ISO 286 states grades for sizes up to {MAX_NOMINAL_MM} mm, not for {} mm", plain(nominal));
    t.error(node.at, message, "use kind = \"grades\" with the tolerances of your processes");
    None
}

fn read_range(t: &mut Table) -> Option<(f64, f64)> {
    let range = t.numbers(&tolerance_cost::RANGE)?;
    let node = t.get(&tolerance_cost::RANGE)?;
    let (least, most) = (range[0], range[1]);
    let (low, high) = SCALES;
    let fault = if least < low || most > high {
        format!("`scale_range` must be from {low} to {high}, not from {} to {}", plain(least), plain(most))
    } else if least > most {
        format!("`scale_range` is reversed: {} is above {}", plain(least), plain(most))
    } else {
        return Some((least, most));
    };
    t.error(node.at, fault, "write the least scale, then the greatest, for example [0.1, 3]");
    None
}

/// Reads names of parameters; returns their indices.
fn read_names(items: &[Node], parameters: &[CostedParameter], t: &mut Table) -> Option<Vec<usize>> {
    let mut places: Vec<usize> = Vec::new();
    let before = t.lib.errors();
    for item in items {
        let Value::Text(name) = &item.value else {
            let message = format!("`parameters` must be a list of names, but has {}", item.value.kind());
            t.error(item.at, message, "write for example parameters = [\"dl2\", \"dalpha3\"]");
            continue;
        };
        let known = || parameters.iter().filter(|p| !p.name.is_empty() && p.plus_minus > 0.0);
        let Some(place) = parameters.iter().position(|p| p.name == *name && !name.is_empty()) else {
            let help = match did_you_mean(name, known().map(|p| p.name.as_str())) {
                Some(near) => format!("did you mean \"{near}\"?"),
                None => format!(
                    "the parameters with a tolerance are: {}",
                    listed(known().map(|p| p.name.as_str()))
                ),
            };
            t.error(item.at, format!("there is no parameter `{}`", shown(name)), help);
            continue;
        };
        if parameters[place].plus_minus <= 0.0 {
            let message = format!("`{name}` has no plus-or-minus value above 0, so it has no cost");
            t.error(item.at, message, "leave out this name, or give the parameter a plus-or-minus value");
        } else if places.contains(&place) {
            t.error(item.at, format!("`{name}` is named twice"), "remove one of the two");
        }
        places.push(place);
    }
    (t.lib.errors() == before).then_some(places)
}

fn read_grades(t: &mut Table) -> Option<Vec<StatedGrade>> {
    let before = t.lib.errors();
    let grades = t.tables(&tolerance_cost::GRADES, |t| {
        let name = t.name(&tolerance_grade::NAME);
        let cost = t.number(&tolerance_grade::COST);
        let sizes = [
            (&tolerance_grade::MILLIMETRES, Some(CostedUnit::Length)),
            (&tolerance_grade::DEGREES, Some(CostedUnit::Angle)),
            (&tolerance_grade::SCALE, None),
        ];
        let given: Vec<_> = sizes.into_iter().filter(|(key, _)| t.get(key).is_some()).collect();
        let [(key, unit)] = given[..] else {
            let names = sizes.map(|(key, _)| key.name).join("`, `");
            t.error(
                t.at,
                format!("a grade needs exactly one of `{names}`"),
                "write for example plus_minus_mm = 0.02",
            );
            return None;
        };
        let size = t.number(key);
        Some(StatedGrade { at: t.at, name: name?, size: size?, unit, cost: cost? })
    });
    let grades: Vec<StatedGrade> = grades?.into_iter().flatten().collect();
    (t.lib.errors() == before).then_some(grades)
}

/// Returns whether a file may state this scale.
fn is_plausible(scale: f64) -> bool {
    (SCALES.0..=SCALES.1).contains(&scale)
}

impl StatedLaw {
    /// Returns the cost model of one parameter; records a fault if the law does not suit the parameter.
    fn of(&self, parameter: &CostedParameter, at: At, t: &mut Table) -> Option<ToleranceCost> {
        let CostedParameter { name, plus_minus, unit } = parameter;
        match self {
            Self::Continuous(law, range) => Some(ToleranceCost { law: law.clone(), range: *range }),
            Self::Grades(stated) => {
                let mut grades = Vec::new();
                for grade in stated {
                    if grade.unit.is_some_and(|own| own != *unit) {
                        let key = match unit {
                            CostedUnit::Length => "plus_minus_mm",
                            CostedUnit::Angle => "plus_minus_deg",
                            CostedUnit::Deflection => "scale",
                        };
                        let message = format!(
                            "the tolerance of the grade `{}` is not in the unit of `{name}`",
                            shown(&grade.name)
                        );
                        t.error(grade.at, message, format!("state the tolerance of the grade as {key}"));
                        return None;
                    }
                    let scale = grade.unit.map_or(grade.size, |_| grade.size / plus_minus);
                    if !is_plausible(scale) {
                        let grade_name = shown(&grade.name);
                        let message = format!(
                            "the grade `{grade_name}` is {} times the tolerance of `{name}`",
                            plain(rounded(scale, 9))
                        );
                        t.error(
                            grade.at,
                            message,
                            "it must be 0.01 to 100 times that tolerance: is the unit right?",
                        );
                        return None;
                    }
                    grades.push((grade, scale));
                }
                grades.sort_by(|a, b| a.1.total_cmp(&b.1));
                for pair in grades.windows(2) {
                    let (tight, loose) = (pair[0].0, pair[1].0);
                    if loose.cost >= tight.cost {
                        let [loose_name, tight_name] = [loose, tight].map(|g| shown(&g.name));
                        let message = format!(
                            "the grade `{loose_name}` is neither tighter nor cheaper than `{tight_name}`"
                        );
                        t.error(loose.at, message, "remove this grade, or correct its tolerance or its cost");
                        return None;
                    }
                }
                let grade = |(g, scale): (&StatedGrade, f64)| ToleranceGrade {
                    name: g.name.clone(),
                    scale,
                    cost: g.cost,
                };
                ToleranceCost::of_grades(grades.into_iter().map(grade).collect())
            }
            Self::Iso { nominal_mm, grades, at: cost, power } => {
                if *unit != CostedUnit::Length {
                    let message = format!("`{name}` is not a length, so it has no grades of ISO 286");
                    t.error(at, message, "name the lengths in parameters = [...]");
                    return None;
                }
                let grade = |&grade: &usize| {
                    let scale = it_half_width(grade, *nominal_mm)? / plus_minus;
                    Some(ToleranceGrade {
                        name: format!("IT{grade}"),
                        scale,
                        cost: cost * scale.powf(-power),
                    })
                };
                let all = grades.iter().filter_map(grade).filter(|grade| is_plausible(grade.scale));
                let costs = ToleranceCost::of_grades(all.collect());
                if costs.is_none() {
                    let message = format!("no grade of ISO 286 is near the tolerance of `{name}`");
                    t.error(
                        at,
                        message,
                        "every grade is below 0.01 times or above 100 times that \
                    tolerance: is nominal_mm right?",
                    );
                }
                costs
            }
        }
    }
}
