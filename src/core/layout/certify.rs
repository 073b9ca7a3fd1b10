//! Certificate of a layout: every operation works at every misplacement inside the placement tolerances.

use super::workcell::Workcell;
use crate::cell::Layout;
use crate::certificate::{Misplacements, NotCertified};
use crate::clearance::{Overlap, Party};
use crate::error_map::{Demand, HeldPosture, MapperWorkspace, OperationMap, Outcome, Spot};

/// Certificate of one operation at its spot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OperationCertificate {
    /// Upper bound of the value (m) of the operation over all misplacements; None if no bound is known.
    pub most: Option<f64>,
}

/// Certificate of a layout, or the reasons why there is no certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct LayoutCertificate {
    /// Pairs of floor spaces that may overlap, or come nearer than the clearance, at a misplacement inside
    /// the placement tolerances.
    pub overlaps: Vec<Overlap>,
    /// Certificate of each operation; None if the operation has no spot.
    pub operations: Vec<Option<Result<OperationCertificate, NotCertified>>>,
}

impl LayoutCertificate {
    /// Returns whether every operation is certified and [`Self::overlaps`] is empty.
    pub fn holds(&self) -> bool {
        self.overlaps.is_empty() && self.operations.iter().all(|o| matches!(o, Some(Ok(_))))
    }
}

impl Workcell {
    /// Certifies a layout, given its maps.
    ///
    /// If the layout does not belong to the cell, no operation has a certificate.
    pub fn certificate(&self, layout: &Layout, maps: &[OperationMap]) -> LayoutCertificate {
        if self.cell.misfit(layout).is_some() {
            return LayoutCertificate { overlaps: Vec::new(), operations: vec![None; maps.len()] };
        }
        let mut overlaps = Vec::new();
        self.wide.overlaps(layout, &mut overlaps);
        overlaps.retain(is_between_solids);
        let mut misplacements = Misplacements::default();
        misplacements.set(&self.cell, layout, self.cell.robot.reach());
        let demand = self.demand(&misplacements);
        let placed = self.placed(layout).demanding(Some(demand));
        let spots: Vec<Option<Spot>> = maps.iter().map(OperationMap::spot).collect();
        let mut memory = MapperWorkspace::default();
        let mut certify = |map: &OperationMap| {
            let operation = map.operation;
            let over = self.cell.operations[operation].over;
            let all = match over.needs_every_node() {
                false => {
                    let spot = map.spot()?;
                    if let Err(why) = placed.certify(operation, &spots, &spot, &demand, &mut memory) {
                        return Some(Err(why));
                    }
                    vec![spot]
                }
                // The certified posture of a node need not be its least-error posture.
                true => match placed.every_free(operation, &spots, &mut memory) {
                    Ok(all) => all,
                    Err(Outcome::Uncertain { why, .. }) => return Some(Err(why)),
                    Err(_) => return None,
                },
            };
            let demand = Demand { value: Some(&self.value_bounds[operation]), ..demand };
            let mut values = Vec::new();
            for spot in &all {
                match placed.most(operation, &spots, spot, &demand, &mut memory) {
                    Ok(most) => values.extend(most),
                    Err(why) => return Some(Err(why)),
                }
            }
            let most = (values.len() == all.len()).then(|| over.of(&mut values));
            Some(Ok(OperationCertificate { most }))
        };
        let operations = maps.iter().map(&mut certify).collect();
        LayoutCertificate { operations, overlaps }
    }

    /// Returns whether the operation certainly works at every misplacement within the tolerances, in the
    /// postures of [`Self::held_nodes`]. If there is a limit, the value must also certainly stay within it.
    pub(super) fn holds_within(
        &self,
        layout: &Layout,
        map: &OperationMap,
        spots: &[Option<Spot>],
        limit: Option<f64>,
    ) -> bool {
        let mut overlaps = Vec::new();
        self.wide.overlaps(layout, &mut overlaps);
        if overlaps.iter().any(is_between_solids) {
            return false;
        }
        let mut misplacements = Misplacements::default();
        misplacements.set(&self.cell, layout, self.cell.robot.reach());
        let operation = map.operation;
        let demand = Demand { value: Some(&self.value_bounds[operation]), ..self.demand(&misplacements) };
        let (placed, mut memory) = (self.placed(layout), MapperWorkspace::default());
        let mut bound = |spot: Spot| {
            placed.certify(operation, spots, &spot, &demand, &mut memory).ok()?;
            match limit {
                None => Some(0.0),
                Some(_) => placed.most(operation, spots, &spot, &demand, &mut memory).ok()?,
            }
        };
        let most: Option<Vec<f64>> = self.shown_spots(map).map(&mut bound).collect();
        let over = self.cell.operations[operation].over;
        most.is_some_and(|mut most| limit.is_none_or(|limit| over.of(&mut most) <= limit))
    }

    /// Returns the postures of an operation at its spot, or at all of its nodes if the operation happens at
    /// every node.
    pub(super) fn held_nodes(&self, layout: &Layout, map: &OperationMap) -> Vec<HeldPosture> {
        let (placed, grid) = (self.placed(layout), self.mapper.grid(map.operation));
        let hold = |spot: Spot| placed.hold(map.operation, grid.local(spot.node), spot.branch);
        self.shown_spots(map).filter_map(hold).collect()
    }

    /// Returns the postures that the map shows at the spot of its operation, or at all of its nodes if the
    /// operation happens at every node.
    fn shown_spots<'m>(&self, map: &'m OperationMap) -> impl Iterator<Item = Spot> + use<'m> {
        let all = self.cell.operations[map.operation].over.needs_every_node();
        let nodes = map.nodes.iter().enumerate().filter(move |(k, _)| all || map.best == Some(*k));
        nodes.filter_map(|(node, record)| {
            let posture = record.posture.as_ref()?;
            Some(Spot { node, branch: posture.branch, value: posture.value })
        })
    }
}

/// Returns whether neither party of an overlap is the floor. A misplacement never moves equipment into the
/// floor. If equipment is misplaced downwards, it is assumed to stand on a lower floor.
pub fn is_between_solids(overlap: &Overlap) -> bool {
    ![overlap.a, overlap.b].contains(&Party::Floor)
}
