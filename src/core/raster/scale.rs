//! Colour scale of the errors, and the choice of the error component that the arrows show.

use super::Shot;
use crate::cell::{Quantity, Reading, Unit};
use crate::drawing::{Arrow, Component, Drawing, Field};

/// Component of the errors that the arrows of a picture show.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Show {
    /// No component. The picture shows neither arrows nor any other part of the error maps.
    Nothing,
    X,
    Y,
    Z,
    /// Part of the error vector in the xy plane of the world.
    InPlane,
    #[default]
    Resultant,
}

impl Show {
    /// Returns the name of the sense that measures this component; None if no component is shown.
    pub fn sense(self) -> Option<&'static str> {
        match self {
            Self::Nothing => None,
            Self::X => Some("x"),
            Self::Y => Some("y"),
            Self::Z => Some("z"),
            Self::InPlane => Some("xy"),
            Self::Resultant => Some("xyz"),
        }
    }

    /// Returns the errors of an error map as arrows that show this component.
    ///
    /// `field` is an index into [`Drawing::fields`]. `take` is an index into [`Field::takes`], which selects
    /// model and reading.
    pub fn arrows(self, drawing: &Drawing<'_>, field: usize, take: usize) -> Vec<Arrow> {
        let component = match self {
            Self::Nothing => return Vec::new(),
            Self::X => Component::X,
            Self::Y => Component::Y,
            Self::Z => Component::Z,
            Self::InPlane | Self::Resultant => Component::Resultant,
        };
        let mut arrows = drawing.arrows(field, take, component);
        if self == Self::InPlane {
            for arrow in &mut arrows {
                let long = (arrow.tip - arrow.tail).norm();
                arrow.tip.z = arrow.tail.z;
                arrow.head *= (arrow.tip - arrow.tail).norm() / long.max(1e-12);
            }
            arrows.retain(|a| a.head > 0.0);
        }
        arrows
    }
}

/// Colour scale of all error maps in the picture.
pub struct ErrorScale {
    /// Names of the senses whose values the colours show.
    pub senses: Vec<String>,
    /// Least and greatest value of the shown error maps (m, rad, or a share from 0 to 1); None if there are
    /// no usable nodes.
    pub range: Option<(f64, f64)>,
    pub unit: Unit,
}

impl ErrorScale {
    /// Returns the colour scale of the error maps that a picture shows.
    pub fn of(drawing: &Drawing<'_>, shot: &Shot) -> Self {
        let shown = || drawing.fields.iter().filter(|f| shot.operation.is_none_or(|o| o == f.operation));
        let (mut senses, mut unit) = (Vec::new(), Unit::Length);
        for field in shown() {
            let sense = &field.senses[sense(field, shot)];
            unit = sense.unit;
            if !senses.contains(&sense.name) {
                senses.push(sense.name.clone());
            }
        }
        let lens = drawing.lenses[shot.take];
        if lens.reading == Reading::Statistical && lens.quantity == Quantity::Yield {
            unit = Unit::Share;
        }
        let ranges = shown().filter_map(|f| f.range(shot.take, sense(f, shot)));
        let range = ranges.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b)));
        Self { senses, range, unit }
    }

    /// Returns the position of a value on the scale, from 0 for the least value to 1 for the greatest
    /// value.
    pub fn share(&self, value: f64) -> f64 {
        let (low, high) = self.range.unwrap_or((0.0, 1.0));
        if high > low { (value - low) / (high - low) } else { 0.5 }
    }

    /// Returns a value, given in SI units, as text in the unit of reports, with the name of that unit.
    pub fn said(&self, value: f64) -> String {
        format!("{:.3} {}", self.unit.from_si(value), self.unit.word())
    }
}

/// Returns the sense that the colours of an error map show, as an index into [`Field::senses`].
pub fn sense(field: &Field, shot: &Shot) -> usize {
    let named = |name: &str| field.senses.iter().position(|s| s.name == name);
    shot.sense.as_deref().and_then(named).unwrap_or(field.sense)
}

/// Returns the value of a node in the sense, model and reading that the picture shows; None if the node has
/// no usable posture.
pub fn value(field: &Field, shot: &Shot, node: usize) -> Option<f64> {
    *field.takes.get(shot.take)?.values[sense(field, shot)].get(node)?
}

/// Returns the best node in the sense that the picture shows.
///
/// If the picture shows the sense of the operation, the best node is the spot. For any other sense, the best
/// node is the usable node of least value.
pub fn best(field: &Field, shot: &Shot) -> Option<usize> {
    if sense(field, shot) == field.sense {
        return field.takes.get(shot.take)?.best;
    }
    let all = field.usable().filter_map(|k| Some((k, value(field, shot, k)?)));
    all.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}
