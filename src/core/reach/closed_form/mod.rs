//! Closed-form inverse kinematics, one file per family of arms or per mathematical tool.

pub(in crate::reach) mod anthropomorphic;
pub(in crate::reach) mod offset_wrist;
pub(in crate::reach) mod pieper;
pub(in crate::reach) mod planar;
pub(in crate::reach) mod positioning_arm;
pub(in crate::reach) mod quartic;
pub(in crate::reach) mod reach_section;
pub(in crate::reach) mod reversed_chain;
pub(in crate::reach) mod roots_on_circle;
pub(in crate::reach) mod scara;
pub(in crate::reach) mod spherical_wrist;
pub(in crate::reach) mod subproblems;
pub(in crate::reach) mod three_joint_point;
pub(in crate::reach) mod three_joints;
pub(in crate::reach) mod three_parallel;
