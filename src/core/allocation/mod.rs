//! Tolerance allocation: the cheapest tolerances with which every requirement is met.
//!
//! The tolerances are `t_k = u_k t0_k`, where `t0_k` are the tolerances of the error set and `u_k` the scales
//! to be found:
//!
//! ```text
//! minimize    sum_k c_k(u_k)
//! such that   F_i(u) <= X_i   for every requirement i,   low_k <= u_k <= high_k
//!
//! worst case  F_i(u) = max over all signs s of |sum_j s_j f_ij + sum_k s_k g_ik u_k|  (zonotope, `farthest`)
//! statistics  F_i(u) = sqrt(f_i^2 + sum_k w_ik u_k^2)                                 (root sum square)
//! ```
//!
//! The figure `F_i(u)` of requirement i is the error of one operation at one node, and `X_i` is its limit.
//! The vector `g_ik` (generator) is the error that parameter k causes at its tolerance `t0_k`. The number
//! `w_ik` is the contribution of this tolerance to the square of the figure. No tolerance changes the errors
//! `f_ij` and the number `f_i`.
//!
//! Every cost `c_k` is a decreasing, convex function of its scale, so this is a convex program. A root sum
//! square is one second-order cone. A worst case is one second-order cone for each sign pattern. If the error
//! has one axis, a worst case is a single linear inequality. If the error has two axes, the patterns depend
//! only on the directions of the generators. Then n generators have at most n patterns, apart from a common
//! sign. The cutting-plane method begins without the constraints of the patterns, and adds some of them as
//! cuts (`ConeCut`). If the worst case of a solution exceeds the limit, the sign pattern of this worst case
//! gives the next cut. A requirement that no solution violates adds no cut. So requirements at many nodes
//! take little computing time.
//!
//! For continuous costs, Newton's method solves the dual problem, which has only a few variables
//! ([`priced_scales`]). The crate `clarabel` solves two cases as cone programs. In the first case, the grades
//! are discrete. In the second case, Newton's method does not close the duality gap. In a cone program, each
//! continuous cost becomes a second-order, power or exponential cone. Newton's method and the cone programs
//! give dual vectors, which give a lower bound of the cost in closed form
//! ([`ToleranceAllocation::lower_bound`]). This bound holds whatever the accuracy of the solver, so the
//! duality gap is proven. Discrete grades are chosen by branch and bound (`grade_choice`). The bounds come
//! from a relaxed problem, which permits mixtures of grades.
//!
//! If the error is not linear, or the figure is a percentile, the formulas of `F_i` are only an
//! approximation. [`allocate_judged`] then judges each solution by the full error model of the cell. The
//! function adapts these formulas until the judged figures are within the limits.

mod cone_cut;
mod cone_program;
mod cutting_planes;
mod dual_ascent;
mod dual_terms;
mod grade_choice;
mod judged;
mod lagrangian;
mod limit_row;
mod linear_figure;
mod nearby_price;
mod node_figure;
mod pricing;
mod problem;
mod shortfall;
mod solution;
mod uniform;

pub use dual_ascent::{PricedScales, priced_scales};
pub use judged::{JUDGED_EXCESS, JudgedAllocation, ToleranceJudge, allocate_judged};
pub use limit_row::LimitRow;
pub use linear_figure::{FigureScratch, LinearFigure};
pub use nearby_price::NearbyPrice;
pub use node_figure::NodeFigure;
pub use pricing::{DEFAULT_YIELD, OperationPricing, TolerancePricing};
pub use problem::{ToleranceProblem, ToleranceRequirement};
pub use shortfall::{BoundInTheWay, ToleranceShortfall};
pub use solution::{AllocationFailure, ToleranceAllocation, allocate};
pub use uniform::uniform_scale;
