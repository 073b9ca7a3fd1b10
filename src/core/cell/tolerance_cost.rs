//! Cost of a tolerance: the cost of holding one parameter within plus or minus a half width.
//!
//! The tolerance is given as the scale `u = t / t0`, where `t0` is the tolerance of the error set.

/// Least and greatest scale of a tolerance whose cost model states no range of scales.
pub const DEFAULT_SCALES: (f64, f64) = (0.1, 3.0);

/// Relative rounding margin for the comparison of two scales. A grade counts as looser than the scale `u`
/// only if its scale exceeds `u (1 + SAME_SCALE)`.
const SAME_SCALE: f64 = 1e-9;

/// Tolerance that one process or one standard grade holds, with its cost.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceGrade {
    pub name: String,
    /// Tolerance of the grade divided by the tolerance of the error set.
    pub scale: f64,
    pub cost: f64,
}

/// Law by which the cost of a parameter decreases with the scale `u` of its tolerance.
#[derive(Debug, Clone, PartialEq)]
pub enum CostLaw {
    /// Reciprocal power: the cost is `at / u^power`, where `at` is the cost at scale 1.
    Reciprocal { at: f64, power: f64 },
    /// Exponential: the cost is `at * exp(-rate * (u - 1))`, where `at` is the cost at scale 1.
    Exponential { at: f64, rate: f64 },
    /// Discrete grades in ascending order of their scales. A looser grade costs less.
    Grades(Vec<ToleranceGrade>),
}

/// Cost model of one parameter, with the range of its scale.
#[derive(Debug, Clone, PartialEq)]
pub struct ToleranceCost {
    pub law: CostLaw,
    /// Least and greatest scale of the tolerance. For grades, these are the scales of the tightest and the
    /// loosest grade.
    pub range: (f64, f64),
}

impl Default for ToleranceCost {
    fn default() -> Self {
        Self::continuous(CostLaw::Reciprocal { at: 1.0, power: 1.0 })
    }
}

impl ToleranceCost {
    /// Returns a cost model with the default range.
    pub fn continuous(law: CostLaw) -> Self {
        Self { law, range: DEFAULT_SCALES }
    }

    /// Returns the cost model of discrete grades; None if there is no grade.
    ///
    /// Grades that cost at least as much as a tighter grade are left out, because nobody would choose them.
    pub fn of_grades(mut grades: Vec<ToleranceGrade>) -> Option<Self> {
        grades.sort_by(|a, b| a.scale.total_cmp(&b.scale).then(a.cost.total_cmp(&b.cost)));
        let mut kept: Vec<ToleranceGrade> = Vec::new();
        for grade in grades {
            if kept.last().is_none_or(|tighter| grade.cost < tighter.cost) {
                kept.push(grade);
            }
        }
        let range = (kept.first()?.scale, kept.last()?.scale);
        Some(Self { law: CostLaw::Grades(kept), range })
    }

    /// Returns the cost at the scale `u`. For grades, this is the cost of the loosest grade whose scale is at
    /// most `u`. If the scales of all grades exceed `u`, the result is the cost of the tightest grade.
    pub fn cost(&self, u: f64) -> f64 {
        match &self.law {
            CostLaw::Reciprocal { at, power: 1.0 } => at / u,
            CostLaw::Reciprocal { at, power } => at * u.powf(-power),
            CostLaw::Exponential { at, rate } => at * (-rate * (u - 1.0)).exp(),
            CostLaw::Grades(grades) => grades.get(self.grade(u).unwrap_or(0)).map_or(0.0, |g| g.cost),
        }
    }

    /// Returns the index of the loosest grade whose scale is at most `u`; None if there is no such grade.
    pub fn grade(&self, u: f64) -> Option<usize> {
        self.grades().iter().rposition(|g| g.scale <= u * (1.0 + SAME_SCALE))
    }

    /// Returns the grades; empty for a continuous law.
    pub fn grades(&self) -> &[ToleranceGrade] {
        match &self.law {
            CostLaw::Grades(grades) => grades,
            _ => &[],
        }
    }

    /// Returns the scale that can be obtained if the scale `u` is wanted. For a continuous law, the result is
    /// `u`, clamped to the range. For grades, the result is the scale of the loosest grade whose scale is at
    /// most `u`. If the scales of all grades exceed `u`, the result is the scale of the tightest grade.
    pub fn ordered(&self, u: f64) -> f64 {
        match &self.law {
            CostLaw::Grades(grades) => grades.get(self.grade(u).unwrap_or(0)).map_or(u, |g| g.scale),
            _ => u.clamp(self.range.0, self.range.1),
        }
    }
}
