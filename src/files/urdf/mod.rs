//! Reader of URDF files (the XML of ROS): converts a chain of links to standard D-H rows and solids.
//!
//! The reader uses only the joints and collision shapes of the chain from `base_link` to `tip_link`, and of
//! the links fixed to the chain. All other elements are counted, and one warning reports them. As in the URDF
//! format, lengths are in m and angles in rad.

mod dh;
mod fault_list;
mod lean;
mod model;
mod motion;
mod outline;
mod packages;
mod parse;
mod scan;
mod solids;
mod tip;
mod tree;
mod xml;

pub use lean::lean;
pub use model::Named;
pub use outline::{UrdfOutline, outline};
pub use packages::RosPackages;

use super::fault::{Severity, shown};
use super::toml::document::Library;
use super::toml::tree::At;
use crate::cell::*;
use crate::pose::Pose;
use model::Urdf;
use motion::Motion;
use tree::Tree;

/// Robot that was read from a URDF.
pub struct UrdfRobot {
    /// Name of the robot in the file, if it is a valid name.
    pub name: Option<String>,
    /// Pose of D-H frame 0 in the base link.
    pub mount: Pose,
    pub joints: Vec<Joint>,
    pub coupling: Vec<Vec<f64>>,
    pub solids: Vec<LinkSolid>,
    pub joint_frames: Vec<Pose>,
    pub origin: UrdfOrigin,
}

/// Chain of a URDF that a robot file requests.
pub struct UrdfChain {
    pub file: Named,
    /// Link that stands still. None means the root of the tree of links.
    pub base: Option<Named>,
    /// Link that carries the tool. None means the only link below the base that has no children.
    pub tip: Option<Named>,
    pub packages: RosPackages,
}

/// Reads the chain of a URDF that a robot file names. Warnings are marked as warnings from an import.
pub fn read(chain: UrdfChain, lib: &mut Library) -> Option<UrdfRobot> {
    let before = lib.faults.len();
    let robot = read_chain(chain, lib);
    lib.mark_import(before);
    robot
}

fn read_chain(chain: UrdfChain, lib: &mut Library) -> Option<UrdfRobot> {
    let UrdfChain { file: named, base, tip, packages } = chain;
    let at = named.at;
    let path = packages.path(&named, lib)?;
    let file = lib.text(&path, Some(at))?;
    let urdf = outline::parsed(file, lib)?;
    let tree = Tree::new(&urdf, lib)?;
    let end = |name: Option<Named>, lib: &mut Library<'_>| name.map(|name| tree.link(&name, lib));
    let (base, tip) = (end(base, lib), end(tip, lib));
    let way = tree.way(base, tip, at, lib)?;
    let motion = motion::read(&urdf, &way, lib)?;
    let derived = dh::derive(&motion.axes, &motion.flange);
    motion::warn_of_slants(&urdf, &way, &motion, &derived, lib);
    let carried = solids::carried(&urdf, &tree, &way, lib);
    let solids = solids::read(&urdf, &carried, &derived, &packages, lib);
    let ignored = solids::ignored(&urdf, &carried, &motion);
    tell_ignored(&ignored, urdf.at, lib);
    let link = |l: usize| urdf.links[l].name.name.clone();
    let (base_link, tip_link) = (link(way.base), link(way.tip));
    let origin = UrdfOrigin { file: path, base_link, tip_link, tip: derived.tip, ignored };
    Some(arm(&urdf, motion, derived, solids, origin))
}

fn arm(
    urdf: &Urdf,
    motion: Motion,
    derived: dh::Derived,
    solids: Vec<LinkSolid>,
    origin: UrdfOrigin,
) -> UrdfRobot {
    let kinds = motion.axes.iter().map(|axis| axis.kind);
    let coupling = motion.movers.iter().map(|m| m.coupling.clone()).collect();
    let joints = motion.movers.into_iter().zip(kinds).zip(&derived.rows).map(|((mover, kind), row)| {
        let (turn, slide) = match kind {
            JointKind::Revolute => (mover.offset, 0.0),
            JointKind::Prismatic => (0.0, mover.offset),
        };
        let (theta, r) = (row.theta + turn, row.r + slide);
        let rates = RateLimits { velocity: mover.velocity, acceleration: None };
        Joint { name: mover.name, kind, theta, r, l: row.l, alpha: row.alpha, limits: mover.limits, rates }
    });
    let (name, joints) = (urdf.name.clone(), joints.collect());
    let (mount, joint_frames) = (derived.mount, derived.joint_frames);
    UrdfRobot { name, mount, joints, coupling, solids, joint_frames, origin }
}

fn tell_ignored(ignored: &[(String, usize)], at: At, lib: &mut Library<'_>) {
    if ignored.is_empty() {
        return;
    }
    let counts: Vec<_> = ignored.iter().map(|(what, n)| format!("{n} {}", shown(what))).collect();
    let message = format!("elements of this URDF that are not used: {}", counts.join(", "));
    let help = "only joints and collision shapes of the chain from base to tip link are used";
    lib.fault(at, Severity::Warning, message, help);
}
