//! Entities of a drawing: outlines, circles and inserts of blocks, in the unit of the drawing.

use super::DxfFault;
use super::pairs::GroupCode;
use crate::units::rad_from_deg;
use nalgebra::Vector2;
use std::f64::consts::TAU;

/// Entity with its layer and the line at which it begins.
#[derive(Debug, Clone, PartialEq)]
pub struct Entity {
    pub kind: EntityKind,
    pub layer: String,
    pub line: usize,
    /// Whether the x coordinates of the entity are mirrored, because its extrusion is (0, 0, -1).
    pub is_flipped: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub enum EntityKind {
    Path(PlanPath),
    Circle {
        centre: Vector2<f64>,
        radius: f64,
    },
    Insert(Insert),
    /// Entity that the reader does not support, with its name.
    Other(String),
}

/// Polyline of straight lines and arcs.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanPath {
    pub vertices: Vec<PathVertex>,
    pub is_closed: bool,
}

/// Vertex of a path, with the bulge of the segment that begins at this vertex. The bulge is the tangent of a
/// quarter of the angle of the arc.
///
/// The bulge is positive if the arc runs anticlockwise, and 0 for a straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathVertex {
    pub at: Vector2<f64>,
    pub bulge: f64,
}

/// Insert of a block: rows and columns of copies.
#[derive(Debug, Clone, PartialEq)]
pub struct Insert {
    pub block: String,
    pub at: Vector2<f64>,
    pub scale: Vector2<f64>,
    /// Rotation of the copies about the insertion point, rad.
    pub rotation: f64,
    pub columns: u64,
    pub rows: u64,
    /// Distances between columns and between rows, before the rotation, in the unit of the drawing.
    pub spacing: Vector2<f64>,
}

/// Entities that are not part of a floor plan, such as texts. The reader ignores these entities without a
/// warning.
const ANNOTATIONS: [&str; 16] = [
    "TEXT",
    "MTEXT",
    "DIMENSION",
    "ATTRIB",
    "ATTDEF",
    "SEQEND",
    "POINT",
    "LEADER",
    "MLEADER",
    "MULTILEADER",
    "TOLERANCE",
    "VIEWPORT",
    "IMAGE",
    "WIPEOUT",
    "ACAD_TABLE",
    "VERTEX",
];

/// Reads the entities in a part of a drawing, except annotations and entities of the paper space.
pub fn entities(pairs: &[GroupCode<'_>]) -> Result<Vec<Entity>, DxfFault> {
    let mut all = Vec::new();
    let mut rest = pairs;
    while let Some(start) = rest.first() {
        let (own, after) = split_next(rest);
        rest = after;
        let mut vertices = Vec::new();
        if start.begins("POLYLINE") {
            while rest.first().is_some_and(|p| p.begins("VERTEX")) {
                let (vertex, after) = split_next(rest);
                vertices.push(vertex);
                rest = after;
            }
        }
        if let Some(entity) = entity(own, &vertices)? {
            all.push(entity);
        }
    }
    Ok(all)
}

/// Splits the pairs into the first entity and the rest. The rest begins at the next group code 0.
fn split_next<'p, 't>(pairs: &'p [GroupCode<'t>]) -> (&'p [GroupCode<'t>], &'p [GroupCode<'t>]) {
    let end = pairs.iter().skip(1).position(|p| p.code == 0).map_or(pairs.len(), |k| k + 1);
    pairs.split_at(end)
}

