//! Does it hit: posed solids against posed solids. The only user of parry3d.
//!
//! parry3d runs in f64 here, so no margin for single precision is needed. A clearance is kept by
//! swelling the robot's solids by it once, at load (a ball swept over a convex solid is exact:
//! capsules, spheres and rounded boxes and cylinders), so that every test is a plain intersection
//! test. Touching counts as collision; floor spaces side by side may touch.

//!
//! Equipment meshes are asked triangle by triangle, so that verdicts are exact; one that is convex
//! becomes a solid polyhedron. Link meshes, which move, collide as convex parts that hold them. The
//! robot is checked against itself, the clearance aside.

mod bodies;
mod decomposition;
mod distance;
mod fence;
mod hit;
mod links;
mod own_pairs;
mod plan;
mod rod;
mod scene;
mod spacing;

pub use decomposition::Remember;
pub use distance::{ACCURACY, Load, Mover, Nearness, Pair};
pub use hit::{Hit, SolidRef};
pub use own_pairs::{Allowed, OwnPair};
pub use plan::{FloorPlan, Overlap, Party, Separation};
pub use scene::{ContactMemory, Placed, Scene};
pub use spacing::footprint;
