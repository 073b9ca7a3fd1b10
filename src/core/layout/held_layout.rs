//! Held layout: a layout whose operations keep their spots while the robot base or equipment is placed
//! elsewhere.
//!
//! The node and the branch of every operation do not change, so that a drawing with the spots remains valid.
//! An operation at every node keeps no posture: at each of its nodes, the best posture of the node is used.

use super::certify::is_between_solids;
use super::ending::Ending;
use super::evaluation::{Evaluation, evaluate};
use super::objective::combined;
use super::spot_choice::{Judge, Loss, SpotChoice, SpotMemory, SpotQuery, SpotValue};
use super::workcell::Workcell;
use crate::allocation::NearbyPrice;
use crate::cell::{Layout, Unit};
use crate::certificate::{Misplacements, NotCertified};
use crate::clearance::{Overlap, PlacedSolids};
use crate::error_map::{HeldPosture, MapperWorkspace, Outcome, PlacedLayout, Spot};
use std::sync::OnceLock;

/// Spot that an operation keeps.
#[derive(Debug, Clone, Copy)]
enum HeldSpot {
    Spot { node: usize, posture: HeldPosture },
    EveryNode,
}

/// Layout whose operations keep their spots.
pub struct HeldLayout<'a> {
    workcell: &'a Workcell,
    layout: &'a Layout,
    /// Objective of the layout (m, rad, share of failures, or cost of tolerances).
    pub objective: f64,
    /// Spot of each operation.
    spots: Vec<HeldSpot>,
    /// Posture that each operation keeps; None for an operation at every node.
    kept: Vec<Option<HeldPosture>>,
    /// Values of the operations in the layout, computed when they are first needed; None inside if they cannot
    /// be computed.
    own: OnceLock<Option<Vec<OperationValue>>>,
    /// Cheapest tolerances of the layout. None if the objective is not a cost of tolerances, or if
    /// [`PlacedLayout::nearby_price`] returns None.
    price: Option<NearbyPrice>,
}

/// Spot and value of one operation.
#[derive(Debug, Clone)]
struct OperationValue {
    spot: Spot,
    /// Spots of all nodes if the operation happens at every node.
    every_node: Option<Vec<Spot>>,
    /// Value that counts in the objective (m, rad, share of failures, or cost of tolerances).
    value: f64,
    /// Value that must be within the limit.
    worst: f64,
}

/// Spot and values of every operation that is independent of a moved piece of equipment; None for any other
/// operation.
pub struct Uncarried(Vec<Option<OperationValue>>);

/// Memory that one thread reuses from judgement to judgement.
#[derive(Default)]
pub struct HeldMemory {
    overlaps: Vec<Overlap>,
    solids: PlacedSolids,
    misplacements: Misplacements,
    spots: JudgementMemory,
}

/// Memory for the judgement of the spots of one layout.
#[derive(Default)]
struct JudgementMemory {
    choice: SpotMemory,
    bounds: MapperWorkspace,
}

impl<'a> HeldLayout<'a> {
    /// Evaluates a layout and keeps its spots. Returns None if the layout is not feasible or misses a
    /// limit.
    pub fn new(workcell: &'a Workcell, layout: &'a Layout) -> Option<Self> {
        Self::holding(workcell, layout, &evaluate(workcell, layout))
    }

    /// Keeps the spots of an evaluated layout. Returns None if the layout is not feasible or misses a
    /// limit.
    pub fn holding(workcell: &'a Workcell, layout: &'a Layout, evaluation: &Evaluation) -> Option<Self> {
        let objective = evaluation.objective.filter(|_| evaluation.is_accepted())?;
        let found = |outcome: &Outcome| if let Outcome::Found(spot) = outcome { Some(*spot) } else { None };
        let all: Vec<Option<Spot>> = evaluation.outcomes.iter().map(found).collect();
        let placed = workcell.placed(layout);
        let held = |(k, spot): (usize, &Option<Spot>)| {
            if workcell.cell.operations[k].over.needs_every_node() {
                return Some(HeldSpot::EveryNode);
            }
            let Spot { node, branch, .. } = (*spot)?;
            let at = workcell.mapper.grid(k).local(node);
            Some(HeldSpot::Spot { node, posture: placed.hold(k, at, branch)? })
        };
        let spots = all.iter().enumerate().map(held).collect::<Option<Vec<_>>>()?;
        let posture = |spot: &HeldSpot| match spot {
            HeldSpot::Spot { posture, .. } => Some(*posture),
            HeldSpot::EveryNode => None,
        };
        let kept = spots.iter().map(posture).collect();
        let is_priced = workcell.cell.unit() == Unit::Cost;
        let price = is_priced.then(|| placed.nearby_price(&all, &mut MapperWorkspace::default())).flatten();
        Some(Self { workcell, layout, objective, spots, kept, price, own: OnceLock::new() })
    }

