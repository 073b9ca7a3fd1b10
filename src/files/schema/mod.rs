//! JSON Schemas and a Markdown reference of the keys of all files, made from the tables of keys that the
//! reader uses.

mod json;
mod merging;
mod reference;

use super::keys::cell::cell;
use super::keys::equipment::equipment;
use super::keys::key::KeyTable;
use super::keys::robot::{robot, tool};
pub use json::schema;
pub use reference::reference;

/// Kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileKind {
    Cell,
    Robot,
    Equipment,
    Tool,
}

impl FileKind {
    pub const ALL: [Self; 4] = [Self::Cell, Self::Robot, Self::Equipment, Self::Tool];

    /// Returns the word for the kind, such as `cell` in `schema = "sweetspot/cell/1"`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Cell => "cell",
            Self::Robot => "robot",
            Self::Equipment => "equipment",
            Self::Tool => "tool",
        }
    }

    /// Returns the keys at the top of a file of this kind.
    fn keys(self) -> &'static KeyTable {
        match self {
            Self::Cell => &cell::TABLE,
            Self::Robot => &robot::TABLE,
            Self::Equipment => &equipment::TABLE,
            Self::Tool => &tool::TABLE,
        }
    }
}
