//! Model of a workcell: robot, equipment, operations, and the interpretation of the errors.
//!
//! A [`Cell`] is plain data in m and rad. The reader of cell files validates each cell, so no other code
//! checks the cell again.

mod assumption;
mod attitude;
mod change;
mod choices;
mod constraints;
mod coordinate;
mod error_model;
mod goal;
mod iso_286;
mod layout;
mod misfit;
mod model;
mod parameter;
mod pedestal;
mod question;
mod rate_limits;
mod robot_model;
mod sense;
mod shape;
mod title_block;
mod tolerance_cost;

pub use assumption::StatedKeys;
pub use attitude::*;
pub use choices::*;
pub use constraints::*;
pub use coordinate::*;
pub use error_model::*;
pub use goal::*;
pub use iso_286::*;
pub use layout::*;
pub use misfit::{MAX_COORDINATE, Misfit};
pub use model::*;
pub use parameter::*;
pub use question::{About, Interpretation, QuestionFault};
pub use rate_limits::RateLimits;
pub use robot_model::*;
pub use sense::*;
pub use shape::*;
pub use title_block::{Projection, TitleBlock};
pub use tolerance_cost::*;
