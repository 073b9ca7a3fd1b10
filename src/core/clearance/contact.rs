//! Contacts between two solids of a cell, and their description.

use crate::cell::Cell;

/// Reference to a solid of a cell, to the floor, to a wall of the fence or to a keep-out box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SolidRef {
    /// Index into [`crate::cell::Robot::solids`].
    Robot(usize),
    /// Index into [`Cell::operations`], and index of a solid of the part held during that operation.
    HeldPart(usize, usize),
    /// Index into [`Cell::equipment`], and index of the solid of that equipment.
    Equipment(usize, usize),
    Floor,
    /// Pedestal of the robot base.
    Pedestal,
    /// Wall of the fence. Wall k stands on the edge that starts at corner k of the fence.
    Fence(usize),
    /// Index into [`Cell::keep_out`].
    KeepOut(usize),
}

/// Contact between a solid of the robot and another solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Hit {
    pub solid: SolidRef,
    pub other: SolidRef,
}

impl SolidRef {
    /// Returns the name that the cell gives to the solid.
    pub fn in_words(self, cell: &Cell) -> String {
        match self {
            Self::Robot(k) => cell.robot.solids[k].solid.name.clone(),
            Self::HeldPart(operation, k) => cell.operations[operation].held.solids[k].name.clone(),
            Self::Equipment(e, s) => {
                let equipment = &cell.equipment[e];
                format!("{} ({})", equipment.name, equipment.solids[s].name)
            }
            Self::Floor => "the floor".into(),
            Self::Pedestal => "the pedestal".into(),
            Self::Fence(edge) => format!("wall {} of the fence", edge + 1),
            Self::KeepOut(k) => format!("keep-out {}", cell.keep_out[k].name),
        }
    }
}

impl Hit {
    /// Describes the contact with the names that the cell gives to the solids.
    pub fn in_words(&self, cell: &Cell) -> String {
        format!("{} touches {}", self.solid.in_words(cell), self.other.in_words(cell))
    }
}
