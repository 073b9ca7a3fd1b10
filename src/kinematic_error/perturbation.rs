//! The errors of every link, made ready for the walk along the chain.

use crate::cell::{JointKind, SignedErrors};
use crate::robot::Chain;

/// Errors of one link, eq. (4), with the differences of sines and cosines that they cause. The
/// differences come from half angles, so that no two nearly equal numbers are subtracted.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinkError {
    /// Of the D-H angle theta (rad) and the axial offset r (m), coupling included.
    pub dtheta: f64,
    pub dr: f64,
    /// m
    pub dl: f64,
    /// rad
    pub dalpha: f64,
    /// sin(dtheta) and cos(dtheta) - 1.
    pub sin_dtheta: f64,
    pub cos_dtheta_less_1: f64,
    /// cos(alpha + dalpha) - cos(alpha) and the same of the sine.
    pub dcos_alpha: f64,
    pub dsin_alpha: f64,
}

/// One signed sample of the errors, for one chain.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    pub links: Vec<LinkError>,
}

impl Perturbation {
    /// The error dq acts on the actuators: it reaches the D-H coordinates through the coupling.
    pub fn new(chain: &Chain, errors: &SignedErrors) -> Self {
        let link = |(i, link): (usize, &crate::robot::Link)| {
            let dq: f64 = chain.coupling[i].iter().zip(&errors.dq).map(|(c, q)| c * q).sum();
            let (dtheta, slide) = match link.kind {
                JointKind::Revolute => (dq, 0.0),
                JointKind::Prismatic => (0.0, dq),
            };
            let dalpha = errors.dalpha[i];
            let (sin_dalpha, cos_less_1) = (dalpha.sin(), cos_less_1(dalpha));
            LinkError {
                dtheta,
                dr: errors.dr[i] + slide,
                dl: errors.dl[i],
                dalpha,
                sin_dtheta: dtheta.sin(),
                cos_dtheta_less_1: self::cos_less_1(dtheta),
                dcos_alpha: link.cos_alpha * cos_less_1 - link.sin_alpha * sin_dalpha,
                dsin_alpha: link.sin_alpha * cos_less_1 + link.cos_alpha * sin_dalpha,
            }
        };
        Self { links: chain.links.iter().enumerate().map(link).collect() }
    }
}

/// cos(x) - 1 without cancellation.
fn cos_less_1(x: f64) -> f64 {
    let half = (x / 2.0).sin();
    -2.0 * half * half
}
