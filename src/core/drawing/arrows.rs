//! Errors as arrows and unusable nodes as circles: the lines that every picture and CAD file shows.
//!
//! Coordinates are in the world frame, m. Errors are too small to be seen at true size. Arrows are
//! therefore longer than the errors by a factor, the [`exaggeration`]. All operations of a drawing have the
//! same factor under one model and reading, so their arrows can be compared.

use super::round_numbers::{HALF_DIGITS, round_down};
use super::{Drawing, Field, Mesh};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// Length of the longest arrow, as a multiple of the distance between nodes.
const LONGEST_ARROW: f64 = 1.5;
/// Two shares that determine the length of an arrow head.
///
/// The first share is multiplied by the length of the arrow, and the second by the distance between nodes.
/// The smaller product is the length of the head.
const HEAD_LENGTH: (f64, f64) = (0.3, 0.25);
/// Half width of an arrow head and half width of the shaft, each as a share of the length of the head.
const HALF_WIDTH: (f64, f64) = (0.35, 0.12);
/// Radius of the circle round a node as a share of the distance between nodes.
const CIRCLE_RADIUS: f64 = 0.25;
/// Distance between nodes that is assumed for a map of one node, m.
const LONE_SPACING: f64 = 0.1;
/// Number of corners of the polygon that draws a circle round a node.
const CIRCLE_CORNERS: usize = 24;
/// Number of sides of the shaft of an arrow that is drawn as a solid.
const SHAFT_SIDES: usize = 6;
/// Least length of an arrow that is drawn, m.
const MIN_LENGTH: f64 = 1e-6;

/// Component of an error that an arrow shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Component {
    X,
    Y,
    Z,
    Resultant,
}

impl Component {
    /// All components.
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Resultant];

    /// Returns the name of this component as it appears in documents, for example `resultant`.
    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Resultant => "resultant",
        }
    }

    /// Returns the name of the sense that measures this component.
    fn sense(self) -> &'static str {
        if self == Self::Resultant { "xyz" } else { self.name() }
    }

    /// Returns the unit vector along this component of an error, in the world frame.
    ///
    /// Returns None for the resultant if the error is zero.
    fn direction(self, error: &Vector3<f64>) -> Option<Vector3<f64>> {
        match self {
            Self::X => Some(Vector3::x()),
            Self::Y => Some(Vector3::y()),
            Self::Z => Some(Vector3::z()),
            Self::Resultant => error.try_normalize(0.0),
        }
    }
}

/// Arrow that shows the error of a node, in the world frame, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// Node at which the arrow starts, as an index into [`Field::nodes`].
    pub node: usize,
    /// Start of the arrow: the position of the node.
    pub tail: Vector3<f64>,
    pub tip: Vector3<f64>,
    /// Length of the head, m.
    pub head: f64,
}

impl Arrow {
    /// Returns the outer ends of the four lines that start at the tip and draw the head, m.
    ///
    /// The first two lines show the head in a view from above. The last two show it in a view from the
    /// side.
    pub fn barbs(&self) -> [Vector3<f64>; 4] {
        let [along, level, upright] = self.axes();
        let (neck, half) = (self.tip - along * self.head, self.head * HALF_WIDTH.0);
        [neck + level * half, neck - level * half, neck + upright * half, neck - upright * half]
    }

    /// Returns three orthogonal unit vectors. The first is along the arrow, and the second is horizontal.
    fn axes(&self) -> [Vector3<f64>; 3] {
        let along = (self.tip - self.tail).try_normalize(0.0).unwrap_or_else(Vector3::z);
        // Every direction perpendicular to a vertical arrow is horizontal, so the x axis is used.
        let level = Vector3::z().cross(&along).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        [along, level, along.cross(&level)]
    }

    /// Returns the arrow as the mesh of a closed solid with a shaft and a pointed head.
    pub fn mesh(&self) -> Mesh {
        let [along, level, upright] = self.axes();
        let neck = self.tip - along * self.head;
        let (wide, thin) = (self.head * HALF_WIDTH.0, self.head * HALF_WIDTH.1);
        let mut vertices = vec![self.tail];
        for (centre, radius) in [(self.tail, thin), (neck, thin), (neck, wide)] {
            vertices.extend((0..SHAFT_SIDES).map(|k| {
                let (sin, cos) = (TAU * k as f64 / SHAFT_SIDES as f64).sin_cos();
                centre + (level * cos + upright * sin) * radius
            }));
        }
        vertices.push(self.tip);
        let at = |ring: usize, k: usize| (1 + ring * SHAFT_SIDES + k % SHAFT_SIDES) as u32;
        let mut triangles = Vec::new();
        for k in 0..SHAFT_SIDES {
            triangles.push([0, at(0, k + 1), at(0, k)]);
            for ring in 0..2 {
                let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
            triangles.push([(1 + 3 * SHAFT_SIDES) as u32, at(2, k), at(2, k + 1)]);
        }
        Mesh::creased(&vertices, &triangles)
    }
}

impl Field {
    /// Returns the mean distance between neighbouring nodes, m.
    ///
    /// The means along the two grid axes are computed separately, and the smaller one is returned.
    ///
    /// Points that the cell file lists one by one have no grid. In this case, successive points of the list
    /// count as neighbours.
    pub fn spacing(&self) -> f64 {
        let along = self.size.0.max(1);
        let mean = |pairs: Vec<(usize, usize)>| {
            let position = |k: usize| self.nodes[k].position;
            let sum: f64 = pairs.iter().map(|(a, b)| (position(*b) - position(*a)).norm()).sum();
            Some(sum / pairs.len() as f64).filter(|mean| *mean > 0.0)
        };
        let all = 0..self.nodes.len();
        let beside = all.clone().skip(1).filter(|k| k % along != 0).map(|k| (k - 1, k));
        let across = all.skip(along).map(|k| (k - along, k));
        let both = [mean(beside.collect()), mean(across.collect())];
        both.into_iter().flatten().reduce(f64::min).unwrap_or(LONE_SPACING)
    }

