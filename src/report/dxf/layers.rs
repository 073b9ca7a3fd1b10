//! Layers of the CAD drawing.

use super::file::Layer;
use crate::drawing::{Drawing, PartKind};

pub const ROBOT: &str = "ROBOT";
pub const EQUIPMENT: &str = "EQUIPMENT";
pub const ENVELOPE: &str = "ENVELOPE";
pub const REGION: &str = "REGION";
pub const SPOT: &str = "SPOT";
pub const DIMENSIONS: &str = "DIMENSIONS";
pub const TEXT: &str = "TEXT";
/// Layer of the triangles of all solids.
pub const FACES: &str = "FACES";
/// Layer of the frame and the title block on the paper.
pub const TITLE: &str = "TITLE_BLOCK";
/// Layer of the viewport on the paper.
pub const VIEWPORT: &str = "VIEWPORT";

/// Names and AutoCAD colour indices. Every colour has a contrast ratio of at least 3 on a white background
/// and on the black background of AutoCAD. Colour 7 is black on white and white on black.
const LAYERS: [(&str, u16); 19] = [
    (ROBOT, 32),
    (ENVELOPE, 134),
    (EQUIPMENT, 8),
    ("OBSTACLES", 252),
    ("FENCE", 252),
    ("KEEP_OUT", 1),
    (FACES, 8),
    ("NODES_OK", 94),
    ("NODES_OUT", 1),
    ("ARROWS_X", 12),
    ("ARROWS_Y", 94),
    ("ARROWS_Z", 150),
    ("ARROWS_R", 7),
    (REGION, 30),
    (SPOT, 6),
    (DIMENSIONS, 7),
    (TEXT, 7),
    (TITLE, 7),
    (VIEWPORT, 8),
];

/// Number of faces above which the layer of the faces is frozen. CAD programs draw a larger number
/// of faces slowly.
const MANY_FACES: usize = 2000;

/// Returns the layers to write. The layers of obstacles, fence, keep-out spaces and regions are left out if
/// they would be empty. The layers of the error components are frozen, so the drawing shows only the
/// resultant errors at first.
pub fn used(drawing: &Drawing<'_>, faces: usize) -> Vec<Layer> {
    let has = |kind: PartKind| drawing.parts.iter().any(|p| p.kind == kind);
    let idle = |name: &str| match name {
        "OBSTACLES" => !has(PartKind::Obstacle),
        "FENCE" => !has(PartKind::Fence),
        "KEEP_OUT" => !has(PartKind::KeepOut),
        REGION => drawing.regions.is_empty(),
        _ => false,
    };
    let is_frozen = |name: &str| match name {
        FACES => faces > MANY_FACES,
        "ARROWS_X" | "ARROWS_Y" | "ARROWS_Z" => true,
        _ => false,
    };
    let all = LAYERS.into_iter().filter(|(name, _)| !idle(name));
    all.map(|(name, colour)| Layer { name, colour, is_frozen: is_frozen(name) }).collect()
}

pub fn layer_of(kind: PartKind) -> &'static str {
    match kind {
        PartKind::Robot | PartKind::Tool | PartKind::HeldPart => ROBOT,
        PartKind::Equipment => EQUIPMENT,
        PartKind::Obstacle => "OBSTACLES",
        PartKind::Fence => "FENCE",
        PartKind::KeepOut => "KEEP_OUT",
    }
}
