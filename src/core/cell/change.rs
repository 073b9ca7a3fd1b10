//! Changes of a validated cell. Each function that changes a cell returns a valid cell.
//!
//! No code outside this folder changes the fields of a cell, except the reader of cell files.

use super::coordinate::Coordinate;
use super::error_model::{ErrorSet, FrameErrors, SignedErrors};
use super::layout::Slot;
use super::model::Cell;
use super::parameter::Parameter;
use super::tolerance_cost::ToleranceCost;

impl Cell {
    /// Returns this cell with a controller that compensates the means of the measured errors of the robot.
    ///
    /// The deviations of the parameters from these means remain. Returns None if the errors of the robot are
    /// not measured.
    pub fn compensated(&self) -> Option<Cell> {
        let mut cell = self.clone();
        let axes = cell.robot.axes();
        let ErrorSet::Measured(measured) = cell.robot.errors.get_mut(self.errors)? else { return None };
        let none = vec![0.0; measured.mean.values().len()];
        measured.mean = SignedErrors::of_values(measured.mean.name.clone(), axes, &none);
        Some(cell)
    }

    /// Returns this cell with the tolerance of every parameter multiplied by the result of `scale` for the
    /// parameter. Correlated and measured errors stay unchanged.
    ///
    /// In a signed sample, a tolerance replaces the value of each parameter. This tolerance is the magnitude
    /// of the value, multiplied by the result of `scale`.
    pub fn with_scaled_tolerances(&self, scale: &dyn Fn(Parameter) -> f64) -> Cell {
        let mut cell = self.clone();
        let parameters = Parameter::of_robot(self.robot.axes());
        let set = &mut cell.robot.errors[self.errors];
        if !matches!(set, ErrorSet::Measured(_)) {
            let mut tolerance = set.tolerance();
            let correlated = tolerance.covariance.as_ref().map_or(&[][..], |c| &c.parameters);
            let own = tolerance.spreads.iter_mut().zip(parameters).enumerate();
            for (_, (spread, parameter)) in own.filter(|(k, _)| !correlated.contains(k)) {
                spread.plus_minus *= scale(parameter);
            }
            *set = ErrorSet::Tolerance(tolerance);
        }
        for (e, equipment) in cell.equipment.iter_mut().enumerate() {
            if let Some(errors) = &equipment.errors {
                let mut spreads = errors.tolerance();
                for (c, spread) in spreads.iter_mut().enumerate() {
                    spread.plus_minus *= scale(Parameter::Equipment(e, c));
                }
                equipment.errors = Some(FrameErrors::Tolerance(spreads));
            }
        }
        cell
    }

    /// Returns the cost model of an error parameter of the robot or of equipment.
    ///
    /// For a parameter of the robot, the chosen error set states the model. If no model is stated, the result
    /// is the default model.
    pub fn tolerance_cost(&self, parameter: Parameter) -> ToleranceCost {
        let stated = match parameter {
            Parameter::Equipment(e, c) => self.equipment.get(e).and_then(|e| e.error_costs.get(c)),
            _ => match self.error_set() {
                ErrorSet::Tolerance(tolerance) => {
                    let place = Parameter::of_robot(self.robot.axes()).position(|p| p == parameter);
                    place.and_then(|place| tolerance.costs.get(place))
                }
                _ => None,
            },
        };
        stated.cloned().unwrap_or_default()
    }

    /// Returns the coordinate that a [`Slot`] denotes; None if the cell has no such coordinate.
    pub fn coordinate(&self, slot: Slot) -> Option<&Coordinate> {
        match slot {
            Slot::Base(axis) => self.base.get(axis),
            Slot::Equipment(k, axis) => self.equipment.get(k)?.placement.get(axis),
            Slot::Attitude(k, angle) => self.operations.get(k)?.angles.get(angle)?.as_ref(),
        }
    }

    fn coordinate_mut(&mut self, slot: Slot) -> Option<&mut Coordinate> {
        match slot {
            Slot::Base(axis) => self.base.get_mut(axis),
            Slot::Equipment(k, axis) => self.equipment.get_mut(k)?.placement.get_mut(axis),
            Slot::Attitude(k, angle) => self.operations.get_mut(k)?.angles.get_mut(angle)?.as_mut(),
        }
    }

    /// Returns this cell with other start values (m or rad) of the coordinates that the [`Slot`]s denote.
    ///
    /// If `frees` is true, a fixed coordinate that gets another value becomes free. The range of this
    /// coordinate is then the interval between the old and the new value.
    pub fn starting_at(&self, values: impl Iterator<Item = (Slot, f64)>, frees: bool) -> Cell {
        let mut cell = self.clone();
        for (slot, value) in values {
            if let Some(coordinate) = cell.coordinate_mut(slot) {
                *coordinate = coordinate.starting_at(value, frees);
            }
        }
        cell
    }

    /// Frees each fixed coordinate of this cell that is free in the cell `wide`, and returns this cell. Each
    /// such coordinate gets the range that it has in `wide`.
    ///
    /// A search can thus start from the result of an earlier search, in which all coordinates are fixed.
    ///
    /// A coordinate becomes free only if its value lies in its range in `wide`. The cell stays unchanged if
    /// the names of its equipment or operations differ from the names in `wide`.
    pub fn with_ranges_of(mut self, wide: &Cell) -> Cell {
        let same = |a: &Cell, b: &Cell| {
            a.equipment.iter().map(|e| &e.name).eq(b.equipment.iter().map(|e| &e.name))
                && a.operations.iter().map(|o| &o.name).eq(b.operations.iter().map(|o| &o.name))
        };
        if !same(&self, wide) {
            return self;
        }
        let mut slots = Vec::new();
        wide.layout(|slot, coordinate| {
            slots.push(slot);
            coordinate.start()
        });
        for slot in slots {
            let (Some(range), Some(own)) = (wide.coordinate(slot), self.coordinate_mut(slot)) else {
                continue;
            };
            let value = own.start();
            let (low, high) = range.range();
            let is_within = match range {
                Coordinate::List(values) => values.contains(&value),
                _ => (low..=high).contains(&value),
            };
            if range.is_free() && !own.is_free() && is_within {
                *own = range.starting_at(value, false);
            }
        }
        self
    }

    /// Returns this cell with another seed or budget of its search; None keeps the present value.
    ///
    /// # Errors
    /// Returns an error if the budget is out of range.
    pub fn searching(mut self, seed: Option<u64>, budget: Option<u64>) -> Result<Cell, String> {
        let range = super::choices::SearchSettings::BUDGETS;
        self.search.seed = seed.unwrap_or(self.search.seed);
        self.search.budget = budget.unwrap_or(self.search.budget);
        match range.contains(&self.search.budget) {
            true => Ok(self),
            false => Err(format!("the budget must be from {} to {}", range.start(), range.end())),
        }
    }
}

impl Coordinate {
    /// Returns this coordinate with another start value.
    ///
    /// If `frees` is true, a fixed coordinate that gets another value becomes free. The range of this
    /// coordinate is then the interval between the old and the new value.
    fn starting_at(&self, value: f64, frees: bool) -> Coordinate {
        match self {
            Coordinate::Fixed(was) if frees && *was != value => {
                Coordinate::Range { min: was.min(value), max: was.max(value), start: value }
            }
            Coordinate::Fixed(_) => Coordinate::Fixed(value),
            Coordinate::Range { min, max, .. } => Coordinate::Range { min: *min, max: *max, start: value },
            Coordinate::List(values) => {
                let others = values.iter().copied().filter(|v| *v != value);
                Coordinate::List(std::iter::once(value).chain(others).collect())
            }
        }
    }
}
