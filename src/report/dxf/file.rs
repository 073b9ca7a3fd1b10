//! DXF file of release 2000 (AC1015): group codes, tables, blocks, objects.
//!
//! The writer follows the DXF reference of Autodesk. Every table, record, block and entity has a unique
//! handle and names its owner. The dxf crate does not write such handles and owners. Lengths are given in m
//! and written in mm.

mod tables;

use super::text::safe;
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

/// Layer: name and AutoCAD colour index.
pub type Layer = (&'static str, u16);

/// Container of entities: model space, paper space or the block of a dimension.
struct DxfSpace {
    name: String,
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
/// First handle of the objects that are neither tables nor dictionaries.
const FIRST_HANDLE: u64 = 0x10;

/// Name of the dimension style.
const STYLE: &str = "MM";

/// Drawing under construction; entities go to the model space.
pub struct DxfFile {
    next: u64,
    spaces: Vec<DxfSpace>,
    /// Index of the space that gets the next entities.
    space: usize,
    /// Height of texts, m.
    pub height: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl DxfFile {
    pub fn new(height: f64) -> Self {
        let (low, high) = (Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN));
        let mut file = Self { next: FIRST_HANDLE, spaces: Vec::new(), space: 0, height, low, high };
        file.add_space("*Model_Space".into());
        file.add_space("*Paper_Space".into());
        file
    }

    fn handle(&mut self) -> u64 {
        self.next += 1;
        self.next - 1
    }

    fn add_space(&mut self, name: String) {
        let [record, begin, end] = [0; 3].map(|_| self.handle());
        self.spaces.push(DxfSpace { name, record, begin, end, content: Codes::default() });
    }

    /// Begins an entity on a layer in the current space.
    fn entity(&mut self, kind: &str, layer: &str) -> &mut Codes {
        let handle = self.handle();
        let DxfSpace { record, content, .. } = &mut self.spaces[self.space];
        content.put(0, kind);
        content.handle(5, handle);
        content.handle(330, *record);
        content.put(100, "AcDbEntity");
        content.put(8, layer);
        content
    }

    fn seen(&mut self, p: &Vector3<f64>) {
        (self.low, self.high) = (self.low.inf(p), self.high.sup(p));
    }

    pub fn line(&mut self, layer: &str, a: &Vector3<f64>, b: &Vector3<f64>) {
        let out = self.entity("LINE", layer);
        out.put(100, "AcDbLine");
        out.point(10, a);
        out.point(11, b);
        [a, b].into_iter().for_each(|p| self.seen(p));
    }

    pub fn circle(&mut self, layer: &str, centre: &Vector3<f64>, radius: f64) {
        let out = self.entity("CIRCLE", layer);
        out.put(100, "AcDbCircle");
        out.point(10, centre);
        out.length(40, radius);
        let half = Vector3::new(radius, radius, 0.0);
        [centre - half, centre + half].iter().for_each(|p| self.seen(p));
    }

    /// Writes a triangle. `hidden` tells for each edge, from a corner to the next one, whether it is
    /// invisible.
    pub fn face(&mut self, layer: &str, corners: &[Vector3<f64>; 3], hidden: [bool; 3]) {
        let out = self.entity("3DFACE", layer);
        out.put(100, "AcDbFace");
        // The fourth corner repeats the third, and the edge between them is invisible.
        for (k, corner) in [0, 1, 2, 2].into_iter().enumerate() {
            out.point(10 + k as u16, &corners[corner]);
        }
        let flags = [(hidden[0], 1), (hidden[1], 2), (true, 4), (hidden[2], 8)];
        out.put(70, flags.iter().filter(|(is, _)| *is).map(|(_, bit)| bit).sum::<u16>());
        corners.iter().for_each(|p| self.seen(p));
    }

    /// Writes a closed horizontal outline at height `z`; world frame, m.
    pub fn outline(&mut self, layer: &str, points: &[(f64, f64)], z: f64) {
        let out = self.entity("LWPOLYLINE", layer);
        out.put(100, "AcDbPolyline");
        out.put(90, points.len());
        out.put(70, 1);
        out.length(38, z);
        for (x, y) in points {
            out.length(10, *x);
            out.length(20, *y);
        }
        points.iter().for_each(|(x, y)| self.seen(&Vector3::new(*x, *y, z)));
    }

    /// Writes a closed line in space.
    pub fn ring(&mut self, layer: &str, points: &[Vector3<f64>]) {
        let out = self.entity("POLYLINE", layer);
        out.put(100, "AcDb3dPolyline");
        out.put(66, 1);
        out.point(10, &Vector3::zeros());
        out.put(70, 9);
        for p in points {
            let out = self.entity("VERTEX", layer);
            out.put(100, "AcDbVertex");
            out.put(100, "AcDb3dPolylineVertex");
            out.point(10, p);
            out.put(70, 32);
            self.seen(p);
        }
        self.entity("SEQEND", layer);
    }

    /// Writes a text that starts at `at` or is centred on it, rotated by `angle` (rad).
    pub fn text(&mut self, layer: &str, at: &Vector3<f64>, text: &str, (angle, centred): (f64, bool)) {
        let (height, text) = (self.height, safe(text));
        let out = self.entity("TEXT", layer);
        out.put(100, "AcDbText");
        out.point(10, at);
        out.length(40, height);
        out.put(1, text);
        out.real(50, crate::units::deg_from_rad(angle));
        if centred {
            out.put(72, 1);
            out.point(11, at);
        }
        out.put(100, "AcDbText");
        self.seen(at);
    }

    /// Writes the dimension from `a` to `b` along x, or along y if `upright`. The dimension line passes
    /// through `through`. AutoCAD reads an associative dimension; other programs draw the block of the
    /// dimension.
    pub fn dimension(
        &mut self,
        layer: &str,
        [a, b]: [&Vector3<f64>; 2],
        through: &Vector3<f64>,
        upright: bool,
    ) {
        let foot = |p: &Vector3<f64>| match upright {
            true => Vector3::new(through.x, p.y, p.z),
            false => Vector3::new(p.x, through.y, p.z),
        };
        let [from, to] = [foot(a), foot(b)];
        let (size, angle) = ((to - from).norm(), if upright { std::f64::consts::FRAC_PI_2 } else { 0.0 });
        let across = if upright { -Vector3::x() } else { Vector3::y() };
        let middle = (from + to) / 2.0 + across * (0.4 * self.height);
        let name = format!("*D{}", self.spaces.len() - 1);
        self.add_space(name.clone());
        self.space = self.spaces.len() - 1;
        self.line(layer, a, &from);
        self.line(layer, b, &to);
        self.line(layer, &from, &to);
        let along = (to - from).try_normalize(1e-9).unwrap_or_else(Vector3::x) * self.height;
        for (tip, along) in [(from, along), (to, -along)] {
            let side = across * (0.2 * self.height);
            self.face(layer, &[tip, tip + along + side, tip + along - side], [false; 3]);
        }
        self.text(layer, &middle, &rounded(mm_from_m(size), 1).to_string(), (angle, true));
        self.space = 0;
        let out = self.entity("DIMENSION", layer);
        out.put(100, "AcDbDimension");
        out.put(2, name);
        out.point(10, &to);
        out.point(11, &middle);
        // The dimension is rotated and has a block of its own.
        out.put(70, 32);
        out.put(71, 5);
        out.length(42, size);
        out.put(1, "");
        out.put(3, STYLE);
        out.put(100, "AcDbAlignedDimension");
        out.point(13, a);
        out.point(14, b);
        out.real(50, crate::units::deg_from_rad(angle));
        out.put(100, "AcDbRotatedDimension");
    }

    /// Returns the whole file.
    pub fn bytes(mut self, layers: &[Layer]) -> Vec<u8> {
        let mut body = Codes::default();
        self.tables(&mut body, layers);
        self.blocks(&mut body);
        section(&mut body, "ENTITIES", |out| out.0.push_str(&self.spaces[0].content.0));
        section(&mut body, "OBJECTS", |out| {
            out.put(0, "DICTIONARY");
            out.handle(5, ROOT);
            out.put(330, 0);
            out.put(100, "AcDbDictionary");
            out.put(281, 1);
            out.put(3, "ACAD_GROUP");
            out.handle(350, GROUPS);
            out.put(0, "DICTIONARY");
            out.handle(5, GROUPS);
            out.handle(330, ROOT);
            out.put(100, "AcDbDictionary");
            out.put(281, 1);
        });
        body.put(0, "EOF");
        let mut head = Codes::default();
        section(&mut head, "HEADER", |out| self.header(out));
        (head.0 + &body.0).into_bytes()
    }

    /// Writes the header. It has no date and no GUID, so equal drawings give equal files.
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
                out.put(70, u8::from(k > 1));
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

fn section(out: &mut Codes, name: &str, content: impl FnOnce(&mut Codes)) {
    out.put(0, "SECTION");
    out.put(2, name);
    content(out);
    out.put(0, "ENDSEC");
}
