//! Errors as arrows and unusable nodes as circles: the lines that every picture and CAD file shows.
//!
//! World frame, m. Errors are too small to be seen: all arrows of a drawing under one lens, whatever
//! their operation and component, are enlarged by one [`exaggeration`], so that they can be compared.

use super::round_numbers::{HALF_DIGITS, round_down};
use super::{Drawing, Field, Mesh};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// The longest arrow spans so many distances between nodes.
const LONGEST: f64 = 1.5;
/// Head: its share of an arrow's length, and at most this share of the distance between nodes.
const HEAD: (f64, f64) = (0.3, 0.25);
/// Half width of a head as a share of its length, and of the shaft.
const WIDTH: (f64, f64) = (0.35, 0.12);
/// Radius of the circle round a node as a share of the distance between nodes.
const CIRCLE: f64 = 0.25;
/// Between nodes where there is but one, m.
const ALONE: f64 = 0.1;
/// Of a circle.
const CORNERS: usize = 24;
/// Of the shaft of a solid arrow.
const SIDES: usize = 6;
/// Shorter arrows are no arrows, m.
const SHORTEST: f64 = 1e-6;

/// What of an error an arrow shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Component {
    X,
    Y,
    Z,
    Resultant,
}

impl Component {
    pub const ALL: [Self; 4] = [Self::X, Self::Y, Self::Z, Self::Resultant];

    pub fn name(self) -> &'static str {
        match self {
            Self::X => "x",
            Self::Y => "y",
            Self::Z => "z",
            Self::Resultant => "resultant",
        }
    }

    /// The sense in which its size is reported.
    fn sense(self) -> &'static str {
        if self == Self::Resultant { "xyz" } else { self.name() }
    }

    /// Direction of the component of an error (world, m); None of no resultant.
    fn direction(self, error: &Vector3<f64>) -> Option<Vector3<f64>> {
        match self {
            Self::X => Some(Vector3::x()),
            Self::Y => Some(Vector3::y()),
            Self::Z => Some(Vector3::z()),
            Self::Resultant => error.try_normalize(0.0),
        }
    }
}

/// An error as drawn, world, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arrow {
    /// Index into [`Field::nodes`].
    pub node: usize,
    /// At the node.
    pub tail: Vector3<f64>,
    pub tip: Vector3<f64>,
    /// Length of the head, m.
    pub head: f64,
}

impl Arrow {
    /// Ends of the four lines from the tip that make the head: two to be seen from above, two from aside.
    pub fn barbs(&self) -> [Vector3<f64>; 4] {
        let [along, level, upright] = self.axes();
        let (neck, half) = (self.tip - along * self.head, self.head * WIDTH.0);
        [neck + level * half, neck - level * half, neck + upright * half, neck - upright * half]
    }

    /// Along the arrow; across it and level; across both.
    fn axes(&self) -> [Vector3<f64>; 3] {
        let along = (self.tip - self.tail).try_normalize(0.0).unwrap_or_else(Vector3::z);
        // Of an upright arrow every direction across is level.
        let level = Vector3::z().cross(&along).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        [along, level, along.cross(&level)]
    }