    /// Returns the workcell of the layout.
    pub fn workcell(&self) -> &'a Workcell {
        self.workcell
    }

    /// Returns the layout whose spots are kept.
    pub fn layout(&self) -> &'a Layout {
        self.layout
    }

    /// Judges another layout whose operations keep the spots of this layout. Returns the objective of the
    /// other layout (m, rad, share of failures, or cost of tolerances). A returned objective never exceeds
    /// `most`. If the objective is the cost of tolerances, the result may be an upper bound of the least
    /// cost.
    ///
    /// # Errors
    /// Returns the first reason why the layout is infeasible, misses a limit, or has an objective above
    /// `most`.
    pub fn judge(&self, layout: &Layout, most: f64, memory: &mut HeldMemory) -> Result<f64, Ending> {
        self.judged(layout, memory, |placed, memory| {
            Ok(Judgement { held: self, placed, most, known: None, is_estimate: false }.kept(memory)?.1)
        })
    }

    /// Estimates the result of [`Self::judge`] for a layout with one moved piece of equipment.
    ///
    /// `known` holds the values of the operations that are independent of this equipment. The estimate does
    /// not check whether the moved equipment obstructs these operations or the transfers.
    ///
    /// # Errors
    /// Returns the reason as [`Self::judge`] does.
    pub fn estimate_moved(
        &self,
        layout: &Layout,
        most: f64,
        Uncarried(known): &Uncarried,
        memory: &mut HeldMemory,
    ) -> Result<f64, Ending> {
        self.judged(layout, memory, |placed, memory| {
            Ok(Judgement { held: self, placed, most, known: Some(known), is_estimate: true }.kept(memory)?.1)
        })
    }

    /// Judges a layout with one moved piece of equipment like [`Self::judge`], but faster. The judgement
    /// begins with [`Self::estimate_moved`], and continues with the other operations and the transfers.
    ///
    /// # Errors
    /// Returns the reason as [`Self::judge`] does.
    pub fn judge_moved(
        &self,
        layout: &Layout,
        most: f64,
        Uncarried(known): &Uncarried,
        memory: &mut HeldMemory,
    ) -> Result<f64, Ending> {
        self.judged(layout, memory, |placed, memory| {
            let estimate = Judgement { held: self, placed, most, known: Some(known), is_estimate: true };
            let (values, _) = estimate.kept(memory)?;
            let is_carried = known.iter().map(Option::is_none);
            let carried: Vec<_> = values.into_iter().zip(is_carried).map(|(v, c)| c.then_some(v)).collect();
            let rest = Judgement { known: Some(&carried), is_estimate: false, ..estimate };
            Ok(rest.kept(memory)?.1)
        })
    }

    /// Returns the spot and the values of every operation that is independent of the equipment with the index
    /// `equipment`. The values are those of the layout whose spots are kept. Returns None if this layout is
    /// infeasible.
    pub fn uncarried(&self, equipment: usize, memory: &mut HeldMemory) -> Option<Uncarried> {
        let cell = &self.workcell.cell;
        let own = || {
            let most = f64::INFINITY;
            let found = self.judged(self.layout, memory, |placed, memory| {
                Judgement { held: self, placed, most, known: None, is_estimate: true }.values(memory)
            });
            found.ok().map(|(values, _)| values)
        };
        let values = self.own.get_or_init(own).as_ref()?;
        let depends = |k: usize| cell.rides_on(cell.operations[k].equipment, equipment);
        let carried = |k: usize| depends(k) || cell.operations[k].relative_to.is_some_and(depends);
        Some(Uncarried(values.iter().enumerate().map(|(k, v)| (!carried(k)).then(|| v.clone())).collect()))
    }

    /// Places a layout whose floor spaces do not overlap, and passes it to `judge`.
    ///
    /// # Errors
    /// Returns the first overlap of floor spaces, or the error of `judge`.
    fn judged<T>(
        &self,
        layout: &Layout,
        memory: &mut HeldMemory,
        judge: impl FnOnce(&PlacedLayout<'_>, &mut JudgementMemory) -> Result<T, Ending>,
    ) -> Result<T, Ending> {
        let HeldMemory { overlaps, solids, misplacements, spots } = memory;
        let workcell = self.workcell;
        if let Some(overlap) = first_overlap(workcell, layout, overlaps) {
            return Err(Ending::Overlap(overlap));
        }
        let demand = workcell.certifies().then(|| {
            misplacements.set(&workcell.cell, layout, workcell.cell.robot.reach());
            workcell.demand(misplacements)
        });
        let placed =
            PlacedLayout::reusing(&workcell.mapper, layout, std::mem::take(solids)).demanding(demand);
        let placed = placed.keeping(&self.kept);
        let found = judge(&placed, spots);
        *solids = placed.into_solids();
        found
    }
}

