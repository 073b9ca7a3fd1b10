//! Tolerance allocation of a cell: the cheapest tolerances with which its operations stay within their
//! limits.

use super::allocated_nodes::{AllocatedNodes, chosen};
use crate::allocation::{
    FigureScratch, JudgedAllocation, LinearFigure, NodeFigure, ToleranceProblem, ToleranceRequirement,
    ToleranceShortfall, allocate,
};
use crate::cell::{Cell, Layout, Parameter, Quantity, Reading, ToleranceCost, Unit};
use crate::error_map::OperationMap;
use crate::layout::Workcell;
use crate::safe_text::shown;
use crate::units::mm_from_m;

/// Largest relative margin at which a requirement counts as binding. The relative margin is the limit minus
/// the error of the requirement, divided by the limit.
const BINDING: f64 = 1e-4;

/// Parameter whose tolerance is chosen.
#[derive(Debug, Clone, PartialEq)]
pub struct AllocatedParameter {
    pub parameter: Parameter,
    /// Tolerance of the parameter in the error set, m or rad.
    pub plus_minus: f64,
    pub cost: ToleranceCost,
}

/// Requirement that an operation stays within its limit at one node.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeRequirement {
    pub operation: usize,
    /// Indices (i, j) of the node.
    pub node: (usize, usize),
    /// Index of the node in the map of the operation.
    place: usize,
    /// Limit, m or rad.
    pub limit: f64,
    /// Error at the tolerances of the error set, m or rad: the worst case or a statistical figure.
    pub before: f64,
}

/// Tolerance allocation problem of one layout.
pub struct CellAllocation<'a> {
    pub workcell: &'a Workcell,
    layout: &'a Layout,
    maps: &'a [OperationMap],
    pub parameters: Vec<AllocatedParameter>,
    /// Parameters whose errors stay unchanged, because they are measured or correlated.
    pub fixed: Vec<Parameter>,
    pub requirements: Vec<NodeRequirement>,
    /// Demanded yield, 0 to 1. This value is used only if the quantity is the yield.
    pub(super) share: f64,
}

/// Reason why a cell has no cheapest tolerances.
#[derive(Debug, Clone, PartialEq)]
pub enum NoAllocation {
    /// A limit is missing, no tolerance can be chosen, or the errors are too large to be tolerances. The text
    /// `why` states the reason, and `help` the remedy.
    Question { why: String, help: &'static str },
    /// An operation has no usable node. The text states the reason.
    Unusable(String),
    /// Even at the tightest tolerances, the errors of these requirements exceed their limits.
    Infeasible(Vec<ToleranceShortfall>),
    /// The solver of the cone programs failed.
    NotSolved,
}

impl<'a> CellAllocation<'a> {
    /// Prepares the tolerance allocation of a layout; `maps` are the error maps of its operations.
    ///
    /// Every operation with a limit has requirements. If `only` is the index of an operation, the other
    /// operations have no requirements.
    ///
    /// # Errors
    /// Returns the reason if there is no requirement, no tolerance or no usable node. Also returns the reason
    /// if the errors would displace the TCP by more than the reach of the arm.
    pub fn new(
        workcell: &'a Workcell,
        layout: &'a Layout,
        maps: &'a [OperationMap],
        (only, nodes): (Option<usize>, AllocatedNodes),
        share: f64,
    ) -> Result<Self, NoAllocation> {
        let cell = &workcell.cell;
        let mut parameters: Vec<AllocatedParameter> = Vec::new();
        let (mut fixed, mut requirements) = (Vec::new(), Vec::new());
        for (k, operation) in cell.operations.iter().enumerate() {
            let Some(limit) = operation.limit.filter(|_| only.is_none_or(|only| only == k)) else { continue };
            for (place, node) in chosen(workcell, &maps[k], nodes).map_err(NoAllocation::Unusable)? {
                requirements.push(NodeRequirement { operation: k, node, place, limit, before: 0.0 });
            }
            for source in &workcell.evaluator(k).sources.list {
                let is_free = source.is_own_tolerance();
                if is_free && !parameters.iter().any(|p| p.parameter == source.parameter) {
                    let (parameter, plus_minus) = (source.parameter, source.plus_minus);
                    let cost = cell.tolerance_cost(parameter);
                    parameters.push(AllocatedParameter { parameter, plus_minus, cost });
                }
                if !is_free && !fixed.contains(&source.parameter) {
                    fixed.push(source.parameter);
                }
            }
        }
        if requirements.is_empty() {
            let which =
                if only.is_some() { "the operation has no limit" } else { "no operation has a limit" };
            let help = "add --limit, or write limit_mm or limit_deg into the operation";
            return Err(NoAllocation::Question { why: which.into(), help });
        }
        if parameters.is_empty() {
            let why = "no parameter has a tolerance to allocate".into();
            let help = "choose an error set of tolerances with --errors; measured and correlated errors have no tolerances to allocate";
            return Err(NoAllocation::Question { why, help });
        }
        let cheapest = nodes == AllocatedNodes::Cheapest;
        let mut problem = Self { workcell, layout, maps, parameters, fixed, requirements, share };
        if cheapest {
            problem.keep_cheapest_nodes()?;
        }
        let present = problem.figures(workcell)?;
        for (requirement, value) in problem.requirements.iter_mut().zip(present) {
            requirement.before = value;
        }
        problem.refuse_compensating_errors()?;
        Ok(problem)
    }

