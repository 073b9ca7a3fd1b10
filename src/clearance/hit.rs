//! What touches what, in words.

use crate::cell::Cell;

/// A solid of a cell, or its floor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolidRef {
    /// Index into [`crate::cell::Robot::solids`].
    Robot(usize),
    /// Index into [`Cell::operations`] and the solids held there.
    Held(usize, usize),
    /// Index into [`Cell::equipment`] and its solids.
    Equipment(usize, usize),
    Floor,
    /// The wall along this edge of the fence, from its corner of the same number.
    Fence(usize),
}

/// A contact: a solid that the robot moves (or its base) and what it touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hit {
    pub solid: SolidRef,
    pub other: SolidRef,
}

impl SolidRef {
    /// Its name in the cell.
    pub fn in_words(self, cell: &Cell) -> String {
        match self {
            Self::Robot(k) => cell.robot.solids[k].solid.name.clone(),
            Self::Held(operation, k) => cell.operations[operation].held.solids[k].name.clone(),
            Self::Equipment(e, s) => {
                let equipment = &cell.equipment[e];
                format!("{} ({})", equipment.name, equipment.solids[s].name)
            }
            Self::Floor => "the floor".into(),
            Self::Fence(edge) => format!("wall {} of the fence", edge + 1),
        }
    }
}

impl Hit {
    /// In words, with the names of the cell.
    pub fn in_words(&self, cell: &Cell) -> String {
        format!("{} touches {}", self.solid.in_words(cell), self.other.in_words(cell))
    }
}
