//! Content of a URDF file as read, m and rad, before conversion to D-H rows.

use crate::files::toml::tree::At;
use crate::pose::Pose;
use nalgebra::Vector3;
use std::collections::BTreeMap;

/// Name read from a file, with its position in the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Named {
    pub name: String,
    pub at: At,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Urdf {
    pub at: At,
    pub name: Option<String>,
    pub links: Vec<UrdfLink>,
    pub joints: Vec<UrdfJoint>,
    /// Number of unused elements by their tag.
    pub ignored: BTreeMap<String, usize>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct UrdfLink {
    pub name: Named,
    pub collisions: Vec<Collision>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Collision {
    pub at: At,
    /// Pose in the frame of the link.
    pub pose: Pose,
    pub geometry: Geometry,
}

#[derive(Debug, Clone, PartialEq)]
pub enum Geometry {
    /// Box with its full edge lengths.
    Box(Vector3<f64>),
    /// Cylinder centred at the origin, with its axis along z.
    Cylinder {
        radius: f64,
        length: f64,
    },
    Sphere(f64),
    Mesh {
        file: Named,
        scale: Vector3<f64>,
    },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UrdfJointKind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
}

impl UrdfJointKind {
    pub const ALL: [Self; 6] =
        [Self::Revolute, Self::Continuous, Self::Prismatic, Self::Fixed, Self::Floating, Self::Planar];

    pub fn name(self) -> &'static str {
        match self {
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Fixed => "fixed",
            Self::Floating => "floating",
            Self::Planar => "planar",
        }
    }
}

#[derive(Debug, Clone, PartialEq)]
pub struct UrdfJoint {
    pub name: Named,
    pub kind: UrdfJointKind,
    pub parent: Named,
    pub child: Named,
    /// Frame of the joint at coordinate 0 in the frame of the parent link.
    pub origin: Pose,
    pub origin_at: At,
    /// Unit vector along the joint axis, in the frame of the joint.
    pub axis: Vector3<f64>,
    /// Limits as the file gives them, with the place of `<limit>`.
    pub limits: Option<(f64, f64, At)>,
    /// Maximum speed as the file gives it, rad/s or m/s, with its place.
    pub velocity: Option<(f64, At)>,
    pub mimic: Option<Mimic>,
}

/// Relation of a mimic joint: the coordinate is `multiplier` times the coordinate of `joint`, plus `offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Mimic {
    pub joint: Named,
    pub multiplier: f64,
    pub offset: f64,
}
