//! Robot, solids, errors and operations of a cell, prepared for any layout.

use super::grid::Grid;
use super::held_posture::HeldPosture;
use super::operation_setup::OperationSetup;
use super::simd::Ranker;
use super::value_field::ValueField;
use crate::allocation::TolerancePricing;
use crate::cell::{Cell, Coordinate, JointVector, Operation, Unit};
use crate::clearance::Scene;
use crate::motion::Guard;
use crate::reach::{Branch, CONTINUED, Cost, Inverse, Shell, ToolAttitudes};
use crate::reading::ErrorEvaluator;
use crate::robot::{Chain, Frames};
use crate::safe_text::shown;
use nalgebra::Vector3;
use std::sync::{Arc, OnceLock};

/// Robot, solids, errors and operations of a cell, prepared for any layout.
pub struct Mapper {
    pub(super) arm: ArmKinematics,
    pub(super) scene: Arc<Scene>,
    pub(super) setups: Vec<OperationSetup>,
    /// Motion rules of the cell; None if the cell has no motion rules.
    pub(super) guard: Option<Guard>,
    /// Ranker of the nodes of each operation; None if these nodes cannot be ranked.
    pub(super) rankers: Vec<Option<Ranker>>,
    /// Value fields of each operation: one field for each range of heights of the operation. Nothing is
    /// stored until the fields are known. The list of an operation without fields is empty.
    fields: OnceLock<Vec<Vec<ValueField>>>,
    /// Whether the search skips postures whose lower bound exceeds the best value found.
    pub(super) ranks: bool,
    /// Spherical shell that bounds the reach of the arm in each operation; None if the shell saves no time.
    pub(super) shells: Vec<Option<Shell>>,
    /// Tolerances with their cost models; None unless the cost of tolerances is the objective or a goal of
    /// the search.
    pub(super) tolerances: Option<Arc<TolerancePricing>>,
}

/// Forward and inverse kinematics of one arm, with the joint limits reduced by the margins of the cell.
pub struct ArmKinematics {
    pub chain: Chain,
    pub inverse: Inverse,
}

impl Mapper {
    /// Prepares a cell whose solids are in `scene`.
    ///
    /// # Errors
    /// Returns the reason if the geometry of the robot does not allow the attitude of an operation. Also
    /// returns the reason if the search takes the cost of tolerances into account but the cell has no
    /// tolerance.
    pub fn new(cell: &Cell, scene: Arc<Scene>) -> Result<Self, String> {
        let chain = Chain::with_margins(&cell.robot, &cell.margins);
        let inverse = Inverse::new(&chain);
        for operation in &cell.operations {
            if let Some(why) = inverse.refusal(&operation.attitude) {
                return Err(format!("operation {}: {why}", shown(&operation.name)));
            }
        }
        let arm = ArmKinematics { chain, inverse };
        let mut setups: Vec<_> = cell.operations.iter().map(|o| OperationSetup::new(cell, o)).collect();
        let tolerances = tolerances(cell, &setups)?;
        if let Some(tolerances) = &tolerances {
            let is_priced = cell.unit() == Unit::Cost;
            setups.iter_mut().zip(&cell.operations).for_each(|(s, o)| s.price(tolerances, o, is_priced));
        }
        let shells = cell.operations.iter().map(|operation| shell(&arm.inverse, operation)).collect();
        let ranker = |s: &OperationSetup| match s.is_priced {
            true => None,
            false => Ranker::new(&arm.inverse, &s.evaluator, &s.grid),
        };
        let rankers = setups.iter().map(ranker).collect();
        let guard = Guard::new(cell);
        let fields = OnceLock::new();
        Ok(Self { arm, scene, setups, guard, rankers, fields, ranks: true, shells, tolerances })
    }

    /// Returns the cost of the tightest tolerances that the cost models allow. Returns 0 if the search
    /// ignores the cost of tolerances.
    pub fn most_cost(&self) -> f64 {
        self.tolerances.as_ref().map_or(0.0, |tolerances| tolerances.most())
    }

    /// Returns the solids of the cell.
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Returns the inverse kinematics of the arm.
    pub fn inverse(&self) -> &Inverse {
        &self.arm.inverse
    }

