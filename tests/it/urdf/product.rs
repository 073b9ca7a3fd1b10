//! Independent reader of URDF files that multiplies transforms with quaternions, as a reference.

use crate::common::root;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};
use sweetspot::files;
use sweetspot::files::{Fault, Loaded};
use sweetspot::pose::Pose;

pub struct Joint {
    pub kind: String,
    pub child: String,
    pub origin: Isometry3<f64>,
    pub axis: Vector3<f64>,
}

/// Returns the joints of a URDF text, which must be in the order of the chain.
pub fn joints(text: &str) -> Vec<Joint> {
    let parts = text.split("<joint ").skip(1).map(|part| part.split("</joint>").next().unwrap());
    parts.map(joint).collect()
}

fn joint(part: &str) -> Joint {
    let after = |text: &str, key: &str| Some(text.split_once(key)?.1.split('"').next()?.to_string());
    let numbers = |tag: &str, key: &str| {
        let inside = part.split_once(tag).map(|(_, rest)| rest.split('>').next().unwrap().to_string());
        let words = inside.and_then(|inside| after(&inside, &format!("{key}=\"")));
        words.map(|w| Vector3::from_iterator(w.split_whitespace().map(|v| v.parse::<f64>().unwrap())))
    };
    let xyz = numbers("<origin", "xyz").unwrap_or_default();
    let rpy = numbers("<origin", "rpy").unwrap_or_default();
    let turn = UnitQuaternion::from_euler_angles(rpy.x, rpy.y, rpy.z);
    Joint {
        kind: after(part, "type=\"").unwrap(),
        child: after(part, "<child link=\"").unwrap(),
        origin: Isometry3::from_parts(Translation3::from(xyz), turn),
        axis: numbers("<axis", "xyz").unwrap_or(Vector3::x()),
    }
}

/// Returns the frame of every joint before its motion and the frame of its child link, in the base frame.
pub fn poses(joints: &[Joint], q: &[f64]) -> Vec<(Isometry3<f64>, Isometry3<f64>)> {
    let mut at = Isometry3::identity();
    let mut q = q.iter();
    let mut next = |joint: &Joint| {
        let before = at * joint.origin;
        let axis = Unit::new_normalize(joint.axis);
        at = before
            * match joint.kind.as_str() {
                "fixed" => Isometry3::identity(),
                "prismatic" => Isometry3::from(Translation3::from(axis.into_inner() * *q.next().unwrap())),
                _ => Isometry3::rotation(axis.into_inner() * *q.next().unwrap()),
            };
        (before, at)
    };
    joints.iter().map(&mut next).collect()
}

/// Returns the largest difference of two poses, in position (m) and in elements of the rotation matrix.
pub fn apart(ours: &Pose, theirs: &Isometry3<f64>) -> f64 {
    let turn = ours.rotation - theirs.rotation.to_rotation_matrix().into_inner();
    (ours.translation - theirs.translation.vector).norm().max(turn.amax())
}

/// Loads a cell with a robot of this URDF and the lines `lines` of the robot file. Also returns the requested
/// paths.
pub fn load(urdf: &str, axes: usize, lines: &str) -> (Result<Loaded, Vec<Fault>>, Vec<String>) {
    let zeros = format!("{:?}", vec![0.0; axes]);
    let robot = format!(
        "schema = \"sweetspot/robot/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\n\
         urdf = \"robots/arm.urdf\"\n{lines}\ntool = {{ position_mm = [0, 0, 0], axis = [1, 0, 0] }}\n\
         footprint = {{ size_mm = [80000, 80000] }}\n[errors.table-3]\nkind = \"signed\"\nsource = \"none\"\n\
         dr_mm = {zeros}\ndl_mm = {zeros}\ndalpha_deg = {zeros}\n"
    );
    let mut paths = Vec::new();
    let result = files::load("cell.toml", &mut |path: &str| {
        paths.push(path.to_string());
        match path {
            "cell.toml" => Ok("from = \"hitachi_paper.toml\"\n[robot]\nfrom = \"arm.toml\"\n".into()),
            "arm.toml" => Ok(robot.clone().into_bytes()),
            "robots/arm.urdf" => Ok(urdf.into()),
            _ => std::fs::read(root().join("cells").join(path)).map_err(|e| e.to_string()),
        }
    });
    (result, paths)
}
