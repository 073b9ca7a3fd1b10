//! Section 3 of the seed paper: the error at every node of a work surface, and the node with the
//! least error in a sense.
//!
//! [`Mapper::least_error`] is what the search asks: candidates in ascending error, collision asked
//! one by one until a node is free. [`Mapper::map`] is what people ask: every node with its posture
//! and errors, or the reason why not. Both walk the same branches and judge them alike. [`Probe`] asks
//! between the nodes.

mod at_point;
mod every_node;
mod free_spots;
mod grid;
mod mapper;
mod node;
mod node_sign;
mod outcome;
mod ranked;
mod ranking;
mod station;
mod way;
mod whole_map;

pub use at_point::{Kept, PointSpot, Probe};
pub use mapper::{Mapper, Scratch};
pub use node::{NodeRecord, OperationMap, PostureRecord, Status};
pub use node_sign::NodeSign;
pub use outcome::{Outcome, Spot, Unjudged};
