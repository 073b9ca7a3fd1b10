//! Cell prepared for evaluation: chain, inverse kinematics, errors and solids.

use crate::cell::{Cell, Interpretation, Layout, Parameter, QuestionFault};
use crate::certificate::{Misplacements, NoValueBound, ValueBound};
use crate::clearance::{FloorPlan, Remember, Scene, SelfCollisionPair};
use crate::cycle_time::RateBounds;
use crate::error_map::{Demand, Mapper, PlacedLayout, PostureOrder, ValueField};
use crate::reach::Inverse;
use crate::reading::ErrorEvaluator;
use std::sync::Arc;

/// Cell prepared for evaluation: chain, inverse kinematics, errors and solids.
pub struct Workcell {
    pub cell: Cell,
    pub(super) mapper: Mapper,
    pub(super) plan: Arc<FloorPlan>,
    certifies: bool,
    /// Maximum speeds and accelerations of the joints, or the indices of the joints whose maximum speed is
    /// not known.
    pub(super) rates: Result<RateBounds, Vec<usize>>,
    /// Floor plan in which each floor space has an extra distance for misplacements.
    pub(super) wide: Arc<FloorPlan>,
    /// Upper bound of the value of each operation over all misplacements, or the reason why there is no
    /// bound.
    pub(super) value_bounds: Vec<Result<ValueBound, NoValueBound>>,
}

impl Workcell {
    /// Prepares a cell.
    ///
    /// # Errors
    /// Returns the reason if the robot cannot hold the attitude of an operation. Also returns the reason if
    /// the search takes the cost of tolerances into account but the cell has no tolerance.
    pub fn new(cell: Cell) -> Result<Self, String> {
        Self::remembering(cell, &mut |_, compute| compute())
    }

    /// Prepares a cell. The function `remember` caches the convex decompositions of link meshes.
    ///
    /// # Errors
    /// Returns an error in the same cases as [`Self::new`].
    pub fn remembering(cell: Cell, remember: &mut Remember<'_>) -> Result<Self, String> {
        let mapper = Mapper::new(&cell, Arc::new(Scene::remembering(&cell, remember)))?;
        let plan = Arc::new(FloorPlan::new(&cell));
        let wide = Arc::new(FloorPlan::with_tolerances(&cell));
        let value_bounds = value_bounds(&cell, &mapper);
        let certifies = certifies(&cell);
        let rates = RateBounds::new(&cell.robot);
        Ok(Self { cell, mapper, plan, certifies, rates, wide, value_bounds })
    }

    /// Returns this workcell under another interpretation of its errors. Both workcells share the solids.
    ///
    /// # Errors
    /// Returns the reason if the interpretation does not suit the cell, or if the robot cannot hold an
    /// attitude.
    pub fn interpreted(&self, interpretation: &Interpretation) -> Result<Self, String> {
        self.sharing(self.cell.with_interpretation(interpretation).map_err(|faults| first_of(&faults))?)
    }

    /// Returns this workcell under another interpretation of its errors. The senses of the operations are
    /// allowed to have different units. Use the result only for values of single operations, not for an
    /// objective that combines them.
    ///
    /// # Errors
    /// Returns the reason if the interpretation does not suit the cell, or if the robot cannot hold an
    /// attitude. Different units of the senses are not an error.
    pub fn interpreted_apart(&self, interpretation: &Interpretation) -> Result<Self, String> {
        self.sharing(
            self.cell
                .with_interpretation_per_operation(interpretation)
                .map_err(|faults| first_of(&faults))?,
        )
    }

    /// Returns this workcell with scaled tolerances. The tolerance of a parameter is multiplied by the factor
    /// that `scale` returns for this parameter. Both workcells share the solids.
    ///
    /// # Errors
    /// Returns the reason if the robot cannot hold an attitude.
    pub fn with_scaled_tolerances(&self, scale: &dyn Fn(Parameter) -> f64) -> Result<Self, String> {
        self.sharing(self.cell.with_scaled_tolerances(scale))
    }

    /// Prepares a cell with the same solids and placements as this workcell. Both workcells share the
    /// solids and the floor plan.
    fn sharing(&self, cell: Cell) -> Result<Self, String> {
        let mapper = Mapper::new(&cell, self.mapper.scene().clone())?;
        let value_bounds = value_bounds(&cell, &mapper);
        let (plan, wide, certifies) = (self.plan.clone(), self.wide.clone(), certifies(&cell));
        let rates = RateBounds::new(&cell.robot);
        Ok(Self { cell, mapper, plan, certifies, rates, wide, value_bounds })
    }