/// Returns the first overlap that makes a layout infeasible.
fn first_overlap(workcell: &Workcell, layout: &Layout, found: &mut Vec<Overlap>) -> Option<Overlap> {
    if workcell.certifies() {
        workcell.wide.overlaps(layout, found);
        if found.is_empty() {
            return None;
        }
        if let Some(overlap) = found.iter().find(|o| is_between_solids(o)) {
            return Some(*overlap);
        }
    }
    workcell.plan.overlaps(layout, found);
    found.first().copied()
}

/// Judgement of one placed layout with held spots.
#[derive(Clone, Copy)]
struct Judgement<'j, 'a> {
    held: &'j HeldLayout<'a>,
    placed: &'j PlacedLayout<'j>,
    /// Largest objective that is allowed.
    most: f64,
    /// Known value of each operation; an operation with a known value is not judged.
    known: Option<&'j [Option<OperationValue>]>,
    /// Whether the transfers between operations are left out.
    is_estimate: bool,
}

impl Judgement<'_, '_> {
    /// Returns the spot and the values of every operation, and the objective.
    ///
    /// # Errors
    /// Returns the first reason why the layout is infeasible, misses a limit, or has an objective above
    /// [`Self::most`].
    fn kept(&self, memory: &mut JudgementMemory) -> Result<(Vec<OperationValue>, f64), Ending> {
        let (values, objective) = self.values(memory)?;
        if objective > self.most {
            return Err(Ending::Objective);
        }
        let workcell = self.held.workcell;
        let worst: Vec<f64> = values.iter().map(|v| v.worst).collect();
        if workcell.priced(objective, &worst) != objective {
            let limits = workcell.cell.operations.iter().map(|o| o.limit);
            let misses = |(limit, worst): (Option<f64>, &f64)| limit.is_some_and(|limit| *worst > limit);
            return Err(Ending::Limit(limits.zip(&worst).position(misses).unwrap_or(0)));
        }
        Ok((values, objective))
    }

    /// Returns the spot and the values of every operation, and the objective. Limits are not checked.
    fn values(
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
        let is_unpriced = price.is_none() && self.held.workcell.cell.unit() == Unit::Cost;
        let price = if is_unpriced { self.placed.joint_price(&spots, bounds) } else { price };
        let objective = self.combined(&values);
        Ok((values, price.map_or(objective, |price| price.max(objective))))
    }

    /// Combines the values of the operations.
    fn combined(&self, values: &[OperationValue]) -> f64 {
        let values: Vec<f64> = values.iter().map(|v| v.value).collect();
        combined(&self.held.workcell.cell, &values)
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
                    let branch = posture.branch_elsewhere(self.held.workcell.inverse());
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
        if self.held.workcell.cell.unit() == Unit::Cost {
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
            self.placed.transfers(spots, &every).map_err(Ending::Transfer)?;
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
        SpotQuery { workcell: self.held.workcell, placed: self.placed, operation, spots }
    }

    /// Certifies a held spot, if a certificate is demanded. Returns the value that counts in the objective
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
