//! Tools and held parts.

use super::parts::*;
use super::solid::{rpy, solids, vector};
use crate::files::toml::value::Must;
use serde_json::{Value, json};

pub fn file() -> Value {
    of_file(tool())
}

/// A tool, in its file or in the robot.
pub fn tool() -> Value {
    let [schema, units] = header("tool");
    table(
        "The tool: its TCP, working direction and solids, in the mechanical interface (the frame after the last row).",
        [
            (
                "from",
                path(
                    "The tool file that this one builds on; what stands here wins.",
                    "equipment/gripper.toml",
                ),
            ),
            schema,
            units,
            ("name", text("What the tool is called.")),
            ("source", text("Where its numbers come from.")),
            (
                "position_mm",
                example(vector("The tool centre point (TCP), mm.", Must::BeFinite), json!([0, 0, 160])),
            ),
            ("rpy_deg", rpy()),
            (
                "axis",
                direction(example(
                    vector(
                        "The working direction in the frame of the TCP; any length but 0.",
                        Must::BeFinite,
                    ),
                    json!([0, 0, 1]),
                )),
            ),
            ("solid", solids("Solids of the tool, in the mechanical interface.", false, (0, None))),
        ],
        &["position_mm", "axis"],
    )
}

/// What an operation carries.
pub fn held() -> Value {
    table(
        "The part that the robot holds there: it collides, too.",
        [
            ("solid", solids("Solids of the part, in the frame of the TCP.", false, (0, None))),
            (
                "touches_surface",
                boolean("The part rests on its surface, and is not checked against that equipment.", false),
            ),
        ],
        &["solid"],
    )
}