    /// Returns the corners of a horizontal circle round a node, as a closed line in the world frame, m.
    pub fn circle(&self, node: usize) -> [Vector3<f64>; CIRCLE_CORNERS] {
        let (centre, radius) = (self.nodes[node].position, self.radius());
        std::array::from_fn(|k| {
            let (sin, cos) = (TAU * k as f64 / CIRCLE_CORNERS as f64).sin_cos();
            centre + Vector3::new(radius * cos, radius * sin, 0.0)
        })
    }

    /// Returns the radius of the circles that are drawn round unusable nodes, m.
    pub fn radius(&self) -> f64 {
        CIRCLE_RADIUS * self.spacing()
    }

    /// Returns the size of one component of the error at a node, m.
    ///
    /// The index `take` into [`Field::takes`] selects the model and the reading. If `is_signed` is true, the
    /// result is the signed component along an axis. For [`Component::Resultant`], it is then the length of
    /// the error vector. If `is_signed` is false, the result is the unsigned value that the reading gives.
    /// Returns None for a node without a usable posture.
    pub fn size_of(&self, take: usize, component: Component, node: usize, is_signed: bool) -> Option<f64> {
        let take = &self.takes[take];
        let error = take.error[node]?;
        Some(match (is_signed, component) {
            (true, Component::Resultant) => error.norm(),
            (true, axis) => axis.direction(&error)?.dot(&error),
            // Every map reports the senses x, y, z and xyz, so the search by name succeeds.
            (false, _) => take.values[self.senses.iter().position(|s| s.name == component.sense())?][node]?,
        })
    }
}

impl Drawing<'_> {
    /// Returns the factor by which arrows are longer than the errors that they show.
    ///
    /// The index `take` into [`Field::takes`] selects the model and the reading. In every operation, the
    /// longest arrow is at most 1.5 times as long as the distance between nodes. The factor is rounded down
    /// to 1, 1.5, 2, ... 9.5 times a power of ten. If there are no errors, the factor is 1.
    pub fn exaggeration(&self, take: usize) -> f64 {
        let is_signed = self.lenses[take].is_signed();
        let raw = self.fields.iter().filter_map(|field| {
            let sizes =
                field.usable().filter_map(|k| field.size_of(take, Component::Resultant, k, is_signed));
            let longest = sizes.fold(0.0, f64::max);
            (longest > 0.0).then(|| LONGEST_ARROW * field.spacing() / longest)
        });
        raw.reduce(f64::min).map_or(1.0, |limit| round_down(limit, HALF_DIGITS))
    }

    /// Returns the errors of the usable nodes of an operation as arrows, enlarged by [`Self::exaggeration`].
    ///
    /// The index `take` into [`Field::takes`] selects the model and the reading. If the reading gives
    /// errors without a sign, each node has two arrows in opposite directions.
    pub fn arrows(&self, field: usize, take: usize, component: Component) -> Vec<Arrow> {
        let (is_signed, enlarged) = (self.lenses[take].is_signed(), self.exaggeration(take));
        let field = &self.fields[field];
        let most = HEAD_LENGTH.1 * field.spacing();
        let ways: &[f64] = if is_signed { &[1.0] } else { &[1.0, -1.0] };
        let mut arrows = Vec::new();
        for node in field.usable() {
            let Some(size) = field.size_of(take, component, node, is_signed) else { continue };
            let direction = field.takes[take].error[node].and_then(|error| component.direction(&error));
            let Some(direction) = direction.filter(|_| size.abs() * enlarged > MIN_LENGTH) else { continue };
            let tail = field.nodes[node].position;
            let head = (HEAD_LENGTH.0 * size.abs() * enlarged).min(most);
            arrows.extend(ways.iter().map(|way| Arrow {
                node,
                tail,
                tip: tail + direction * (way * size * enlarged),
                head,
            }));
        }
        arrows
    }
}
