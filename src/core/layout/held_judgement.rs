//! Judgement of one placed layout whose operations keep their spots.

use super::ending::Ending;
use super::objective::combined;
use super::spot_choice::{Judge, Loss, SpotChoice, SpotMemory, SpotQuery, SpotValue};
use super::workcell::Workcell;
use crate::allocation::NearbyPrice;
use crate::cell::Unit;
use crate::certificate::NotCertified;
use crate::error_map::{HeldPosture, MapperWorkspace, Outcome, PlacedLayout, Spot};

/// Spot that an operation keeps.
#[derive(Debug, Clone, Copy)]
pub enum HeldSpot {
    Spot { node: usize, posture: HeldPosture },
    EveryNode,
}

/// Spots that the operations of a layout keep.
pub struct HeldSpots {
    /// Spot of each operation.
    pub spots: Vec<HeldSpot>,
    /// Cheapest tolerances of the layout. None if the objective is not a cost of tolerances, or if
    /// [`PlacedLayout::nearby_price`] returns None.
    pub price: Option<NearbyPrice>,
}

/// Spot and value of one operation.
#[derive(Debug, Clone)]
pub struct OperationValue {
    pub spot: Spot,
    /// Spots of all nodes if the operation happens at every node.
    pub every_node: Option<Vec<Spot>>,
    /// Value that enters the objective (m, rad, share of failures, or cost of tolerances).
    pub value: f64,
    /// Value that must be within the limit.
    pub worst: f64,
}

/// Memory for the judgement of the spots of one layout.
#[derive(Default)]
pub struct JudgementMemory {
    choice: SpotMemory,
    bounds: MapperWorkspace,
}

/// Judgement of one placed layout with held spots.
#[derive(Clone, Copy)]
pub struct Judgement<'j> {
    pub workcell: &'j Workcell,
    pub held: &'j HeldSpots,
    pub placed: &'j PlacedLayout<'j>,
    /// Largest objective that is allowed.
    pub most: f64,
    /// Known value of each operation; an operation with a known value is not judged.
    pub known: Option<&'j [Option<OperationValue>]>,
    /// Whether the transfers between operations are left out.
    pub is_estimate: bool,
}

