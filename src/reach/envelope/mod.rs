//! The working envelope: where an arm can hold its tool in an attitude, joint limits kept.
//!
//! A point belongs to it if [`Inverse::reaches`] says so: map, search and envelope ask the same judge. Collisions are no matter here. All in the base frame of the robot, m.

mod outline;
mod size;

pub use outline::{Outline, Region};
pub use size::{Extent, Size};

use crate::cell::{Attitude, JointKind, MAX_JOINTS};
use crate::pose::exact_sin_cos;
use crate::reach::kernel::Kernel;
use crate::reach::{Approach, Inverse, Shell};
use crate::robot::Posture;
use nalgebra::Vector3;
use outline::Lattice;

/// Nearer to the base axis than this (m) no direction can be told.
const ON_AXIS: f64 = 1e-3;

/// How finely an envelope is drawn.
#[derive(Clone, Copy)]
pub struct Fineness<'a> {
    /// Between the points asked, m: what is narrower may be missed.
    pub step: f64,
    /// By how much a crossing of the boundary may be off, m.
    pub tolerance: f64,
    /// Told how many points were asked since the last time, from any thread; [`Envelope::work`] of them.
    pub asked: &'a (dyn Fn(u64) + Sync),
}

/// One arm and one attitude of its tool.
pub struct Envelope<'a> {
    inverse: &'a Inverse,
    attitude: Attitude,
    approach: Approach,
    shell: Shell,
}

impl<'a> Envelope<'a> {
    /// `yaw`: turn (rad) of the surface that the attitude's azimuth counts from.
    pub fn new(inverse: &'a Inverse, attitude: &Attitude, yaw: f64) -> Self {
        let approach = inverse.approach(attitude, yaw);
        Self { inverse, attitude: attitude.clone(), approach, shell: inverse.shell(attitude) }
    }

    /// Whether the TCP can be here, m.
    pub fn has(&self, target: &Vector3<f64>) -> bool {
        self.inverse.reaches(target, &self.approach, &mut self.inverse.scratch())
    }

    /// A posture there, if there is one.
    pub fn posture(&self, target: &Vector3<f64>) -> Option<Posture> {
        let mut first = None;
        let mut scratch = self.inverse.scratch();
        self.inverse.visit(target, &self.approach, &mut scratch, |_, posture| {
            first.get_or_insert(*posture);
        });
        first
    }

    /// Azimuth (rad) in which the arm points with every joint in the middle of its range.
    pub fn middle(&self) -> f64 {
        let chain = &self.inverse.chain;
        let mut q = [0.0; MAX_JOINTS];
        q.iter_mut().zip(&chain.links).for_each(|(q, link)| *q = (link.limits.0 + link.limits.1) / 2.0);
        let tcp = chain.forward(&chain.posture(&q)).translation;
        let turning = chain.links.first().is_some_and(|link| link.kind == JointKind::Revolute);
        if turning && tcp.x.hypot(tcp.y) > ON_AXIS { tcp.y.atan2(tcp.x) } else { 0.0 }
    }

    /// The vertical plane through the base axis at an azimuth (rad): points (r, z), r < 0 behind the
    /// axis.
    pub fn section(&self, azimuth: f64, fine: &Fineness<'_>) -> Region {
        let (sin, cos) = exact_sin_cos(azimuth);
        self.upright(azimuth, fine.step)
            .region(fine.tolerance, fine.asked, |[r, z]| self.has(&Vector3::new(r * cos, r * sin, z)))
    }

    /// The horizontal plane at a height (m): points (x, y).
    pub fn plan(&self, height: f64, fine: &Fineness<'_>) -> Region {
        let at = |[x, y]: [f64; 2]| self.has(&Vector3::new(x, y, height));
        self.level(height, fine.step).region(fine.tolerance, fine.asked, at)
    }

    /// Points that a section, plans at these heights and [`Self::size`] ask, at a step (m).
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

    /// Whether the envelope is the same round the base axis, but for the limits of joint 1; exactly so:
    /// the first axis is the base axis and drives no other joint, and what is asked of the tool turns
    /// with it. Of an arm that tries a free angle in steps from a fixed direction that is so only where
    /// joint 1 makes whole turns and the tool is vertical.
    pub fn is_symmetric(&self) -> bool {
        let chain = &self.inverse.chain;
        let Some(first) = chain.links.first() else { return false };
        let upright = (chain.mount.rotation.column(2) - Vector3::z()).norm() < 1e-12;
        let central = chain.mount.translation.xy().norm() < 1e-12;
        let alone = chain.coupling.iter().skip(1).all(|row| row[0] == 0.0);
        let turns = first.kind == JointKind::Revolute;
        upright && central && alone && turns && self.attitude_turns()
    }

    fn attitude_turns(&self) -> bool {
        use crate::cell::{Azimuth, Spin};
        let (attitude, kernel) = (&self.attitude, &self.inverse.kernel);
        let free = match attitude.azimuth {
            Azimuth::Radial => true,
            _ if attitude.is_vertical() => attitude.spin == Spin::Free,
            azimuth => azimuth == Azimuth::Free,
        };
        match kernel {
            Kernel::Planar(_) => free,
            Kernel::Numeric(_) => free && size::turns_whole(self.inverse),
            Kernel::Pose(_) | Kernel::Locked(_) => {
                attitude.azimuth == Azimuth::Radial
                    || free && attitude.is_vertical() && size::turns_whole(self.inverse)
            }
        }
    }
}
