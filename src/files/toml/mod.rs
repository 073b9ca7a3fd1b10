//! TOML documents as trees of values with their places: parsing, `from`, settings that override a file, and
//! readers of tables and values.

pub mod document;
pub mod from;
mod nesting;
pub mod reader;
pub mod setting;
pub mod tree;
pub mod value;

pub use document::{ReadFile, Source};
pub use setting::{Choices, Setting, of_setting, toml_string};
