//! Reader of obstacles that a floor plan draws: `plan = { file, layers, height_mm, units, tolerance_mm }`.

use super::header::header;
use super::placement;
use crate::cell::*;
use crate::files::content::{FileContent, not_needed};
use crate::files::dxf::{DrawingUnit, DxfFault, PlanBody, PlanDrawing, bodies, outlines, text_of};
use crate::files::fault::{Severity, did_you_mean, listed, shown};
use crate::files::keys::equipment::{body, obstacle, plan};
use crate::files::toml::document::Library;
use crate::files::toml::reader::Table;
use crate::files::toml::tree::{At, Node};
use crate::files::toml::value::text;
use std::collections::BTreeSet;

const ASCII_DXF: &str = "save the drawing as DXF (ASCII) in the CAD program";

/// Reads `[obstacle.NAME]` with a plan: one obstacle for each convex part of each outline.
pub fn read(name: &str, t: &mut Table) -> Option<Vec<Equipment>> {
    header(t, &body::SCHEMA)?;
    t.if_given(&body::NAME, Table::text);
    t.if_given(&body::SOURCE, Table::text);
    t.exclude_beside(&obstacle::PLAN);
    let bodies = t.table(&obstacle::PLAN, read_bodies);
    let origin = t.table(&obstacle::PLACEMENT, placement::read_fixed);
    let (bodies, origin) = (bodies?, Placement::from_values(origin?.each_ref().map(Coordinate::start)));
    Some(bodies.into_iter().map(|body| standing(name, body, &origin)).collect())
}

/// Returns a body of a plan as an obstacle; `origin` is the placement of the drawing in the world.
fn standing(name: &str, body: PlanBody, origin: &Placement) -> Equipment {
    let solid = Solid { name: body.name.clone(), shape: body.shape };
    Equipment {
        name: format!("{name}/{}", body.name),
        role: Role::Obstacle,
        surface: None,
        footprint: Rectangle { centre: (0.0, 0.0), size: body.size },
        solids: vec![solid],
        on: None,
        placement: origin.carrying(&body.placement).values().map(Coordinate::Fixed),
        errors: None,
        error_costs: Vec::new(),
        tolerance: PlacementTolerance::default(),
    }
}

fn read_bodies(t: &mut Table) -> Option<Vec<PlanBody>> {
    let unit = t.if_given(&plan::UNITS, Table::word::<DrawingUnit>);
    let (height, tolerance) = (t.number(&plan::HEIGHT), t.number(&plan::TOLERANCE));
    let (names, file) = (t.items(&plan::LAYERS), read_file(t));
    let (unit, height, tolerance, file) = (unit?, height?, tolerance?, file?);
    let drawing = file.checked(PlanDrawing::read(&text_of(&t.lib.sources[file.source].bytes)), t.lib)?;
    let layers = read_layers(names?, &drawing, &file, t.lib);
    let unit = unit_of(unit, &drawing, &file, t);
    let (layers, unit) = (layers?, unit?);
    let found = outlines(&drawing, &layers, unit.metres(), tolerance);
    for warning in &found.warnings {
        file.tell(Severity::Warning, warning, t.lib);
    }
    for error in &found.errors {
        file.tell(Severity::Error, error, t.lib);
    }
    if found.found.is_empty() && found.errors.is_empty() {
        let message = format!("`{}` has no closed outline on the layers in `layers`", shown(&file.path));
        let help = "draw obstacles as closed polylines, circles, or lines and arcs whose ends meet";
        t.error(file.at, message, help);
    }
    file.checked(bodies(&found.found, height), t.lib).filter(|_| found.errors.is_empty())
}

/// File of a plan: its path, its index among the sources, and the place that names it.
struct PlanFile {
    path: String,
    source: usize,
    at: At,
}

impl PlanFile {
    /// Records a fault of the drawing at its line.
    ///
    /// A line of a drawing that is not UTF-8 cannot be shown. The fault is then at the place that names the
    /// file.
    fn tell(&self, severity: Severity, fault: &DxfFault, lib: &mut Library) {
        let source = lib.sources[self.source].text();
        let offset = source.split_inclusive('\n').take(fault.line).map(str::len).sum();
        let (at, message) = match source.is_empty() {
            false => (At { file: self.source, offset }, fault.message.clone()),
            true => (self.at, format!("`{}`, line {}: {}", shown(&self.path), fault.line + 1, fault.message)),
        };
        lib.fault(at, severity, message, fault.help.clone());
    }

