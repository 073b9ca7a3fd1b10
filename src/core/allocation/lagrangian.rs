//! Lagrangian bound of the cost: the minimum over each scale alone, at given prices of the scales.
//!
//! If every permitted `u` satisfies `prices . u <= limit`, the cost is at least
//! `min_u sum_k (c_k(u_k) + prices_k u_k) - limit`. Each term has a closed form.

use super::cone_program::ScaleDomain;
use crate::cell::{CostLaw, ToleranceCost};

/// Returns the scale of a domain with the least `c(u) + price u`, and this least value.
pub fn least_priced(cost: &ToleranceCost, domain: &ScaleDomain, price: f64) -> (f64, f64) {
    match domain {
        ScaleDomain::Range(low, high) => {
            let u = stationary(&cost.law, price).clamp(*low, *high);
            (u, cost.cost(u) + price * u)
        }
        ScaleDomain::Grades(allowed) => {
            let grades = allowed.iter().filter_map(|&g| cost.grades().get(g));
            let priced = grades.map(|g| (g.scale, g.cost + price * g.scale));
            priced.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((1.0, f64::INFINITY))
        }
    }
}

/// Returns the scale at which `c(u) + price u` has no slope; infinite if it always decreases.
fn stationary(law: &CostLaw, price: f64) -> f64 {
    if price <= 0.0 {
        return f64::INFINITY;
    }
    match law {
        CostLaw::Reciprocal { at, power } => (power * at / price).powf(1.0 / (power + 1.0)),
        CostLaw::Exponential { at, rate } => 1.0 + (rate * at / price).ln() / rate,
        CostLaw::Grades(_) => f64::INFINITY,
    }
}
