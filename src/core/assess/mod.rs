//! Assessment of layouts, alone and side by side.
//!
//! An [`Assessment`] is the full evaluation of one layout. A [`Comparison`] holds several assessments with
//! the same operations, readings and objective. [`BudgetReport`] (the error budget), [`Explanation`] and
//! [`ErrorDistribution`] concern one posture. [`Readings`] compares the results of one layout under every
//! reading.

mod allocated_nodes;
mod allocation;
mod budget;
mod cheapest_tolerances;
mod comparison;
mod corrections;
mod distribution;
mod ending_tolerance;
mod envelope_study;
mod explain;
mod feasibility;
mod operation_difference;
mod parameter_motion;
mod posture_check;
mod posture_context;
mod readings;
mod remedies;
mod sampled_allocation;
mod sampled_spots;

pub use allocated_nodes::AllocatedNodes;
pub use allocation::{AllocatedParameter, CellAllocation, NoAllocation, NodeRequirement};
pub use budget::{BudgetReport, Tighter};
pub use cheapest_tolerances::CheapestTolerances;
pub use comparison::Comparison;
pub use corrections::{CorrectedTarget, OperationCorrector, StatedTarget};
pub use distribution::ErrorDistribution;
pub use envelope_study::{EnvelopeQuery, Reachable, RobotDataSheet, SheetEnvelope, step_of, tolerance_of};
pub use explain::{DhRow, Explanation, ParameterEffect, SenseRow};
pub use feasibility::Feasibility;
pub use operation_difference::{NodePair, OperationDifference};
pub use parameter_motion::{MotionFrame, ParameterMotion};
pub use posture_check::PostureCheck;
pub use posture_context::{NoPosture, NodeChoice, PostureContext};
pub use readings::{ReadingChoice, ReadingRow, Readings};
pub use remedies::{Remedies, Remedy};
pub use sampled_allocation::SampledRequirement;
pub use sampled_spots::SAMPLES;
use sampled_spots::{SampledSpots, take_over};

use ending_tolerance::ending_tolerances;

use crate::cell::{Cell, Goals, Layout, Unit};

use crate::cycle_time::CycleTime;
use crate::error_map::{NodeRecord, OperationMap, PostureRecord};
use crate::layout::{Evaluation, LayoutCertificate, Refined, Robustness, Workcell, evaluate, separated};
use crate::proof::Proof;
use crate::reach::{Envelope, Fineness};
use crate::reading::{Estimate, Figures, MonteCarlo};
use crate::region::Regions;

/// Full evaluation of one layout, with its error maps and error figures.
pub struct Assessment<'a> {
    pub label: String,
    pub cell: &'a Cell,
    pub workcell: &'a Workcell,
    pub layout: Layout,
    pub evaluation: Evaluation,
    pub maps: Vec<OperationMap>,
    /// Spots refined between the nodes of the grid, one per operation.
    ///
    /// An entry is None if the operation has no spot, has listed points instead of a grid, or happens at
    /// every node. All entries are None if the layout does not fit the cell.
    pub refined: Vec<Option<Refined>>,
    /// Effect of the placement tolerances on every operation; empty unless [`Self::misplaced`] was called.
    pub robustness: Vec<Option<Robustness>>,
    /// Monte Carlo estimates at the spot of each operation; None without a spot, or if the reading is not
    /// statistical.
    pub samples: Vec<Option<MonteCarlo>>,
    /// Yield of the whole cell: share of Monte Carlo samples that stay within the limits of all operations at
    /// their spots.
    ///
    /// None unless the reading is statistical, every operation has a spot and at least one operation has a
    /// limit.
    pub cell_yield: Option<Estimate>,
    /// Whether the samples confirm the first-order figures of each operation; None without samples.
    ///
    /// If the samples do not confirm these figures, figures from the samples replace them in [`Self::maps`]
    /// at the spot.
    pub confirmed: Vec<Option<bool>>,
    /// Certificate that the layout works at every misplacement; None if no certificate is demanded, or if the
    /// layout is not feasible.
    pub certificate: Option<LayoutCertificate>,
    /// Regions in which each piece of equipment may stand.
    ///
    /// None if [`Self::with_regions`] was not called, or if the layout is not feasible or misses a limit.
    pub regions: Option<Regions>,
    /// Layout near [`Self::layout`] in which nothing overlaps. None if nothing overlaps in [`Self::layout`]
    /// itself, or if no such layout was found.
    pub apart: Option<Layout>,
}

