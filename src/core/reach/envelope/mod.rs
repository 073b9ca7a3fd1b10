//! Working envelope: the points that the TCP can reach with the required tool attitude, within the joint
//! limits.
//!
//! A point belongs to the envelope if [`Inverse::reaches`] returns true for it. Collisions are ignored. All
//! points are in the base frame of the robot, m.

mod extent;
mod outline;
mod size;

pub use extent::EnvelopeExtent;
pub use outline::{EnvelopeSection, Outline};
pub use size::Size;

use crate::cell::{Attitude, JointKind, MAX_JOINTS};
use crate::pose::exact_sin_cos;
use crate::reach::solver::ChainSolver;
use crate::reach::{Cost, Inverse, Shell, ToolAttitudes};
use crate::robot::Posture;
use nalgebra::Vector3;
use outline::Lattice;
use std::f64::consts::TAU;

/// Distance from the base axis, m, below which the azimuth of a point is taken as 0.
const ON_AXIS: f64 = 1e-3;

/// Resolution at which an envelope is sampled.
#[derive(Clone, Copy)]
pub struct Fineness<'a> {
    /// Distance between sampled points, m; parts of the envelope narrower than this may be missed.
    pub step: f64,
    /// Largest error of the points on the boundary of the envelope, m.
    pub tolerance: f64,
    /// Function called from any thread with the number of points sampled since the last call.
    ///
    /// The sum of these numbers is [`Envelope::work`].
    pub on_progress: &'a (dyn Fn(u64) + Sync),
}

/// Working envelope of one arm for one attitude of its tool.
pub struct Envelope<'a> {
    inverse: &'a Inverse,
    attitude: Attitude,
    attitudes: ToolAttitudes,
    shell: Shell,
}

impl<'a> Envelope<'a> {
    /// Prepares an envelope.
    ///
    /// `yaw` (rad) is the rotation of the work surface in the base frame. Azimuths are measured from the x
    /// axis of this surface, unless the azimuth is radial.
    pub fn new(inverse: &'a Inverse, attitude: &Attitude, yaw: f64) -> Self {
        let attitudes = inverse.tool_attitudes(attitude, yaw);
        Self { inverse, attitude: attitude.clone(), attitudes, shell: inverse.shell(attitude) }
    }

    /// Returns whether the TCP can reach a point (m, base frame) with the required attitude.
    pub fn contains(&self, target: &Vector3<f64>) -> bool {
        self.inverse.reaches(target, &self.attitudes, &mut self.inverse.scratch())
    }

    /// Returns a posture whose TCP is at a point (m, base frame); None if no posture is found.
    pub fn posture(&self, target: &Vector3<f64>) -> Option<Posture> {
        let mut first = None;
        let mut scratch = self.inverse.scratch();
        self.inverse.visit(target, &self.attitudes, &mut scratch, |_, posture| {
            first.get_or_insert(*posture);
        });
        first
    }

    /// Returns the azimuth (rad) of the TCP when every joint is in the middle of its range.
    ///
    /// The azimuth is 0 if joint 1 is prismatic, or if the TCP is on the base axis in this posture.
    pub fn middle(&self) -> f64 {
        let chain = &self.inverse.chain;
        let mut q = [0.0; MAX_JOINTS];
        q.iter_mut().zip(&chain.links).for_each(|(q, link)| *q = (link.limits.0 + link.limits.1) / 2.0);
        let tcp = chain.forward(&chain.posture(&q)).translation;
        let turning = chain.links.first().is_some_and(|link| link.kind == JointKind::Revolute);
        if turning && tcp.x.hypot(tcp.y) > ON_AXIS { tcp.y.atan2(tcp.x) } else { 0.0 }
    }

    /// Returns the section of the envelope by a vertical plane through the base axis at an azimuth (rad).
    ///
    /// The points of the outline are (r, z): distance from the base axis and height, m. Points with r < 0 lie
    /// on the side of the axis opposite to the azimuth.
    pub fn section(&self, azimuth: f64, fine: &Fineness<'_>) -> EnvelopeSection {
        let (sin, cos) = exact_sin_cos(azimuth);
        self.upright(azimuth, fine.step).region(fine.tolerance, fine.on_progress, |[r, z]| {
            self.contains(&Vector3::new(r * cos, r * sin, z))
        })
    }