    /// Refuses errors that would displace the TCP by more than the reach of the arm.
    ///
    /// Some factory calibrations have Denavit-Hartenberg rows with lengths of kilometres. The errors of such
    /// rows compensate each other only in the calibrated arm.
    fn refuse_compensating_errors(&self) -> Result<(), NoAllocation> {
        let cell = &self.workcell.cell;
        let is_beyond =
            |r: &&NodeRequirement| self.unit(r.operation) == Unit::Length && r.before > cell.robot.reach();
        let Some(first) = self.requirements.iter().find(is_beyond) else { return Ok(()) };
        let name = shown(&cell.operations[first.operation].name);
        let why = format!(
            "if these errors were tolerances, the error of {name} would be {:.0} mm, more than the reach of the arm; in the calibrated arm, these errors compensate each other",
            mm_from_m(first.before)
        );
        let help = "choose an error set of tolerances with --errors; `sweetspot errors` creates such a set";
        Err(NoAllocation::Question { why, help })
    }

    /// Keeps only one node for each operation. This node has the least cost according to the linear model.
    /// The cost of a node is the cost of the cheapest tolerances that meet the limit at this node alone.
    fn keep_cheapest_nodes(&mut self) -> Result<(), NoAllocation> {
        let costs: Vec<ToleranceCost> = self.parameters.iter().map(|p| p.cost.clone()).collect();
        let free: Vec<Parameter> = self.parameters.iter().map(|p| p.parameter).collect();
        let present = vec![1.0; free.len()];
        let figures = self.visit(self.workcell, 0..self.requirements.len(), |_, figure| {
            let mut memory = figure.evaluator.memory();
            let value = figure.value(&mut memory);
            let linear = figure.linear(&free, &present, value, &mut memory);
            let at_present = linear.value(&present, &mut FigureScratch::default());
            // The linear figure is scaled so that it equals the judged figure at the present tolerances.
            linear.scaled(if at_present > 0.0 && value > 0.0 { value / at_present } else { 1.0 })
        })?;
        let cost_of = |(figure, r): (LinearFigure, &NodeRequirement)| {
            let requirements = vec![ToleranceRequirement { figure, limit: r.limit }];
            match allocate(&ToleranceProblem { costs: costs.clone(), requirements }) {
                Ok(found) => found.cost,
                Err(_) => f64::INFINITY,
            }
        };
        let node_costs: Vec<f64> = figures.into_iter().zip(&self.requirements).map(cost_of).collect();
        let mut kept: Vec<usize> = Vec::new();
        for (k, requirement) in self.requirements.iter().enumerate() {
            let same = kept.iter().position(|&own| self.requirements[own].operation == requirement.operation);
            match same {
                None => kept.push(k),
                Some(place) if node_costs[k] < node_costs[kept[place]] => kept[place] = k,
                Some(_) => {}
            }
        }
        self.requirements = kept.into_iter().map(|k| self.requirements[k].clone()).collect();
        Ok(())
    }

    /// Returns whether the error of a requirement at the allocated tolerances is at least 99.99 % of the
    /// limit.
    pub fn is_binding(&self, requirement: usize, found: &JudgedAllocation) -> bool {
        found.judged[requirement] >= self.requirements[requirement].limit * (1.0 - BINDING)
    }

    /// Returns the unit in which the errors and the limit of an operation are given.
    pub fn unit(&self, operation: usize) -> Unit {
        self.workcell.cell.operations[operation].sense.unit
    }

    /// Returns the yield that is demanded; None if the quantity is not the yield.
    pub fn demanded_yield(&self) -> Option<f64> {
        let cell = &self.workcell.cell;
        ((cell.reading, cell.quantity) == (Reading::Statistical, Quantity::Yield)).then_some(self.share)
    }

    /// Returns the cell with its tolerances multiplied by `scales`.
    pub fn scaled_cell(&self, scales: &[f64]) -> Cell {
        self.workcell.cell.with_scaled_tolerances(&|parameter| self.scale(parameter, scales))
    }

    /// Returns the workcell with its tolerances multiplied by `scales`.
    pub(super) fn scaled(&self, scales: &[f64]) -> Result<Workcell, NoAllocation> {
        let scaled = self.workcell.with_scaled_tolerances(&|parameter| self.scale(parameter, scales));
        scaled.map_err(NoAllocation::Unusable)
    }

    fn scale(&self, parameter: Parameter, scales: &[f64]) -> f64 {
        let place = self.parameters.iter().position(|p| p.parameter == parameter);
        place.map_or(1.0, |place| scales[place])
    }

    /// Calls `each` for every requirement whose index is in `which`, and collects the results. `each`
    /// receives the index of the requirement and a `NodeFigure`, which computes its error figure in
    /// `workcell`.
    pub(super) fn visit<T>(
        &self,
        workcell: &Workcell,
        which: impl Iterator<Item = usize>,
        mut each: impl FnMut(usize, &NodeFigure<'_>) -> T,
    ) -> Result<Vec<T>, NoAllocation> {
        let figures = which.map(|k| {
            let requirement = &self.requirements[k];
            let map = &self.maps[requirement.operation];
            let posture = map.nodes[requirement.place].posture.as_ref();
            let posture = posture.ok_or_else(|| NoAllocation::Unusable("a node has no posture".into()))?;
            let posed = workcell.posed(self.layout, self.maps, requirement.operation, posture);
            let (context, frames) = posed.map_err(|why| NoAllocation::Unusable(why.in_words().into()))?;
            let evaluator = workcell.evaluator(requirement.operation);
            let figure = NodeFigure { evaluator, context: &context, frames: &frames, share: self.share };
            Ok(each(k, &figure))
        });
        figures.collect()
    }

    /// Returns the error figure (worst case or statistical) of every requirement in a workcell.
    pub(super) fn figures(&self, workcell: &Workcell) -> Result<Vec<f64>, NoAllocation> {
        let all = 0..self.requirements.len();
        self.visit(workcell, all, |_, figure| figure.value(&mut figure.evaluator.memory()))
    }
}
