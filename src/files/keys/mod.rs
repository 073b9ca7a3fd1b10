//! All keys of the files: one [`key::KeyTable`] for each kind of TOML table.
//!
//! The reader, the JSON Schemas and the reference for users all use these tables.

pub mod cell;
pub mod constraints;
pub mod costs;
pub mod equipment;
pub mod errors;
pub mod key;
pub mod operation;
pub mod parts;
pub mod range;
pub mod robot;
pub mod sense;
pub mod solid;
pub mod title_block;
pub mod unit;
pub mod word;
