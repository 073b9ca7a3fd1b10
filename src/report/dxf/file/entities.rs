//! Entities of a DXF file: lines, circles, faces, outlines, texts and references to blocks.

use super::DxfFile;
use crate::report::dxf::planar_face::PlanarFace;
use crate::report::dxf::text::safe;
use crate::units::{mm_from_m, rounded};
use nalgebra::Vector3;

impl DxfFile {
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

    /// Writes a triangle. `hidden` states for each edge whether the edge is invisible. Edge k leads from
    /// corner k to the next corner.
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

    /// Writes a face at height `z` (m) as a REGION.
    pub fn region(&mut self, layer: &str, face: &PlanarFace, z: f64) {
        let out = self.entity("REGION", layer);
        out.put(100, "AcDbModelerGeometry");
        // Version of the embedded format.
        out.put(70, 1);
        face.acis_text(rounded(mm_from_m(z), 6)).iter().for_each(|line| out.put(1, line));
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

    /// Writes a reference to a block at a point, rotated about z by `angle` (rad).
    pub fn insert(&mut self, layer: &str, block: &str, at: &Vector3<f64>, angle: f64) {
        let out = self.entity("INSERT", layer);
        out.put(100, "AcDbBlockReference");
        out.put(2, block);
        out.point(10, at);
        out.real(50, crate::units::deg_from_rad(angle));
    }
}
