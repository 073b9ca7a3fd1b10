//! Keys of the costs of tolerances, in error sets of robots and in the errors of equipment.

use super::key::*;
use super::parts::*;
use crate::cell::{FIRST_IT_GRADE, LAST_IT_GRADE};

/// Largest exponent of a reciprocal cost.
pub const MAX_POWER: f64 = 10.0;
/// Largest rate of an exponential cost.
pub const MAX_RATE: f64 = 20.0;
/// Least and greatest scale that a file may state. A scale is a tolerance divided by the tolerance in the
/// error set.
pub const SCALES: (f64, f64) = (0.01, 100.0);

/// Law by which a cost depends on a tolerance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CostForm {
    Reciprocal,
    Exponential,
    /// Processes, each with a tolerance and a cost.
    Grades,
    /// Tolerance grades of ISO 286.
    Iso286,
}

impl CostForm {
    pub const ALL: [Self; 4] = [Self::Reciprocal, Self::Exponential, Self::Grades, Self::Iso286];

    pub fn name(self) -> &'static str {
        match self {
            Self::Reciprocal => "reciprocal",
            Self::Exponential => "exponential",
            Self::Grades => "grades",
            Self::Iso286 => "iso-286",
        }
    }
}

words!(CostForm);

key_table! {
    tolerance_grade, "a grade", "Grade: the tolerance that one process achieves, and the cost of this tolerance.", {
        NAME = Key::new("name", ValueKind::Name, "Name of the process or grade.").required().example("\"ground\"").remedy("add name = \"ground\"");
        MILLIMETRES = number("plus_minus_mm", NumberRange::Positive, "Tolerance of a length: half the width of its range.").example("0.02");
        DEGREES = number("plus_minus_deg", NumberRange::Positive, "Tolerance of an angle: half the width of its range.").example("0.01");
        SCALE = number("scale", NumberRange::Positive, "Tolerance divided by the tolerance in the error set.").example("0.5");
        COST = number("cost", NumberRange::NotNegative, "Cost of the grade; a looser grade must cost less.").required().example("4").remedy("add cost = 4");
    }
    rules [Rule::OneAtMost(&["plus_minus_mm", "plus_minus_deg", "scale"])];
}

key_table! {
    tolerance_cost, "a cost", "Cost of tolerances. `allocate` uses these costs to find the cheapest set of tolerances. The scale is the tolerance divided by the tolerance in the error set.", {
        PARAMETERS = Key::new("parameters", ValueKind::List(&ValueKind::Text, (1, UNBOUNDED), "names"), "Parameters that have this cost; a separate tolerance is chosen for each. If left out, the cost applies to all parameters that no other cost lists.").example("[\"dl2\", \"dalpha3\"]");
        FORM = word::<CostForm>("kind", "reciprocal: cost = `at` / scale^`power`; exponential: cost = `at` exp(-`rate` (scale - 1)); grades: processes with tolerances and costs; iso-286: grades of ISO 286, each with the cost `at` / scale^`power`.").required();
        AT = number("at", NumberRange::Positive, "Cost of the tolerance in the error set, in any currency.").default(Literal::Number(1.0));
        POWER = number("power", NumberRange::Positive, "Exponent of a reciprocal cost, at most 10.").default(Literal::Number(1.0));
        RATE = number("rate", NumberRange::Positive, "Rate of an exponential cost, at most 20.").default(Literal::Number(1.0));
        RANGE = Key::new("scale_range", ValueKind::List(&POSITIVE, (2, 2), "numbers"), "Least and greatest scale that can be chosen, from 0.01 to 100; if left out, [0.1, 3].").example("[0.1, 3]");
        GRADES = Key::new("grades", ValueKind::List(&ValueKind::Table(&tolerance_grade::TABLE), (1, 32), "grades"), "Grades to choose from.").example("[{ name = \"milled\", scale = 1, cost = 1 }, { name = \"ground\", scale = 0.5, cost = 4 }]");
        NOMINAL = number("nominal_mm", NumberRange::Positive, "Nominal size of the length that has the tolerance, at most 3150. The tolerance of a grade of ISO 286 depends on this size.").example("400");
        IT_GRADES = Key::new("it_grades", ValueKind::List(&ValueKind::Whole(FIRST_IT_GRADE as u64, LAST_IT_GRADE as u64), (1, LAST_IT_GRADE - FIRST_IT_GRADE + 1), "grades"), "Grades of ISO 286 to choose from, IT4 to IT14; the tolerance is half of the interval that the grade allows. If left out, IT5 to IT12.").example("[6, 7, 8, 9]");
    }
    rules [
        Rule::When { key: "kind", words: reciprocal, needs: &[], never: &["rate", "grades", "nominal_mm", "it_grades"] },
        Rule::When { key: "kind", words: exponential, needs: &[], never: &["power", "grades", "nominal_mm", "it_grades"] },
        Rule::When { key: "kind", words: grades, needs: &["grades"], never: &["at", "power", "rate", "scale_range", "nominal_mm", "it_grades"] },
        Rule::When { key: "kind", words: iso_286, needs: &["nominal_mm"], never: &["rate", "scale_range", "grades"] },
    ];
}

/// Key of the costs of the tolerances in an error set.
pub const COST: Key = Key::new(
    "cost",
    ValueKind::List(&ValueKind::Table(&tolerance_cost::TABLE), (0, UNBOUNDED), "costs"),
    "Costs of the tolerances; a tolerance without a stated cost costs 1 / scale, with a scale from 0.1 to 3.",
)
.example("[{ parameters = [\"dl2\"], kind = \"reciprocal\", at = 2 }]");

fn reciprocal() -> Vec<String> {
    vec![CostForm::Reciprocal.name().to_string()]
}

fn exponential() -> Vec<String> {
    vec![CostForm::Exponential.name().to_string()]
}

fn grades() -> Vec<String> {
    vec![CostForm::Grades.name().to_string()]
}

fn iso_286() -> Vec<String> {
    vec![CostForm::Iso286.name().to_string()]
}
