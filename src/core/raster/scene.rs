//! Scene of a picture: bodies, lines and labels in the world frame, m.

use super::Shot;
use super::palette::{Colour, Light, Palette, lit, mixed};
use crate::cell::Role;
use crate::drawing::{Arrow, Drawing, Mesh, PartKind};
use crate::pose::Pose;
use nalgebra::Vector3;

/// Body of the scene: a surface with its colours.
pub struct SceneBody {
    pub mesh: Mesh,
    pub colour: Colour,
    /// Colour of the darkest corners of an unlit body.
    ///
    /// The colour of a corner is a mixture of `dark` and `colour`. The list `shares` gives the share of
    /// `colour` for each corner. If `shares` is empty, every share is 1.
    pub dark: Colour,
    pub shares: Vec<f32>,
    pub opacity: f32,
    /// Whether lamps light the body. An unlit body, such as a node or an arrow, is equally bright from all
    /// sides.
    pub is_lit: bool,
    /// Whether the body is an arrow or a node. SVG draws arrows and nodes as separate shapes, not as bodies.
    pub is_sign: bool,
    pub has_edges: bool,
    /// Distance by which the body is shifted towards the eye when it is drawn, m.
    pub lift: f64,
}

impl SceneBody {
    /// Returns the tone of each corner: brightness for a lit body, share of `colour` for an unlit body.
    pub fn tones(&self, light: &Light) -> Vec<f32> {
        match (self.is_lit, self.shares.is_empty()) {
            (true, _) => self.mesh.normals.iter().map(|n| light.on(n)).collect(),
            (false, false) => self.shares.clone(),
            (false, true) => vec![1.0; self.mesh.positions.len()],
        }
    }

    /// Returns the colour of the body for a tone of [`Self::tones`].
    pub fn toned(&self, tone: f32) -> Colour {
        if self.is_lit { lit(self.colour, tone) } else { mixed(self.dark, self.colour, tone) }
    }
}

/// Polyline of the scene, in the world frame.
pub struct SceneLine {
    pub points: Vec<Vector3<f64>>,
    pub closed: bool,
    /// Whether the line is dashed. In a dashed line, two segments are drawn, the next two are left out, and
    /// so on.
    pub dashed: bool,
    pub colour: Colour,
    /// Width of the line, in tenths of the height of capital letters.
    pub width: f64,
    pub lift: f64,
}

impl SceneLine {
    /// Returns the segments of the line that are drawn, each with its two ends.
    pub fn spans(&self) -> impl Iterator<Item = [Vector3<f64>; 2]> {
        let count = if self.closed { self.points.len() } else { self.points.len().saturating_sub(1) };
        let kept = (0..count).filter(|k| !self.dashed || k % 4 < 2);
        kept.map(|k| [self.points[k], self.points[(k + 1) % self.points.len()]])
    }
}

/// Position of a label relative to the object that it names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LabelSide {
    Above,
    /// The label is centred below the two corners of the object's top that are lowest in the picture.
    Below,
    /// The label is beside a spot, and a leader line connects label and spot.
    Spot,
}

/// Text that names an object or states its value.
pub struct Label {
    pub text: String,
    /// Points of the labelled object, in the world frame, m.
    pub points: Vec<Vector3<f64>>,
    pub side: LabelSide,
}

/// Node of an error map in the form in which SVG draws it.
pub struct NodeMark {
    pub at: Vector3<f64>,
    /// Colour of a usable node; None if the node is unusable.
    pub colour: Option<Colour>,
    /// Text of the node's tooltip: the value, or the reason why the node cannot be used.
    pub title: String,
}

/// Scene of a picture, in the world frame, m.
pub struct RasterScene {
    pub bodies: Vec<SceneBody>,
    pub lines: Vec<SceneLine>,
    pub labels: Vec<Label>,
    pub nodes: Vec<NodeMark>,
    pub arrows: Vec<(Arrow, Colour)>,
    /// Diagonal of the bounding box of all bodies, m.
    pub size: f64,
    /// Horizontal direction to the right of the picture, in the world frame.
    pub right: Vector3<f64>,
}

