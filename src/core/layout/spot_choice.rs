//! Choice of the spot of one operation, for evaluation and maps alike.
//!
//! If the layout must withstand misplacements, only certified spots are used. At a certified spot, the
//! operation works at every misplacement ([`crate::certificate`]). The nominal value is the value without
//! misplacements. The certified spot with the least nominal value is chosen.
//!
//! A robust search chooses the certified spot with the least bound of its value instead. Spots are judged in
//! ascending order of their nominal values. The bound is never below the nominal value. The search therefore
//! ends when the nominal value of the next spot reaches the least bound found. If no bound of the value is
//! known, the greatest value at the corners of the placement tolerances replaces the bound. At most
//! [`MAX_NODES`] nodes are judged. If the search ends at this number, a better spot may exist.

use super::misplacement::{BoxPoints, Moves, ToleranceBoxes};
use super::workcell::Workcell;
use crate::cell::Layout;
use crate::certificate::NotCertified;
use crate::error_map::{
    Demand, HeldPosture, MapperWorkspace, Outcome, PlacedLayout, Probe, Spot, Status, Unjudged, WalkCounts,
};

/// Greatest number of nodes that a robust search judges for one operation.
const MAX_NODES: usize = 16;

/// Largest penalty of an operation without a certified spot, m.
///
/// The penalty of an operation without any spot is larger.
const LOST_PENALTY: f64 = 0.1;

/// Penalty of an operation whose posture cannot be used at a corner of the placement tolerances, m.
const CORNER_PENALTY: f64 = LOST_PENALTY * 0.2;

/// Operation whose spot is to be chosen in a placed layout.
pub struct SpotQuery<'a> {
    pub workcell: &'a Workcell,
    pub placed: &'a PlacedLayout<'a>,
    pub operation: usize,
    /// Spots of the earlier operations.
    pub spots: &'a [Option<Spot>],
}

/// Memory for the choice of spots, reused between layouts.
#[derive(Default)]
pub struct SpotMemory {
    mapper: MapperWorkspace,
    bounds: MapperWorkspace,
}

impl SpotMemory {
    /// Returns the memory of the search for spots.
    pub fn mapper(&mut self) -> &mut MapperWorkspace {
        &mut self.mapper
    }

    /// Returns the work done so far.
    pub fn counts(&self) -> WalkCounts {
        [&self.mapper, &self.bounds].into_iter().map(MapperWorkspace::counts).sum()
    }
}

/// Chosen spot of an operation.
pub struct SpotChoice {
    pub outcome: Outcome,
    /// Contribution to the objective; None if the operation has no spot.
    pub value: Option<SpotValue>,
    /// Usable spots of all nodes of an operation that happens at every node. None for any other operation, or
    /// if the choice does not need these spots.
    pub every_node: Option<Vec<Spot>>,
}

impl SpotChoice {
    fn new(outcome: Outcome, value: Option<SpotValue>) -> Self {
        Self { outcome, value, every_node: None }
    }
}

/// Contribution of an operation's spot to the objective.
#[derive(Clone, Copy)]
pub enum SpotValue {
    Kept {
        /// Value of the spot (m, rad, share of failures, or cost of tolerances). In a robust search, this is
        /// the worst value over the placement tolerances.
        value: f64,
        /// Value that must be within the limit of the operation: the largest value over the placement
        /// tolerances. This value is infinite if no bound is known.
        most: f64,
    },
    /// The spot may fail at a misplacement inside the placement tolerances.
    Lost(Loss),
}

/// Reason why a spot may fail at a misplacement inside the placement tolerances.
#[derive(Clone, Copy)]
pub enum Loss {
    NotCertified(NotCertified),
    /// The posture cannot be held at a corner of the placement tolerances.
    Corner,
}

impl Loss {
    /// Returns the penalty of the operation, m.
    pub fn penalty(&self) -> f64 {
        match self {
            Self::NotCertified(why) => penalty(why),
            Self::Corner => CORNER_PENALTY,
        }
    }
}

impl SpotQuery<'_> {
    /// Chooses the spot of the operation.
    pub fn choose(&self, memory: &mut SpotMemory) -> SpotChoice {
        let SpotMemory { mapper, bounds } = memory;
        let SpotQuery { workcell, placed, operation, spots } = *self;
        let demand = placed.demand().filter(|_| self.needs_bound());
        let nominal = |value: f64| SpotValue::Kept { value, most: value };
        let needs_every_node = workcell.cell.operations[operation].over.needs_every_node();
        if needs_every_node && (placed.demand().is_some() || placed.visits_every_point(operation)) {
            let all = match placed.every_free(operation, spots, mapper) {
                Ok(all) => all,
                Err(why) => return SpotChoice::new(why, None),
            };
            let outcome = placed.value_of_all(operation, &all);
            let Outcome::Found(worst) = outcome else { return SpotChoice::new(outcome, None) };
            let value = match demand {
                Some(demand) => Judge::new(self, demand, bounds).value(worst.value, &all),
                None => nominal(worst.value),
            };
            return SpotChoice { every_node: Some(all), ..SpotChoice::new(outcome, Some(value)) };
        }
        let outcome = placed.outcome(operation, spots, mapper);
        let Outcome::Found(first) = outcome else { return SpotChoice::new(outcome, None) };
        let Some(demand) = demand else {
            return SpotChoice::new(outcome, Some(nominal(first.value)));
        };
        let mut judge = Judge::new(self, demand, bounds);
        let robust = workcell.cell.search.robust;
        let mut best = (first, judge.value(first.value, &[first]));
        let mut judged = 1;
        if robust {
            placed.free_spots(operation, spots, mapper, |spot| {
                let is_settled = matches!(best.1, SpotValue::Kept { value, .. } if spot.value >= value);
                if judged == MAX_NODES || is_settled {
                    return false;
                }
                let found = judge.value(spot.value, &[spot]);
                judged += 1;
                if found.is_better_than(&best.1) {
                    best = (spot, found);
                }
                true
            });
        }
        SpotChoice::new(Outcome::Found(best.0), Some(best.1))
    }

    /// Returns whether the objective or a limit depends on the value at the misplacements.
    pub fn needs_bound(&self) -> bool {
        let cell = &self.workcell.cell;
        let is_limited = cell.operations[self.operation].limit.is_some();
        cell.search.robust || is_limited && cell.unit().is_error()
    }
}

