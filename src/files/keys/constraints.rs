//! Keys of `[margins]`, `[transfer]` and `[fence]`.

use super::key::*;
use super::parts::*;
use crate::cell::MAX_JOINTS;

/// List with one number for each joint.
pub const POSTURE: ValueKind = ValueKind::List(&FINITE, (1, MAX_JOINTS), "numbers");

key_table! {
    margins, "margins", "Least distance of postures from joint limits and singular postures.", {
        TURN = number_or_zero("joint_deg", NumberRange::NotNegative, "Least distance of the coordinate of a revolute joint from its limits. Default in a search for layouts to build: 2, or less if the joint has little travel. Default otherwise: 0.");
        SLIDE = number_or_zero("joint_mm", NumberRange::NotNegative, "Least distance of the coordinate of a prismatic joint from its limits. Default in a search for layouts to build: 2, or less if the joint has little travel. Default otherwise: 0.");
        SINGULARITY = number_or_zero("singularity", NumberRange::Below(1.0), "Least allowed singularity measure: the smallest singular value of the Jacobian, in which lengths are divided by the reach of the arm. Default in a search for layouts to build: 0.02. Default otherwise: 0.").example("0.02");
    }
}

key_table! {
    transfer, "transfer rules", "Collision check of two kinds of motions: from one operation to the next, and from one listed point of an operation to the next.", {
        CHECK = boolean("check", true, "Whether two kinds of motions are checked for collisions: from one operation to the next, and from one listed point of an operation to the next.");
        LIFT = number_or_zero("lift_mm", NumberRange::NotNegative, "Largest lift of the tool to pass over obstacles.");
        VIA = Key::new("via", ValueKind::Either(&[POSTURE, ValueKind::List(&POSTURE, (0, UNBOUNDED), "postures")]), "Via posture, or list of via postures, in degrees and mm; if left out, the home posture. If the direct motion and the lifted motion fail, motions through these postures are tried, one posture at a time.").example("[[0, 0, 0, 0], [90, -10, 10, 20.5]]");
        CYCLE = boolean("cycle", false, "Whether the motion from the last operation back to the first is checked.");
    }
}

key_table! {
    fence, "a fence", "Fence around the equipment and the robot base.", {
        POLYGON = Key::new("polygon_mm", ValueKind::List(&PLAN, (3, UNBOUNDED), "corners"), "Corners (x and y in the world frame), in their order along the fence; the last corner is joined to the first.").required().example("[[-2000, -1500], [2000, -1500], [2000, 2500], [-2000, 2500]]");
        HEIGHT = number("height_mm", NumberRange::Positive, "Height of walls that the robot must not touch; if left out, the fence is a line on the floor.").example("2200");
    }
}