    /// Switches off the ranking of nodes by lower bounds of their values. A search then judges every node,
    /// which is slower. The result is the same, bit for bit.
    #[must_use]
    pub fn unranked(mut self) -> Self {
        self.mapper.forget_ranks();
        self
    }

    /// Keeps the value fields that `compute` returns, if no fields are kept yet. The function `compute`
    /// returns the list of fields of every operation, or None if it was stopped.
    pub(crate) fn keep_value_fields(&self, compute: impl FnOnce() -> Option<Vec<Vec<ValueField>>>) {
        self.mapper.keep_value_fields(compute);
    }

    /// Restricts each map to errors in the operation's own sense. Errors in other senses are left out. Maps
    /// are then computed several times faster.
    #[must_use]
    pub fn in_own_senses(mut self) -> Self {
        self.mapper.report_own_senses();
        self
    }

    /// Returns whether the nodes of every operation can be ranked by lower bounds of their values.
    pub fn is_ranked(&self) -> bool {
        self.mapper.is_ranked()
    }

    /// Returns every pair of robot solids that can be present at the same time. A held part is present only
    /// during its operation. Each pair states whether a contact is allowed, and why.
    ///
    /// If self-collision is not checked, the list has only pairs with the pedestal.
    pub fn self_collision_pairs(&self) -> &[SelfCollisionPair] {
        self.mapper.scene().self_collision_pairs()
    }

    /// Returns whether a layout must work at every misplacement inside the placement tolerances.
    ///
    /// The result is false if no body has a placement tolerance. The result is also false if the cell
    /// requests an ideal layout ([`crate::cell::SearchSettings::ideal`]). An ideal layout need only work at
    /// its nominal placements.
    pub fn certifies(&self) -> bool {
        self.certifies
    }

    /// Returns the reason why the value of an operation has no upper bound over the misplacements; None if
    /// the value has such a bound.
    pub fn no_value_bound(&self, operation: usize) -> Option<NoValueBound> {
        self.value_bounds[operation].as_ref().err().copied()
    }

    /// Returns the demand that every posture of a layout must meet. The demand contains no bound of the
    /// value.
    pub(super) fn demand<'a>(&'a self, misplacements: &'a Misplacements) -> Demand<'a> {
        Demand { cell: &self.cell, misplacements, value: None }
    }

    /// Returns the solids of the cell.
    pub(crate) fn scene(&self) -> &Scene {
        self.mapper.scene()
    }

    /// Returns the floor plan in which the floor spaces of a feasible layout do not overlap.
    pub(crate) fn floor_plan(&self) -> &FloorPlan {
        if self.certifies { &self.wide } else { &self.plan }
    }

    /// Returns the inverse kinematics of the arm.
    pub fn inverse(&self) -> &Inverse {
        self.mapper.inverse()
    }

    /// Returns, for each operation, the order in which a search judges the postures of the operation. This
    /// order depends on the required attitude. The function uses the attitudes of the start layout.
    pub fn posture_orders(&self) -> impl Iterator<Item = PostureOrder> + '_ {
        let attitudes = self.cell.operations.iter().map(|operation| &operation.attitude);
        attitudes.enumerate().map(|(k, attitude)| self.mapper.posture_order(k, attitude))
    }

    /// Returns the error evaluator of an operation.
    pub fn evaluator(&self, operation: usize) -> &ErrorEvaluator {
        self.mapper.evaluator(operation)
    }

    /// Returns a layout with the poses of its solids.
    pub fn placed<'a>(&'a self, layout: &'a Layout) -> PlacedLayout<'a> {
        PlacedLayout::new(&self.mapper, layout)
    }
}

/// Returns whether a layout of the cell must work at every misplacement.
fn certifies(cell: &Cell) -> bool {
    !cell.search.ideal && cell.has_placement_tolerance()
}

/// Prepares the upper bound of the value of every operation.
fn value_bounds(cell: &Cell, mapper: &Mapper) -> Vec<Result<ValueBound, NoValueBound>> {
    let bound = |k: usize| ValueBound::new(cell, k, mapper.evaluator(k), mapper.chain());
    (0..cell.operations.len()).map(bound).collect()
}

/// Returns the message and the help of the first fault as one line of text. The text is empty if there is
/// no fault.
fn first_of(faults: &[QuestionFault]) -> String {
    faults.first().map_or(String::new(), |fault| format!("{}; {}", fault.message, fault.help))
}
