//! Tables of a DXF file: layers, styles, the view, block records.

use super::{Codes, DxfFile, DxfSpace, Layer, STYLE, section};
use crate::units::mm_from_m;
use nalgebra::Vector3;

/// Tables in the order of the file, each with its handle.
const TABLES: [(&str, u64); 9] = [
    ("VPORT", 1),
    ("LTYPE", 2),
    ("LAYER", 3),
    ("STYLE", 4),
    ("VIEW", 5),
    ("UCS", 6),
    ("APPID", 7),
    ("DIMSTYLE", 8),
    ("BLOCK_RECORD", 9),
];

impl DxfFile {
    pub(super) fn tables(&mut self, body: &mut Codes, layers: &[Layer]) {
        section(body, "TABLES", |out| {
            for (table, owner) in TABLES {
                let records = self.records(table, owner, layers);
                out.put(0, "TABLE");
                out.put(2, table);
                out.handle(5, owner);
                out.put(330, 0);
                out.put(100, "AcDbSymbolTable");
                out.put(70, records.len());
                if table == "DIMSTYLE" {
                    out.put(100, "AcDbDimStyleTable");
                    out.put(71, records.len());
                }
                records.iter().for_each(|r| out.0.push_str(&r.0));
                out.put(0, "ENDTAB");
            }
        });
    }

    fn records(&mut self, table: &str, owner: u64, layers: &[Layer]) -> Vec<Codes> {
        match table {
            "VPORT" => vec![self.view_port(owner)],
            "LTYPE" => ["ByBlock", "ByLayer", "Continuous"].map(|n| self.line_type(owner, n)).into(),
            "LAYER" => {
                let zero = Layer { name: "0", colour: 7, is_frozen: false };
                let layers = [zero].into_iter().chain(layers.iter().copied());
                layers.map(|layer| self.layer(owner, layer)).collect()
            }
            "STYLE" => vec![self.text_style(owner)],
            "APPID" => vec![self.record(table, owner, "AcDbRegAppTableRecord", "ACAD")],
            "DIMSTYLE" => vec![self.dimension_style(owner)],
            "BLOCK_RECORD" => {
                let record = |space: &DxfSpace| {
                    let subclass = "AcDbBlockTableRecord";
                    let mut out = begun(table, (5, space.record), owner, subclass, &space.name);
                    out.handle(340, space.layout);
                    out
                };
                self.spaces.iter().map(record).collect()
            }
            _ => Vec::new(),
        }
    }

    fn record(&mut self, table: &str, owner: u64, subclass: &str, name: &str) -> Codes {
        let handle = self.handle();
        let mut out = begun(table, (5, handle), owner, subclass, name);
        out.put(70, 0);
        out
    }

    /// Returns the record of the active view: from above, showing the whole drawing.
    fn view_port(&mut self, owner: u64) -> Codes {
        let (middle, size) = ((self.low + self.high) / 2.0, self.high - self.low);
        let mut out = self.record("VPORT", owner, "AcDbViewportTableRecord", "*Active");
        let mut pair = |code: u16, x: f64, y: f64| {
            out.real(code, x);
            out.real(code + 10, y);
        };
        pair(10, 0.0, 0.0);
        pair(11, 1.0, 1.0);
        pair(12, mm_from_m(middle.x), mm_from_m(middle.y));
        pair(13, 0.0, 0.0);
        pair(14, 10.0, 10.0);
        pair(15, 10.0, 10.0);
        out.point(16, &Vector3::new(0.0, 0.0, 1.0));
        out.point(17, &Vector3::zeros());
        out.length(40, 1.1 * size.y.max(size.x / 1.6));
        out.real(41, 1.6);
        out.real(42, 50.0);
        out
    }

    fn line_type(&mut self, owner: u64, name: &str) -> Codes {
        let mut out = self.record("LTYPE", owner, "AcDbLinetypeTableRecord", name);
        out.put(3, "");
        out.put(72, 65);
        out.put(73, 0);
        out.real(40, 0.0);
        out
    }

    fn layer(&mut self, owner: u64, layer: Layer) -> Codes {
        let handle = self.handle();
        let mut out = begun("LAYER", (5, handle), owner, "AcDbLayerTableRecord", layer.name);
        out.put(70, u8::from(layer.is_frozen));
        out.put(62, layer.colour);
        out.put(6, "Continuous");
        out
    }

    fn text_style(&mut self, owner: u64) -> Codes {
        let mut out = self.record("STYLE", owner, "AcDbTextStyleTableRecord", "Standard");
        out.real(40, 0.0);
        out.real(41, 1.0);
        out.real(50, 0.0);
        out.put(71, 0);
        out.length(42, self.height);
        out.put(3, "txt");
        out.put(4, "");
        out
    }

    /// Returns the record of the dimension style: numbers in mm with one decimal, above the dimension lines.
    fn dimension_style(&mut self, owner: u64) -> Codes {
        let handle = self.handle();
        let mut out = begun("DIMSTYLE", (105, handle), owner, "AcDbDimStyleTableRecord", STYLE);
        out.put(70, 0);
        for (code, share) in [(41, 1.0), (42, 0.3), (44, 0.3), (140, 1.0), (147, 0.3)] {
            out.length(code, share * self.height);
        }
        for (code, value) in [(73, 0), (74, 0), (77, 1), (78, 8), (271, 1), (277, 2)] {
            out.put(code, value);
        }
        out
    }
}

/// Begins a record of a table with its handle, owner and name. The group code of the handle depends on the
/// table.
fn begun(table: &str, (code, handle): (u16, u64), owner: u64, subclass: &str, name: &str) -> Codes {
    let mut out = Codes::default();
    out.put(0, table);
    out.handle(code, handle);
    out.handle(330, owner);
    out.put(100, "AcDbSymbolTableRecord");
    out.put(100, subclass);
    out.put(2, name);
    out
}
