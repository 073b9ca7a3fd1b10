//! Solids of a layout as parts of a picture, each with the frame that carries it.

use super::mesh::Mesh;
use crate::assess::Assessment;
use crate::cell::{Cell, Equipment, Fence, Role, Shape, Solid};
use crate::pose::Pose;
use crate::robot::Chain;
use nalgebra::Vector3;

/// Kind of the object that a drawn solid belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum PartKind {
    Robot,
    Tool,
    HeldPart,
    Equipment,
    Obstacle,
    Fence,
    KeepOut,
}

impl PartKind {
    /// Returns the name of this kind as it appears in documents, for example `keep-out`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robot => "robot",
            Self::Tool => "tool",
            Self::HeldPart => "held",
            Self::Equipment => "equipment",
            Self::Obstacle => "obstacle",
            Self::Fence => "fence",
            Self::KeepOut => "keep-out",
        }
    }
}

/// Carrier of a part: the world, or the link frame with which the part moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PartCarrier {
    /// Part that does not move, with its pose in the world frame.
    World(Pose),
    /// Part that moves with a link frame. The index 0 denotes the robot base, and k denotes the frame after
    /// link k.
    Link(usize),
}

/// Solid in the form in which pictures show it.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnPart {
    pub name: String,
    /// Name of the object that the solid belongs to, for example the robot, a piece of equipment or an
    /// operation.
    pub owner: String,
    pub kind: PartKind,
    pub carrier: PartCarrier,
    /// Index of the equipment that the solid belongs to; None if it does not belong to equipment.
    pub equipment: Option<usize>,
    /// The only operation at which the part is visible; None if the part is always visible.
    pub operation: Option<usize>,
    /// Mesh in the frame of the carrier, m.
    pub mesh: Mesh,
}

/// Radius of the bars that are drawn for a robot without solids, as a share of the reach of the robot.
const BAR: f64 = 0.018;
/// Thickness of a wall of the fence, and height of the wall if the fence has no height, m.
const WALL: f64 = 0.01;

/// Returns all parts of a layout.
pub fn parts(a: &Assessment<'_>) -> Vec<DrawnPart> {
    let cell = a.cell;
    let mut parts = robot(cell);
    parts.extend(drawn_pedestal(cell, a.layout.base.z));
    for (k, operation) in cell.operations.iter().enumerate() {
        parts.extend(operation.held.solids.iter().map(|solid| DrawnPart {
            name: solid.name.clone(),
            owner: operation.name.clone(),
            kind: PartKind::HeldPart,
            carrier: PartCarrier::Link(cell.robot.axes()),
            equipment: None,
            operation: Some(k),
            mesh: Mesh::of(&solid.shape, 0.0).seen_from(&cell.robot.tool),
        }));
    }
    for (k, (equipment, at)) in cell.equipment.iter().zip(&a.layout.placements).enumerate() {
        let floor = cell.floor - at.z;
        parts.extend(stand(equipment, k, at.pose(), floor));
    }
    parts.extend(fence_walls(cell).into_iter().enumerate().map(|(k, (pose, size))| {
        fixed(&format!("fence {}", k + 1), PartKind::Fence, &Shape::Box { pose, size })
    }));
    parts.extend(cell.keep_out.iter().map(|space| {
        let pose = Pose { translation: (space.min + space.max) / 2.0, ..Pose::IDENTITY };
        fixed(&space.name, PartKind::KeepOut, &Shape::Box { pose, size: space.max - space.min })
    }));
    parts
}

fn robot(cell: &Cell) -> Vec<DrawnPart> {
    let robot = &cell.robot;
    let part = |link: usize, name: &str, kind: PartKind, mesh: Mesh| DrawnPart {
        name: name.to_string(),
        owner: robot.name.clone(),
        kind,
        carrier: PartCarrier::Link(link),
        equipment: None,
        operation: None,
        mesh,
    };
    let tools = robot.solids.len() - robot.tool_solids;
    let solids = robot.solids.iter().enumerate().map(|(k, s)| {
        let kind = if k < tools { PartKind::Robot } else { PartKind::Tool };
        part(s.link, &s.solid.name, kind, Mesh::of(&s.solid.shape, 0.0))
    });
    let mut parts: Vec<DrawnPart> = solids.collect();
    if tools == 0 {
        let bars = skeleton(&Chain::new(robot), robot.reach() * BAR);
        parts.extend(bars.into_iter().map(|(link, shape)| {
            part(link, &format!("link {link}"), PartKind::Robot, Mesh::of(&shape, 0.0))
        }));
    }
    parts
}

