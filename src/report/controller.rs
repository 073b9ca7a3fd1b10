//! Work objects for robot controllers: frames of the equipment in the frame of the robot base, and spots.
//!
//! The terms base frame (of the robot) and task frame are those of ISO 9787. Manufacturers use
//! other names for the task frame: "base", "work object", "feature" or "user frame". Each controller
//! states rotations in its own way:
//!
//! | controller | rotation | matrix |
//! |---|---|---|
//! | KUKA KRL | A, B, C (degrees) about z, the rotated y and the twice rotated x | `Rz(A) Ry(B) Rx(C)` |
//! | ABB RAPID | unit quaternion q1 (scalar), q2, q3, q4 | |
//! | Universal Robots URScript | rotation vector rx, ry, rz (rad) | |
//! | FANUC | W, P, R (degrees) about the fixed x, then y, then z axis | `Rz(R) Ry(P) Rx(W)` |

use super::identifiers::{Identifiers, ascii};
use super::layout_frames::LayoutFrames;
use crate::pose::Pose;
use crate::units::{deg_from_rad, mm_from_m, rounded};

/// Language of a robot controller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Controller {
    Krl,
    Rapid,
    UrScript,
    Fanuc,
}

/// Comment lines that state the units, rotations and reference frames of KRL.
const KRL: [&str; 4] = [
    "X, Y, Z in mm. A, B, C in degrees: A about Z, then B about the rotated Y, then C about the twice rotated X.",
    "The values are relative to $ROBROOT, which equals $WORLD if $ROBROOT is zero.",
    "Use a frame as $BASE = $ROBROOT : base_NAME, or enter it as BASE_DATA[n] if $ROBROOT is zero.",
    "A spot is the frame of the TCP relative to base_NAME of the equipment on which the operation happens.",
];
/// Comment lines that state the units, rotations and reference frames of RAPID.
const RAPID: [&str; 4] = [
    "Positions in mm. Rotations as unit quaternions q1 to q4; q1 is the scalar part.",
    "A user frame is relative to the world frame: the values hold if the robot base frame is the world frame.",
    "The object frame of each work object is zero.",
    "A spot is the pose of the TCP in the work object of the equipment on which the operation happens.",
];
/// Comment lines that state the units, rotations and reference frames of URScript.
const URSCRIPT: [&str; 4] = [
    "Poses p[x, y, z, rx, ry, rz]: positions in m, rotation vectors in rad.",
    "The values are relative to the base feature of the controller. The frame base_link of ROS is rotated by 180",
    "degrees about z relative to the base feature.",
    "A spot is the pose of the TCP in its feature. In the base feature, it is pose_trans(feature_NAME, spot_NAME).",
];
/// Comment lines that state the units, rotations and reference frame of FANUC user frames.
const FANUC: [&str; 6] = [
    "X, Y, Z in mm. W, P, R in degrees: W about the fixed X, then P about the fixed Y, then R about the fixed Z.",
    "UFRAME is relative to the world frame of the controller. On most arms, its origin lies on axis J1 at the height",
    "of axis J2, not at the foot of the robot: subtract the height of that origin in the base frame from each Z.",
    "Enter the values by hand: MENU, SETUP, Frames, User Frame, DETAIL, METHOD, Direct Entry.",
    "A spot is the frame of the TCP in the user frame of the equipment on which the operation happens; the",
    "configuration of the joints is not part of the frame.",
];

/// Returns the file for a controller. All characters are ASCII.
///
/// Lengths have 4 decimals in mm or 7 in m. Angles have 6 decimals in degrees or 9 in rad. Quaternions have
/// 10 decimals. `stem` is the file name without its extension. KRL and RAPID modules are named after `stem`.
pub fn file(controller: Controller, stem: &str, frames: &LayoutFrames) -> String {
    let module = |longest: usize| {
        let prefix = if stem.starts_with(|c: char| c.is_ascii_alphabetic()) { "" } else { "cell_" };
        Identifiers::new(longest).give(prefix, stem)
    };
    match controller {
        Controller::Krl => {
            let mut names = Identifiers::new(24);
            let lines = entries(frames, &mut names, ["base_", "spot_"], |word, pose, _| {
                format!("DECL GLOBAL FRAME {word}={{{}}}", joined(["X", "Y", "Z", "A", "B", "C"], krl(pose)))
            });
            let (module, comment) = (module(24), comment("; ", frames, &KRL));
            let named = format!("; The controller needs this file under the name {module}.dat.\n");
            format!("DEFDAT {module} PUBLIC\n{comment}{named}{lines}ENDDAT\n").replace('\n', "\r\n")
        }
        Controller::Rapid => {
            let mut names = Identifiers::new(32);
            let lines = entries(frames, &mut names, ["wobj_", "spot_"], |word, pose, is_spot| {
                let pose = rapid(pose);
                match is_spot {
                    true => format!("  CONST pose {word} := {pose};"),
                    false => format!(
                        "  PERS wobjdata {word} := [FALSE, TRUE, \"\", {pose}, [[0, 0, 0], [1, 0, 0, 0]]];"
                    ),
                }
            });
            let (module, comment) = (module(32), comment("  ! ", frames, &RAPID));
            format!("MODULE {module}\n{comment}{lines}ENDMODULE\n").replace('\n', "\r\n")
        }
        Controller::UrScript => {
            let mut names = Identifiers::new(60);
            let lines = entries(frames, &mut names, ["feature_", "spot_"], |word, pose, _| {
                format!("global {word} = p[{}]", urscript(pose).join(", "))
            });
            comment("# ", frames, &URSCRIPT) + &lines
        }
        Controller::Fanuc => {
            let frame = |pose: &Pose| joined(["X", "Y", "Z", "W", "P", "R"], fanuc(pose));
            let bases = frames.in_base().enumerate().map(|(k, base)| {
                format!("UFRAME[{}] {}  ({})\n", k + 1, frame(&base.pose), ascii(&base.name))
            });
            let spots = frames.spots.iter().map(|spot| {
                let pose = frame(&frames.on_equipment(spot));
                format!("spot in UFRAME[{}] {pose}  ({})\n", spot.equipment + 1, ascii(&spot.operation))
            });
            comment("", frames, &FANUC) + "\n" + &bases.chain(spots).collect::<String>()
        }
    }
}

