//! Propagation of parameter errors to the error of an operation, relative to the equipment on which the robot
//! works.

use super::effects::Effects;
use super::error_sources::ErrorSources;
use super::registration::BestFit;
use super::work_context::{WorkContext, WorkFrame};
use crate::cell::Model;
use crate::kinematic_error::{Expansion, FrameError, Perturbation, pose_error};
use crate::pose::{Displacement, Pose, SmallRotation};
use crate::robot::{Chain, Frames};
use nalgebra::Vector3;

/// Propagation of the errors of one robot, with an optional best fit of its base.
pub struct ErrorPropagation<'a> {
    pub chain: &'a Chain,
    pub sources: &'a ErrorSources,
    pub best_fit: Option<&'a BestFit>,
}

impl ErrorPropagation<'_> {
    /// Computes the first-order effects of the error sources on the TCP at a posture. The effects are
    /// relative to the equipment on which the robot works.
    ///
    /// If the operation places a picked part, the function subtracts the effects at the pick. Before that, it
    /// rotates the effects at the pick by the rotation of the part from the pick to this posture.
    pub fn effects(
        &self,
        context: &WorkContext,
        frames: &Frames,
        expansion: &mut Expansion,
        mean: bool,
        out: &mut Effects,
    ) {
        self.effects_at(&context.site, frames, expansion, mean, out);
        if let Some(reference) = &context.reference {
            let turn = frames.tcp.rotation * reference.frames.tcp.rotation.transpose();
            out.less(&reference.effects, |d| d.turned(&turn));
        }
    }

    /// Computes the first-order effects of the error sources on the TCP, relative to a work frame. The
    /// effects at a pick are not subtracted.
    pub fn effects_at(
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

    /// Prepares a signed sample for a model; `values` holds one value per source.
    pub fn sample(&self, values: &[f64], model: Model) -> PreparedSample {
        let errors = self.sources.perturbation(self.chain, values);
        let fitted = self.best_fit.map(|fit| fit.motion(&errors, model));
        let equipment = self.sources.equipment(values);
        PreparedSample { errors, fitted, equipment }
    }

    /// Returns the error of a sample at a posture, relative to the equipment on which the robot works.
    ///
    /// If the operation places a picked part, the error includes the displacement of the part in the gripper.
    /// The error at the pick causes this displacement.
    ///
    /// Do not call this function for the linear model; the errors of that model are sums of
    /// [`Self::effects`].
    pub fn error(
        &self,
        context: &WorkContext,
        frames: &Frames,
        sample: &PreparedSample,
        model: Model,
    ) -> Displacement {
        let placed = self.error_at(&context.site, frames, sample, model);
        let Some(reference) = &context.reference else { return placed };
        let picked = self.error_at(&reference.site, &reference.frames, sample, model);
        // In the gripper, the part is displaced by the inverse of the pick error. This displacement is
        // rotated to the present posture.
        let turn = frames.tcp.rotation * reference.frames.tcp.rotation.transpose();
        picked.inverse().turned(&turn).then(&placed)
    }

    /// Returns the error of a sample relative to a work frame; a pick is ignored.
    fn error_at(
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

/// Signed sample of all error sources, prepared for one model.
#[derive(Debug, Clone)]
pub struct PreparedSample {
    errors: Perturbation,
    /// Rigid motion that the best fit of the base finds for the sample; None without a best fit. The
    /// reference point is the centre of the fit.
    fitted: Option<Displacement>,
    /// Indices and frame errors of two pieces of equipment: first the work equipment, then the equipment from
    /// which the part was picked. An entry is None if the equipment has no frame error.
    equipment: [Option<(usize, FrameError)>; 2],
}

impl PreparedSample {
    /// Returns the parameter errors of the robot in this sample.
    pub fn errors(&self) -> &Perturbation {
        &self.errors
    }
}

/// Returns the displacement of the equipment at the point `p` (base frame, m) that the error of its frame
/// causes.
///
/// The equipment is rotated about x, y and z of its frame, in this order, and then translated.
fn work_moved(error: &FrameError, work: &Pose, p: &Vector3<f64>) -> Displacement {
    let arm = p - work.translation;
    let turns = (0..3).fold(SmallRotation::none(), |sum, k| {
        SmallRotation::about(&work.rotation.column(k).into_owned(), error.turns[k].angle).after(&sum)
    });
    let slide = work.rotation * Vector3::from(error.slides);
    Displacement { position: turns.moved(&arm) + slide, rotation: turns.vector() }
}
