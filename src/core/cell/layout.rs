//! Layout of a cell: placements of robot base and equipment, and attitudes of the tool.

use super::attitude::{Attitude, Azimuth, Spin};
use super::coordinate::Coordinate;
use super::model::{Cell, Placement, PlacementTolerance};
use serde::{Deserialize, Serialize};

/// Address of a coordinate or an angle in a layout.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Slot {
    /// Coordinate of the robot base: 0 to 3 stand for x, y, z and yaw.
    Base(usize),
    /// Index of the equipment, then its coordinate: 0 to 3 stand for x, y, z and yaw.
    ///
    /// The coordinate is in the world frame, or in the frame of the equipment that carries this equipment.
    Equipment(usize, usize),
    /// Index of the operation, then the angle of its attitude: 0 to 2 stand for elevation, azimuth and spin.
    Attitude(usize, usize),
}

impl Slot {
    /// Returns whether the coordinate is an angle; otherwise it is a length.
    pub fn is_angle(self) -> bool {
        matches!(self, Slot::Base(3) | Slot::Equipment(_, 3) | Slot::Attitude(..))
    }
}

/// Candidate of a search: placements of robot base and equipment, and attitudes of the operations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// Placement of the robot base in the world.
    pub base: Placement,
    /// Placements of the equipment in the world, in the order of [`Cell::equipment`].
    pub placements: Vec<Placement>,
    /// Attitudes of the tool, in the order of [`Cell::operations`].
    pub attitudes: Vec<Attitude>,
}

impl Layout {
    /// Returns the value of a coordinate, m or rad.
    ///
    /// If the layout lacks the placement or the attitude, the result is the nominal value in the cell.
    pub fn value(&self, cell: &Cell, slot: Slot) -> f64 {
        match slot {
            Slot::Base(axis) => self.base.values()[axis],
            Slot::Equipment(k, axis) => cell.own_placement(self, k).values()[axis],
            Slot::Attitude(k, angle) => {
                let attitude = self.attitudes.get(k).unwrap_or(&cell.operations[k].attitude);
                match (angle, &attitude.azimuth, &attitude.spin) {
                    (0, ..) => attitude.elevation,
                    (1, Azimuth::Surface(azimuth), _) => *azimuth,
                    (2, _, Spin::At(spins)) => spins.first().copied().unwrap_or(0.0),
                    _ => 0.0,
                }
            }
        }
    }
}

impl Cell {
    /// Returns the nominal layout of the cell, in which free coordinates have their start values.
    pub fn start(&self) -> Layout {
        self.layout(|_, coordinate| coordinate.start())
    }

    /// Returns the layout in which every coordinate has the value that `value` returns for it, m or rad.
    pub fn layout(&self, mut value: impl FnMut(Slot, &Coordinate) -> f64) -> Layout {
        let mut four = |slot: &dyn Fn(usize) -> Slot, c: &[Coordinate; 4]| {
            Placement::from_values([0, 1, 2, 3].map(|axis| value(slot(axis), &c[axis])))
        };
        let base = four(&Slot::Base, &self.base);
        let equipment = self.equipment.iter().enumerate();
        let own: Vec<_> =
            equipment.map(|(k, e)| four(&|axis| Slot::Equipment(k, axis), &e.placement)).collect();
        let attitude = |(k, o): (usize, &super::model::Operation)| {
            let mut attitude = o.attitude.clone();
            let [elevation, azimuth, spin] = [0, 1, 2].map(|angle| {
                let coordinate = o.angles[angle].as_ref()?;
                Some(value(Slot::Attitude(k, angle), coordinate))
            });
            attitude.elevation = elevation.unwrap_or(attitude.elevation);
            attitude.azimuth = azimuth.map_or(attitude.azimuth, Azimuth::Surface);
            if let Some(spin) = spin {
                attitude.spin = Spin::At(vec![spin]);
            }
            attitude
        };
        let attitudes = self.operations.iter().enumerate().map(attitude).collect();
        let placements = (0..own.len()).map(|k| self.in_world(&own, k)).collect();
        Layout { base, placements, attitudes }
    }

