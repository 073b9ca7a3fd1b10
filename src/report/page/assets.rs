//! What is built into the program: template, style and script of the pages.

/// The page with the sections of a report.
pub const REPORT: &str = include_str!("report.html");
pub const STYLE: &str = include_str!("report.css");
pub const SCRIPT: &str = include_str!("report.js");
