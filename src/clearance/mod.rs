//! Does it hit: posed solids against posed solids. The only user of parry3d.
//!
//! parry3d runs in f64 here, so no margin for single precision is needed. A clearance is kept by
//! swelling the robot's solids by it once, at load (a ball swept over a convex solid is exact:
//! capsules, spheres and rounded boxes and cylinders), so that every test is a plain intersection
//! test. Touching counts as collision; floor spaces side by side may touch.

mod bodies;
mod plan;
mod scene;

pub use plan::{FloorPlan, Overlap, Party, Separation};
pub use scene::{Hit, Placed, Scene};
