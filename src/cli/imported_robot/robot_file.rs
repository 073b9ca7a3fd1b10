//! Text of the robot file for an imported URDF, with comments for the user.

use crate::cell::{JointKind, Robot};
use crate::files::{UrdfOutline, toml_string};
use crate::reach::Inverse;

/// Returns the name of the preset of tolerances that fits an arm best, guessed from its joints and reach.
pub fn guessed_preset(robot: &Robot, inverse: &Inverse) -> &'static str {
    let slides = robot.joints.iter().any(|joint| joint.kind == JointKind::Prismatic);
    let passive = robot.joints.iter().any(|joint| joint.is_passive());
    let reach = own_reach(robot);
    // An arm on a linear axis is judged by its other joints.
    let turning = robot.joints.iter().filter(|joint| joint.kind == JointKind::Revolute).count();
    match if robot.axes() > 6 { turning } else { robot.axes() } {
        3 | 4 if slides => "scara",
        _ if passive => "palletizer",
        7.. => "research",
        6 if inverse.family().starts_with("six axes with three parallel") => "collaborative",
        _ if reach < 1.1 => "small",
        _ if reach < 2.4 => "medium",
        _ => "large",
    }
}

/// Returns the reach of an arm, m, measured from its first joint. Slides count at their zero position,
/// because a linear axis does not make an arm larger.
pub fn own_reach(robot: &Robot) -> f64 {
    let mut robot = robot.clone();
    let slides = robot.joints.iter_mut().filter(|joint| joint.kind == JointKind::Prismatic);
    slides.for_each(|joint| joint.limits = (0.0, 0.0));
    robot.reach() - robot.mount.translation.xy().norm()
}

/// Returns the text of the robot file without its error sets. `footprint_mm` is the side of a guessed
/// footprint; None writes no footprint.
pub fn text(stem: &str, given: &str, outline: &UrdfOutline, footprint_mm: Option<f64>) -> String {
    let UrdfOutline { tip_link, last_joint, direction, .. } = outline;
    let numbers =
        direction.iter().map(|v| crate::units::rounded(*v, 9).to_string()).collect::<Vec<_>>().join(", ");
    let name = outline.name.clone().unwrap_or_else(|| stem.to_string());
    let guess = if outline.is_guessed {
        "GUESS: the last link of the longest chain of joints"
    } else {
        "Chosen with --tip"
    };
    let footprint = footprint_mm.map_or(String::new(), |side| {
        format!("\n# GUESS: floor space of the base, because the base link has no solids.\nfootprint = {{ size_mm = [{side}, {side}] }}\n")
    });
    format!(
        r#"#:schema ../schemas/robot.schema.json
# Written by `sweetspot init` from {given}. The URDF beside it is a lean copy: change this file instead.
schema = "sweetspot/robot/1"
units = {{ length = "mm", angle = "deg" }}
name = {}
source = {}
urdf = "{stem}.urdf"

# Link that carries the tool. {guess}.
tip_link = {}

# GUESS: a tool of length 0 along the axis of {}. State your own tool: position_mm is its TCP in the tip link,
# and axis its working direction.
tool = {{ position_mm = [0, 0, 0], axis = [{numbers}] }}
{footprint}
"#,
        toml_string(&name),
        toml_string(&format!("the URDF {given}")),
        toml_string(tip_link),
        crate::files::shown(last_joint),
    )
}