    /// Returns the section of the envelope by a horizontal plane at a height (m); its points are (x, y), m.
    pub fn plan(&self, height: f64, fine: &Fineness<'_>) -> EnvelopeSection {
        let at = |[x, y]: [f64; 2]| self.contains(&Vector3::new(x, y, height));
        self.level(height, fine.step).region(fine.tolerance, fine.on_progress, at)
    }

    /// Returns the number of points that are sampled to compute the requested sections and, if wanted, the
    /// size.
    ///
    /// The argument `sections` is the number of vertical sections. There is one horizontal section at each
    /// height in `heights` (m). The number includes the points of [`Self::size`] if `size` is true.
    pub fn work(&self, sections: u64, heights: &[f64], size: bool, step: f64) -> u64 {
        let plans: u64 = heights.iter().map(|z| self.level(*z, step).count()).sum();
        let size = if size { self.size_work(step) } else { 0 };
        sections * self.upright(self.middle(), step).count() + plans + size
    }

    fn upright(&self, azimuth: f64, step: f64) -> Lattice {
        let (sin, cos) = exact_sin_cos(azimuth);
        let centre = &self.shell.centre;
        Lattice::round([centre.x * cos + centre.y * sin, centre.z], self.shell.outer, step)
    }

    fn level(&self, height: f64, step: f64) -> Lattice {
        let (centre, outer) = (&self.shell.centre, self.shell.outer);
        let away = (height - centre.z).abs().min(outer);
        Lattice::round([centre.x, centre.y], (outer * outer - away * away).sqrt(), step)
    }

    /// Returns whether the envelope would be exactly symmetric about the base axis if joint 1 had no limits.
    ///
    /// Joint 1 must rotate about the base axis, and its axis may point upwards or downwards. Joint 1 must
    /// drive no other joint, and the required attitude must rotate with joint 1. For the numeric solver,
    /// joint 1 must also have a range of at least one turn.
    ///
    /// A solver for the full pose of the flange samples a free azimuth and a free spin. The sampled angles
    /// are measured from a fixed direction. For such a solver, more conditions apply unless the azimuth is
    /// [`Radial`](crate::cell::Azimuth::Radial). The tool must be exactly vertical. In addition, one of two
    /// conditions must hold:
    ///
    /// - Joint 1 has a range of at least one turn.
    /// - In every posture, the last joint alone can rotate the tool to at least one of the sampled spins.
    pub fn is_symmetric(&self) -> bool {
        let chain = &self.inverse.chain;
        let Some(first) = chain.links.first() else { return false };
        let upright = chain.mount.rotation.column(2).xy().norm() < 1e-12;
        let central = chain.mount.translation.xy().norm() < 1e-12;
        let alone = chain.coupling.iter().skip(1).all(|row| row[0] == 0.0);
        let turns = first.kind == JointKind::Revolute;
        upright && central && alone && turns && self.attitude_turns()
    }

    /// Returns whether the required attitude rotates with joint 1.
    fn attitude_turns(&self) -> bool {
        use crate::cell::{Azimuth, Spin};
        let (attitude, solver) = (&self.attitude, &self.inverse.solver);
        let free = match attitude.azimuth {
            Azimuth::Radial => true,
            _ if attitude.is_vertical() => attitude.spin == Spin::Free,
            azimuth => azimuth == Azimuth::Free,
        };
        match solver {
            ChainSolver::Planar(_) => free,
            ChainSolver::Numeric(_) => free && size::turns_whole(self.inverse),
            ChainSolver::Pose(_) | ChainSolver::Redundant(_) => {
                let is_upright = attitude.is_vertical() && attitude.tolerance == 0.0;
                let turns = size::turns_whole(self.inverse) || self.last_joint_spins_freely();
                attitude.azimuth == Azimuth::Radial || free && is_upright && turns
            }
        }
    }

    /// Returns whether the last joint alone can give the tool a sampled free spin in every posture of the
    /// other joints.
    ///
    /// The solver must be a closed form that leaves the spin to the last joint. The range of this joint must
    /// be at least as wide as the distance between neighbouring sampled spins.
    fn last_joint_spins_freely(&self) -> bool {
        let spacing = TAU / Attitude::free_spins().count() as f64;
        let width = self.inverse.chain.links.last().map(|link| link.limits.1 - link.limits.0);
        let is_closed_form = self.inverse.cost() == Cost::Middle;
        is_closed_form && self.inverse.last_joint.is_some() && width.is_some_and(|width| width >= spacing)
    }
}