/// Returns the pedestal below a robot base as a box, m. The argument `z` is the height of the base in the
/// world frame, m. The box is given by the pose of its centre in the base frame and by its edge lengths.
///
/// Returns None if the base stands on the floor, or if no pedestal carries it.
pub fn pedestal(cell: &Cell, z: f64) -> Option<(Pose, Vector3<f64>)> {
    let (section, height) = cell.pedestal(z)?;
    let (centre, size) = (section.centre, section.size);
    let pose = Pose { translation: Vector3::new(centre.0, centre.1, -height / 2.0), ..Pose::IDENTITY };
    Some((pose, Vector3::new(size.0, size.1, height)))
}

fn drawn_pedestal(cell: &Cell, z: f64) -> Option<DrawnPart> {
    let (pose, size) = pedestal(cell, z)?;
    let shape = Shape::Box { pose, size };
    Some(DrawnPart {
        name: "pedestal".into(),
        owner: cell.robot.name.clone(),
        kind: PartKind::Robot,
        carrier: PartCarrier::Link(0),
        equipment: None,
        operation: None,
        mesh: Mesh::of(&shape, 0.0),
    })
}

/// Returns bars along the links of a chain, each with the index of the link frame that carries it.
///
/// These bars are drawn if the robot has no solids.
fn skeleton(chain: &Chain, radius: f64) -> Vec<(usize, Shape)> {
    let mut bars = Vec::new();
    let mut bar = |link: usize, a: Vector3<f64>, b: Vector3<f64>| {
        if (b - a).norm() > radius {
            bars.push((link, Shape::Capsule { a, b, radius }));
        }
    };
    bar(0, Vector3::zeros(), chain.mount.translation);
    for (i, link) in chain.links.iter().enumerate() {
        // `back` undoes the twist of D-H row i. Before its twist, the row translates along z by r, then along
        // x by l.
        let back = |p: Vector3<f64>| {
            let (sin, cos) = (link.sin_alpha, link.cos_alpha);
            Vector3::new(p.x, cos * p.y + sin * p.z, cos * p.z - sin * p.y)
        };
        let elbow = back(Vector3::new(-link.l, 0.0, 0.0));
        bar(i + 1, Vector3::zeros(), elbow);
        bar(i + 1, elbow, back(Vector3::new(-link.l, 0.0, -link.r)));
    }
    bar(chain.axes(), Vector3::zeros(), chain.tool.translation);
    bars
}

fn stand(equipment: &Equipment, index: usize, pose: Pose, floor: f64) -> Vec<DrawnPart> {
    let kind = match equipment.role {
        Role::Equipment => PartKind::Equipment,
        Role::Obstacle => PartKind::Obstacle,
    };
    let part = |solid: &Solid| DrawnPart {
        name: solid.name.clone(),
        owner: equipment.name.clone(),
        kind,
        carrier: PartCarrier::World(pose),
        equipment: Some(index),
        operation: None,
        mesh: Mesh::of(&solid.shape, floor),
    };
    equipment.solids.iter().map(part).collect()
}

/// Returns the walls of the fence as boxes. Each box is given by the pose of its centre in the world frame
/// and by its edge lengths, m.
///
/// Each wall is 10 mm thick. If the fence has no height, each wall is 10 mm high.
pub fn fence_walls(cell: &Cell) -> Vec<(Pose, Vector3<f64>)> {
    let Some(Fence { corners, height }) = &cell.fence else { return Vec::new() };
    let height = height.unwrap_or(WALL);
    let wall = |k: usize| {
        let (a, b) = (corners[k], corners[(k + 1) % corners.len()]);
        let (x, y) = (b.0 - a.0, b.1 - a.1);
        let middle = Vector3::new((a.0 + b.0) / 2.0, (a.1 + b.1) / 2.0, cell.floor + height / 2.0);
        (Pose::from_translation_yaw(middle, y.atan2(x)), Vector3::new(x.hypot(y), WALL, height))
    };
    (0..corners.len()).map(wall).collect()
}

fn fixed(name: &str, kind: PartKind, shape: &Shape) -> DrawnPart {
    DrawnPart {
        name: name.to_string(),
        owner: kind.name().to_string(),
        kind,
        carrier: PartCarrier::World(Pose::IDENTITY),
        equipment: None,
        operation: None,
        mesh: Mesh::of(shape, 0.0),
    }
}
