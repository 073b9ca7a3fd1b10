//! Coordinate of a cell: a fixed number, or a variable of the search.

/// Coordinate (m or rad) of a cell: a fixed number, or a variable of the search.
#[derive(Debug, Clone, PartialEq)]
pub enum Coordinate {
    Fixed(f64),
    /// Search variable that takes any value from `min` to `max`, m or rad.
    Range {
        min: f64,
        max: f64,
        start: f64,
    },
    /// Search variable that takes one of these values; the first value is the start value.
    List(Vec<f64>),
}

impl Coordinate {
    /// Returns the start value, m or rad.
    pub fn start(&self) -> f64 {
        match self {
            Coordinate::Fixed(value) | Coordinate::Range { start: value, .. } => *value,
            Coordinate::List(values) => values.first().copied().unwrap_or(0.0),
        }
    }

    /// Returns whether the search may change the coordinate.
    pub fn is_free(&self) -> bool {
        !matches!(self, Coordinate::Fixed(_))
    }

    /// Returns the least and the greatest value that the coordinate can take.
    pub fn range(&self) -> (f64, f64) {
        match self {
            Coordinate::Fixed(value) => (*value, *value),
            Coordinate::Range { min, max, .. } => (*min, *max),
            Coordinate::List(values) => {
                values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(*v), hi.max(*v)))
            }
        }
    }
}
