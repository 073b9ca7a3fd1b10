//! Expansion of blocks: every outline of the named layers in the frame of the drawing.

use super::DxfFault;
use super::drawing::PlanDrawing;
use super::entities::{Entity, EntityKind, Insert, PlanPath};
use crate::files::fault::shown;
use nalgebra::{Matrix2, Rotation2, Vector2};
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of entities, each counted once for every insert of its block.
const MAX_ENTITIES: u64 = 100_000;

/// Largest depth of blocks within blocks.
const MAX_DEPTH: usize = 16;

/// Affine map of the plane: `linear p + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaneMap {
    pub linear: Matrix2<f64>,
    pub offset: Vector2<f64>,
}

impl PlaneMap {
    /// Returns the map that multiplies by `factor`.
    pub fn scaling(factor: f64) -> Self {
        Self { linear: Matrix2::identity() * factor, offset: Vector2::zeros() }
    }

    pub fn of(&self, p: &Vector2<f64>) -> Vector2<f64> {
        self.linear * p + self.offset
    }

    /// Returns the map that applies `first`, then `self`.
    fn after(&self, first: &Self) -> Self {
        Self { linear: self.linear * first.linear, offset: self.of(&first.offset) }
    }

    /// Returns the largest factor by which the map stretches a length.
    pub fn stretch(&self) -> f64 {
        self.linear.singular_values().max()
    }

    /// Returns whether the map keeps angles, so that arcs stay arcs. The map may also mirror.
    pub fn keeps_arcs(&self) -> bool {
        let values = self.linear.singular_values();
        values.min() > 0.0 && values.max() - values.min() <= 1e-9 * values.max()
    }

    pub fn mirrors(&self) -> bool {
        self.linear.determinant() < 0.0
    }
}

/// Shape of the drawing, with the map from the frame of the shape (drawing units) to the frame of the drawing
/// (m).
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedShape {
    pub shape: FlatShape,
    pub map: PlaneMap,
    /// Name of the layer, in upper case.
    pub layer: String,
    pub line: usize,
}

#[derive(Debug, Clone, PartialEq)]
pub enum FlatShape {
    Path(PlanPath),
    Circle { centre: Vector2<f64>, radius: f64 },
}

/// Shapes of the named layers, and the entities that the reader does not support.
#[derive(Debug, Default)]
pub struct Expanded {
    pub shapes: Vec<PlacedShape>,
    /// Number of unsupported entities and the line of the first one, for each layer and entity name.
    pub ignored: BTreeMap<(String, String), (usize, usize)>,
}

/// Returns the shapes on `layers` (names in upper case). `unit` is the length of one unit of the drawing, m.
///
/// # Errors
/// Fails if a block contains itself, is missing or nested too deeply, or if there are too many entities.
pub fn expanded(drawing: &PlanDrawing, layers: &BTreeSet<String>, unit: f64) -> Result<Expanded, DxfFault> {
    let mut walk = BlockWalk { drawing, layers, found: Expanded::default(), visited: 0, inside: Vec::new() };
    walk.entities(&drawing.entities, &PlaneMap::scaling(unit), None)?;
    Ok(walk.found)
}

struct BlockWalk<'d> {
    drawing: &'d PlanDrawing,
    layers: &'d BTreeSet<String>,
    found: Expanded,
    visited: u64,
    /// Names of the blocks, in upper case, whose inserts are being expanded.
    inside: Vec<String>,
}

impl BlockWalk<'_> {
    /// Adds the shapes of entities. Inside a block, an entity on layer 0 belongs to `inherited`, the layer of
    /// the insert.
    fn entities(&mut self, all: &[Entity], map: &PlaneMap, inherited: Option<&str>) -> Result<(), DxfFault> {
        let flip = PlaneMap { linear: Matrix2::new(-1.0, 0.0, 0.0, 1.0), offset: Vector2::zeros() };
        for entity in all {
            self.visited += 1;
            if self.visited > MAX_ENTITIES {
                let message = format!("the inserts of blocks add up to more than {MAX_ENTITIES} entities");
                return Err(DxfFault::new(entity.line, message, "delete what the plan does not need"));
            }
            let own = entity.layer.to_uppercase();
            let layer = inherited.filter(|_| own == "0").map_or(own, str::to_string);
            let map = if entity.is_flipped { map.after(&flip) } else { *map };
            let shape = match &entity.kind {
                EntityKind::Insert(insert) => {
                    self.insert(insert, &map, &layer, entity.line)?;
                    continue;
                }
                _ if !self.layers.contains(&layer) => continue,
                EntityKind::Path(path) => FlatShape::Path(path.clone()),
                EntityKind::Circle { centre, radius } => {
                    FlatShape::Circle { centre: *centre, radius: *radius }
                }
                EntityKind::Other(name) => {
                    let entry = self.found.ignored.entry((layer, name.clone())).or_insert((0, entity.line));
                    entry.0 += 1;
                    continue;
                }
            };
            self.found.shapes.push(PlacedShape { shape, map, layer, line: entity.line });
        }
        Ok(())
    }

    fn insert(&mut self, insert: &Insert, map: &PlaneMap, layer: &str, line: usize) -> Result<(), DxfFault> {
        let name = insert.block.to_uppercase();
        let drawing = self.drawing;
        let Some(block) = drawing.blocks.get(&name) else {
            let message = format!("there is no block `{}`", shown(&insert.block));
            return Err(DxfFault::new(line, message, "bind external references, and save the drawing again"));
        };
        if self.inside.contains(&name) {
            let message = format!("the block `{}` contains itself", shown(&block.name));
            return Err(DxfFault::new(line, message, "explode the block, or redraw it"));
        }
        if self.inside.len() == MAX_DEPTH {
            let message = format!("blocks are nested more than {MAX_DEPTH} deep");
            return Err(DxfFault::new(line, message, "explode the inner blocks"));
        }
        let copies = insert.columns.saturating_mul(insert.rows);
        if copies > MAX_ENTITIES {
            let message = format!("the block `{}` is inserted {copies} times", shown(&block.name));
            return Err(DxfFault::new(line, message, format!("insert at most {MAX_ENTITIES} copies")));
        }
        let turn = Rotation2::new(insert.rotation).into_inner();
        self.inside.push(name);
        for k in 0..copies {
            let step = Vector2::new((k % insert.columns) as f64, (k / insert.columns) as f64);
            let linear = turn * Matrix2::from_diagonal(&insert.scale);
            let offset = insert.at + turn * step.component_mul(&insert.spacing) - linear * block.base;
            let inner = map.after(&PlaneMap { linear, offset });
            // An insert of an empty block also counts as one entity.
            self.visited += 1;
            self.entities(&block.entities, &inner, Some(layer))?;
        }
        self.inside.pop();
        Ok(())
    }
}