impl Judgement<'_> {
    /// Returns the spot and the values of every operation, and the objective.
    ///
    /// # Errors
    /// Returns the first reason why the layout is infeasible, misses a limit, or has an objective above
    /// [`Self::most`].
    pub fn kept(&self, memory: &mut JudgementMemory) -> Result<(Vec<OperationValue>, f64), Ending> {
        let (values, objective) = self.values(memory)?;
        if objective > self.most {
            return Err(Ending::Objective);
        }
        let workcell = self.workcell;
        let worst: Vec<f64> = values.iter().map(|v| v.worst).collect();
        if workcell.priced(objective, &worst) != objective {
            let limits = workcell.cell.operations.iter().map(|o| o.limit);
            let misses = |(limit, worst): (Option<f64>, &f64)| limit.is_some_and(|limit| *worst > limit);
            return Err(Ending::Limit(limits.zip(&worst).position(misses).unwrap_or(0)));
        }
        Ok((values, objective))
    }

    /// Returns the spot and the values of every operation, and the objective. Limits are not checked.
    pub fn values(
        &self,
        JudgementMemory { choice, bounds }: &mut JudgementMemory,
    ) -> Result<(Vec<OperationValue>, f64), Ending> {
        let mut values = self.drawn(choice, bounds)?;
        let spots: Vec<Option<Spot>> = values.iter().map(|v| Some(v.spot)).collect();
        // Errors and prices are computed before collisions and certificates, because errors and prices take
        // less time.
        let price = self.held.price.as_ref().map(|near| {
            let price = self.placed.joint_price_within(&spots, (near, self.most), bounds);
            price.unwrap_or(f64::INFINITY)
        });
        if price.unwrap_or(self.combined(&values)) > self.most {
            return Err(Ending::Objective);
        }
        self.replace_bounds(&mut values, &spots, bounds)?;
        self.check(&mut values, &spots, bounds)?;
        let is_unpriced = price.is_none() && self.workcell.cell.unit() == Unit::Cost;
        let price = if is_unpriced { self.placed.joint_price(&spots, bounds) } else { price };
        let objective = self.combined(&values);
        Ok((values, price.map_or(objective, |price| price.max(objective))))
    }

    /// Combines the values of the operations.
    fn combined(&self, values: &[OperationValue]) -> f64 {
        let values: Vec<f64> = values.iter().map(|v| v.value).collect();
        combined(&self.workcell.cell, &values)
    }

    /// Returns the spot and the value of every operation without misplacements. Collisions and certificates
    /// are not checked. The value of a held spot may be a lower bound.
    ///
    /// If the price of the held layout is known, the costs of single operations are not needed. In this case,
    /// 0 is returned as a lower bound of each value.
    fn drawn(
        &self,
        choice: &mut SpotMemory,
        bounds: &mut MapperWorkspace,
    ) -> Result<Vec<OperationValue>, Ending> {
        let count = self.held.spots.len();
        let mut spots: Vec<Option<Spot>> = Vec::with_capacity(count);
        let mut values: Vec<OperationValue> = Vec::with_capacity(count);
        for (k, held) in self.held.spots.iter().enumerate() {
            let found = match (self.known(k), held) {
                (Some(known), _) => known.clone(),
                (None, HeldSpot::Spot { node, posture }) => {
                    let found = match &self.held.price {
                        Some(_) => self.placed.keeps(k, &spots, posture, bounds).map(|()| 0.0),
                        None => self.placed.held_bound(k, &spots, posture, bounds),
                    };
                    let value = found.map_err(|status| Ending::Posture(k, status))?;
                    let branch = posture.branch_elsewhere(self.workcell.inverse());
                    let spot = Spot { node: *node, branch, value };
                    OperationValue { spot, every_node: None, value, worst: value }
                }
                (None, HeldSpot::EveryNode) => {
                    let SpotChoice { outcome, value, every_node } = self.query(k, &spots).choose(choice);
                    match (outcome, value) {
                        (Outcome::Found(spot), Some(SpotValue::Kept { value, most })) => {
                            OperationValue { spot, every_node, value, worst: most }
                        }
                        (Outcome::Uncertain { why, .. }, _) => return Err(Ending::NotCertified(k, why)),
                        _ => return Err(Ending::EveryNode(k)),
                    }
                }
            };
            spots.push(Some(found.spot));
            values.push(found);
        }
        Ok(values)
    }

    /// Replaces lower bounds of errors at held spots by the errors.
    ///
    /// # Errors
    /// Returns the reason if the objective exceeds the largest objective that is allowed.
    fn replace_bounds(
        &self,
        values: &mut [OperationValue],
        spots: &[Option<Spot>],
        memory: &mut MapperWorkspace,
    ) -> Result<(), Ending> {
        if self.workcell.cell.unit() == Unit::Cost {
            return Ok(());
        }
        for (k, posture) in self.judged_spots().filter(|(k, _)| self.placed.has_held_bound(*k)) {
            let value = self.placed.held(k, spots, posture, memory);
            let value = value.map_err(|status| Ending::Posture(k, status))?;
            let spot = Spot { value, ..values[k].spot };
            values[k] = OperationValue { spot, every_node: None, value, worst: value };
        }
        if self.combined(values) > self.most { Err(Ending::Objective) } else { Ok(()) }
    }

    /// Certifies the spots and checks collisions and transfers. If a certificate is demanded, the worst
    /// values over the misplacements replace the values without misplacements.
    fn check(
        &self,
        values: &mut [OperationValue],
        spots: &[Option<Spot>],
        bounds: &mut MapperWorkspace,
    ) -> Result<(), Ending> {
        for (k, posture) in self.judged_spots() {
            // A certified posture can also be used without misplacements.
            if self.placed.demand().is_none() {
                let free = self.placed.keeps_free(k, spots, posture, bounds);
                free.map_err(|status| Ending::Posture(k, status))?;
            }
            if let Some((value, worst)) = self.certified(k, spots, &values[k].spot, bounds)? {
                (values[k].value, values[k].worst) = (value, worst);
            }
        }
        if !self.is_estimate {
            let every: Vec<_> = values.iter().map(|v| v.every_node.clone()).collect();
            self.placed.transfers(spots, &every, bounds).map_err(Ending::Transfer)?;
        }
        Ok(())
    }

    /// Returns the operations with a held spot and without a known value, each with its held posture.
    fn judged_spots(&self) -> impl Iterator<Item = (usize, &HeldPosture)> {
        self.held.spots.iter().enumerate().filter_map(|(k, held)| match (held, self.known(k)) {
            (HeldSpot::Spot { posture, .. }, None) => Some((k, posture)),
            _ => None,
        })
    }

    /// Returns the known value of an operation; None if the value is not known.
    fn known(&self, operation: usize) -> Option<&OperationValue> {
        self.known?[operation].as_ref()
    }

    fn query<'q>(&'q self, operation: usize, spots: &'q [Option<Spot>]) -> SpotQuery<'q> {
        SpotQuery { workcell: self.workcell, placed: self.placed, operation, spots }
    }

    /// Certifies a held spot, if a certificate is demanded. Returns the value that enters the objective
    /// and the value that must be within the limit. Returns None if both equal the value without
    /// misplacements.
    fn certified(
        &self,
        operation: usize,
        spots: &[Option<Spot>],
        spot: &Spot,
        memory: &mut MapperWorkspace,
    ) -> Result<Option<(f64, f64)>, Ending> {
        let Some(demand) = self.placed.demand() else { return Ok(None) };
        let query = self.query(operation, spots);
        let refused = |why: NotCertified| Ending::NotCertified(operation, why);
        self.placed.certify(operation, spots, spot, &demand, memory).map_err(refused)?;
        if !query.needs_bound() {
            return Ok(None);
        }
        match Judge::new(&query, demand, memory).value(spot.value, &[*spot]) {
            SpotValue::Kept { value, most } => Ok(Some((value, most))),
            SpotValue::Lost(Loss::NotCertified(why)) => Err(refused(why)),
            SpotValue::Lost(Loss::Corner) => Err(Ending::Corner(operation)),
        }
    }
}
