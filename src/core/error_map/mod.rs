//! Error map (section 3 of the seed paper): the error at every node of a work surface, and the node with the
//! least error.
//!
//! The seed paper is the journal paper from which this project grew. A [`PlacedLayout`] is a layout of a
//! cell together with its posed solids. The functions of `walk.rs` visit one node or every node, and judge
//! the postures there. The following items use these functions:
//!
//! - [`PlacedLayout::outcome`], for the search: the usable spot with the least error, or the combined value
//!   of all nodes;
//! - [`PlacedLayout::free_spots`], for the robust search: usable spots in ascending order of value;
//! - [`PlacedLayout::map`], for reports: every node with its posture and errors, or the reason why the node
//!   cannot be used;
//! - [`Probe`], for any point of the surface, including points between the nodes.
//!
//! Ranking (`simd`) orders nodes by a lower bound of their error, and the nodes are judged in this order.
//! The result is bit-identical to the result without ranking.

mod candidate;
mod certify;
mod configuration;
mod demand;
mod every_node;
mod extrapolation;
mod family_queue;
mod first_free;
mod free_spots;
mod grid;
mod held;
mod held_posture;
mod joint_price;
mod least_error;
mod map;
mod mapper;
mod node_ranking;
mod node_record;
mod node_sign;
mod operation_setup;
mod outcome;
mod placed_layout;
mod posture_order;
mod probe;
mod refined_posture;
mod simd;
mod spin_families;
mod teaching;
mod transfers;
mod value_field;
mod walk;
mod work_context;
mod workspace;
mod worst_node;

pub use configuration::{ConfigurationFlag, ConfigurationFlags, MAX_FLAGS};
pub use demand::Demand;
pub use extrapolation::{Extrapolation, contains_joint};
pub use grid::Grid;
pub use held_posture::{HeldPosture, PointSpot};
pub use mapper::Mapper;
pub use node_record::{NodeRecord, OperationMap, PostureRecord, Status};
pub use node_sign::NodeSign;
pub use outcome::{Outcome, Spot, Unjudged};
pub use placed_layout::PlacedLayout;
pub use posture_order::PostureOrder;
pub use probe::Probe;
pub use value_field::{PostureBounds, ValueField};
pub use workspace::{MapperWorkspace, WalkCounts};