    fn checked<T>(&self, read: Result<T, DxfFault>, lib: &mut Library) -> Option<T> {
        read.map_err(|fault| self.tell(Severity::Error, &fault, lib)).ok()
    }
}

/// Reads the path of the drawing and the drawing itself, which must be an ASCII DXF.
fn read_file(t: &mut Table) -> Option<PlanFile> {
    let node = t.get(&plan::FILE)?;
    let name = text(node, plan::FILE.name, t.lib)?;
    let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    if ending != "dxf" {
        let help =
            if ending == "dwg" { format!("convert it: dwg2dxf {}", shown(&name)) } else { ASCII_DXF.into() };
        t.error(node.at, format!("`{}` is not a DXF file", shown(&name)), help);
        return None;
    }
    let path = t.lib.relative(&name, node.at)?;
    let source = t.lib.file(&path, Some(node.at))?;
    let bytes = &t.lib.sources[source].bytes;
    let message = match FileContent::of(bytes) {
        Some(FileContent::Dxf) if bytes.starts_with(b"AutoCAD Binary DXF") => {
            format!("`{}` is a binary DXF, not text", shown(&path))
        }
        Some(content)
            if content != FileContent::Dxf && (content.is_shape() || content == FileContent::Binary) =>
        {
            not_needed(&path, content, "a DXF drawing (ASCII)")
        }
        _ => return Some(PlanFile { path, source, at: node.at }),
    };
    t.error(node.at, message, ASCII_DXF);
    None
}

/// Returns the layers that a plan names, in upper case. A layer that the drawing does not have is a fault.
fn read_layers(
    items: &[Node],
    drawing: &PlanDrawing,
    file: &PlanFile,
    lib: &mut Library,
) -> Option<BTreeSet<String>> {
    let mut all = Some(BTreeSet::new());
    for item in items {
        let name = text(item, "a layer", lib);
        let known = name.as_ref().map(|n| n.to_uppercase()).filter(|n| drawing.layers.contains_key(n));
        if let (Some(name), None) = (name, &known) {
            let near = did_you_mean(&name.to_uppercase(), drawing.layers.keys().map(String::as_str));
            let near = near.and_then(|upper| drawing.layers.get(upper));
            let has = format!("the layers are: {}", listed(drawing.layers.values().map(String::as_str)));
            let help = match near {
                Some(near) => format!("did you mean \"{}\"? {has}", shown(near)),
                None => has,
            };
            lib.error(item.at, format!("`{}` has no layer `{}`", shown(&file.path), shown(&name)), help);
        }
        match (known, &mut all) {
            (Some(layer), Some(layers)) => drop(layers.insert(layer)),
            _ => all = None,
        }
    }
    all
}

/// Returns the unit of a drawing, which the header of the drawing or the key `units` states.
fn unit_of(
    given: Option<DrawingUnit>,
    drawing: &PlanDrawing,
    file: &PlanFile,
    t: &mut Table,
) -> Option<DrawingUnit> {
    let path = shown(&file.path);
    let stated = drawing.unit_code.filter(|code| *code != 0);
    let (message, help) = match (given, stated, stated.and_then(DrawingUnit::of_code)) {
        (Some(given), None, _) => return Some(given),
        (None, Some(_), Some(unit)) => return Some(unit),
        (Some(given), Some(_), Some(unit)) if given == unit => return Some(unit),
        (Some(given), Some(_), Some(unit)) => (
            format!("the header of `{path}` states the unit {}, not {}", unit.name(), given.name()),
            "remove `units`, or correct $INSUNITS in the drawing".to_string(),
        ),
        (_, Some(code), None) => (
            format!("the header of `{path}` states an unsupported unit ($INSUNITS = {code})"),
            "convert the drawing to mm".to_string(),
        ),
        (None, None, _) => (
            format!("the header of `{path}` does not state the unit of the drawing ($INSUNITS)"),
            "add units = \"mm\" or \"cm\" or \"m\" or \"inch\" or \"foot\" to the plan".to_string(),
        ),
    };
    t.error(file.at, message, help);
    None
}
