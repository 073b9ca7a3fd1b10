//! Content of a drawing: unit, layers, blocks and the entities of the model space.

use super::DxfFault;
use super::entities::{Entity, EntityKind, entities};
use super::pairs::{GroupCode, pairs};
use nalgebra::Vector2;
use std::collections::{BTreeMap, HashMap};

/// Content of a DXF drawing, in the unit of the drawing.
#[derive(Debug, Clone, PartialEq)]
pub struct PlanDrawing {
    /// Value of `$INSUNITS` in the header; None if the header does not state it.
    pub unit_code: Option<i64>,
    /// Names of all layers as the drawing writes them. The keys are the names in upper case, because DXF
    /// ignores case.
    pub layers: BTreeMap<String, String>,
    /// Blocks; the keys are the names in upper case.
    pub(super) blocks: HashMap<String, Block>,
    pub(super) entities: Vec<Entity>,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    pub name: String,
    /// Base point of the block. An insert places this point at its insertion point.
    pub base: Vector2<f64>,
    pub entities: Vec<Entity>,
}

impl PlanDrawing {
    /// Reads a drawing from the text of a DXF file.
    ///
    /// # Errors
    /// Returns the first fault: an invalid group code or number, or a file that is cut off.
    pub fn read(text: &str) -> Result<Self, DxfFault> {
        let pairs = pairs(text)?;
        let mut drawing =
            Self { unit_code: None, layers: BTreeMap::new(), blocks: HashMap::new(), entities: Vec::new() };
        for section in pairs.split(|p| p.begins("SECTION")).skip(1) {
            let end = section.iter().position(|p| p.begins("ENDSEC")).unwrap_or(section.len());
            let (name, content) = match section[..end].split_first() {
                Some((name, content)) if name.code == 2 => (name.value, content),
                _ => continue,
            };
            match name {
                "HEADER" => drawing.unit_code = unit_code(content)?,
                "TABLES" => drawing.add_layers(layers(content)),
                "BLOCKS" => drawing.blocks = blocks(content)?,
                "ENTITIES" => drawing.entities = entities(content)?,
                _ => {}
            }
        }
        let used = drawing.blocks.values().flat_map(|b| &b.entities).chain(&drawing.entities);
        let used: Vec<String> = used.map(|e| e.layer.clone()).collect();
        drawing.add_layers(used.iter().map(String::as_str));
        Ok(drawing)
    }

    fn add_layers<'n>(&mut self, names: impl Iterator<Item = &'n str>) {
        for name in names {
            self.layers.entry(name.to_uppercase()).or_insert_with(|| name.to_string());
        }
    }

    /// Returns whether the model space contains no entity that the reader supports.
    pub fn is_empty(&self) -> bool {
        self.entities.iter().all(|e| matches!(e.kind, EntityKind::Other(_)))
    }
}

fn unit_code(header: &[GroupCode<'_>]) -> Result<Option<i64>, DxfFault> {
    let at = header.iter().position(|p| p.code == 9 && p.value == "$INSUNITS");
    at.and_then(|k| header.get(k + 1)).filter(|p| p.code == 70).map(GroupCode::whole).transpose()
}

fn layers<'p>(tables: &'p [GroupCode<'_>]) -> impl Iterator<Item = &'p str> {
    tables.split(|p| p.code == 0).zip(starts(tables)).filter_map(|(own, start)| {
        let name = own.iter().find(|p| p.code == 2)?.value;
        (start == "LAYER").then_some(name)
    })
}

/// Returns the type of each part that [`slice::split`] makes at group codes 0, in order. The type is the
/// value of the group code 0 before the part. No group code 0 precedes the first part, so its type is empty.
fn starts<'p>(pairs: &'p [GroupCode<'_>]) -> impl Iterator<Item = &'p str> {
    std::iter::once("").chain(pairs.iter().filter(|p| p.code == 0).map(|p| p.value))
}

fn blocks(content: &[GroupCode<'_>]) -> Result<HashMap<String, Block>, DxfFault> {
    let mut all = HashMap::new();
    for part in content.split(|p| p.begins("BLOCK")).skip(1) {
        let end = part.iter().position(|p| p.begins("ENDBLK")).unwrap_or(part.len());
        let head = part[..end].iter().position(|p| p.code == 0).unwrap_or(end);
        let first = |code: i32| part[..head].iter().find(|p| p.code == code);
        let number = |code: i32| first(code).map_or(Ok(0.0), GroupCode::number);
        let Some(name) = first(2) else { continue };
        let base = Vector2::new(number(10)?, number(20)?);
        let block = Block { name: name.value.to_string(), base, entities: entities(&part[head..end])? };
        all.insert(name.value.to_uppercase(), block);
    }
    Ok(all)
}
