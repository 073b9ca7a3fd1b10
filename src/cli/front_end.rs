//! Parts of the command line that another front end of the library uses, such as the Python package.
//!
//! None of these parts prints anything.

pub use super::arguments::{ErrorFlags, QuestionFlags, SearchArguments, StoppingFlags};
pub use super::cache::remember;
pub use super::imported_robot::read_robot_or_urdf;
pub use super::library::{ROBOTS, robot};
pub use super::loading::{FileSnapshot, read_cell_with, replace, sha256, without_import};
pub use super::packages::PackageFolders;
#[cfg(feature = "view")]
pub use super::view::{BackgroundView, Origin, open_in_browser};
