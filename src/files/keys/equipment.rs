//! Keys of equipment, obstacles and keep-out boxes.

use super::errors::errors_of_equipment;
use super::key::*;
use super::parts::*;
use super::solid::{equipment_solid, rectangle};
use crate::files::dxf::DrawingUnit;
use serde_json::{Value, json};

/// Keys that define the floor space; a piece of equipment needs at least one of them.
pub const BODY: [&str; 3] = ["footprint", "solid", "surface"];

/// Keys that define an obstacle; it needs at least one of them.
pub const OBSTACLE_BODY: [&str; 4] = ["footprint", "solid", "surface", "plan"];

words!(DrawingUnit);

key_table! {
    /// Keys that equipment and obstacles have in common.
    body, "a body", "Equipment or obstacle.", {
        FROM = from("\"equipment/worktable.toml\"");
        SCHEMA = schema("sweetspot/equipment/1");
        UNITS = super::UNITS;
        NAME = text("name", "Name that only readers of this file see. Messages use the name of the table in the cell file.");
        SOURCE = super::SOURCE;
        SURFACE = table("surface", &rectangle::TABLE, "Work surface: a rectangle at height 0 of the frame of the equipment.").example("{ size_mm = [1500, 700] }");
        FOOTPRINT = table("footprint", &rectangle::TABLE, "Floor space: rectangle in plan that no other object is allowed to enter. This rule applies at the heights of the solids, or at every height if there are no solids. If left out, the floor space is the rectangle that covers the solids and the surface.").example("{ size_mm = [600, 600] }").remedy("add footprint = { size_mm = [600, 600] }");
        SOLID = Key::new("solid", ValueKind::List(&ValueKind::Table(&equipment_solid::TABLE), (0, UNBOUNDED), "solids"), "Solids, in the frame of the equipment.");
    }
    rules [Rule::Needs("schema", "units")];
}

key_table! {
    equipment, "a piece of equipment", "Equipment: work surface, solids, floor space and placement.", {
        PLACEMENT = table("placement", &placement::TABLE, "Placement in the world frame; with `stands_on`, placement in the frame of the equipment that carries this piece.").required().remedy("add placement = { x_mm = 0, y_mm = 1000, z_mm = 600 }");
        STANDS_ON = text("stands_on", "Equipment that carries this piece. The piece moves with its carrier, and its placement is in the frame of the carrier.").example("\"worktable\"");
        TOLERANCE = table("placement_tolerance", &placement_tolerance::TABLE, "Tolerance of the placement: the layout must work everywhere within this tolerance. If left out, it is 2 mm and 0.2 degrees for equipment that a search places.").example("{ x_mm = 2, y_mm = 2 }");
        ERRORS = table("errors", &errors_of_equipment::TABLE, "Errors of the placement or the fixture, in the frame of the equipment.");
    }
    extends super::body::TABLE;
    rules [Rule::AnyOf(&BODY)];
}

key_table! {
    fixed_placement, "`placement`", "Placement of an obstacle in the world.", {
        X = number("x_mm", NumberRange::Finite, "Position along x.").required();
        Y = number("y_mm", NumberRange::Finite, "Position along y.").required();
        Z = number("z_mm", NumberRange::Finite, "Position along z.").required();
        YAW = number_or_zero("yaw_deg", NumberRange::Finite, "Rotation about z.");
    }
}

key_table! {
    plan, "a floor plan", "Closed outlines of a drawing as obstacles of equal height.", {
        FILE = Key::new("file", ValueKind::Checked(&ValueKind::Path, dxf), "DXF drawing (ASCII). The path is relative to the folder of this file.").required().example("\"hall.dxf\"").remedy("add file = \"NAME.dxf\"");
        LAYERS = Key::new("layers", ValueKind::List(&ValueKind::Text, (1, UNBOUNDED), "layers"), "Layers of the drawing whose closed outlines are obstacles.").required().example("[\"COLUMNS\", \"MACHINES\"]");
        HEIGHT = number("height_mm", NumberRange::Positive, "Height of the obstacles. Each obstacle begins at the height z_mm of the placement of the drawing.").required().example("3000");
        UNITS = word::<DrawingUnit>("units", "Length of one unit of the drawing; needed if the header of the drawing does not state it.").example("\"mm\"");
        TOLERANCE = number("tolerance_mm", NumberRange::Positive, "Largest distance between an arc and the straight lines that replace it, on the outer side of the arc.").default(Literal::Number(1.0));
    }
}

fn dxf() -> Value {
    json!({ "allOf": [{ "pattern": "\\.[dD][xX][fF]$" }] })
}

key_table! {
    obstacle, "an obstacle", "Obstacle: fixed in the world; no operation happens on it.", {
        PLACEMENT = table("placement", &fixed_placement::TABLE, "Placement in the world; for a floor plan, the placement of the origin of the drawing.").required().remedy("add placement = { x_mm = 0, y_mm = 1000, z_mm = 600 }");
        PLAN = table("plan", &plan::TABLE, "Floor plan whose closed outlines are obstacles; each convex part of an outline is one obstacle.").example("{ file = \"hall.dxf\", layers = [\"COLUMNS\"], height_mm = 3000 }");
    }
    extends super::body::TABLE;
    rules [Rule::AnyOf(&OBSTACLE_BODY), Rule::Excludes("plan", &BODY)];
    refused [
        Refused { name: "errors", message: "an obstacle cannot have `errors`", remedy: "make the obstacle an [equipment.NAME] if work is done on it, or remove the errors" },
        Refused { name: "stands_on", message: "an obstacle cannot have `stands_on`, because it is fixed in the world", remedy: "make the obstacle an [equipment.NAME], or give its placement in the world" },
        Refused { name: "placement_tolerance", message: "an obstacle cannot have `placement_tolerance`", remedy: "make the obstacle an [equipment.NAME] if it can be misplaced, or remove the tolerance" },
    ];
}

key_table! {
    keep_out, "a keep-out box", "Keep-out box, fixed in the world. Equipment, robot, tool and held parts must not enter it, but obstacles are allowed inside.", {
        MIN = vector("min_mm", "Corner with the least x, y and z, in the world frame.").required();
        MAX = vector("max_mm", "Corner with the greatest x, y and z, in the world frame.").required();
    }
}