impl RasterScene {
    /// Returns a scene with solids and working envelopes only. Error maps and names are added later.
    pub fn of(drawing: &Drawing<'_>, shot: &Shot, palette: &Palette) -> Self {
        let context = shot.operation.or(shot.context);
        let frames = drawing.movement.frames(context);
        let mut scene = Self {
            bodies: Vec::new(),
            lines: Vec::new(),
            labels: Vec::new(),
            nodes: Vec::new(),
            arrows: Vec::new(),
            size: 1.0,
            right: Vector3::x(),
        };
        for (part, pose) in drawing.posed(context, frames) {
            let (colour, opacity) = palette.of_kind(part.kind);
            let mesh = part.mesh.seen_from(&pose);
            scene.bodies.push(SceneBody::solid(mesh, colour, opacity));
        }
        let points = scene.points();
        let bounds = points.iter().map(|p| (*p, *p)).reduce(|(lo, hi), (p, q)| (lo.inf(&p), hi.sup(&q)));
        scene.size = bounds.map_or(1.0, |(lo, hi)| (hi - lo).norm()).max(0.1);
        if shot.envelope {
            scene.add_envelopes(drawing, shot, palette);
        }
        scene
    }

    /// Returns all points of bodies and lines, in the world frame, m. The camera is fitted to these points.
    pub fn points(&self) -> Vec<Vector3<f64>> {
        let bodies = self.bodies.iter().flat_map(|b| &b.mesh.positions);
        bodies.chain(self.lines.iter().flat_map(|l| &l.points)).copied().collect()
    }

    fn add_envelopes(&mut self, drawing: &Drawing<'_>, shot: &Shot, palette: &Palette) {
        let all = drawing.envelopes.iter().zip(&drawing.fields);
        // Operations with the same tool orientation may share an envelope.
        let mut drawn: Vec<&Vec<Vector3<f64>>> = Vec::new();
        for (rings, _) in all.filter(|(_, f)| shot.operation.is_none_or(|o| o == f.operation)) {
            let pale = mixed(palette.envelope, palette.paper, 0.4);
            let sets = [(&rings.at_work, 2.0, palette.envelope), (&rings.around, 0.9, pale)];
            let each = sets.into_iter().flat_map(|(set, w, c)| set.iter().map(move |r| (r, w, c)));
            for (ring, width, colour) in each {
                if drawn.contains(&ring) {
                    continue;
                }
                drawn.push(ring);
                self.lines.push(SceneLine {
                    points: ring.clone(),
                    closed: true,
                    dashed: false,
                    colour,
                    width,
                    lift: self.size * 0.002,
                });
            }
        }
    }

    /// Adds a label with the name of each piece of equipment and each keep-out box.
    pub fn add_names(&mut self, drawing: &Drawing<'_>, shot: &Shot) {
        let frames = drawing.movement.frames(shot.operation.or(shot.context));
        for (k, equipment) in drawing.cell.equipment.iter().enumerate() {
            let parts = drawing.posed(None, frames).filter(|(part, _)| part.equipment == Some(k));
            let points: Vec<_> = parts.filter_map(|(part, pose)| corners(&part.mesh, &pose)).collect();
            let points: Vec<Vector3<f64>> = points.into_iter().flatten().collect();
            let side = match (equipment.role, equipment.surface.is_some()) {
                (Role::Equipment, true) => LabelSide::Below,
                _ => LabelSide::Above,
            };
            if !points.is_empty() {
                self.labels.push(Label { text: equipment.name.clone(), points, side });
            }
        }
        let is_keep_out = |kind| kind == PartKind::KeepOut;
        for (part, pose) in drawing.posed(None, frames).filter(|(part, _)| is_keep_out(part.kind)) {
            let points = corners(&part.mesh, &pose).map_or(Vec::new(), |c| c.to_vec());
            self.labels.push(Label { text: part.name.clone(), points, side: LabelSide::Above });
        }
    }
}

impl SceneBody {
    /// Returns a lit body of one colour.
    pub fn solid(mesh: Mesh, colour: Colour, opacity: f32) -> Self {
        Self {
            mesh,
            colour,
            dark: colour,
            shares: Vec::new(),
            opacity,
            is_lit: opacity >= 1.0,
            is_sign: false,
            has_edges: true,
            lift: 0.0,
        }
    }
}

/// Returns the corners of the bounding box of a mesh, transformed by `pose` to the world frame.
///
/// Returns None if the mesh is empty.
fn corners(mesh: &Mesh, pose: &Pose) -> Option<[Vector3<f64>; 8]> {
    let (low, high) = mesh.extent()?;
    Some(std::array::from_fn(|k| {
        let side = |axis: usize| if k >> axis & 1 == 1 { high[axis] } else { low[axis] };
        pose.transform(&Vector3::new(side(0), side(1), side(2)))
    }))
}