impl<'a> Assessment<'a> {
    /// Evaluates one layout, maps its operations and refines their spots.
    ///
    /// If the layout does not fit the cell, [`Evaluation::misfit`] states the reason. [`Self::layout`] is
    /// then the layout of the cell file.
    pub fn new(label: &str, workcell: &'a Workcell, layout: Layout) -> Self {
        let mut evaluation = evaluate(workcell, &layout);
        let mut maps = workcell.maps(&layout);
        let apart = if evaluation.overlaps.is_empty() { None } else { separated(workcell, &layout) };
        let refined = workcell.refined(&layout, &maps);
        let SampledSpots { samples, cell_yield } = SampledSpots::new(workcell, &layout, &maps);
        let confirmed = take_over(workcell, &samples, &mut maps, &mut evaluation);
        let layout = if evaluation.misfit.is_some() { workcell.cell.start() } else { layout };
        let (cell, robustness) = (&workcell.cell, Vec::new());
        let is_certified = workcell.certifies() && evaluation.objective.is_some();
        let certificate = is_certified.then(|| workcell.certificate(&layout, &maps));
        Self {
            label: label.to_string(),
            cell,
            workcell,
            layout,
            evaluation,
            maps,
            refined,
            robustness,
            samples,
            cell_yield,
            confirmed,
            certificate,
            regions: None,
            apart,
        }
    }

    /// Computes [`Self::regions`]: where every piece of equipment may stand.
    pub fn with_regions(mut self) -> Self {
        if self.evaluation.misfit.is_none() {
            self.regions = Regions::new(self.workcell, &self.layout);
        }
        self
    }

    /// Computes [`Self::robustness`]: the effect of the placement tolerances on every operation.
    pub fn misplaced(mut self) -> Self {
        self.robustness = self.workcell.robustness(&self.layout, &self.maps);
        self
    }

    /// Returns whether the layout is feasible and within its limits for all placements inside the tolerances.
    ///
    /// Call [`Self::misplaced`] first.
    pub fn is_robust(&self) -> bool {
        let holds = |r: &Option<Robustness>| r.as_ref().is_some_and(Robustness::holds);
        let is_certified = self.certificate.as_ref().is_none_or(LayoutCertificate::holds);
        self.evaluation.objective.is_some() && is_certified && self.robustness.iter().all(holds)
    }

    /// Returns coarse outlines of the area that the arm reaches at the height of an operation's TCP.
    ///
    /// Points are (x, y) in the world frame, m. The tool has the attitude of the operation. The list is
    /// empty if the layout does not fit the cell ([`Evaluation::misfit`]).
    pub fn reachable(&self, operation: usize) -> Vec<Vec<(f64, f64)>> {
        if self.evaluation.misfit.is_some() {
            return Vec::new();
        }
        let inverse = self.workcell.inverse();
        let attitude = &self.layout.attitudes[operation];
        let operation = &self.cell.operations[operation];
        let (at, base) = (&self.layout.placements[operation.equipment], &self.layout.base);
        let envelope = Envelope::new(inverse, attitude, at.yaw - base.yaw);
        let step = 2.0 * step_of(&self.cell.robot, inverse);
        let fine = Fineness { step, tolerance: tolerance_of(inverse, step), on_progress: &|_| () };
        let plan = envelope.plan(at.z + operation.standoff - base.z, &fine);
        let (sin, cos) = base.yaw.sin_cos();
        let world = |[x, y]: [f64; 2]| (base.x + cos * x - sin * y, base.y + sin * x + cos * y);
        plan.outlines.iter().map(|o| o.points.iter().map(|p| world(*p)).collect()).collect()
    }

