//! 3-D scene of the cell with its motion: binary glTF 2.0 in m. The z axis of the world points up. The root
//! node rotates the z axis to the y axis, which points up in glTF.

mod file;

use crate::cell::Shape;
use crate::colours::viridis;
use crate::drawing::{Component, Drawing, DrawnPart, Field, Mesh, PartCarrier, PartKind};
use crate::pose::Pose;
use crate::units::rounded;
use file::{GlbFile, GlbSurface, quaternion};
use gltf_json::animation::Property;
use gltf_json::{Animation, Index, Material, Node};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use std::collections::BTreeMap;
use std::f32::consts::FRAC_1_SQRT_2;

/// Appearance of a material: red, green, blue (sRGB, 0 to 255), opacity, roughness.
type Look = ([u8; 3], f64, f32);

fn look(kind: PartKind) -> Look {
    match kind {
        PartKind::Robot => ([230, 159, 0], 1.0, 0.45),
        PartKind::Tool => ([87, 96, 106], 1.0, 0.35),
        PartKind::HeldPart => ([0, 158, 115], 1.0, 0.5),
        PartKind::Equipment => ([200, 208, 217], 1.0, 0.8),
        PartKind::Obstacle => ([140, 147, 156], 1.0, 0.9),
        PartKind::Fence => ([240, 228, 66], 0.35, 0.9),
        PartKind::KeepOut => ([213, 94, 0], 0.25, 0.9),
    }
}

const REACH: Look = ([0, 114, 178], 1.0, 1.0);
const OUT: Look = ([90, 98, 108], 1.0, 1.0);
const SPOT: Look = ([204, 121, 167], 1.0, 0.4);

/// Converts a colour (sRGB, 0 to 255) to the linear scale of glTF (IEC 61966-2-1).
fn linear(colour: [u8; 3]) -> [f64; 3] {
    colour.map(|c| match f64::from(c) / 255.0 {
        c if c <= 0.04045 => c / 12.92,
        c => ((c + 0.055) / 1.055).powf(2.4),
    })
}

/// Scene under construction, with the motion of the robot.
struct GlbBuilder {
    file: GlbFile,
    materials: BTreeMap<String, Index<Material>>,
    animation: Animation,
}

impl GlbBuilder {
    fn material(&mut self, name: &str, (colour, alpha, roughness): Look) -> Index<Material> {
        let [r, g, b] = linear(colour);
        let file = &mut self.file;
        let new = || file.material(name, [r, g, b, alpha], roughness);
        *self.materials.entry(name.to_string()).or_insert_with(new)
    }

    /// Adds a mesh as one glTF node, in the frame of the parent node.
    fn solid(&mut self, name: &str, mesh: &Mesh, (what, look): (&str, Look)) -> Option<Index<Node>> {
        let material = self.material(what, look);
        let indices = mesh.triangles.iter().flatten().copied().collect();
        let surface =
            GlbSurface { positions: &mesh.positions, normals: &mesh.normals, colours: &[], indices };
        let mesh = Some(self.file.mesh(name, &surface, material)?);
        Some(self.file.node(Node { mesh, name: Some(name.to_string()), ..Node::default() }))
    }

    fn part(&mut self, part: &DrawnPart) -> Option<Index<Node>> {
        self.solid(&part.name, &part.mesh, (part.kind.name(), look(part.kind)))
    }

    /// Adds closed lines (world frame, m) as one glTF node.
    fn rings(&mut self, name: &str, rings: &[Vec<Vector3<f64>>], what: (&str, Look)) -> Option<Index<Node>> {
        let mut indices = Vec::new();
        let mut first = 0;
        for ring in rings {
            let count = ring.len() as u32;
            indices.extend((0..count).flat_map(|k| [first + k, first + (k + 1) % count]));
            first += count;
        }
        let material = self.material(what.0, what.1);
        let positions = rings.concat();
        let surface = GlbSurface { positions: &positions, normals: &[], colours: &[], indices };
        let mesh = Some(self.file.mesh(name, &surface, material)?);
        Some(self.file.node(Node { mesh, name: Some(name.to_string()), ..Node::default() }))
    }
}