/// Returns the comment at the start of a file. The comment names cell, layout, robot, and the convention of
/// the controller. It also names the operations without a spot.
fn comment(mark: &str, frames: &LayoutFrames, convention: &[&str]) -> String {
    let LayoutFrames { cell, robot, layout, .. } = frames;
    let mut lines = vec![
        format!("Frames of the equipment in the frame of the robot base (ISO 9787); sweetspot {VERSION}."),
        format!("cell: {cell}"),
        format!("layout: {layout}"),
        format!(
            "robot: {robot}. The robot file defines its base frame; compare it with the base frame of the controller."
        ),
    ];
    lines.extend(frames.warning.map(String::from));
    lines.extend(convention.iter().map(|line| line.to_string()));
    let spotless = frames.spotless.iter();
    lines.extend(spotless.map(|operation| format!("operation {operation} has no spot in this layout")));
    lines.iter().map(|line| format!("{mark}{}\n", ascii(line))).collect()
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Returns one line for each work object and each spot.
///
/// `line` receives the identifier, the pose, and whether the pose belongs to a spot.
fn entries(
    frames: &LayoutFrames,
    names: &mut Identifiers,
    [base, spot]: [&str; 2],
    line: impl Fn(&str, &Pose, bool) -> String,
) -> String {
    let mut all = String::new();
    for frame in frames.in_base() {
        all += &(line(&names.give(base, &frame.name), &frame.pose, false) + "\n");
    }
    for found in &frames.spots {
        all += &(line(&names.give(spot, &found.operation), &frames.on_equipment(found), true) + "\n");
    }
    all
}

fn joined(keys: [&str; 6], values: [String; 6]) -> String {
    let pairs = keys.iter().zip(&values).map(|(key, value)| format!("{key} {value}"));
    pairs.collect::<Vec<_>>().join(", ")
}

/// Returns X, Y, Z, A, B, C of a KRL frame.
fn krl(pose: &Pose) -> [String; 6] {
    let [x, y, z] = millimetres(pose);
    let angles = pose.roll_pitch_yaw();
    let [c, b, a] = [angles.x, angles.y, angles.z].map(degrees);
    [x, y, z, a, b, c]
}

/// Returns X, Y, Z, W, P, R of a FANUC frame.
fn fanuc(pose: &Pose) -> [String; 6] {
    let [x, y, z] = millimetres(pose);
    let angles = pose.roll_pitch_yaw();
    let [w, p, r] = [angles.x, angles.y, angles.z].map(degrees);
    [x, y, z, w, p, r]
}

/// Returns the value of a RAPID pose: position, then quaternion.
fn rapid(pose: &Pose) -> String {
    let quaternion = pose.quaternion().map(|part| decimals(part, 10));
    format!("[[{}], [{}]]", millimetres(pose).join(", "), quaternion.join(", "))
}

/// Returns x, y, z, rx, ry, rz of a URScript pose.
fn urscript(pose: &Pose) -> [String; 6] {
    let (at, turn) = (pose.translation, pose.rotation_vector());
    let [x, y, z] = [at.x, at.y, at.z].map(|v| decimals(v, 7));
    let [rx, ry, rz] = [turn.x, turn.y, turn.z].map(|v| decimals(v, 9));
    [x, y, z, rx, ry, rz]
}

fn millimetres(pose: &Pose) -> [String; 3] {
    let at = pose.translation;
    [at.x, at.y, at.z].map(|v| decimals(mm_from_m(v), 4))
}

fn degrees(angle: f64) -> String {
    decimals(deg_from_rad(angle), 6)
}

fn decimals(value: f64, digits: usize) -> String {
    format!("{:.digits$}", rounded(value, digits as i32))
}
