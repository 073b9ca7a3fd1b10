//! DXF file of release 2000 (AC1015): group codes, tables, blocks, objects.
//!
//! The writer follows the DXF reference of Autodesk. Every table, record, block and entity has a unique
//! handle and names its owner. The dxf crate does not write such handles and owners. Lengths are given in m
//! and written in mm.

mod dimensions;
mod entities;
mod layouts;
mod tables;

use crate::units::{mm_from_m, rounded};
use nalgebra::Vector3;
use std::fmt::{Display, Write};

/// Text of a DXF file under construction: lines of group codes and values.
#[derive(Default)]
struct Codes(String);

impl Codes {
    fn put(&mut self, code: u16, value: impl Display) {
        // Writing to a String cannot fail.
        let _ = write!(self.0, "{code:>3}\r\n{value}\r\n");
    }

    fn real(&mut self, code: u16, value: f64) {
        self.put(code, format_args!("{:?}", rounded(value, 6)));
    }

    /// Writes a length, given in m.
    fn length(&mut self, code: u16, m: f64) {
        self.real(code, mm_from_m(m));
    }

    fn point(&mut self, code: u16, p: &Vector3<f64>) {
        (0..3).for_each(|k| self.length(code + 10 * k as u16, p[k]));
    }

    fn handle(&mut self, code: u16, handle: u64) {
        self.put(code, format_args!("{handle:X}"));
    }
}

/// Layer of a drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Layer {
    pub name: &'static str,
    /// AutoCAD colour index.
    pub colour: u16,
    /// Whether CAD programs hide the layer until the user thaws it.
    pub is_frozen: bool,
}

/// Container of entities: model space, paper space, the block of a dimension or the block of an object.
struct DxfSpace {
    name: String,
    /// Handle of the layout of model space or paper space; 0 for a block.
    layout: u64,
    /// Handle of the block record; `begin` and `end` are the handles of the BLOCK and ENDBLK entities.
    record: u64,
    begin: u64,
    end: u64,
    content: Codes,
}

impl DxfSpace {
    /// Writes the beginning or the end of the block of this space.
    fn edge(&self, out: &mut Codes, kind: &str, handle: u64, subclass: &str) {
        out.put(0, kind);
        out.handle(5, handle);
        out.handle(330, self.record);
        out.put(100, "AcDbEntity");
        out.put(8, "0");
        out.put(100, subclass);
    }
}

/// Handle of the root dictionary; the tables have smaller handles.
const ROOT: u64 = 0xA;
const GROUPS: u64 = 0xB;
/// Handle of the dictionary of layouts.
const LAYOUTS: u64 = 0xC;
/// First handle of the objects that are neither tables nor dictionaries.
const FIRST_HANDLE: u64 = 0x10;

/// Name of the dimension style.
const STYLE: &str = "MM";

/// Index of the model space among the spaces.
const MODEL: usize = 0;
/// Index of the paper space among the spaces.
const PAPER: usize = 1;

/// Drawing under construction; entities go to the model space unless a block or the paper space is being
/// written.
pub struct DxfFile {
    next: u64,
    spaces: Vec<DxfSpace>,
    /// Index of the space that gets the next entities.
    space: usize,
    /// Height of texts, m.
    pub height: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
    /// Width and height of the paper, m.
    paper: (f64, f64),
}