/// Returns the scene with the robot at the spot of an operation, or at home. An animation goes from home to
/// every spot and back. Arrows show the resultant errors under the model and the reading of the cell.
///
/// # Errors
/// Fails if the glTF writer fails.
pub fn glb(drawing: &Drawing<'_>, operation: Option<usize>) -> Result<Vec<u8>, String> {
    let animation = GlbFile::animation("home - spots - home");
    let mut scene = GlbBuilder { file: GlbFile::new(), materials: BTreeMap::new(), animation };
    let robot = robot(&mut scene, drawing, operation);
    let mut top: Vec<Index<Node>> = robot.into_iter().collect();
    top.extend(stands(&mut scene, drawing));
    top.extend(maps(&mut scene, drawing));
    top.extend(envelopes(&mut scene, drawing));
    let top = scene.file.node(Node {
        name: Some(drawing.cell.name.clone()),
        children: Some(top),
        // Rotation from z up to y up: -90 degrees about x.
        rotation: quaternion([-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2]),
        ..Node::default()
    });
    scene.file.bytes(top, Some(scene.animation))
}

fn translation(pose: &Pose) -> [f32; 3] {
    pose.translation.map(|v| v as f32).into()
}

fn turn(pose: &Pose) -> UnitQuaternion<f64> {
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(pose.rotation))
}

fn single(q: &UnitQuaternion<f64>) -> [f32; 4] {
    [q.i, q.j, q.k, q.w].map(|v| v as f32)
}

fn placed(name: &str, pose: &Pose, children: Vec<Index<Node>>) -> Node {
    Node {
        name: Some(name.to_string()),
        translation: Some(translation(pose)),
        rotation: quaternion(single(&turn(pose))),
        children: (!children.is_empty()).then_some(children),
        ..Node::default()
    }
}

/// Adds the robot: one moving node for each link with its solids, then a node for the TCP.
fn robot(scene: &mut GlbBuilder, drawing: &Drawing<'_>, operation: Option<usize>) -> Option<Index<Node>> {
    let movement = &drawing.movement;
    let input = scene.file.times(&movement.times);
    let frames = movement.frames(operation);
    let mut links = Vec::new();
    for (k, frame) in frames.iter().enumerate() {
        let mut solids = Vec::new();
        for part in drawing.parts.iter().filter(|p| p.carrier == PartCarrier::Link(k)) {
            solids.extend(match part.operation {
                None => scene.part(part),
                Some(o) => held(scene, drawing, part, (o, operation == Some(o)), input),
            });
        }
        let name = match k {
            0 => "base".to_string(),
            k if k + 1 == frames.len() => "tcp".to_string(),
            k => format!("link {k}"),
        };
        let link = scene.file.node(placed(&name, frame, solids));
        links.push(link);
        let poses: Vec<Pose> = movement.frames.iter().map(|f| f[k]).collect();
        if poses.iter().any(|p| *p != poses[0]) {
            moving(scene, link, &poses, input);
        }
    }
    scene.file.group(&drawing.cell.robot.name, links)
}

/// Adds the channels of a link. Two quaternions of opposite sign describe each rotation. At each time, the
/// channel contains the quaternion that is nearer to the previous quaternion.
fn moving(scene: &mut GlbBuilder, link: Index<Node>, poses: &[Pose], input: Index<gltf_json::Accessor>) {
    let GlbBuilder { file, animation, .. } = scene;
    let places: Vec<f32> = poses.iter().flat_map(translation).collect();
    file.channel(animation, (link, Property::Translation), input, &places);
    let mut turns: Vec<f32> = Vec::new();
    let mut last = turn(&poses[0]);
    for pose in poses {
        let next = turn(pose);
        last = if next.coords.dot(&last.coords) < 0.0 {
            UnitQuaternion::new_unchecked(-next.into_inner())
        } else {
            next
        };
        turns.extend(single(&last));
    }
    file.channel(animation, (link, Property::Rotation), input, &turns);
}

/// Adds a held part that is visible only while the robot holds it.
fn held(
    scene: &mut GlbBuilder,
    drawing: &Drawing<'_>,
    part: &DrawnPart,
    (operation, is_held): (usize, bool),
    input: Index<gltf_json::Accessor>,
) -> Option<Index<Node>> {
    let solid = scene.part(part)?;
    let size = |is_held: bool| [if is_held { 1.0 } else { 0.0 }; 3];
    let node = scene.file.node(Node {
        name: Some(format!("{} of {}", part.name, part.owner)),
        children: Some(vec![solid]),
        scale: Some(size(is_held)),
        ..Node::default()
    });
    let holding = drawing.movement.holding.iter();
    let sizes: Vec<f32> = holding.flat_map(|held| size(*held == Some(operation))).collect();
    scene.file.channel(&mut scene.animation, (node, Property::Scale), input, &sizes);
    Some(node)
}