    /// Returns the spot of an operation (its best usable node) and the posture there.
    pub fn spot(&self, operation: usize) -> Option<(&NodeRecord, &PostureRecord)> {
        let node = self.maps[operation].best_node()?;
        Some((node, node.posture.as_ref()?))
    }

    /// Returns the error figures at the spot of an operation, m or rad. The figures belong to the sense
    /// (error component) with the name `sense`.
    ///
    /// Returns None without a spot, or if the map does not report the sense.
    pub fn figures(&self, operation: usize, sense: &str) -> Option<&Figures> {
        let place = self.maps[operation].sense(sense)?;
        self.spot(operation).map(|(_, posture)| &posture.figures[place])
    }

    /// Returns the value that the reading gives at the spot of an operation, mm or degrees. The value belongs
    /// to the sense (error component) with the name `sense`. If the quantity is the yield, returns the 95th
    /// percentile instead.
    ///
    /// Returns None without a spot, or if the map does not report the sense.
    pub fn error_at(&self, operation: usize, sense: &str) -> Option<f64> {
        let unit = self.maps[operation].senses[self.maps[operation].sense(sense)?].unit;
        let figures = self.figures(operation, sense)?;
        Some(unit.from_si(figures.in_reading(self.cell.reading, self.cell.quantity)))
    }

    /// Returns whether the Monte Carlo samples confirm the first-order figures at the spot of an operation.
    ///
    /// If the samples do not confirm these figures, the figures of the samples replace them. Returns None if
    /// the operation has no samples.
    pub fn first_order_holds(&self, operation: usize) -> Option<bool> {
        self.confirmed[operation]
    }

    /// Returns `proof` without the bounds that do not hold for this layout. Also returns the gap `objective /
    /// bound - 1`. The gap compares the objective of this layout with the bound of the returned proof. The
    /// gap is None if the layout is infeasible, or if the returned proof has no bound above 0.
    ///
    /// The bound of an operation does not hold if its Monte Carlo samples do not confirm its first-order
    /// figures ([`Self::first_order_holds`]).
    pub fn proven(&self, proof: &Proof) -> (Proof, Option<f64>) {
        let proof = proof.without(self.workcell, |k| self.confirmed[k] == Some(false));
        let bound = proof.bound.filter(|bound| *bound > 0.0);
        let gap = self.evaluation.objective.zip(bound).map(|(objective, bound)| objective / bound - 1.0);
        (proof, gap)
    }

    /// Returns the values of all goals in the order of [`crate::cell::Goal::ALL`]: m, rad, m^2, s, a share or
    /// a cost.
    ///
    /// Returns None if the layout is infeasible.
    pub fn goals(&self) -> Option<Vec<f64>> {
        self.workcell.goals(&self.layout, &self.evaluation, &Goals::all())
    }

    /// Computes the cycle time with its steps.
    ///
    /// Returns None if the layout is infeasible, or if the maximum speed of a joint is not given.
    pub fn cycle_time(&self) -> Option<CycleTime> {
        self.workcell.cycle_time(&self.layout, &self.evaluation)
    }

    /// Returns the objective in mm, in degrees, as a share or as a cost; None if the layout is infeasible.
    pub fn objective(&self) -> Option<f64> {
        self.evaluation.objective.map(|o| self.cell.unit().from_si(o))
    }

    /// Returns the objective in mm; None if the objective is not a length or the layout is infeasible.
    pub fn objective_mm(&self) -> Option<f64> {
        self.objective().filter(|_| self.cell.unit() == Unit::Length)
    }

