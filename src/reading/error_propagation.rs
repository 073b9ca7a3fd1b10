//! Propagation of parameter errors to the error of an operation, seen from the work.

use super::effects::Effects;
use super::error_sources::ErrorSources;
use super::registration::BestFit;
use super::work_context::{WorkContext, WorkFrame};
use crate::cell::Model;
use crate::kinematic_error::{Expansion, FrameError, Perturbation, pose_error};
use crate::pose::{Displacement, Pose, SmallRotation};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// What all operations share: the robot and the errors.
pub struct ErrorPropagation<'a> {
    pub chain: &'a Chain,
    pub sources: &'a ErrorSources,
    pub best_fit: Option<&'a BestFit>,
}

impl ErrorPropagation<'_> {
    /// First-order effects at a posture, seen from the work.
    pub fn effects(
        &self,
        situation: &WorkContext,
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
        site: &WorkFrame,
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
    pub fn sample(&self, values: &[f64], model: Model) -> PreparedSample {
        let errors = self.sources.perturbation(self.chain, values);
        let fitted = self.best_fit.map(|fit| fit.motion(&errors, model));
        let equipment = self.sources.equipment(values);
        PreparedSample { errors, fitted, equipment }
    }

    /// The error of a sample at a posture, seen from the work; not for the linear model, whose
    /// errors are sums of [`Self::effects`].
    pub fn error(
        &self,
        situation: &WorkContext,
        frames: &Frames,
        sample: &PreparedSample,
        model: Model,
    ) -> Displacement {
        let placed = self.site_error(&situation.site, frames, sample, model);
        let Some(reference) = &situation.reference else { return placed };
        let picked = self.site_error(&reference.site, &reference.frames, sample, model);
        // The part sits in the gripper displaced by the error of the pick, undone and carried here.
        let turn = frames.tcp.rotation * reference.frames.tcp.rotation.transpose();
        picked.inverse().turned(&turn).then(&placed)
    }

    fn site_error(
        &self,
        site: &WorkFrame,
        frames: &Frames,
        sample: &PreparedSample,
        model: Model,
    ) -> Displacement {
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
pub struct PreparedSample {
    errors: Perturbation,
    /// What the best fit of the base makes of it, seen at the centre of the fit.
    fitted: Option<Displacement>,
    equipment: [Option<(usize, FrameError)>; 2],
}

impl PreparedSample {
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
