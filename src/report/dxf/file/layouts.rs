//! Layouts of a DXF file: model space, and a paper with a viewport on the model.

use super::{Codes, DxfFile, LAYOUTS, MODEL, PAPER, ROOT, dictionary};
use crate::units::mm_from_m;
use nalgebra::Vector3;

/// Names of the layouts, in the order of the spaces.
const NAMES: [&str; 2] = ["Model", "Layout1"];

impl DxfFile {
    /// Writes the dictionary of the layouts, then the layouts themselves.
    pub(super) fn layouts(&self, out: &mut Codes) {
        let entries = [MODEL, PAPER].map(|space| (NAMES[space], self.spaces[space].layout));
        dictionary(out, LAYOUTS, ROOT, &entries);
        [MODEL, PAPER].iter().for_each(|space| self.layout(out, *space));
    }

    fn layout(&self, out: &mut Codes, space: usize) {
        let is_paper = space == PAPER;
        let (width, height) = if is_paper { self.paper } else { (0.0, 0.0) };
        out.put(0, "LAYOUT");
        out.handle(5, self.spaces[space].layout);
        out.handle(330, LAYOUTS);
        out.put(100, "AcDbPlotSettings");
        out.put(1, "");
        out.put(2, "none_device");
        out.put(4, "");
        out.put(6, "");
        [40, 41, 42, 43].into_iter().for_each(|margin| out.real(margin, 0.0));
        out.length(44, width);
        out.length(45, height);
        [46, 47, 48, 49, 140, 141].into_iter().for_each(|code| out.real(code, 0.0));
        [142, 143].into_iter().for_each(|scale| out.real(scale, 1.0));
        // Bit 1024 marks model space. Plot type 5 plots the layout, and plot type 0 the displayed part.
        out.put(70, if is_paper { 0 } else { 1024 });
        // Plot units are millimetres, and the plot is not rotated.
        out.put(72, 1);
        out.put(73, 0);
        out.put(74, if is_paper { 5 } else { 0 });
        out.put(7, "");
        // Scale 1:1.
        out.put(75, 16);
        out.real(147, 1.0);
        out.real(148, 0.0);
        out.real(149, 0.0);
        out.put(100, "AcDbLayout");
        out.put(1, NAMES[space]);
        out.put(70, 1);
        out.put(71, space);
        let (low, high) = match is_paper {
            true => (Vector3::zeros(), Vector3::new(width, height, 0.0)),
            false => self.extents(),
        };
        let mut flat = |code: u16, p: &Vector3<f64>| {
            out.length(code, p.x);
            out.length(code + 10, p.y);
        };
        flat(10, &low);
        flat(11, &high);
        out.point(12, &Vector3::zeros());
        out.point(14, &low);
        out.point(15, &high);
        out.real(146, 0.0);
        out.point(13, &Vector3::zeros());
        unit_vector(out, 16, 0);
        unit_vector(out, 17, 1);
        out.put(76, 0);
        out.handle(330, self.spaces[space].record);
    }

    /// Writes the viewport that represents the paper itself.
    pub(super) fn main_viewport(&mut self) {
        let (width, height) = self.paper;
        let centre = Vector3::new(width / 2.0, height / 2.0, 0.0);
        self.numbered_viewport("0", 1, (&centre, (width, height)), (&centre, height));
    }

    /// Writes a viewport on the model. `on_paper` is the middle and the size of the viewport on paper, m.
    /// `of_model` is the point of the model in the middle of the viewport, and the visible height of the
    /// model, m.
    pub fn viewport(
        &mut self,
        layer: &str,
        on_paper: (&Vector3<f64>, (f64, f64)),
        of_model: (&Vector3<f64>, f64),
    ) {
        self.numbered_viewport(layer, 2, on_paper, of_model);
    }

    fn numbered_viewport(
        &mut self,
        layer: &str,
        number: u16,
        (centre, (width, height)): (&Vector3<f64>, (f64, f64)),
        (target, shown): (&Vector3<f64>, f64),
    ) {
        let out = self.entity("VIEWPORT", layer);
        out.put(100, "AcDbViewport");
        out.point(10, centre);
        out.length(40, width);
        out.length(41, height);
        out.put(68, number);
        out.put(69, number);
        let mut pair = |code: u16, x: f64, y: f64| {
            out.real(code, x);
            out.real(code + 10, y);
        };
        pair(12, mm_from_m(target.x), mm_from_m(target.y));
        pair(13, 0.0, 0.0);
        pair(14, 10.0, 10.0);
        pair(15, 10.0, 10.0);
        unit_vector(out, 16, 2);
        out.point(17, &Vector3::zeros());
        out.real(42, 50.0);
        out.real(43, 0.0);
        out.real(44, 0.0);
        out.length(45, shown);
        out.real(50, 0.0);
        out.real(51, 0.0);
        out.put(72, 100);
        // Bit 16384 locks the scale.
        out.put(90, 32768 + 16384);
        out.put(1, "");
        out.put(281, 0);
        out.put(71, 1);
        out.put(74, 0);
        out.point(110, &Vector3::zeros());
        unit_vector(out, 111, 0);
        unit_vector(out, 112, 1);
        out.put(79, 0);
        out.real(146, 0.0);
    }
}

/// Writes the unit vector along an axis.
fn unit_vector(out: &mut Codes, code: u16, axis: usize) {
    (0..3).for_each(|k| out.real(code + 10 * k as u16, if k == axis { 1.0 } else { 0.0 }));
}
