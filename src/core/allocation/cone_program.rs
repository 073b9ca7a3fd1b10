//! Cone program for the cheapest scales that satisfy a list of cuts. The crate `clarabel` solves the program.
//!
//! The variables are the scales `u_k`, an upper bound `e_k` of each continuous cost, and a share of each
//! grade. The costs are expressed as cones:
//!
//! ```text
//! reciprocal         1 / u <= e            |(u - e, 2)| <= u + e
//! reciprocal power   u^-p <= e             u^(p/(p+1)) e^(1/(p+1)) >= 1
//! exponential        exp(-r (u - 1)) <= e  (-r (u - 1), 1, e) in the exponential cone
//! grades             u = sum_g share_g u_g,  cost sum_g share_g c_g,  shares >= 0 with the sum 1
//! ```

use super::cone_cut::ConeCut;
use crate::cell::{CostLaw, ToleranceCost};
use clarabel::algebra::CscMatrix;
use clarabel::solver::{
    DefaultSettings, DefaultSolver, ExponentialConeT, IPSolver, NonnegativeConeT, PowerConeT,
    SecondOrderConeT, SolverStatus, SupportedConeT, ZeroConeT,
};

/// Solver tolerance of a final solution: largest duality gap (relative and absolute) and constraint
/// violation.
pub const FINE: f64 = 1e-9;
/// Solver tolerance of a solution that serves only to find cuts: largest duality gap (relative and absolute)
/// and constraint violation.
pub const COARSE: f64 = 1e-5;

/// Values that the tolerance scale of one parameter may take.
#[derive(Debug, Clone, PartialEq)]
pub enum ScaleDomain {
    Range(f64, f64),
    /// Indices of permitted grades; the relaxation permits every mixture of them.
    Grades(Vec<usize>),
}

/// Solution of a cone program.
pub struct ConeSolution {
    pub scales: Vec<f64>,
    /// Dual vector of every cut.
    pub duals: Vec<Vec<f64>>,
}

/// Cone program under construction: rows of `A x + s = b` with `s` in a product of cones.
#[derive(Default)]
struct Builder {
    rows: Vec<usize>,
    columns: Vec<usize>,
    values: Vec<f64>,
    right: Vec<f64>,
    cones: Vec<SupportedConeT<f64>>,
}

impl Builder {
    /// Adds rows `s = constant + sum of terms`, whose values `s` must lie in a cone. A term is a row, a
    /// variable and a coefficient.
    fn add(&mut self, cone: SupportedConeT<f64>, constant: &[f64], terms: &[(usize, usize, f64)]) {
        let first = self.right.len();
        for &(row, variable, value) in terms.iter().filter(|(.., value)| *value != 0.0) {
            self.rows.push(first + row);
            self.columns.push(variable);
            self.values.push(-value);
        }
        self.right.extend_from_slice(constant);
        self.cones.push(cone);
    }
}

