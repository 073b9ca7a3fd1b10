//! Reader of the covariance of a calibration: normally distributed parameters that are correlated.

use super::row_order::ErrorRows;
use crate::cell::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::keys::errors::{PARAMETERS, covariance};
use crate::files::keys::key::NumberRange;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node, Value};
use crate::files::toml::value;
use crate::files::toml::value::plain;
use crate::units;
use nalgebra::DMatrix;

/// Relative tolerance for rounding errors in the checks of a matrix: symmetry, correlations and eigenvalues.
const ROUNDING: f64 = 1e-9;

/// Reads `covariance`.
///
/// `values` are the plus-or-minus values of all parameters. In `values`, every parameter of the covariance
/// must have the value 0.
pub fn read(t: &mut Table, arm: ErrorRows<'_>, values: Option<&SignedErrors>) -> Option<Covariance> {
    let (names, rows) = (t.get(&covariance::PARAMETERS), t.get(&covariance::MATRIX));
    let items = names.and_then(|names| items_of(names, arm, t))?;
    let places = read_parameters(items, arm, t);
    let matrix = rows.and_then(|rows| Matrix::read(rows, items.len(), t));
    if let (Some(places), Some(values)) = (&places, values) {
        spread_once(places, items, values, t);
    }
    let matrix = matrix?;
    matrix.check(&items.iter().map(name_of).collect::<Vec<_>>(), t)?;
    let places = places?;
    let lengths: Vec<_> = Parameter::of_robot(arm.axes).map(|p| is_length(p, arm)).collect();
    let si = |k: usize, v| if lengths[places[k]] { units::m_from_mm(v) } else { units::rad_from_deg(v) };
    let product = |i: usize, j: usize| si(i, si(j, matrix.at(i, j)));
    let half = |i: usize, j: usize| (product(i, j) + product(j, i)) / 2.0;
    let matrix = DMatrix::from_fn(places.len(), places.len(), |i, j| half(i.min(j), i.max(j)));
    Some(Covariance { parameters: places, matrix })
}

/// Returns whether a file gives the parameter in mm.
pub fn is_length(parameter: Parameter, arm: ErrorRows<'_>) -> bool {
    match parameter {
        Parameter::Dq(i) => arm.slides(i),
        Parameter::Dr(_) | Parameter::Dl(_) => true,
        Parameter::Dalpha(_) | Parameter::Dbeta(_) => false,
        // Degrees per m and degrees per N m are converted like degrees. A covariance cannot name a periodic
        // error.
        Parameter::Elastic(..) | Parameter::Compliance(_) | Parameter::Periodic(_) => false,
        Parameter::Base(c) | Parameter::Tool(c) => c < PER_FRAME / 2,
        Parameter::Joint(_, c) | Parameter::Equipment(_, c) => c < PER_FRAME / 2,
    }
}

/// Returns the names in `parameters`. Records a fault if there are no names, or more names than parameters of
/// the robot.
fn items_of<'n>(node: &'n Node, arm: ErrorRows<'_>, t: &mut Table) -> Option<&'n [Node]> {
    // A covariance cannot name the periodic errors. Each joint has one periodic error.
    let most = Parameter::count(arm.axes) - arm.axes;
    if let Some(items) = node.value.items().filter(|items| (1..=most).contains(&items.len())) {
        return Some(items);
    }
    let given = node.value.count_or_kind();
    let message = format!("`parameters` must be a list of 1 to {most} names, not {given}");
    t.error(node.at, message, "write for example parameters = [\"dq1\", \"dl2\", \"base x\"]");
    None
}

/// Returns the name of a parameter as the file gives it, for messages. If the item is not a text, returns the
/// kind of the item.
fn name_of(item: &Node) -> String {
    match &item.value {
        Value::Text(name) => shown(name),
        other => other.kind().to_string(),
    }
}

