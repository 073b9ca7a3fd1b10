//! Calibrations that a manufacturer or another program states, as errors of a robot.

use crate::cell::{PER_FRAME, SignedErrors};
use crate::pose::Pose;
use crate::robot::Chain;
use nalgebra::Rotation3;

/// Two axes count as different if their unit vectors differ by more than this value.
const OTHER_AXIS: f64 = 1e-9;

/// Returns an error set in which every error is 0.
pub fn no_errors(axes: usize) -> SignedErrors {
    let zeros = || vec![0.0; axes];
    SignedErrors {
        name: "measured".into(),
        dq: zeros(),
        dr: zeros(),
        dl: zeros(),
        dalpha: zeros(),
        dbeta: zeros(),
        base: [0.0; PER_FRAME],
        tool: [0.0; PER_FRAME],
        joints: vec![[0.0; PER_FRAME]; axes],
        elastic: Vec::new(),
        periodic: Vec::new(),
    }
}

/// Returns the joint frame errors with which a chain of Denavit-Hartenberg rows has the stated frames.
///
/// The z axis of joint frame k is the axis of the joint of row k. The frame moves with this joint.
/// `frames[k]` is the pose of joint frame k in joint frame k - 1 at coordinate 0 of joint k. `frames[0]` is
/// the pose of joint frame 0 in the base frame. The nominal value of `frames[k]` is `Tx(l) Rx(alpha)` of row
/// k - 1, followed by `Rz(theta) Tz(r)` of row k.
pub fn errors_of_frames(chain: &Chain, frames: &[Pose]) -> SignedErrors {
    let mut errors = no_errors(chain.axes());
    let mut before = Pose::IDENTITY;
    for ((k, link), frame) in chain.links.iter().enumerate().zip(frames) {
        let own = about_z(link.theta, link.r);
        let error = before.inverse() * *frame * own.inverse();
        let joint = chain.joint_frames[k];
        errors.joints[k] = components(&(joint.inverse() * error * joint));
        before = link.pose(1.0, 0.0, 0.0);
    }
    errors
}

/// Returns the nominal frames with which [`errors_of_frames`] compares the stated frames.
pub fn nominal_frames(chain: &Chain) -> Vec<Pose> {
    let mut before = Pose::IDENTITY;
    let frame = |link: &crate::robot::Link| {
        let frame = before * about_z(link.theta, link.r);
        before = link.pose(1.0, 0.0, 0.0);
        frame
    };
    chain.links.iter().map(frame).collect()
}

/// Returns the errors of joint frames and tool that transform one chain into another.
///
/// Both chains must come from URDF files. The function compares the frames of each joint relative to the
/// frame of the joint before it.
///
/// # Errors
///
/// Returns the index of the first joint whose axis, expressed in its own joint frame, differs between the
/// chains.
pub fn errors_between(nominal: &Chain, calibrated: &Chain) -> Result<SignedErrors, usize> {
    let mut errors = no_errors(nominal.axes());
    let [a, b] = [nominal, calibrated].map(frames_at_zero);
    let axis = |chain: &Chain, k: usize| chain.joint_frames[k].rotation.row(2).into_owned();
    for k in 0..nominal.axes() {
        if (axis(nominal, k) - axis(calibrated, k)).amax() > OTHER_AXIS {
            return Err(k);
        }
        errors.joints[k] = components(&change(&a, &b, k));
    }
    errors.tool = components(&change(&a, &b, nominal.axes()));
    Ok(errors)
}

/// Returns the change from frame k of `a` to frame k of `b`, in the axes of frame k of `a`. The frames before
/// frame k are assumed to coincide.
fn change(a: &[Pose], b: &[Pose], k: usize) -> Pose {
    let own = |all: &[Pose]| match k {
        0 => all[0],
        k => all[k - 1].inverse() * all[k],
    };
    own(a).inverse() * own(b)
}

/// Returns the frames of all joints, and of the TCP, in the base frame with all coordinates at 0.
fn frames_at_zero(chain: &Chain) -> Vec<Pose> {
    let frames = chain.frames(&chain.zero_posture());
    let joints = chain.joint_frames.iter().zip(&frames.links).map(|(joint, link)| *link * *joint);
    joints.chain([frames.tcp]).collect()
}

fn about_z(theta: f64, r: f64) -> Pose {
    Pose { rotation: super::deformed::about(2, theta), translation: nalgebra::Vector3::new(0.0, 0.0, r) }
}

/// Returns x, y, z (m) and rx, ry, rz (rad) of a pose `Trans(x, y, z) Rz(rz) Ry(ry) Rx(rx)`.
fn components(pose: &Pose) -> [f64; PER_FRAME] {
    let (rx, ry, rz) = Rotation3::from_matrix_unchecked(pose.rotation).euler_angles();
    let t = pose.translation;
    [t.x, t.y, t.z, rx, ry, rz]
}