    /// Returns the kinematic chain of the arm, with the joint limits reduced by the margins of the cell.
    pub fn chain(&self) -> &Chain {
        &self.arm.chain
    }

    /// Computes the link frames at the given joint coordinates.
    pub fn frames(&self, joints: &JointVector) -> Frames {
        self.arm.chain.frames(&self.arm.chain.posture(joints))
    }

    /// Returns a branch at a target; None if the branch does not exist there. If the index is [`CONTINUED`],
    /// the numeric solver computes the branch. The solver starts at the posture `kept`.
    pub(super) fn branch_at(
        &self,
        target: &Vector3<f64>,
        attitudes: &ToolAttitudes,
        branch: u64,
        kept: Option<&HeldPosture>,
    ) -> Option<Branch> {
        let inverse = &self.arm.inverse;
        match kept.filter(|_| branch == CONTINUED) {
            Some(held) => held.continued(inverse, target, attitudes).ok(),
            None => inverse.branch_at(target, attitudes, branch),
        }
    }

    /// Returns the error evaluator of an operation.
    pub fn evaluator(&self, operation: usize) -> &ErrorEvaluator {
        &self.setups[operation].evaluator
    }

    /// Returns the nodes of an operation.
    pub fn grid(&self, operation: usize) -> &Grid {
        &self.setups[operation].grid
    }

    /// Restricts each map to its operation's own sense.
    pub fn report_own_senses(&mut self) {
        self.setups.iter_mut().for_each(|setup| setup.evaluator.report_own_sense());
    }

    /// Keeps the value fields that `compute` returns, if no fields are kept yet. The function `compute`
    /// returns the list of fields of every operation, or None if it was stopped.
    pub fn keep_value_fields(&self, compute: impl FnOnce() -> Option<Vec<Vec<ValueField>>>) {
        if self.ranks && self.fields.get().is_none() {
            // Two threads compute equal fields, so either may be kept.
            compute().into_iter().for_each(|fields| drop(self.fields.set(fields)));
        }
    }

    /// Returns the value field of an operation for targets at the height `z` in the base frame (m), and for
    /// an elevation of the tool axis (rad). Returns None if no such field is kept.
    pub(super) fn value_field(&self, operation: usize, z: f64, elevation: f64) -> Option<&ValueField> {
        self.fields.get()?[operation].iter().find(|field| field.covers(z, elevation))
    }

    /// Switches off the ranking of nodes, so that every node is judged.
    pub fn forget_ranks(&mut self) {
        self.rankers.fill(None);
        self.fields = OnceLock::new();
        self.ranks = false;
    }

    /// Returns whether the nodes of every operation can be ranked.
    pub fn is_ranked(&self) -> bool {
        self.rankers.iter().all(Option::is_some)
    }

    /// Returns whether the transfers between operations are checked.
    pub fn asks_transfers(&self) -> bool {
        self.guard.as_ref().is_some_and(Guard::asks_transfers)
    }
}

/// Collects the tolerances of a cell. Returns None if the search does not take their cost into account.
///
/// # Errors
/// Returns the reason if the cell has no tolerance.
fn tolerances(cell: &Cell, setups: &[OperationSetup]) -> Result<Option<Arc<TolerancePricing>>, String> {
    if !cell.search.prices_tolerances() {
        return Ok(None);
    }
    let evaluators: Vec<&ErrorEvaluator> = setups.iter().map(|setup| &setup.evaluator).collect();
    match TolerancePricing::new(cell, &evaluators) {
        Some(tolerances) => Ok(Some(Arc::new(tolerances))),
        None => Err("the cost of tolerances cannot be computed: every error is measured or correlated, so no tolerance can be chosen".into()),
    }
}

/// Returns a spherical shell that bounds the reach of the arm in an operation; None if the shell would save
/// no time.
///
/// The shell saves no time if inverse kinematics is cheap, or if a search may change the attitude.
fn shell(inverse: &Inverse, operation: &Operation) -> Option<Shell> {
    // An attitude that the search may change would need one shell for each of its values.
    let is_fixed = !operation.angles.iter().flatten().any(Coordinate::is_free);
    (inverse.cost() != Cost::Low && is_fixed).then(|| inverse.shell(&operation.attitude))
}
