//! Parameters of a robot or of a frame that can have an error, and their order.

/// Number of error parameters of one link: dq, dr, dl, dalpha and dbeta.
pub const PER_LINK: usize = 5;

/// Number of components of a frame error: x, y, z (m), then rx, ry, rz (rad).
///
/// The erroneous frame is the nominal frame times `Trans(x, y, z) Rz(rz) Ry(ry) Rx(rx)`.
pub const PER_FRAME: usize = 6;

/// Parameter that can have an error.
///
/// Links, joints and equipment are given by index from 0. Components of a frame are 0 to 5: x, y, z, rx, ry,
/// rz.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parameter {
    /// Actuator coordinate of a joint. The joint coupling passes an error of this coordinate on to the
    /// Denavit-Hartenberg coordinates.
    Dq(usize),
    /// Axial offset r of a link.
    Dr(usize),
    /// Common normal l of a link.
    Dl(usize),
    /// Twist alpha of a link.
    Dalpha(usize),
    /// Fifth parameter beta of a link (Hayati): a rotation about the y axis after the twist.
    Dbeta(usize),
    /// Component of the error of the robot's base frame, in the axes of that frame.
    Base(usize),
    /// Component of the error of the tool frame (TCP), in the axes of that frame.
    Tool(usize),
    /// Component of the error of a joint frame ([`super::Robot::joint_frames`]), in the axes of that frame.
    /// The first index is the joint, and the second index is the component.
    ///
    /// The error moves this joint and everything after it in the chain.
    Joint(usize, usize),
    /// Deflection of a revolute joint per horizontal lever of a link that it carries, rad/m
    /// ([`crate::robot::lever`]). The first index is the joint, and the second index is the link.
    ///
    /// The deflection grows with the posture-dependent lever. The parameter is the compliance of the joint
    /// times the weight of all masses at and after the end of the link.
    Elastic(usize, usize),
    /// Compliance of a revolute joint, rad/(N m), which multiplies the gravity torque of all masses that the
    /// joint carries ([`crate::robot::gravity_torque`]).
    Compliance(usize),
    /// Dimensionless factor of the periodic error of a revolute joint ([`super::SignedErrors::periodic`]); the
    /// factor 1 gives the full error. The stored index is that of the joint.
    Periodic(usize),
    /// Component of the error of the frame of a piece of equipment, in the axes of that frame.
    /// The first index is the equipment, and the second index is the component.
    Equipment(usize, usize),
}

impl Parameter {
    /// Returns the parameters of a robot with `axes` joints, in the order that all lists of parameter values
    /// use.
    ///
    /// The order is link by link, then base, then tool, then joint frame by joint frame, then the elastic
    /// parameters.
    pub fn of_robot(axes: usize) -> impl Iterator<Item = Parameter> {
        let links = (0..axes).flat_map(|i| {
            [Self::Dq(i), Self::Dr(i), Self::Dl(i), Self::Dalpha(i), Self::Dbeta(i)].into_iter()
        });
        let joints = (0..axes).flat_map(|i| (0..PER_FRAME).map(move |c| Self::Joint(i, c)));
        let frames = (0..PER_FRAME).map(Self::Base).chain((0..PER_FRAME).map(Self::Tool));
        links.chain(frames).chain(joints).chain(Self::elastic(axes))
    }

    /// Returns the elastic parameters of a robot with `axes` joints: the elastic terms joint by joint, the
    /// compliances, then the factors of periodic errors. Each joint has one elastic term per link that it
    /// carries.
    pub fn elastic(axes: usize) -> impl Iterator<Item = Parameter> {
        let terms =
            (0..axes).flat_map(move |joint| (joint..axes).map(move |link| Self::Elastic(joint, link)));
        terms.chain((0..axes).map(Self::Compliance)).chain((0..axes).map(Self::Periodic))
    }

    /// Returns the name of this parameter as it is written in files. Some examples are `dl2`, `base rx`,
    /// `joint3 rx` and `elastic 2 3`.
    ///
    /// For a parameter of equipment, the result is the name of the component alone.
    pub fn name(self) -> String {
        match self {
            Self::Dq(i) => format!("dq{}", i + 1),
            Self::Dr(i) => format!("dr{}", i + 1),
            Self::Dl(i) => format!("dl{}", i + 1),
            Self::Dalpha(i) => format!("dalpha{}", i + 1),
            Self::Dbeta(i) => format!("dbeta{}", i + 1),
            Self::Base(c) => format!("base {}", COMPONENTS[c]),
            Self::Tool(c) => format!("tool {}", COMPONENTS[c]),
            Self::Joint(i, c) => format!("joint{} {}", i + 1, COMPONENTS[c]),
            Self::Elastic(joint, link) => format!("elastic {} {}", joint + 1, link + 1),
            Self::Compliance(joint) => format!("compliance {}", joint + 1),
            Self::Periodic(joint) => format!("periodic {}", joint + 1),
            Self::Equipment(_, c) => COMPONENTS[c].to_string(),
        }
    }

    /// Returns the index of the joint that an elastic parameter deflects.
    ///
    /// For any other parameter, the result is 0 and has no meaning.
    pub const fn deflected_joint(self) -> usize {
        match self {
            Self::Elastic(joint, _) | Self::Compliance(joint) | Self::Periodic(joint) => joint,
            _ => 0,
        }
    }

    /// Returns whether the effect of the parameter is a joint deflection that depends on the posture.
    pub const fn is_elastic(self) -> bool {
        matches!(self, Self::Elastic(..) | Self::Compliance(_) | Self::Periodic(_))
    }

    /// Returns the index of the first joint-frame parameter, which follows the parameters of links, base and
    /// tool.
    pub const fn first_joint(axes: usize) -> usize {
        PER_LINK * axes + 2 * PER_FRAME
    }

    /// Returns the index of the first elastic parameter, which follows the parameters of the joint frames.
    pub const fn first_elastic(axes: usize) -> usize {
        Self::first_joint(axes) + PER_FRAME * axes
    }

    /// Returns the number of parameters of a robot with `axes` joints.
    pub const fn count(axes: usize) -> usize {
        Self::first_elastic(axes) + axes * (axes + 1) / 2 + 2 * axes
    }
}

/// Names of the components of a frame error.
pub const COMPONENTS: [&str; PER_FRAME] = ["x", "y", "z", "rx", "ry", "rz"];