    /// Returns the limit of an operation and the margin that is left.
    ///
    /// Returns None if the operation has no spot or no limit. Also returns None if the objective is a share
    /// of failures, which already counts the arms that exceed the limit.
    ///
    /// If the objective is the cost of tolerances, the limit in the result is the cost of the tightest
    /// tolerances. This rule also applies if the quantity is the yield. If the error exceeds its limit even
    /// at the tightest tolerances, the margin is negative. The cost of the operation is then the cost of the
    /// tightest tolerances times the ratio of error to limit.
    ///
    /// If the cost of tolerances is only one of several goals, the result is None. The limits then apply to
    /// the errors at the chosen tolerances, not at the tolerances of the error set.
    pub fn requirement(&self, operation: usize) -> Option<Requirement> {
        if self.cell.unit() == Unit::Cost {
            let (limit, value) = (self.workcell.tightest_cost(), self.maps[operation].value?);
            return Some(Requirement { limit, margin: limit - value, drawn: limit - value, known: true });
        }
        let is_compared = self.cell.unit().is_error() && !self.cell.search.prices_tolerances();
        let limit = self.cell.operations[operation].limit.filter(|_| is_compared)?;
        let drawn = self.maps[operation].value?;
        let (value, known) = match &self.certificate {
            None => (drawn, true),
            Some(_) => self.worst(operation).map_or((drawn, false), |worst| (worst, true)),
        };
        Some(Requirement { limit, margin: limit - value, drawn: limit - drawn, known })
    }

    /// Returns an upper bound of the value of an operation over all misplacements, m or rad.
    ///
    /// Returns None if the layout is not certified or no bound is known.
    pub fn worst(&self, operation: usize) -> Option<f64> {
        let certified = self.certificate.as_ref()?.operations.get(operation)?.as_ref()?;
        let most = certified.as_ref().ok()?.most?;
        // A bound cannot be below the nominal value, except by rounding.
        Some(self.maps[operation].value.map_or(most, |value| most.max(value)))
    }

    /// Returns whether every requirement is met ([`Requirement::is_met`]). An operation for which
    /// [`Self::requirement`] returns None does not count.
    pub fn meets_requirements(&self) -> bool {
        (0..self.maps.len()).filter_map(|k| self.requirement(k)).all(Requirement::is_met)
    }

    /// Returns, in words, which placement tolerances make the layout infeasible. The list is empty if the
    /// layout is feasible. The list is also empty if smaller placement tolerances do not make the layout
    /// feasible.
    pub fn ending_tolerances(&self) -> Vec<String> {
        if self.evaluation.objective.is_some() || self.evaluation.misfit.is_some() {
            return Vec::new();
        }
        ending_tolerances(self.workcell, &self.layout)
    }

    /// Returns why the layout is infeasible, in words; empty if the layout is feasible.
    pub fn reasons(&self) -> Vec<String> {
        let spotless = self.maps.iter().filter(|map| map.best.is_none());
        feasibility::reasons(self.cell, &self.layout, &self.evaluation, self.apart.as_ref(), spotless)
    }
}

/// Limit of an operation, with the margin that is left, m or rad.
///
/// If the objective is the cost of tolerances, limit and margin are costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    pub limit: f64,
    /// Limit minus the error of the operation under the reading. If the objective is the cost of tolerances,
    /// the cost of the operation's tolerances replaces the error. The margin is negative if the limit is
    /// exceeded.
    ///
    /// If the layout must withstand misplacements, an upper bound over all misplacements replaces the error.
    /// If no such bound is known, the error itself is used.
    pub margin: f64,
    /// Margin without misplacements: limit minus the error of the layout as drawn.
    pub drawn: f64,
    /// Whether a margin of at least 0 proves that the limit is met. The value is false only if the
    /// certificate of the layout gives no upper bound of the error. The margin then uses the error itself.
    ///
    /// The value is true for costs. The value is also true without a certificate
    /// ([`Assessment::certificate`]), and for a posture that is not at the spot.
    pub known: bool,
}

impl Requirement {
    /// Returns whether the margin is not negative and [`Self::known`] is true.
    pub fn is_met(self) -> bool {
        self.known && self.margin >= 0.0
    }

    /// Returns whether the layout as drawn is within the limit, but the limit is not proven for all
    /// misplacements.
    pub fn is_unproven(self) -> bool {
        !self.is_met() && self.drawn >= 0.0
    }
}
