//! Fit of the base frame to the position errors over the working space.

use crate::cell::Model;
use crate::kinematic_error::{Perturbation, position_error};
use crate::robot::{Chain, Frames};
use nalgebra::{Matrix3, Vector3};

/// Number of postures to which the base frame is fitted.
const POSTURES: usize = 128;

/// Least-squares fit of a small rigid motion to the errors at sampled postures between the joint limits.
#[derive(Debug, Clone)]
pub struct BaseFit {
    frames: Vec<Frames>,
    /// Mean position of the TCP in the base frame, m.
    centre: Vector3<f64>,
    /// Pseudo-inverse of the mean inertia matrix of the positions about their centre, 1/m^2.
    inverse: Matrix3<f64>,
}

impl BaseFit {
    /// Prepares the fit of a chain.
    pub fn new(chain: &Chain) -> Self {
        let frames: Vec<Frames> =
            (0..POSTURES).map(|k| chain.frames(&chain.posture(&chain.halton_sample(k)))).collect();
        let centre = frames.iter().map(|f| f.tcp.translation).sum::<Vector3<f64>>() / POSTURES as f64;
        let inertia: Matrix3<f64> = frames
            .iter()
            .map(|f| {
                let r = f.tcp.translation - centre;
                Matrix3::identity() * r.norm_squared() - r * r.transpose()
            })
            .sum();
        let inertia = inertia / POSTURES as f64;
        // Points on one line leave the rotation about this line undetermined. The pseudo-inverse then gives
        // no rotation about the line.
        let inverse = inertia.pseudo_inverse(1e-12 * inertia.norm()).unwrap_or_else(|_| Matrix3::zeros());
        Self { frames, centre, inverse }
    }

    /// Returns the displacements (m) of the points `at` (base frame, m) under the fitted rigid motion. This
    /// motion is fitted to the position errors that `errors` causes at the sampled postures.
    pub fn displacements<const N: usize>(
        &self,
        errors: &Perturbation,
        at: &[Vector3<f64>; N],
    ) -> [Vector3<f64>; N] {
        let (mut mean, mut moment) = (Vector3::zeros(), Vector3::zeros());
        for frames in &self.frames {
            let moved = position_error(frames, errors, Model::Nonlinear);
            mean += moved;
            moment += (frames.tcp.translation - self.centre).cross(&moved);
        }
        let count = self.frames.len() as f64;
        let rotation = self.inverse * (moment / count);
        at.map(|p| mean / count + rotation.cross(&(p - self.centre)))
    }
}
