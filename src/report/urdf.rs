//! What was made of a URDF, as JSON.

use crate::cell::Robot;

use crate::files::shown;
use crate::pose::Pose;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::{Rotation3, Vector3};
use serde_json::{Value, json};

/// Roll, pitch and yaw about fixed axes, rad: the turn of [`Pose::from_translation_rpy`].
pub fn roll_pitch_yaw(pose: &Pose) -> Vector3<f64> {
    let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(pose.rotation).euler_angles();
    Vector3::new(roll, pitch, yaw)
}

/// The derived rows of a robot and what of its URDF is not used; null for one of D-H rows.
pub fn derived(robot: &Robot) -> Value {
    let Some(origin) = &robot.urdf else { return Value::Null };
    let (mm, deg) = (|v| rounded(mm_from_m(v), 9), |v| rounded(deg_from_rad(v), 9));
    let pose = |p: &Pose| {
        let (at, turn) = (p.translation.map(mm), roll_pitch_yaw(p).map(deg));
        json!({ "position_mm": [at.x, at.y, at.z], "rpy_deg": [turn.x, turn.y, turn.z] })
    };
    let rows = robot.joints.iter().map(|j| {
        json!({ "joint": shown(&j.name), "theta_deg": deg(j.theta), "r_mm": mm(j.r), "l_mm": mm(j.l),
            "alpha_deg": deg(j.alpha), "passive": j.is_passive() })
    });
    let ignored: serde_json::Map<_, _> =
        origin.ignored.iter().map(|(what, n)| (shown(what), json!(n))).collect();
    json!({
        "file": shown(&origin.file), "base_link": shown(&origin.base_link), "tip_link": shown(&origin.tip_link),
        "base_to_frame_0": pose(&robot.mount), "rows": rows.collect::<Vec<_>>(),
        "last_frame_to_tip": pose(&origin.tip), "ignored": ignored,
    })
}
