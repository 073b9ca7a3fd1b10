//! Presets: tolerances for classes of arms whose own tolerances are unknown.

use crate::cell::{Convention, Distribution, JointKind, Parameter, Robot, Spread};
use crate::kinematic_error::{ParameterSet, identifiable};
use crate::robot::Chain;
use crate::units::{m_from_mm, rad_from_deg};

/// Tolerances of a class of arms: one half width (three standard deviations) for every kind of parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorPreset {
    pub name: &'static str,
    /// Class of arms for which the preset is meant.
    pub class: &'static str,
    /// Half width of the error of the zero positions of revolute joints, degrees.
    pub zero_deg: f64,
    /// Half width of the error of the zero positions of prismatic joints, mm.
    pub zero_mm: f64,
    /// Half width of the errors of link lengths and axial offsets, mm.
    pub length_mm: f64,
    /// Half width of the errors of the twists, degrees. Between parallel axes, this half width also applies
    /// to the fifth parameter beta of Hayati ([`Parameter::Dbeta`]).
    pub twist_deg: f64,
    /// Source from which the tolerances are taken or estimated.
    pub source: &'static str,
}

/// Presets for all classes of arms.
///
/// Publications give the position error of whole arms, not the tolerances of their parameters. The ratios
/// of the tolerances are therefore our estimate in every preset.
pub const PRESETS: [ErrorPreset; 7] = [
    ErrorPreset {
        name: "collaborative",
        class: "collaborative six-axis arm without individual calibration",
        zero_deg: 0.08,
        zero_mm: 0.1,
        length_mm: 0.8,
        twist_deg: 0.08,
        source: "the predicted AP of a UR10 is 0.9 mm, and the measured mean errors of one UR10 were 0.7 to 1.0 mm (C. Landgraf et al., A Hybrid Neural Network Approach for Increasing the Absolute Accuracy of Industrial Robots, CASE 2021); the ratios of the tolerances are our estimate",
    },
    ErrorPreset {
        name: "small",
        class: "industrial six-axis arm for up to 10 kg",
        zero_deg: 0.05,
        zero_mm: 0.1,
        length_mm: 0.4,
        twist_deg: 0.04,
        source: "our estimate: smaller tolerances than in the preset `medium`, because the arm is shorter",
    },
    ErrorPreset {
        name: "medium",
        class: "industrial six-axis arm for 10 to 60 kg",
        zero_deg: 0.05,
        zero_mm: 0.1,
        length_mm: 0.6,
        twist_deg: 0.05,
        source: "the predicted AP of a PUMA 560 is 0.6 mm, near the linear position accuracy of 0.65 mm of an uncalibrated ABB IRB 1600 (M. Slamani, A. Nubiola, I. A. Bonev, Assessment of the positioning performance of an industrial robot, Industrial Robot 39(1), 2012); the ratios of the tolerances are our estimate",
    },
    ErrorPreset {
        name: "large",
        class: "industrial six-axis arm for more than 60 kg",
        zero_deg: 0.04,
        zero_mm: 0.2,
        length_mm: 1.0,
        twist_deg: 0.04,
        source: "our estimate, based on a mean error of about 1.2 mm that was measured on a KUKA KR210 (International Journal of Advanced Robotic Systems, 2020, doi 10.1177/1729881420921644). The estimate was not compared with measurements of an arm in the robot library of sweetspot",
    },
    ErrorPreset {
        name: "palletizer",
        class: "palletizer with four or five joints",
        zero_deg: 0.08,
        zero_mm: 0.2,
        length_mm: 1.5,
        twist_deg: 0.1,
        source: "our estimate: no published measurement was found; the predicted AP of an ABB IRB 460 is 1 mm",
    },
    ErrorPreset {
        name: "scara",
        class: "SCARA",
        zero_deg: 0.03,
        zero_mm: 0.05,
        length_mm: 0.2,
        twist_deg: 0.05,
        source: "our estimate: no published measurement was found; the predicted AP of an Adept Cobra s600 is 0.15 mm",
    },
    ErrorPreset {
        name: "research",
        class: "seven-axis research arm without individual calibration",
        zero_deg: 0.6,
        zero_mm: 0.5,
        length_mm: 2.0,
        twist_deg: 0.4,
        source: "the predicted AP of a Franka Panda is 3 mm; published errors of Franka and KUKA arms before calibration are of the order of 10 mm (G. Franzese et al., MUKCa, arXiv 2503.12584, 2025), but these errors include the errors of the fitted base and tool frames; sizes and ratios of the tolerances are our estimate",
    },
];

impl ErrorPreset {
    /// Returns the tolerances of a robot's parameters in the order of [`Parameter::of_robot`].
    ///
    /// Only parameters that a calibration can distinguish have a tolerance other than 0. Between parallel
    /// axes, the fifth parameter beta of Hayati ([`Parameter::Dbeta`]) replaces the axial offset.
    pub fn spreads(&self, robot: &Robot, chain: &Chain) -> Vec<Spread> {
        let known = identifiable(chain, ParameterSet::FiveParameter);
        let last = robot.axes().saturating_sub(1);
        // A cell file in the modified convention has no keys for l, alpha and beta of the last row in the
        // standard convention.
        let is_stated = |parameter: &Parameter| match parameter {
            Parameter::Dl(i) | Parameter::Dalpha(i) | Parameter::Dbeta(i) => {
                robot.convention == Convention::Standard || *i != last
            }
            _ => true,
        };
        let half = |parameter: &Parameter| match *parameter {
            Parameter::Dq(i) if robot.joints[i].is_passive() => 0.0,
            Parameter::Dq(i) if robot.joints[i].kind == JointKind::Prismatic => m_from_mm(self.zero_mm),
            Parameter::Dq(_) => rad_from_deg(self.zero_deg),
            Parameter::Dr(_) | Parameter::Dl(_) => m_from_mm(self.length_mm),
            _ => rad_from_deg(self.twist_deg),
        };
        let spread =
            |plus_minus| Spread { plus_minus, distribution: Distribution::Normal, sigmas: Spread::SIGMAS };
        let all = Parameter::of_robot(robot.axes());
        all.map(|p| spread(if known.contains(&p) && is_stated(&p) { half(&p) } else { 0.0 })).collect()
    }
}