/// Returns the names of the parameters in the file, in the order of [`Parameter::of_robot`]. The name of a
/// parameter that the file cannot set is empty.
pub fn names_of(arm: ErrorRows<'_>) -> Vec<String> {
    let mut names: Vec<_> = Parameter::of_robot(arm.axes).map(Parameter::name).collect();
    arm.in_order(&mut names);
    arm.unused().into_iter().flatten().for_each(|place| names[place].clear());
    let is_none = |(_, p): &(usize, Parameter)| {
        matches!(p, Parameter::Periodic(_)) || p.is_elastic() && arm.slides(p.deflected_joint())
    };
    let nameless: Vec<_> = Parameter::of_robot(arm.axes).enumerate().filter(is_none).collect();
    nameless.into_iter().for_each(|(place, _)| names[place].clear());
    names
}

/// Reads the names of the parameters; returns their indices in the order of [`Parameter::of_robot`].
fn read_parameters(items: &[Node], arm: ErrorRows<'_>, t: &mut Table) -> Option<Vec<usize>> {
    let names = names_of(arm);
    let mut places: Vec<Option<usize>> = Vec::new();
    for item in items {
        let place = read_parameter(item, &names, arm, t);
        if let Some(place) = place.filter(|_| places.contains(&place)) {
            let message = format!("`{}` is given twice", names[place]);
            t.error(item.at, message, "remove one of the two, with its row and column");
        }
        places.push(place);
    }
    places.into_iter().collect()
}

fn read_parameter(item: &Node, names: &[String], arm: ErrorRows<'_>, t: &mut Table) -> Option<usize> {
    let Value::Text(name) = &item.value else {
        let message = format!("`parameters` must be a list of names, but has {}", item.value.kind());
        t.error(item.at, message, PARAMETERS);
        return None;
    };
    let found = names.iter().position(|n| n == name).filter(|_| !name.is_empty());
    if found.is_none() {
        t.error(item.at, format!("there is no parameter `{}`", shown(name)), nearest(name, names, arm));
    }
    found
}

/// Returns a help text for an unknown name: the range of joint numbers, a similar name, or the allowed names.
fn nearest(name: &str, names: &[String], arm: ErrorRows<'_>) -> String {
    if let Some(first) = of_joint(name, 1).filter(|first| names.contains(first)) {
        let last = of_joint(name, arm.axes).unwrap_or_default();
        return format!("this parameter exists for joints 1 to {}: {first} to {last}", arm.axes);
    }
    match did_you_mean(name, names.iter().map(String::as_str).filter(|n| !n.is_empty())) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None => PARAMETERS.into(),
    }
}

/// Returns the name of a parameter with its joint number replaced by `number`; None if the name has no digit.
fn of_joint(name: &str, number: usize) -> Option<String> {
    let (before, rest) = name.split_at(name.find(|c: char| c.is_ascii_digit())?);
    Some(format!("{before}{number}{}", rest.trim_start_matches(|c: char| c.is_ascii_digit())))
}

/// Records a fault for every parameter that has both a plus-or-minus value and a covariance.
fn spread_once(places: &[usize], items: &[Node], values: &SignedErrors, t: &mut Table) {
    let values = values.values();
    for item in places.iter().zip(items).filter(|(place, _)| values[**place] != 0.0).map(|(_, item)| item) {
        let name = name_of(item);
        let message = format!("`{name}` has both a plus-or-minus value and a covariance");
        let help = format!(
            "write 0 as the plus-or-minus value of {name}: the diagonal of `matrix` gives its variance"
        );
        t.error(item.at, message, help);
    }
}

/// Covariance matrix as the file gives it, with the place of every entry.
struct Matrix<'n> {
    node: &'n Node,
    rows: Vec<Vec<f64>>,
}

impl<'n> Matrix<'n> {
    fn read(node: &'n Node, n: usize, t: &mut Table) -> Option<Self> {
        let Some(rows) = node.value.items().filter(|rows| rows.len() == n) else {
            let message = format!("`matrix` must be a list of {n} rows, not {}", node.value.count_or_kind());
            t.error(node.at, message, "write a row for each of `parameters`, in their order");
            return None;
        };
        let read = |(i, row): (usize, &Node)| {
            value::numbers(row, &format!("row {} of `matrix`", i + 1), n, NumberRange::Finite, t.lib)
        };
        let rows: Vec<_> = rows.iter().enumerate().map(read).collect();
        Some(Self { node, rows: rows.into_iter().collect::<Option<_>>()? })
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.rows[i][j]
    }

