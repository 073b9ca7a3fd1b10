//! Lagrangian bound of the cost: lower bound that follows from given prices of the scales. The Lagrangian is
//! minimized over each scale separately.
//!
//! If every permitted `u` satisfies `prices . u <= limit`, the cost is at least `min_u sum_k (c_k(u_k) +
//! prices_k u_k) - limit`. The minimum over each scale has a closed form.

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

/// Returns the scale at which `c(u) + price u` is stationary; infinite if this sum always decreases.
fn stationary(law: &CostLaw, price: f64) -> f64 {
    if price <= 0.0 {
        return f64::INFINITY;
    }
    match law {
        CostLaw::Reciprocal { at, power: 1.0 } => (at / price).sqrt(),
        CostLaw::Reciprocal { at, power } => (power * at / price).powf(1.0 / (power + 1.0)),
        CostLaw::Exponential { at, rate } => 1.0 + (rate * at / price).ln() / rate,
        CostLaw::Grades(_) => f64::INFINITY,
    }
}

/// Scale with the least cost at given prices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Charged {
    pub scale: f64,
    /// Least value of `c(u) + p u + q u^2`.
    pub least: f64,
    /// Second derivative of `c(u) + p u + q u^2` at this scale. It is infinite at a bound or a grade, where a
    /// small change of the prices does not move the scale.
    pub curvature: f64,
}

/// Largest number of Newton steps for one scale; the steps converge from one side.
const MAX_STEPS: usize = 60;

/// Returns the permitted scale at which `c(u) + p u + q u^2` is least. The cost model `cost` states the
/// permitted scales: a range or grades. The price `q` must be at least 0.
pub fn charged(cost: &ToleranceCost, p: f64, q: f64) -> Charged {
    let (low, high) = cost.range;
    let total = |u: f64, c: f64| c + (p + q * u) * u;
    let at_bound = |u: f64| Charged { scale: u, least: total(u, cost.cost(u)), curvature: f64::INFINITY };
    if let CostLaw::Grades(grades) = &cost.law {
        let priced = grades.iter().map(|g| (g.scale, total(g.scale, g.cost)));
        let (scale, least) = priced.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((1.0, f64::INFINITY));
        return Charged { scale, least, curvature: f64::INFINITY };
    }
    let excess = |u: f64| slope(&cost.law, u) + p + 2.0 * q * u;
    if excess(high) <= 0.0 {
        return at_bound(high);
    }
    if excess(low) >= 0.0 {
        return at_bound(low);
    }
    let of_square = |q: f64| match cost.law {
        // The function `cbrt` of the standard library is slower.
        CostLaw::Reciprocal { at, power: 1.0 } => (at / (2.0 * q)).powf(1.0 / 3.0),
        CostLaw::Reciprocal { at, power } => (power * at / (2.0 * q)).powf(1.0 / (power + 2.0)),
        _ => low,
    };
    // Two trial scales follow from the price `2 p` alone and from the price `2 q` alone. The smaller trial
    // scale does not exceed the scale that is sought.
    let mut u = match (q > 0.0, p > 0.0) {
        (false, _) => stationary(&cost.law, p),
        (true, false) => of_square(q).clamp(low, high),
        (true, true) => stationary(&cost.law, 2.0 * p).min(of_square(2.0 * q)).clamp(low, high),
    };
    let is_exact = q <= 0.0 || p == 0.0 && matches!(cost.law, CostLaw::Reciprocal { .. });
    if !is_exact {
        if excess(u) > 0.0 {
            u = low;
        }
        // The slope of the cost is concave, so Newton's method rises to the stationary scale.
        for _ in 0..MAX_STEPS {
            let next = (u - excess(u) / (curvature(&cost.law, u) + 2.0 * q)).clamp(low, high);
            let is_same = (next - u).abs() <= 1e-15 * u;
            u = next;
            if is_same {
                break;
            }
        }
    }
    Charged { scale: u, least: total(u, cost.cost(u)), curvature: curvature(&cost.law, u) + 2.0 * q }
}

/// Returns the slope of a continuous cost.
fn slope(law: &CostLaw, u: f64) -> f64 {
    match law {
        CostLaw::Reciprocal { at, power: 1.0 } => -at / (u * u),
        CostLaw::Reciprocal { at, power } => -power * at * u.powf(-power - 1.0),
        CostLaw::Exponential { at, rate } => -rate * at * (-rate * (u - 1.0)).exp(),
        CostLaw::Grades(_) => 0.0,
    }
}

/// Returns the second derivative of a continuous cost.
fn curvature(law: &CostLaw, u: f64) -> f64 {
    match law {
        CostLaw::Reciprocal { at, power: 1.0 } => 2.0 * at / (u * u * u),
        CostLaw::Reciprocal { at, power } => power * (power + 1.0) * at * u.powf(-power - 2.0),
        CostLaw::Exponential { at, rate } => rate * rate * at * (-rate * (u - 1.0)).exp(),
        CostLaw::Grades(_) => 0.0,
    }
}
