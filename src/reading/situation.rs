//! Where an operation happens under one layout, and the error seen from the work there.

use super::registration::{BestFit, Taught};
use super::{Effects, Gauge, Sources};
use crate::cell::Model;
use crate::kinematic_error::{Expansion, FrameError, Perturbation, pose_error};
use crate::pose::{Displacement, Pose, SmallRotation};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// The work of one operation under one layout.
#[derive(Debug, Clone)]
pub struct Site {
    pub equipment: usize,
    /// The equipment's frame in the base frame.
    pub work: Pose,
    /// Turns world axes into the base frame.
    pub world: Matrix3<f64>,
    /// How its frame was taught, if it was.
    pub taught: Option<Box<Taught>>,
}

/// The spot at which a part was picked before.
#[derive(Debug, Clone)]
pub struct Reference {
    pub site: Site,
    pub frames: Frames,
    pub effects: Effects,
}

impl Situation {
    /// Whether a target (base frame, m) was touched to teach the frame: what is left there says
    /// nothing of the surface, for it is nothing by the rule of the frame.
    pub fn touches(&self, target: &Vector3<f64>) -> bool {
        self.site.taught.as_ref().is_some_and(|taught| taught.touches(target))
    }

    /// Distance of a target (base frame, m) from the nearest point touched; infinite if none was.
    pub fn from_touched(&self, target: &Vector3<f64>) -> f64 {
        self.site.taught.as_ref().map_or(f64::INFINITY, |taught| taught.distance(target))
    }
}

impl Reference {
    /// A pick at `frames`, seen by the sources of the gauge that places.
    pub fn new(gauge: &Gauge, site: Site, frames: Frames) -> Self {
        let mut effects = Effects::default();
        let (theory, mean) = (gauge.theory(), gauge.takes_mean());
        theory.site_effects(&site, &frames, gauge.memory().expansion(), mean, &mut effects);
        Self { site, frames, effects }
    }
}

/// What an operation depends on besides its own posture.
#[derive(Debug, Clone)]
pub struct Situation {
    pub site: Site,
    pub reference: Option<Box<Reference>>,
}

/// What all operations share: the robot and the errors.
pub struct Theory<'a> {
    pub chain: &'a Chain,
    pub sources: &'a Sources,
    pub best_fit: Option<&'a BestFit>,
}

impl Theory<'_> {
    /// First-order effects at a posture, seen from the work.
    pub fn effects(
        &self,
        situation: &Situation,
        frames: &Frames,
        expansion: &mut Expansion,
        mean: bool,
        out: &mut Effects,
    ) {
        self.site_effects(&situation.site, frames, expansion, mean, out);
        if let Some(reference) = &situation.reference {
            let turn = frames.tcp.rotation * reference.frames.tcp.rotation.transpose();
            out.less(&reference.effects, |d| d.turned(&turn));
        }
    }

    /// The same without the pick.
    pub fn site_effects(
        &self,
        site: &Site,
        frames: &Frames,
        expansion: &mut Expansion,
        mean: bool,
        out: &mut Effects,
    ) {
        expansion.set(frames);
        out.set(self.sources, expansion, mean);
        if let Some(fit) = self.best_fit {
            let arm = fit.arm(frames);
            out.less(&fit.effects, |d| d.linear_at(&arm));
        }
        match &site.taught {
            Some(taught) => {
                let arm = taught.arm(frames);
                out.less(&taught.effects, |d| d.linear_at(&arm));
            }
            None => out.less_equipment(self.sources, site.equipment, &site.work, &frames.tcp.translation),
        }
    }

    /// A signed sample, one value per source, made ready.
    pub fn sample(&self, values: &[f64], model: Model) -> Sample {
        let errors = self.sources.perturbation(self.chain, values);
        let fitted = self.best_fit.map(|fit| fit.motion(&errors, model));
        let equipment = self.sources.equipment(values);
        Sample { errors, fitted, equipment }
    }

    /// The error of a sample at a posture, seen from the work; not for the linear model, whose
    /// errors are sums of [`Self::effects`].
    pub fn error(
        &self,
        situation: &Situation,
        frames: &Frames,
        sample: &Sample,
        model: Model,
    ) -> Displacement {
        let placed = self.site_error(&situation.site, frames, sample, model);
        let Some(reference) = &situation.reference else { return placed };
        let picked = self.site_error(&reference.site, &reference.frames, sample, model);
        // The part sits in the gripper displaced by the error of the pick, undone and carried here.
        let turn = frames.tcp.rotation * reference.frames.tcp.rotation.transpose();
        picked.inverse().turned(&turn).then(&placed)
    }

    fn site_error(&self, site: &Site, frames: &Frames, sample: &Sample, model: Model) -> Displacement {
        let mut error = pose_error(frames, &sample.errors, model);
        if let (Some(fit), Some(motion)) = (self.best_fit, &sample.fitted) {
            error = error.then(&motion.at(&fit.arm(frames)).inverse());
        }
        if let Some(taught) = &site.taught {
            return error.then(&taught.motion(&sample.errors, model).at(&taught.arm(frames)).inverse());
        }
        match sample.equipment.iter().flatten().find(|(e, _)| *e == site.equipment) {
            Some((_, moved)) => error.then(&work_moved(moved, &site.work, &frames.tcp.translation).inverse()),
            None => error,
        }
    }
}

/// A signed sample of everything that can be wrong.
#[derive(Debug, Clone)]
pub struct Sample {
    errors: Perturbation,
    /// What the best fit of the base makes of it, seen at the centre of the fit.
    fitted: Option<Displacement>,
    equipment: [Option<(usize, FrameError)>; 2],
}

impl Sample {
    /// The robot's part.
    pub fn errors(&self) -> &Perturbation {
        &self.errors
    }
}

/// What the error of the equipment's frame does to a point of the work: first its turns about x, y
/// and z, then its slides.
fn work_moved(error: &FrameError, work: &Pose, p: &Vector3<f64>) -> Displacement {
    let arm = p - work.translation;
    let turns = (0..3).fold(SmallRotation::none(), |sum, k| {
        SmallRotation::about(&work.rotation.column(k).into_owned(), error.turns[k].angle).after(&sum)
    });
    let slide = work.rotation * Vector3::from(error.slides);
    Displacement { position: turns.moved(&arm) + slide, rotation: turns.vector() }
}