/// Adds the fence, the keep-out spaces, the equipment and the obstacles, each at its frame.
fn stands(scene: &mut GlbBuilder, drawing: &Drawing<'_>) -> Vec<Index<Node>> {
    let mut all = Vec::new();
    for (k, equipment) in drawing.cell.equipment.iter().enumerate() {
        let parts: Vec<&DrawnPart> = drawing.parts.iter().filter(|p| p.equipment == Some(k)).collect();
        let solids = parts.iter().filter_map(|part| scene.part(part)).collect();
        let at = drawing.layout.placements[k].pose();
        all.push(scene.file.node(placed(&equipment.name, &at, solids)));
    }
    for kind in [PartKind::Fence, PartKind::KeepOut] {
        let parts = drawing.parts.iter().filter(|p| p.kind == kind);
        let solids = parts.filter_map(|part| scene.part(part)).collect();
        all.extend(scene.file.group(kind.name(), solids));
    }
    all
}

/// Adds the error maps, one glTF node for each operation. A map shows arrows, the spot, and circles round
/// unusable nodes of the grid.
fn maps(scene: &mut GlbBuilder, drawing: &Drawing<'_>) -> Option<Index<Node>> {
    let ranges = drawing.fields.iter().filter_map(|f| f.range(0, f.sense));
    let range = ranges.reduce(|(lo, hi), (a, b)| (lo.min(a), hi.max(b))).unwrap_or_default();
    let mut operations = Vec::new();
    for (k, field) in drawing.fields.iter().enumerate() {
        let mut all: Vec<Index<Node>> = arrows(scene, drawing, k, range).into_iter().collect();
        let out = (0..field.nodes.len()).filter(|k| !field.nodes[*k].is_ok());
        let circles: Vec<_> = out.map(|k| field.circle(k).to_vec()).collect();
        all.extend(scene.rings("nodes that cannot be used", &circles, ("unusable", OUT)));
        if let Some(centre) = field.spot {
            let ball = Shape::Sphere { centre, radius: field.radius() / 2.0 };
            all.extend(scene.solid("spot", &Mesh::of(&ball, 0.0), ("spot", SPOT)));
        }
        operations.extend(scene.file.group(&drawing.cell.operations[field.operation].name, all));
    }
    scene.file.group("error map", operations)
}

/// Adds arrows of the resultant errors of an operation. The colour of an arrow shows the value of the map for
/// the sense (error component) of the operation.
fn arrows(
    scene: &mut GlbBuilder,
    drawing: &Drawing<'_>,
    k: usize,
    (low, high): (f64, f64),
) -> Option<Index<Node>> {
    let field: &Field = &drawing.fields[k];
    let mut all = Mesh::default();
    let mut colours = Vec::new();
    for arrow in drawing.arrows(k, 0, Component::Resultant) {
        let value = field.takes[0].values[field.sense][arrow.node].unwrap_or(low);
        let colour = linear(viridis((value - low) / (high - low).max(f64::MIN_POSITIVE)));
        let (mesh, first) = (arrow.mesh(), all.positions.len() as u32);
        colours.extend(std::iter::repeat_n(colour, mesh.positions.len()));
        all.positions.extend(mesh.positions);
        all.normals.extend(mesh.normals);
        all.triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| i + first)));
    }
    let name = format!("errors, enlarged {} times", rounded(drawing.exaggeration(0), 6));
    let material = scene.material("errors", ([255; 3], 1.0, 0.7));
    let surface = GlbSurface {
        positions: &all.positions,
        normals: &all.normals,
        colours: &colours,
        indices: all.triangles.into_iter().flatten().collect(),
    };
    let mesh = Some(scene.file.mesh(&name, &surface, material)?);
    Some(scene.file.node(Node { mesh, name: Some(name), ..Node::default() }))
}

/// Adds the working envelopes, one glTF node for each operation.
fn envelopes(scene: &mut GlbBuilder, drawing: &Drawing<'_>) -> Option<Index<Node>> {
    let mut all = Vec::new();
    for (operation, rings) in drawing.cell.operations.iter().zip(&drawing.envelopes) {
        let at_work = scene.rings("at the height of the work", &rings.at_work, ("reach", REACH));
        let around = scene.rings("at other heights and in a vertical plane", &rings.around, ("reach", REACH));
        all.extend(scene.file.group(&operation.name, at_work.into_iter().chain(around).collect()));
    }
    scene.file.group("envelope", all)
}
