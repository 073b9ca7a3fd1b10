//! The robots that come with the program, built in so that they are known anywhere.

use crate::cell::{self, LoadedRobot, ReadFile};

/// Name and text of every file of cells/robots, in the order of names.
pub const ROBOTS: [(&str, &str); 4] = [
    ("hitachi_pw10", include_str!("../../cells/robots/hitachi_pw10.toml")),
    ("hitachi_pw10_parallelogram", include_str!("../../cells/robots/hitachi_pw10_parallelogram.toml")),
    ("ur10", include_str!("../../cells/robots/ur10.toml")),
    ("ur10e", include_str!("../../cells/robots/ur10e.toml")),
];

/// The text of a robot file by its name.
pub fn text(name: &str) -> Option<&'static str> {
    ROBOTS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// A robot of the library by its name.
pub fn robot(name: &str) -> Option<Result<LoadedRobot, Vec<cell::Fault>>> {
    text(name)?;
    let read: &mut ReadFile<'_> = &mut |path: &str| {
        let text = path.strip_suffix(".toml").and_then(text);
        text.map(str::to_string).ok_or_else(|| "the library has no such file".to_string())
    };
    Some(cell::load_robot(&format!("{name}.toml"), read))
}
