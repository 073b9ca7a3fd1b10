//! TOML documents as trees of values with their places: parsing, `from`, settings that override a file, and
//! readers of tables and values.

pub mod document;
pub mod from;
mod nesting;
mod quoted;
pub mod reader;
pub mod setting;
pub mod tree;
pub mod value;

pub use document::{ReadFile, Source};
pub use quoted::toml_string;
pub use setting::{Choices, Setting, of_setting};
