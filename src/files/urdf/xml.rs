//! Attributes of XML elements as names and numbers, with their places.

use super::fault_list::Faults;
use super::model::Named;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::tree::At;
use crate::pose::Pose;
use nalgebra::Vector3;
use roxmltree::Node;
use std::f64::consts::FRAC_PI_2;

/// Largest number that is accepted in a URDF.
const LARGEST: f64 = 1e7;

const NO_MEASURE: &str = "write plain numbers, with blanks between them; nan and inf are not allowed";

/// Returns the place of the value of an attribute, or of the element if the attribute is missing.
pub fn place(e: Node<'_, '_>, name: &str, faults: &Faults) -> At {
    let found = e.attributes().find(|a| a.name() == name).map(|a| a.range_value().start);
    faults.at(found.unwrap_or(e.range().start))
}

/// Returns the text of a required attribute.
pub fn text(e: Node<'_, '_>, name: &str, faults: &mut Faults) -> Option<Named> {
    let at = place(e, name, faults);
    let Some(value) = e.attribute(name).filter(|v| !v.is_empty()) else {
        let message = format!("<{}> has no `{name}`", shown(e.tag_name().name()));
        faults.error(at, message, format!("add {name}=\"...\""));
        return None;
    };
    Some(Named { name: value.to_string(), at })
}

/// Returns the numbers of an attribute; `default` if the attribute is missing. An attribute without a default
/// is required.
pub fn numbers<const N: usize>(
    e: Node<'_, '_>,
    name: &str,
    default: Option<[f64; N]>,
    faults: &mut Faults,
) -> Option<[f64; N]> {
    let Some(value) = e.attribute(name) else {
        if default.is_none() {
            text(e, name, faults);
        }
        return default;
    };
    let at = place(e, name, faults);
    let mut all = [0.0; N];
    let words: Vec<_> = value.split_ascii_whitespace().take(N + 1).collect();
    if words.len() != N {
        let wanted = if N == 1 { "one number".to_string() } else { format!("{N} numbers") };
        let message = format!("`{name}` must be {wanted}, not \"{}\"", shown(value));
        faults.error(at, message, NO_MEASURE);
        return None;
    }
    for (number, word) in all.iter_mut().zip(words) {
        match word.parse::<f64>() {
            Ok(v) if v.abs() <= LARGEST => *number = v,
            Ok(_) => {
                let message = format!("`{name}` must be finite, from -1e7 to 1e7, not {}", shown(word));
                faults.error(at, message, NO_MEASURE);
                return None;
            }
            Err(_) => {
                faults.error(at, format!("`{}` in `{name}` is not a number", shown(word)), NO_MEASURE);
                return None;
            }
        }
    }
    Some(all)
}

/// Returns the first child element with the tag `name`; records a fault if there are several.
pub fn only<'a, 'i>(e: Node<'a, 'i>, name: &str, faults: &mut Faults) -> Option<Node<'a, 'i>> {
    let mut all = e.children().filter(|c| c.has_tag_name(name));
    let first = all.next();
    if let Some(second) = all.next() {
        let message = format!("a second <{name}> in <{}>", shown(e.tag_name().name()));
        faults.error(faults.at(second.range().start), message, "remove one of the two");
    }
    first
}

/// Refuses unknown attributes, because a misspelt attribute would count as missing and be read as 0.
pub fn refuse_unknown(e: Node<'_, '_>, known: &[&'static str], faults: &mut Faults) {
    for a in e.attributes().filter(|a| a.namespace().is_none() && !known.contains(&a.name())) {
        let help = match did_you_mean(a.name(), known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`?"),
            None => format!("allowed here: {}", listed(known.iter().copied())),
        };
        let message = format!("unknown attribute `{}` of <{}>", shown(a.name()), shown(e.tag_name().name()));
        faults.error(faults.at(a.range().start), message, help);
    }
}

/// Returns the pose in the `<origin>` of an element (m, rad); the identity if there is none.
pub fn origin(e: Node<'_, '_>, faults: &mut Faults) -> Option<Pose> {
    let Some(origin) = only(e, "origin", faults) else { return Some(Pose::identity()) };
    refuse_unknown(origin, &["xyz", "rpy"], faults);
    let xyz = numbers(origin, "xyz", Some([0.0; 3]), faults);
    let mut rpy = numbers(origin, "rpy", Some([0.0; 3]), faults)?;
    let words = origin.attribute("rpy").unwrap_or("").split_ascii_whitespace();
    for (angle, word) in rpy.iter_mut().zip(words) {
        faults.snap(angle, right_angle(word, *angle));
    }
    Some(Pose::from_translation_rpy(Vector3::from(xyz?), Vector3::from(rpy)))
}

/// Returns the multiple of a right angle, rad, that a number of a file plainly means. Returns any other
/// number unchanged.
///
/// The number must be this multiple, rounded or truncated to the number of digits in the file. The number
/// needs at least two digits after the point.
pub fn right_angle(word: &str, value: f64) -> f64 {
    let (mantissa, exponent) = word.split_once(['e', 'E']).unwrap_or((word, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, digits)| digits.len());
    let digits = exponent.parse::<i32>().ok().map(|exponent| digits as i32 - exponent);
    let turns = (value / FRAC_PI_2).round();
    let meant = turns * FRAC_PI_2;
    let Some(digits) =
        digits.filter(|digits| (2..=17).contains(digits) && turns != 0.0 && turns.abs() <= 4.0)
    else {
        return value;
    };
    let unit = 10f64.powi(-digits);
    let off = (value - meant).abs();
    let is_rounded = off <= 0.5 * unit + f64::EPSILON * meant.abs();
    let is_cut_off = off < unit && value.abs() < meant.abs();
    if is_rounded || is_cut_off { meant } else { value }
}