    /// Returns every coordinate that the search may change, with the [`Slot`] that denotes it.
    pub fn free(&self) -> Vec<(Slot, &Coordinate)> {
        let base = self.base.iter().enumerate().map(|(axis, c)| (Slot::Base(axis), c));
        let equipment = self.equipment.iter().enumerate().flat_map(|(k, e)| {
            e.placement.iter().enumerate().map(move |(axis, c)| (Slot::Equipment(k, axis), c))
        });
        let attitudes = self.operations.iter().enumerate().flat_map(|(k, o)| {
            let angles = o.angles.iter().enumerate();
            angles.filter_map(move |(angle, c)| Some((Slot::Attitude(k, angle), c.as_ref()?)))
        });
        base.chain(equipment).chain(attitudes).filter(|(_, c)| c.is_free()).collect()
    }

    /// Returns the placement of a piece of equipment in the frame that the cell file uses.
    ///
    /// This is the frame of the equipment that carries the piece, or the world frame. If the layout does not
    /// place the piece, the result is the nominal placement of the piece.
    pub fn own_placement(&self, layout: &Layout, equipment: usize) -> Placement {
        let placed = |k: usize| layout.placements.get(k).copied();
        let drawn =
            || Placement::from_values(self.equipment[equipment].placement.each_ref().map(|c| c.start()));
        match self.equipment[equipment].on {
            Some(under) => placed(equipment).zip(placed(under)).map(|(at, under)| at.seen_from(&under)),
            None => placed(equipment),
        }
        .unwrap_or_else(drawn)
    }

    /// Returns the coordinates of robot base and equipment that have a tolerance, each with the half width
    /// (m, rad).
    ///
    /// The coordinates form one group for each body (robot base or piece of equipment) that has a tolerance.
    pub fn placement_tolerances(&self) -> Vec<Vec<(Slot, f64)>> {
        let off = |t: PlacementTolerance, slot: &dyn Fn(usize) -> Slot| {
            let axes = t.0.into_iter().enumerate().filter(|(_, half)| *half > 0.0);
            axes.map(|(axis, half)| (slot(axis), half)).collect::<Vec<_>>()
        };
        let base = off(self.base_tolerance, &Slot::Base);
        let equipment = self.equipment.iter().enumerate();
        let bodies = equipment.map(|(k, e)| off(e.tolerance, &|axis| Slot::Equipment(k, axis)));
        std::iter::once(base).chain(bodies).filter(|body| !body.is_empty()).collect()
    }

    /// Returns whether any body has a placement tolerance.
    pub fn has_placement_tolerance(&self) -> bool {
        !self.placement_tolerances().is_empty()
    }

    /// Returns the layout with `moves` (m, rad) added to its coordinates.
    ///
    /// Equipment that stands on moved equipment moves with it.
    pub fn misplaced(&self, layout: &Layout, moves: &[(Slot, f64)]) -> Layout {
        let mut moved = layout.clone();
        let off = |slot: Slot| moves.iter().filter(|(s, _)| *s == slot).map(|(_, by)| by).sum::<f64>();
        let by = |slot: &dyn Fn(usize) -> Slot| [0, 1, 2, 3].map(|axis| off(slot(axis)));
        let plus = |at: &Placement, by: [f64; 4]| {
            let v = at.values();
            Placement::from_values([0, 1, 2, 3].map(|axis| v[axis] + by[axis]))
        };
        moved.base = plus(&layout.base, by(&Slot::Base));
        // Each own placement is relative to the carrier, so `in_world` moves equipment with its carrier.
        let own: Vec<_> = (0..self.equipment.len())
            .map(|k| plus(&self.own_placement(layout, k), by(&|axis| Slot::Equipment(k, axis))))
            .collect();
        let stirred = |k: usize| {
            (0..own.len())
                .any(|under| self.rides_on(k, under) && by(&|axis| Slot::Equipment(under, axis)) != [0.0; 4])
        };
        for k in (0..own.len()).filter(|k| stirred(*k)) {
            if let Some(place) = moved.placements.get_mut(k) {
                *place = self.in_world(&own, k);
            }
        }
        moved
    }

    /// Returns whether a piece of equipment moves with `other`.
    ///
    /// This is true if the piece is `other` itself, or if it stands on `other`, directly or indirectly.
    pub fn rides_on(&self, equipment: usize, other: usize) -> bool {
        equipment == other || self.equipment[equipment].on.is_some_and(|under| self.rides_on(under, other))
    }

    fn in_world(&self, own: &[Placement], k: usize) -> Placement {
        match self.equipment[k].on {
            Some(under) => self.in_world(own, under).carrying(&own[k]),
            None => own[k],
        }
    }
}