fn entity(own: &[GroupCode<'_>], vertices: &[&[GroupCode<'_>]]) -> Result<Option<Entity>, DxfFault> {
    let Some(start) = own.first().filter(|p| p.code == 0) else { return Ok(None) };
    let is_in_paper_space = own.iter().any(|p| p.code == 67 && p.value == "1");
    if is_in_paper_space || ANNOTATIONS.contains(&start.value) {
        return Ok(None);
    }
    let number = |code: i32, default: f64| find(own, code).map_or(Ok(default), GroupCode::number);
    let point = |x: i32| Ok::<_, DxfFault>(Vector2::new(number(x, 0.0)?, number(x + 10, 0.0)?));
    let other = || EntityKind::Other(start.value.to_string());
    let normal = [number(210, 0.0)?, number(220, 0.0)?, number(230, 1.0)?];
    // A LINE is given in world coordinates, whatever its extrusion.
    let is_tilted = start.value != "LINE" && (normal[0].abs() > 1e-9 || normal[1].abs() > 1e-9);
    let kind = match start.value {
        _ if is_tilted => other(),
        "LINE" => path(vec![straight(point(10)?), straight(point(11)?)], false),
        "LWPOLYLINE" => path(light_vertices(own)?, closes(own)?),
        "POLYLINE" if flags(own)? & (16 | 64) != 0 => other(),
        "POLYLINE" => path(heavy_vertices(vertices)?, closes(own)?),
        "CIRCLE" => EntityKind::Circle { centre: point(10)?, radius: number(40, 0.0)? },
        "ARC" => arc(point(10)?, number(40, 0.0)?, number(50, 0.0)?, number(51, 360.0)?),
        "INSERT" => {
            let copies = |code: i32| find(own, code).map_or(Ok(1), |p| p.whole().map(|n| n.max(1) as u64));
            EntityKind::Insert(Insert {
                block: find(own, 2).map_or("", |p| p.value).to_string(),
                at: point(10)?,
                scale: Vector2::new(number(41, 1.0)?, number(42, 1.0)?),
                rotation: rad_from_deg(number(50, 0.0)?),
                columns: copies(70)?,
                rows: copies(71)?,
                spacing: Vector2::new(number(44, 0.0)?, number(45, 0.0)?),
            })
        }
        _ => other(),
    };
    let layer = find(own, 8).map_or("0", |p| p.value).to_string();
    let is_flipped = start.value != "LINE" && normal[2] < 0.0;
    Ok(Some(Entity { kind, layer, line: start.line, is_flipped }))
}

fn find<'p, 't>(own: &'p [GroupCode<'t>], code: i32) -> Option<&'p GroupCode<'t>> {
    own.iter().find(|p| p.code == code)
}

fn flags(own: &[GroupCode<'_>]) -> Result<i64, DxfFault> {
    find(own, 70).map_or(Ok(0), GroupCode::whole)
}

fn closes(own: &[GroupCode<'_>]) -> Result<bool, DxfFault> {
    Ok(flags(own)? & 1 == 1)
}

fn straight(at: Vector2<f64>) -> PathVertex {
    PathVertex { at, bulge: 0.0 }
}

fn path(vertices: Vec<PathVertex>, is_closed: bool) -> EntityKind {
    EntityKind::Path(PlanPath { vertices, is_closed })
}

/// Returns an arc that runs anticlockwise from the angle `start` to the angle `end`, degrees.
fn arc(centre: Vector2<f64>, radius: f64, start: f64, end: f64) -> EntityKind {
    let [start, end] = [start, end].map(rad_from_deg);
    let sweep = (end - start).rem_euclid(TAU);
    if sweep == 0.0 {
        return EntityKind::Circle { centre, radius };
    }
    let on = |angle: f64| centre + Vector2::new(angle.cos(), angle.sin()) * radius;
    // The arc is divided into two halves, because the bulge of an almost full circle would be nearly
    // infinite.
    let bulge = (sweep / 8.0).tan();
    let half = |angle: f64, bulge: f64| PathVertex { at: on(angle), bulge };
    path(vec![half(start, bulge), half(start + sweep / 2.0, bulge), half(end, 0.0)], false)
}

fn light_vertices(own: &[GroupCode<'_>]) -> Result<Vec<PathVertex>, DxfFault> {
    let mut vertices: Vec<PathVertex> = Vec::new();
    for pair in own {
        match (pair.code, vertices.last_mut()) {
            (10, _) => vertices.push(straight(Vector2::new(pair.number()?, 0.0))),
            (20, Some(last)) => last.at.y = pair.number()?,
            (42, Some(last)) => last.bulge = pair.number()?,
            _ => {}
        }
    }
    Ok(vertices)
}

fn heavy_vertices(vertices: &[&[GroupCode<'_>]]) -> Result<Vec<PathVertex>, DxfFault> {
    let mut all = Vec::new();
    for own in vertices {
        let number = |code: i32| find(own, code).map_or(Ok(0.0), GroupCode::number);
        // A control point of a spline is not a point of the curve.
        if flags(own)? & 16 == 0 {
            all.push(PathVertex { at: Vector2::new(number(10)?, number(20)?), bulge: number(42)? });
        }
    }
    Ok(all)
}
