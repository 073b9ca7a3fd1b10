//! Numbers of a cell that the search may change.

/// One number of a cell file that the search may change.
#[derive(Debug, Clone, PartialEq)]
pub enum Coordinate {
    Fixed(f64),
    /// A search variable.
    Range {
        min: f64,
        max: f64,
        start: f64,
    },
    /// A search variable that takes one of these values, the first at the start.
    List(Vec<f64>),
}

impl Coordinate {
    pub fn start(&self) -> f64 {
        match self {
            Coordinate::Fixed(value) | Coordinate::Range { start: value, .. } => *value,
            Coordinate::List(values) => values.first().copied().unwrap_or(0.0),
        }
    }

    pub fn is_free(&self) -> bool {
        !matches!(self, Coordinate::Fixed(_))
    }

    /// Least and greatest value.
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
