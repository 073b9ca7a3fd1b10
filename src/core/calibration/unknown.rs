//! Parameters that a calibration identifies, and their prior standard deviations.

use crate::cell::{JointKind, MAX_JOINTS, Parameter};
use crate::kinematic_error::{ParameterSet, identifiable};
use crate::robot::{Chain, lever};
use crate::units::{m_from_mm, rad_from_deg};

/// Error parameter of a robot that a calibration identifies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// Error of a Denavit-Hartenberg row.
    Row(Parameter),
    /// Deflection of joint `joint` by weight that link `link` carries.
    ///
    /// The deflection is the value of the unknown (rad/m) times the horizontal lever of the link (m; see
    /// [`crate::robot::lever`]). The value is the compliance of the joint (rad/(N m)) times the weight (N) at
    /// and beyond the end of the link.
    Elastic { joint: usize, link: usize },
    /// Error of actuator `joint` that is periodic in the coordinate q of the actuator. The error is the value
    /// (rad) times `cos(order q)`, or `sin(order q)` if `sine` is true.
    Harmonic { joint: usize, order: usize, sine: bool },
}

/// Unknown with its value and standard deviations, all in m, rad or rad/m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identified {
    pub unknown: Unknown,
    pub value: f64,
    /// Prior standard deviation (before the measurement).
    pub prior: f64,
    /// Posterior standard deviation (after the measurement).
    pub sigma: f64,
}

impl Identified {
    /// Returns whether the data reduce the standard deviation of the parameter to less than half.
    pub fn is_identified(&self) -> bool {
        self.sigma < self.prior / 2.0
    }
}

/// A lever is ignored if it is below this share of the largest lever.
const SHORT_LEVER: f64 = 1.0 / 6.0;

/// Returns the unknowns of a chain, with the elastic terms if `elastic` is true.
///
/// A revolute joint has an elastic term for each link that it carries and whose lever is long. A lever is
/// long if it exceeds a sixth of the longest lever of the arm. The calibration also finds base and reflector
/// of every session. Base and reflector absorb some errors, which are therefore not unknowns. These are the
/// errors dq and dr of a revolute first joint. All errors of the last row are absorbed too, except dq of a
/// prismatic last joint.
pub fn unknowns(chain: &Chain, elastic: bool) -> Vec<Unknown> {
    let last = chain.axes() - 1;
    let is_free = |parameter: &Parameter| match *parameter {
        Parameter::Dq(i) | Parameter::Dr(i) if i == 0 => chain.links[i].kind != JointKind::Revolute,
        Parameter::Dq(i) => i != last || chain.links[i].kind != JointKind::Revolute,
        Parameter::Dr(i) | Parameter::Dl(i) | Parameter::Dalpha(i) | Parameter::Dbeta(i) => i != last,
        _ => false,
    };
    let rows = identifiable(chain, ParameterSet::FiveParameter).into_iter().filter(is_free);
    let rows = rows.map(Unknown::Row);
    match elastic {
        true => rows.chain(elastic_terms(chain)).collect(),
        false => rows.collect(),
    }
}

/// Number of sampled postures in which the levers of the links about the joints are compared.
const POSTURES: usize = 200;

fn elastic_terms(chain: &Chain) -> Vec<Unknown> {
    let axes = chain.axes();
    let mut longest = [[0.0_f64; MAX_JOINTS]; MAX_JOINTS];
    for k in 0..POSTURES {
        let frames = chain.frames(&chain.posture(&chain.halton_sample(k)));
        for joint in (0..axes).filter(|&j| chain.links[j].kind == JointKind::Revolute) {
            for (link, longest) in longest[joint].iter_mut().enumerate().take(axes).skip(joint) {
                *longest = longest.max(lever(&frames, joint, link).abs());
            }
        }
    }
    let short = SHORT_LEVER * longest.iter().flatten().fold(0.0_f64, |a, b| a.max(*b));
    let terms = (0..axes).flat_map(|joint| (joint..axes).map(move |link| (joint, link)));
    let terms = terms.filter(|&(joint, link)| longest[joint][link] > short);
    terms.map(|(joint, link)| Unknown::Elastic { joint, link }).collect()
}

impl Unknown {
    /// Returns whether the unknown is a coefficient of a periodic error.
    pub const fn is_harmonic(self) -> bool {
        matches!(self, Self::Harmonic { .. })
    }

    /// Returns the default prior standard deviation, m, rad or rad/m.
    ///
    /// The values are assumptions of this library: 0.5 mm for lengths, 0.5 degrees for joint zeros, 0.1
    /// degrees for twists, and 3 mrad/m for elastic terms. The value for a coefficient of a harmonic is 0.15
    /// mrad up to order 4, and 0.075 mrad above order 4.
    pub fn default_prior(self) -> f64 {
        match self {
            Self::Row(Parameter::Dr(_) | Parameter::Dl(_)) => m_from_mm(0.5),
            Self::Row(Parameter::Dq(_)) => rad_from_deg(0.5),
            Self::Row(_) => rad_from_deg(0.1),
            Self::Elastic { .. } => 3e-3,
            Self::Harmonic { order, .. } => expected_harmonic(order),
        }
    }
}

/// Largest order of the slow harmonics, whose coefficients are larger because encoders and gears are
/// eccentric or tilted.
const SLOW: usize = 4;
/// Expected standard deviation of a coefficient of a harmonic above order [`SLOW`] before the fit, rad.
const EXPECTED_HARMONIC: f64 = 7.5e-5;

/// Returns the prior standard deviation of one coefficient of this order, rad.
///
/// The values come from a real arm (results/measured).
pub(super) fn expected_harmonic(order: usize) -> f64 {
    if order <= SLOW { 2.0 * EXPECTED_HARMONIC } else { EXPECTED_HARMONIC }
}
