//! Robots from URDF files: the derived rows move as the URDF does, the same robot gives the same map,
//! and hostile files are refused.

mod chains;
mod faults;
mod hostile;
mod product;
mod same_map;