    /// The arrow as a solid: shaft and pointed head, closed.
    pub fn mesh(&self) -> Mesh {
        let [along, level, upright] = self.axes();
        let neck = self.tip - along * self.head;
        let (wide, thin) = (self.head * WIDTH.0, self.head * WIDTH.1);
        let mut vertices = vec![self.tail];
        for (centre, radius) in [(self.tail, thin), (neck, thin), (neck, wide)] {
            vertices.extend((0..SIDES).map(|k| {
                let (sin, cos) = (TAU * k as f64 / SIDES as f64).sin_cos();
                centre + (level * cos + upright * sin) * radius
            }));
        }
        vertices.push(self.tip);
        let at = |ring: usize, k: usize| (1 + ring * SIDES + k % SIDES) as u32;
        let mut triangles = Vec::new();
        for k in 0..SIDES {
            triangles.push([0, at(0, k + 1), at(0, k)]);
            for ring in 0..2 {
                let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
            triangles.push([(1 + 3 * SIDES) as u32, at(2, k), at(2, k + 1)]);
        }
        Mesh::creased(&vertices, &triangles)
    }
}

impl Field {
    /// Distance between neighbouring nodes, m: the mean along the axis of the grid along which it is less;
    /// of points that from one to the next.
    pub fn spacing(&self) -> f64 {
        let (along, _) = self.size;
        let mean = |pairs: Vec<(usize, usize)>| {
            let position = |k: usize| self.nodes[k].position;
            let sum: f64 = pairs.iter().map(|(a, b)| (position(*b) - position(*a)).norm()).sum();
            Some(sum / pairs.len() as f64).filter(|mean| *mean > 0.0)
        };
        let next = |step: usize| {
            let pairs = (step..self.nodes.len()).map(move |k| (k - step, k));
            pairs.filter(|(a, b)| step > 1 || a / along == b / along).collect()
        };
        let both = [mean(next(1)), mean(next(along.max(2)))];
        both.into_iter().flatten().reduce(f64::min).unwrap_or(ALONE)
    }

    /// The circle round a node that cannot be used: level, closed, world, m.
    pub fn circle(&self, node: usize) -> [Vector3<f64>; CORNERS] {
        let (centre, radius) = (self.nodes[node].position, self.radius());
        std::array::from_fn(|k| {
            let (sin, cos) = (TAU * k as f64 / CORNERS as f64).sin_cos();
            centre + Vector3::new(radius * cos, radius * sin, 0.0)
        })
    }

    /// Of the circles round nodes, m.
    pub fn radius(&self) -> f64 {
        CIRCLE * self.spacing()
    }

    /// Size of a component of the error of a node under a lens, m: of a signed sample with its sign, else
    /// what the reading says, plus or minus. None where the node has no posture.
    pub fn size_of(&self, take: usize, component: Component, node: usize, is_signed: bool) -> Option<f64> {
        let take = &self.takes[take];
        let error = take.error[node]?;
        Some(match (is_signed, component) {
            (true, Component::Resultant) => error.norm(),
            (true, axis) => axis.direction(&error)?.dot(&error),
            // A map reports every node in the paper's senses, x, y, z and xyz among them.
            (false, _) => take.values[self.senses.iter().position(|s| s.name == component.sense())?][node]?,
        })
    }
}

impl Drawing<'_> {
    /// By how much arrows under a lens are longer than the errors: the longest of any operation spans
    /// about 1.5 distances between its nodes. One digit and a half: 1, 1.5, 2, ... 9.5, times a power of
    /// ten; 1 without errors.
    pub fn exaggeration(&self, take: usize) -> f64 {
        let is_signed = self.lenses[take].is_signed();
        let raw = self.fields.iter().filter_map(|field| {
            let sizes =
                field.usable().filter_map(|k| field.size_of(take, Component::Resultant, k, is_signed));
            let longest = sizes.fold(0.0, f64::max);
            (longest > 0.0).then(|| LONGEST * field.spacing() / longest)
        });
        raw.reduce(f64::min).map_or(1.0, |limit| round_down(limit, HALF_DIGITS))
    }

    /// The errors of an operation's usable nodes under a lens, enlarged by [`Self::exaggeration`]. Errors
    /// without a sign are plus or minus: of each two arrows, one either way.
    pub fn arrows(&self, field: usize, take: usize, component: Component) -> Vec<Arrow> {
        let (is_signed, enlarged) = (self.lenses[take].is_signed(), self.exaggeration(take));
        let field = &self.fields[field];
        let most = HEAD.1 * field.spacing();
        let ways: &[f64] = if is_signed { &[1.0] } else { &[1.0, -1.0] };
        let mut arrows = Vec::new();
        for node in field.usable() {
            let Some(size) = field.size_of(take, component, node, is_signed) else { continue };
            let direction = field.takes[take].error[node].and_then(|error| component.direction(&error));
            let Some(direction) = direction.filter(|_| size.abs() * enlarged > SHORTEST) else { continue };
            let tail = field.nodes[node].position;
            let head = (HEAD.0 * size.abs() * enlarged).min(most);
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
