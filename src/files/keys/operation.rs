//! Keys of operations.

use super::key::*;
use super::parts::*;
use super::robot::held;
use super::solid::rectangle;
use crate::cell::{Frame, NodeAggregation, PLAIN};

/// Largest number of nodes of one grid. A map of more nodes takes hours and gigabytes.
pub const MAX_NODES: u64 = 1_000_000;

/// Largest number of spins of one operation.
pub const MAX_SPINS: usize = 72;

/// Largest tolerance on the direction of the tool axis, degrees.
pub const MAX_TOLERANCE: f64 = 45.0;

/// Longest time of an operation at its spot, s: a day.
const MAX_DWELL: f64 = 86_400.0;

/// Largest elevation of the tool axis, up or down, degrees. Beyond 90 degrees, the horizontal direction of
/// the tool axis is opposite to the azimuth.
pub const MAX_BEND: f64 = 135.0;

/// Returns the names of the built-in senses: each alone, and each followed by `@` and the name of a frame.
fn plain_senses() -> Vec<String> {
    let framed = PLAIN.iter().flat_map(|p| Frame::ALL.map(|f| format!("{p}@{}", f.name())));
    PLAIN.iter().map(|p| p.to_string()).chain(framed).collect()
}

fn rotations() -> Vec<String> {
    plain_senses().into_iter().filter(|sense| sense.starts_with('r')).collect()
}

fn lengths() -> Vec<String> {
    plain_senses().into_iter().filter(|sense| !sense.starts_with('r')).collect()
}

/// Name of a sense that the cell defines.
const OWN_SENSE: ValueKind =
    ValueKind::Checked(&ValueKind::Text, || serde_json::json!({ "pattern": "^[^@]*$" }));

const AZIMUTH: ValueKind = ValueKind::Either(&[
    ValueKind::Coordinate(-LARGEST, LARGEST),
    ValueKind::Word(|| vec!["radial".into(), "free".into()]),
]);

const SPIN: ValueKind = ValueKind::Either(&[
    FINITE,
    ValueKind::Table(&range::TABLE),
    ValueKind::List(&FINITE, (1, MAX_SPINS), "angles"),
    ValueKind::Exactly("free"),
]);

const POINTS: ValueKind = ValueKind::List(&PLAN, (1, MAX_NODES as usize), "points");
const DIVISIONS: ValueKind =
    ValueKind::List(&ValueKind::Whole(1, MAX_NODES / 2 - 1), (2, 2), "whole numbers");

key_table! {
    operation, "an operation", "Precision operation: its place, the attitude of the tool, and the error that is assessed.", {
        ON = text("on", "Equipment on whose work surface the operation happens.").required().example("\"worktable\"").remedy("add the key on = \"NAME\", where NAME is the equipment with the work surface");
        GRID = Key::new("grid", DIVISIONS, "Divisions along x and y of the surface: [10, 8] makes 11 x 9 nodes.").required_unless("points_mm").example("[10, 8]").remedy("add grid = [10, 8], the divisions along x and y");
        REGION = table("region", &rectangle::TABLE, "Part of the surface that the grid covers; if left out, the whole surface.").example("{ centre_mm = [100, 50], size_mm = [200, 100] }");
        POINTS_MM = Key::new("points_mm", POINTS, "Points of the surface (x and y) at which the operation happens, in place of a grid.").example("[[-100, 0], [100, 0]]");
        OVER = word::<NodeAggregation>("over", "Rule that gives the operation one error. best: the operation happens at the best node, and the error there counts. max, mean, p95: the operation happens at every node, and the maximum, mean or 95th percentile of the errors counts. If left out, the rule is best for a grid and max for points.");
        STANDOFF = number_or_zero("standoff_mm", NumberRange::NotNegative, "Distance of the TCP above the surface.");
        BEND = Key::new("bend_deg", ValueKind::Coordinate(-MAX_BEND, MAX_BEND), "Elevation of the tool axis: -90 points down, 0 is horizontal; a number, a range or a list.").required().example("-90").remedy("add bend_deg = 0");
        AZIMUTH = Key::new("azimuth_deg", super::AZIMUTH, "Azimuth: angle from the x axis of the surface to the tool axis, seen from above. If the tool is vertical, the spin is measured from the azimuth. A number, a range, a list, \"radial\" (in the vertical plane through the axis of the robot base) or \"free\".").default(Literal::Word("free"));
        SPIN = Key::new("spin_deg", super::SPIN, "Spin: right-handed rotation about the tool axis. The reference axis is the first TCP axis perpendicular to the tool axis. At spin 0, the reference axis points up as far as possible, or along the azimuth if the tool points down. A number, a range, a list, or \"free\".").default(Literal::Word("free"));
        TOLERANCE = number_or_zero("tolerance_deg", NumberRange::UpTo(MAX_TOLERANCE), "Largest allowed angle between the tool axis and the direction given by bend_deg and azimuth_deg.");
        SENSE = Key::new("sense", ValueKind::Either(&[ValueKind::Word(plain_senses), OWN_SENSE]), "Sense in which the error is measured: x, y, z, xy, xyz, rx, ry, rz, rotation, or a sense that the cell defines. The axes are those of the world. A suffix selects axes of the surface or the tool: xy@surface, xy@tool.").required().example("\"xy\"").remedy("add sense = \"xy\", or another of x, y, z, xy, xyz, rx, ry, rz, rotation");
        LIMIT_MM = number("limit_mm", NumberRange::Positive, "Requirement: largest allowed error, for a sense measured in mm.").example("0.5");
        LIMIT_DEG = number("limit_deg", NumberRange::Positive, "Requirement: largest allowed error, for a sense measured in degrees.").example("0.1");
        RELATIVE_TO = text("relative_to", "Earlier operation that picks the part placed here. Errors common to both operations cancel.").example("\"picking\"");
        TEACH = Key::new("teach_mm", ValueKind::List(&PLAN, (3, 3), "points"), "Three points of the surface (x and y) that the robot touches to teach the surface frame, if the registration is \"taught\".").example("[[-500, -200], [500, -200], [-500, 200]]");
        APPROACH = number_or_zero("approach_mm", NumberRange::NotNegative, "Length of the straight approach along the tool axis.");
        RETRACT = number_or_zero("retract_mm", NumberRange::NotNegative, "Length of the straight retract along the tool axis.");
        DWELL = number_or_zero("dwell_s", NumberRange::UpTo(MAX_DWELL), "Duration of the operation at its spot, or at every listed point, with the robot at rest. The duration is part of the cycle time.");
        LINE_SPEED = number("line_speed_mm_s", NumberRange::Positive, "Maximum speed of the TCP on the approach and the retract, for example during an insertion; if left out, only the joints limit the speed.").example("50");
        WEIGHT = number("weight", NumberRange::Positive, "Weight of the operation's error in the objective.").default(Literal::Number(1.0));
        HELD = table("held", &held::TABLE, "Part that the robot holds at the operation. Collision checks include the part.");
    }
    rules [
        Rule::When { key: "sense", words: rotations, needs: &[], never: &["limit_mm"] },
        Rule::When { key: "sense", words: lengths, needs: &[], never: &["limit_deg"] },
        Rule::Excludes("points_mm", &["grid", "region"]),
    ];
}
