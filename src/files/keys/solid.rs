//! Keys of solids and rectangles.

use super::key::*;
use super::parts::*;
use crate::cell::MAX_JOINTS;
use crate::units::{INCH, MILLIMETRE};
use serde_json::{Value, json};

/// Shapes that any solid may have.
pub const SHAPES: [&str; 5] = ["box", "sphere", "capsule", "cylinder", "mesh"];

/// Shapes of the solids of equipment.
pub const EQUIPMENT_SHAPES: [&str; 6] = ["box", "sphere", "capsule", "cylinder", "mesh", "leg"];

/// Length of one unit of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MeshUnit {
    Millimetre,
    Metre,
    Inch,
}

impl MeshUnit {
    pub const ALL: [Self; 3] = [Self::Millimetre, Self::Metre, Self::Inch];

    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Metre => "m",
            Self::Inch => "inch",
        }
    }

    /// Returns the length of the unit, m.
    pub fn metres(self) -> f64 {
        match self {
            Self::Millimetre => MILLIMETRE,
            Self::Metre => 1.0,
            Self::Inch => INCH,
        }
    }
}

words!(MeshUnit);

key_table! {
    rectangle, "a rectangle", "Rectangle in plan.", {
        SIZE = Key::new("size_mm", PLAN_SIZES, "Size along x and y.").required().example("[600, 400]");
        CENTRE = Key::new("centre_mm", PLAN, "Centre.").default(Literal::Zeros(2));
    }
}

key_table! {
    cuboid, "a box", "Box.", {
        CENTRE = vector("centre_mm", "Centre.").required();
        SIZE = Key::new("size_mm", SIZES, "Full lengths of the edges along x, y and z.").required();
        RPY = super::RPY;
    }
}

key_table! {
    sphere, "a sphere", "Sphere.", {
        CENTRE = vector("centre_mm", "Centre.").required();
        RADIUS = number("radius_mm", NumberRange::Positive, "Radius.").required();
    }
}

key_table! {
    bar, "a bar", "Capsule (with round ends) or cylinder (with flat ends).", {
        A = vector("a_mm", "One end of the axis.").required();
        B = vector("b_mm", "Other end of the axis.").required();
        RADIUS = number("radius_mm", NumberRange::Positive, "Radius.").required();
    }
}

key_table! {
    leg, "a leg", "Upright leg down to the floor; its length follows from the height of the equipment.", {
        CENTRE = Key::new("centre_mm", PLAN, "Centre in plan.").required();
        SIZE = Key::new("size_mm", PLAN_SIZES, "Size along x and y.").required();
        TOP = number("top_mm", NumberRange::Finite, "Height of the top of the leg in the frame of the equipment.").required();
    }
}

key_table! {
    mesh, "a mesh", "Triangles of a mesh file.", {
        CENTRE = vector("centre_mm", "Position of the origin of the mesh.").default(Literal::Zeros(3));
        RPY = super::RPY;
        UNITS = word::<MeshUnit>("units", "Length of one unit of the mesh file.").required();
        FILE = Key::new("file", ValueKind::Checked(&ValueKind::Path, obj_or_stl), "STL or OBJ file. The path is relative to the folder of this file.").required().example("\"machine.stl\"").remedy("add file = \"NAME.stl\" or \"NAME.obj\"");
    }
}

fn obj_or_stl() -> Value {
    json!({ "allOf": [{ "pattern": "\\.([oO][bB][jJ]|[sS][tT][lL])$" }] })
}

key_table! {
    /// Keys that all solids have in common.
    any_solid, "a solid", "Solid: a name and one shape.", {
        NAME = Key::new("name", ValueKind::Name, "Name for messages; no two solids of a robot or a piece of equipment may have the same name.").required();
        BOX = table("box", &cuboid::TABLE, "Box.").example("{ centre_mm = [0, 0, 0], size_mm = [100, 100, 100] }");
        SPHERE = table("sphere", &sphere::TABLE, "Sphere.");
        CAPSULE = table("capsule", &bar::TABLE, "Bar with hemispherical ends.");
        CYLINDER = table("cylinder", &bar::TABLE, "Bar of circular cross-section with flat ends.");
        MESH = table("mesh", &mesh::TABLE, "Triangles of a mesh file.");
    }
}

key_table! {
    /// Solid of a tool or a held part.
    solid, "a solid", "Solid of a tool or a held part: a name and one shape.", {}
    extends super::any_solid::TABLE;
    rules [Rule::AnyOf(&SHAPES), Rule::OneAtMost(&SHAPES)];
    refused [Refused {
        name: "leg",
        message: "only a solid of equipment or of an obstacle can be a leg",
        remedy: "give the solid one of the shapes box, sphere, capsule, cylinder, mesh",
    }];
}

key_table! {
    link_solid, "a solid", "Solid on a link: a name, a link and one shape.", {
        LINK = Key::new("link", ValueKind::Whole(0, MAX_JOINTS as u64), "Number k of the link that carries the solid. Link 0 is the base. D-H row k ends at the frame of link k.").required().remedy("add link = 0 for the base, or link = k for the frame at which D-H row k ends");
    }
    extends super::solid::TABLE;
}

key_table! {
    equipment_solid, "a solid", "Solid of a piece of equipment: a name and one shape.", {
        LEG = table("leg", &leg::TABLE, "Upright leg down to the floor; its length follows from the height of the equipment.");
    }
    extends super::any_solid::TABLE;
    rules [Rule::AnyOf(&EQUIPMENT_SHAPES), Rule::OneAtMost(&EQUIPMENT_SHAPES)];
}
