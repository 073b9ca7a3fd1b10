//! All keys of the files: one table per kind of table, from which the reader reads, and from which the
//! JSON Schemas and the reference for people are made.

pub mod cell;
pub mod constraints;
pub mod equipment;
pub mod errors;
pub mod key;
pub mod operation;
pub mod parts;
pub mod range;
pub mod robot;
pub mod sense;
pub mod solid;
pub mod unit;
pub mod word;
