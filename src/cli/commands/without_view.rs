//! `view` in a build without the feature `view`: prints how to build the program with this feature.

use crate::cli::arguments::ViewArguments;
use crate::cli::{Exit, output};

/// Runs `sweetspot view`.
pub fn view(_: &ViewArguments) -> Result<Exit, Exit> {
    output::error("this build has no `view`");
    output::talk("  help: cargo install --path . --features view");
    Err(Exit::BadInput)
}
