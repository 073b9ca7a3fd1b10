//! Collision checking between solids at given poses. No other module uses parry3d.
//!
//! - Broad phase: axis-aligned bounding boxes (`placed_solids`) and bounding capsules of the links
//!   (`bounding_capsule`).
//! - Narrow phase: closed forms for capsules against boxes, triangles and each other
//!   (`bounding_capsule`); parry3d for the pairs that the closed forms cannot decide (`scene`).
//! - Distances and bounding spheres serve continuous collision checking in [`crate::motion`].
//!
//! parry3d runs in f64 here, so no margin for single precision is needed. The robot's solids are enlarged
//! once, when the cell is loaded, so that no check has to add the clearance. The enlargement is the clearance
//! plus 1e-7 m (`TOUCHING` in `robot_solids`). Every check is then a plain intersection test. Enlarged
//! capsules, spheres, boxes and cylinders are exact, because parry3d has rounded shapes for them. Solids that
//! touch count as a collision, but a contact of floor spaces is allowed.
//!
//! A convex equipment mesh is checked as a convex polyhedron. Any other equipment mesh is checked triangle by
//! triangle. Both checks are exact. Because links move, each link mesh is checked as a set of convex parts
//! that together contain the mesh. The robot is checked against itself without the clearance. The pedestal is
//! an exception: the arm must keep the clearance from the sides of the pedestal.

mod arm_part;
mod bodies;
mod bounding_capsule;
mod bounding_sphere;
mod contact;
mod convex_decomposition;
mod distance;
mod fence;
mod floor_heights;
mod floor_plan;
mod floor_rectangle;
mod line_of_sight;
mod margin;
mod overlap;
mod pairs;
mod placed_solids;
mod robot_solids;
mod scene;
mod self_collision_pairs;
mod self_overlap;
mod spacing;

pub use arm_part::ArmPart;
pub use bounding_sphere::BoundingSphere;
pub use contact::{Hit, SolidRef};
pub use convex_decomposition::Remember;
pub use distance::{ACCURACY, LinkBounds, Nearness};
pub use floor_plan::{FloorPlan, Separation};
pub use margin::SolidMotion;
pub use overlap::{Overlap, Party};
pub use pairs::{Load, Pair};
pub use placed_solids::{ContactMemory, PlacedSolids};
pub use scene::Scene;
pub use self_collision_pairs::{Allowed, SelfCollisionPair};
pub use spacing::footprint;