/// Returns the cheapest scales that satisfy the cuts; `tolerance` is the solver tolerance.
///
/// Returns None if the solver fails or the cuts cannot be satisfied.
pub fn solve(
    costs: &[ToleranceCost],
    domains: &[ScaleDomain],
    cuts: &[&ConeCut],
    tolerance: f64,
) -> Option<ConeSolution> {
    let n = costs.len();
    let mut objective = vec![0.0; n];
    let mut program = Builder::default();
    for (k, (cost, domain)) in costs.iter().zip(domains).enumerate() {
        match domain {
            ScaleDomain::Range(low, high) if low >= high => {
                program.add(ZeroConeT(1), &[-low], &[(0, k, 1.0)]);
            }
            ScaleDomain::Range(low, high) => {
                program.add(NonnegativeConeT(2), &[-low, *high], &[(0, k, 1.0), (1, k, -1.0)]);
                add_cost(&mut program, &mut objective, cost, k);
            }
            ScaleDomain::Grades(allowed) => add_grades(&mut program, &mut objective, cost, k, allowed),
        }
    }
    let total: f64 = costs.iter().map(|cost| cost.cost(1.0).abs()).sum();
    let unit = if total > 0.0 { total } else { 1.0 };
    objective.iter_mut().for_each(|c| *c /= unit);
    let first_cut = program.right.len();
    for cut in cuts {
        let mut terms = Vec::new();
        let constant = cut.rows(|row, k, value| terms.push((row, k, value)));
        let cone = match cut {
            ConeCut::Row { .. } => NonnegativeConeT(1),
            _ => SecondOrderConeT(cut.height()),
        };
        program.add(cone, &constant, &terms);
    }
    let variables = objective.len();
    let Builder { rows, columns, values, right, cones } = program;
    let a = CscMatrix::new_from_triplets(right.len(), variables, rows, columns, values);
    let p = CscMatrix::zeros((variables, variables));
    let settings = DefaultSettings {
        verbose: false,
        tol_gap_abs: tolerance,
        tol_gap_rel: tolerance,
        tol_feas: tolerance,
        ..DefaultSettings::default()
    };
    let mut solver = DefaultSolver::new(&p, &objective, &a, &right, &cones, settings).ok()?;
    solver.solve();
    let solution = &solver.solution;
    let is_usable = matches!(
        solution.status,
        SolverStatus::Solved | SolverStatus::AlmostSolved | SolverStatus::InsufficientProgress
    ) && solution.x.iter().chain(&solution.z).all(|v| v.is_finite());
    if !is_usable {
        return None;
    }
    let mut at = first_cut;
    let duals = cuts.iter().map(|cut| {
        let dual: Vec<f64> = solution.z[at..at + cut.height()].iter().map(|z| z * unit).collect();
        at += cut.height();
        dual
    });
    let duals = duals.collect();
    Some(ConeSolution { scales: solution.x[..n].to_vec(), duals })
}

/// Adds the upper bound of a continuous cost as a variable, with the cone that relates this bound to the
/// scale.
fn add_cost(program: &mut Builder, objective: &mut Vec<f64>, cost: &ToleranceCost, k: usize) {
    let e = objective.len();
    match cost.law {
        CostLaw::Reciprocal { at, power: 1.0 } => {
            let terms = [(0, k, 1.0), (0, e, 1.0), (1, k, 1.0), (1, e, -1.0)];
            program.add(SecondOrderConeT(3), &[0.0, 0.0, 2.0], &terms);
            objective.push(at);
        }
        CostLaw::Reciprocal { at, power } => {
            let cone = PowerConeT(power / (power + 1.0));
            program.add(cone, &[0.0, 0.0, 1.0], &[(0, k, 1.0), (1, e, 1.0)]);
            objective.push(at);
        }
        CostLaw::Exponential { at, rate } => {
            program.add(ExponentialConeT(), &[rate, 1.0, 0.0], &[(0, k, -rate), (2, e, 1.0)]);
            objective.push(at);
        }
        CostLaw::Grades(_) => {}
    }
}

/// Adds the shares of the permitted grades as variables.
fn add_grades(
    program: &mut Builder,
    objective: &mut Vec<f64>,
    cost: &ToleranceCost,
    k: usize,
    allowed: &[usize],
) {
    let first = objective.len();
    let grades: Vec<_> = allowed.iter().filter_map(|&g| cost.grades().get(g)).collect();
    objective.extend(grades.iter().map(|g| g.cost));
    let scale = grades.iter().enumerate().map(|(g, grade)| (0, first + g, grade.scale));
    let sum = (0..grades.len()).map(|g| (1, first + g, 1.0));
    let equalities: Vec<_> = scale.chain(sum).chain([(0, k, -1.0)]).collect();
    program.add(ZeroConeT(2), &[0.0, -1.0], &equalities);
    let signs: Vec<_> = (0..grades.len()).map(|g| (g, first + g, 1.0)).collect();
    program.add(NonnegativeConeT(grades.len()), &vec![0.0; grades.len()], &signs);
}
