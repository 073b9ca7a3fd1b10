//! Tests robots from URDF files: the derived rows move like the URDF, the same robot gives the same map, and
//! hostile files do no harm.

mod chains;
mod faults;
mod hostile;
mod outline;
mod product;
mod same_map;