impl SpotValue {
    fn is_better_than(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Kept { value, .. }, Self::Kept { value: least, .. }) => value < least,
            (Self::Lost(by), Self::Lost(least)) => by.penalty() < least.penalty(),
            (Self::Kept { .. }, Self::Lost(_)) => true,
            (Self::Lost(_), Self::Kept { .. }) => false,
        }
    }
}

/// Judge of the certified spots of one operation. The judge bounds the values of these spots.
pub struct Judge<'a, 'm> {
    query: &'a SpotQuery<'a>,
    demand: Demand<'a>,
    memory: &'m mut MapperWorkspace,
}

impl<'a, 'm> Judge<'a, 'm> {
    /// Returns a judge for the operation of `query`. The certificates use the data in `demand`; the bound of
    /// the value comes from the workcell.
    pub fn new(query: &'a SpotQuery<'a>, demand: Demand<'a>, memory: &'m mut MapperWorkspace) -> Self {
        let demand = Demand { value: Some(&query.workcell.value_bounds[query.operation]), ..demand };
        Self { query, demand, memory }
    }

    /// Returns the value of the operation at the certified spots `at`. `drawn` is the nominal value, without
    /// misplacements.
    pub fn value(&mut self, drawn: f64, at: &[Spot]) -> SpotValue {
        let SpotQuery { workcell, placed, operation, spots } = *self.query;
        let mut most = Vec::with_capacity(at.len());
        for spot in at {
            match placed.most(operation, spots, spot, &self.demand, self.memory) {
                Ok(bound) => most.extend(bound),
                Err(why) => return SpotValue::Lost(Loss::NotCertified(why)),
            }
        }
        let over = workcell.cell.operations[operation].over;
        // A bound cannot be below the nominal value, except by rounding.
        let bound = (most.len() == at.len()).then(|| over.of(&mut most).max(drawn));
        if !workcell.cell.search.robust {
            return SpotValue::Kept { value: drawn, most: bound.unwrap_or(f64::INFINITY) };
        }
        let worst = match bound {
            Some(bound) => Ok(bound),
            None => {
                let grid = workcell.mapper.grid(operation);
                let held = |spot: &Spot| placed.hold(operation, grid.local(spot.node), spot.branch);
                let held: Vec<HeldPosture> = at.iter().filter_map(held).collect();
                Corners::new(self.query).worst(drawn, &held, self.memory)
            }
        };
        match worst {
            Ok(value) => SpotValue::Kept { value, most: bound.unwrap_or(f64::INFINITY) },
            Err(loss) => SpotValue::Lost(loss),
        }
    }
}

/// Corners of the box of placement tolerances, at which an operation is evaluated.
struct Corners<'a> {
    query: &'a SpotQuery<'a>,
    layouts: Vec<Layout>,
}

impl<'a> Corners<'a> {
    fn new(query: &'a SpotQuery<'a>) -> Self {
        let cell = &query.workcell.cell;
        let corners = ToleranceBoxes::of(cell, query.operation).moves(1.0, BoxPoints::Corners);
        let misplaced = |moves: &Moves| cell.misplaced(query.placed.layout(), moves);
        Self { query, layouts: corners.iter().map(misplaced).collect() }
    }

    /// Computes the greatest of the nominal value and the values at the corners of the placement tolerances.
    ///
    /// The points and postures in `held` do not change.
    ///
    /// # Errors
    /// Returns the loss if a posture cannot be used at one of the corners.
    fn worst(&self, drawn: f64, held: &[HeldPosture], memory: &mut MapperWorkspace) -> Result<f64, Loss> {
        let SpotQuery { workcell, operation, spots, .. } = *self.query;
        let over = workcell.cell.operations[operation].over;
        let mut worst = drawn;
        for layout in &self.layouts {
            let placed = workcell.placed(layout);
            let values: Result<Vec<f64>, Status> = Probe::new(&placed, operation, spots, memory)
                .map_err(|why: Unjudged| Status::Unjudged(why))
                .and_then(|mut probe| held.iter().map(|held| probe.holding(held)).collect());
            worst = worst.max(over.of(&mut values.map_err(|_| Loss::Corner)?));
        }
        Ok(worst)
    }
}

/// Returns the penalty (m) of an operation without a certified spot. The penalty is at most [`LOST_PENALTY`].
pub fn penalty(why: &NotCertified) -> f64 {
    let share = match why {
        NotCertified::NoSpot | NotCertified::NoBranch | NotCertified::NoTask => 1.0,
        NotCertified::NearlySingular | NotCertified::Singular { .. } => 0.6,
        NotCertified::JointLimit { by, .. } => 0.3 + by.min(0.3),
        _ => 0.2,
    };
    LOST_PENALTY * share
}