impl DxfFile {
    pub fn new(height: f64) -> Self {
        let (low, high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        let (spaces, paper) = (Vec::new(), (0.0, 0.0));
        let mut file = Self { next: FIRST_HANDLE, spaces, space: MODEL, height, low, high, paper };
        for name in ["*Model_Space", "*Paper_Space"] {
            file.add_space(name.into());
            let layout = file.handle();
            if let Some(space) = file.spaces.last_mut() {
                space.layout = layout;
            }
        }
        file
    }

    fn handle(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    fn add_space(&mut self, name: String) {
        let [record, begin, end] = [0; 3].map(|_| self.handle());
        self.spaces.push(DxfSpace { name, layout: 0, record, begin, end, content: Codes::default() });
    }

    /// Writes a block. The entities of `content` belong to the block; their coordinates are in the frame of
    /// the block.
    ///
    /// Returns the name of the block: `name`, with a number if another block has this name.
    pub fn block(&mut self, name: &str, content: impl FnOnce(&mut Self)) -> String {
        let name = self.free_name(&block_name(name));
        let before = (self.space, self.low, self.high);
        self.add_space(name.clone());
        self.space = self.spaces.len() - 1;
        content(self);
        // The content of a block has no position in the model until the block is inserted.
        (self.space, self.low, self.high) = before;
        name
    }

    fn free_name(&self, name: &str) -> String {
        let is_free = |name: &str| self.spaces.iter().all(|space| !space.name.eq_ignore_ascii_case(name));
        let numbered = (2..).map(|k| format!("{name}_{k}"));
        std::iter::once(name.to_string()).chain(numbered).find(|name| is_free(name)).unwrap_or_default()
    }

    /// Writes the paper space: a sheet of this size (m) with the entities that `content` draws. The
    /// coordinates are on paper, m.
    pub fn paper(&mut self, size: (f64, f64), content: impl FnOnce(&mut Self)) {
        let before = (self.space, self.low, self.high, self.height);
        (self.space, self.paper) = (PAPER, size);
        self.main_viewport();
        content(self);
        (self.space, self.low, self.high, self.height) = before;
    }

    /// Returns the extents of the model, m.
    pub fn extents(&self) -> (Vector3<f64>, Vector3<f64>) {
        (self.low, self.high)
    }

    /// Widens the extents of the model so that they include a point.
    pub fn include(&mut self, p: &Vector3<f64>) {
        self.seen(p);
    }

    /// Begins an entity on a layer in the current space.
    fn entity(&mut self, kind: &str, layer: &str) -> &mut Codes {
        let handle = self.handle();
        let DxfSpace { record, content, .. } = &mut self.spaces[self.space];
        content.put(0, kind);
        content.handle(5, handle);
        content.handle(330, *record);
        content.put(100, "AcDbEntity");
        if self.space == PAPER {
            content.put(67, 1);
        }
        content.put(8, layer);
        content
    }

    fn seen(&mut self, p: &Vector3<f64>) {
        (self.low, self.high) = (self.low.inf(p), self.high.sup(p));
    }
    /// Returns the whole file.
    pub fn bytes(mut self, layers: &[Layer]) -> Vec<u8> {
        let mut body = Codes::default();
        self.tables(&mut body, layers);
        self.blocks(&mut body);
        section(&mut body, "ENTITIES", |out| {
            [MODEL, PAPER].iter().for_each(|space| out.0.push_str(&self.spaces[*space].content.0));
        });
        section(&mut body, "OBJECTS", |out| {
            dictionary(out, ROOT, 0, &[("ACAD_GROUP", GROUPS), ("ACAD_LAYOUT", LAYOUTS)]);
            dictionary(out, GROUPS, ROOT, &[]);
            self.layouts(out);
        });
        body.put(0, "EOF");
        let mut head = Codes::default();
        section(&mut head, "HEADER", |out| self.header(out));
        (head.0 + &body.0).into_bytes()
    }

    /// Writes the header. The header has no date and no GUID, so equal drawings give equal files.
    fn header(&self, out: &mut Codes) {
        let name = |out: &mut Codes, name: &str| out.put(9, name);
        name(out, "$ACADVER");
        out.put(1, "AC1015");
        name(out, "$DWGCODEPAGE");
        out.put(3, "ANSI_1252");
        name(out, "$HANDSEED");
        out.handle(5, self.next);
        // $INSUNITS 4 means millimetres, $MEASUREMENT 1 metric, and $LUNITS 2 decimal numbers.
        for (what, value) in [("$INSUNITS", 4), ("$MEASUREMENT", 1), ("$LUNITS", 2), ("$LUPREC", 1)] {
            name(out, what);
            out.put(70, value);
        }
        for (what, p) in [("$EXTMIN", &self.low), ("$EXTMAX", &self.high)] {
            name(out, what);
            out.point(10, p);
        }
        name(out, "$DIMSTYLE");
        out.put(2, STYLE);
        name(out, "$CLAYER");
        out.put(8, "0");
    }

    fn blocks(&self, body: &mut Codes) {
        section(body, "BLOCKS", |out| {
            for (k, space) in self.spaces.iter().enumerate() {
                space.edge(out, "BLOCK", space.begin, "AcDbBlockBegin");
                out.put(2, &space.name);
                // The block of a dimension is anonymous.
                out.put(70, u8::from(space.name.starts_with("*D")));
                out.point(10, &Vector3::zeros());
                out.put(3, &space.name);
                out.put(1, "");
                if k > 1 {
                    out.0.push_str(&space.content.0);
                }
                space.edge(out, "ENDBLK", space.end, "AcDbBlockEnd");
            }
        });
    }
}

/// Returns a name that a block may have. Characters other than letters, digits and a few signs become `_`.
fn block_name(name: &str) -> String {
    let allowed = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '$' | ' ');
    name.chars().map(|c| if allowed(c) { c } else { '_' }).collect::<String>().trim().to_string()
}

/// Writes a dictionary with its entries: names and handles.
fn dictionary(out: &mut Codes, handle: u64, owner: u64, entries: &[(&str, u64)]) {
    out.put(0, "DICTIONARY");
    out.handle(5, handle);
    out.handle(330, owner);
    out.put(100, "AcDbDictionary");
    out.put(281, 1);
    for (name, handle) in entries {
        out.put(3, name);
        out.handle(350, *handle);
    }
}

fn section(out: &mut Codes, name: &str, content: impl FnOnce(&mut Codes)) {
    out.put(0, "SECTION");
    out.put(2, name);
    content(out);
    out.put(0, "ENDSEC");
}