    fn place(&self, i: usize, j: usize) -> At {
        let item = |node: &'n Node, k: usize| node.value.items()?.get(k);
        item(self.node, i).and_then(|row| item(row, j)).map_or(self.node.at, |entry| entry.at)
    }

    /// Checks that the matrix is symmetric and positive semidefinite with no correlation beyond 1.
    ///
    /// Returns None and records the faults if the matrix fails a check.
    fn check(&self, names: &[String], t: &mut Table) -> Option<()> {
        let before = t.lib.errors();
        for i in 0..names.len() {
            self.check_variance(i, &names[i], t);
            (0..i).for_each(|j| self.check_pair(i, j, names, t));
        }
        (t.lib.errors() == before).then_some(())?;
        self.check_definite(names, t)
    }

    fn check_variance(&self, i: usize, name: &str, t: &mut Table) {
        if self.at(i, i) < 0.0 {
            let variance = plain(self.at(i, i));
            let message = format!("the variance of `{name}` must be 0 or greater, not {variance}");
            t.error(self.place(i, i), message, "write the square of its standard deviation");
        }
    }

    /// Checks that the entries (i, j) and (j, i) are equal, and that their correlation is from -1 to 1.
    fn check_pair(&self, i: usize, j: usize, names: &[String], t: &mut Table) {
        let (a, b) = (self.at(i, j), self.at(j, i));
        let (of, and) = (&names[i], &names[j]);
        let deviations = self.at(i, i).max(0.0).sqrt() * self.at(j, j).max(0.0).sqrt();
        if (a - b).abs() > ROUNDING * a.abs().max(b.abs()) {
            let message = format!(
                "`matrix` is not symmetric: this entry is {0}, but entry {2} of row {3} is {1}",
                plain(a),
                plain(b),
                i + 1,
                j + 1
            );
            let help = format!("write the same covariance of {of} and {and} in both places");
            t.error(self.place(i, j), message, help);
        } else if a.abs() > deviations * (1.0 + ROUNDING) {
            let message = format!("{of} and {and} cannot have the covariance {}", plain(a));
            let help = format!(
                "write at most {}, the product of their standard deviations: are all units mm and degrees?",
                plain(deviations)
            );
            t.error(self.place(i, j), message, help);
        }
    }

    /// Checks that no linear combination of the parameters has a negative variance.
    ///
    /// The check uses the correlations, because they have no unit.
    fn check_definite(&self, names: &[String], t: &mut Table) -> Option<()> {
        let n = names.len();
        let deviation = |k: usize| if self.at(k, k) > 0.0 { self.at(k, k).sqrt() } else { 1.0 };
        let scaled = |i: usize, j: usize| self.at(i, j) / deviation(i) / deviation(j);
        let eigen = DMatrix::from_fn(n, n, |i, j| scaled(i.max(j), i.min(j))).symmetric_eigen();
        let values = eigen.eigenvalues.iter().copied().enumerate();
        let (least, value) = values.min_by(|a, b| a.1.total_cmp(&b.1))?;
        if value >= -ROUNDING * eigen.eigenvalues.max() {
            return Some(());
        }
        let mut weights: Vec<_> =
            eigen.eigenvectors.column(least).iter().map(|v| v.abs()).enumerate().collect();
        weights.sort_by(|a, b| b.1.total_cmp(&a.1));
        let first = weights.iter().take(3).map(|(k, _)| names[*k].as_str());
        let message = format!(
            "`matrix` is not a covariance: its correlation matrix has the eigenvalue {}",
            plain(units::rounded(value, 9))
        );
        let help = format!(
            "no eigenvalue may be negative: write every entry with all its digits, and check {} first",
            listed(first)
        );
        t.error(self.node.at, message, help);
        None
    }
}
