//! Linear and angular dimensions of a DXF file.
//!
//! AutoCAD reads the points of a dimension, and can edit the dimension. Other programs draw the block of the
//! dimension.

use super::{Codes, DxfFile, MODEL, STYLE};
use crate::report::dxf::text::{safe, width};
use crate::units::{deg_from_rad, mm_from_m, rounded};
use nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// Number of straight lines that approximate an arc.
const ARC_LINES: usize = 24;

impl DxfFile {
    /// Writes the dimension from `a` to `b` along x, or along y if `upright` is true. The dimension line
    /// passes through `through`. `after` is the text after the number: a tolerance or an empty text.
    pub fn dimension(
        &mut self,
        layer: &str,
        [a, b]: [&Vector3<f64>; 2],
        (through, upright): (&Vector3<f64>, bool),
        after: &str,
    ) {
        let foot = |p: &Vector3<f64>| match upright {
            true => Vector3::new(through.x, p.y, p.z),
            false => Vector3::new(p.x, through.y, p.z),
        };
        let [from, to] = [foot(a), foot(b)];
        let (size, angle) = ((to - from).norm(), if upright { FRAC_PI_2 } else { 0.0 });
        let across = if upright { -Vector3::x() } else { Vector3::y() };
        let said = format!("{}{after}", rounded(mm_from_m(size), 1));
        let middle = self.number_place([&from, &to], &across, width(&said, self.height));
        let height = self.height;
        let name = self.dimension_block(|file| {
            file.line(layer, a, &from);
            file.line(layer, b, &to);
            file.line(layer, &from, &to);
            let along = (to - from).try_normalize(1e-9).unwrap_or_else(Vector3::x);
            file.head(layer, &from, &along);
            file.head(layer, &to, &-along);
            let below = middle - across * (0.5 * height);
            file.text(layer, &below, &said, (angle, true));
        });
        let out = self.begun_dimension(layer, (&name, &to, &middle), 0, after);
        out.length(42, size);
        out.put(100, "AcDbAlignedDimension");
        out.point(13, a);
        out.point(14, b);
        out.real(50, deg_from_rad(angle));
        out.put(100, "AcDbRotatedDimension");
    }

    /// Returns the position at which the number of a dimension is centred. The number is above the line or,
    /// if the line is too short, beside its end.
    fn number_place(&self, [from, to]: [&Vector3<f64>; 2], across: &Vector3<f64>, wide: f64) -> Vector3<f64> {
        let lift = across * (0.9 * self.height);
        let along = (to - from).try_normalize(1e-9).unwrap_or_else(Vector3::x);
        if (to - from).norm() > wide + 2.0 * self.height {
            return (from + to) / 2.0 + lift;
        }
        to + along * (wide / 2.0 + 1.5 * self.height) + lift
    }

    /// Writes the angle at `vertex` from world x to the direction `angle` (rad). The radius of the arc is
    /// `radius` (m), and the middle of the number is at `place`.
    pub fn angular_dimension(
        &mut self,
        layer: &str,
        vertex: &Vector3<f64>,
        (angle, radius): (f64, f64),
        (place, after): (&Vector3<f64>, &str),
    ) {
        let at = |turn: f64, radius: f64| vertex + Vector3::new(turn.cos(), turn.sin(), 0.0) * radius;
        let said = format!("{}\u{b0}{after}", rounded(deg_from_rad(angle), 2) + 0.0);
        let height = self.height;
        let name = self.dimension_block(|file| {
            for turn in [0.0, angle] {
                file.line(layer, vertex, &at(turn, radius + height));
            }
            let step = |k: usize| at(angle * k as f64 / ARC_LINES as f64, radius);
            (0..ARC_LINES).for_each(|k| file.line(layer, &step(k), &step(k + 1)));
            let arc = angle.abs() * radius;
            if arc > 2.0 * height {
                let ahead = Vector3::new(0.0, angle.signum(), 0.0);
                let back = Vector3::new(angle.sin(), -angle.cos(), 0.0) * angle.signum();
                file.head(layer, &at(0.0, radius), &ahead);
                file.head(layer, &at(angle, radius), &back);
            }
            let below = place - Vector3::y() * (0.5 * height);
            file.text(layer, &below, &said, (0.0, true));
        });
        let arc = at(angle / 2.0, radius);
        // Bit 128: the text is at a position that the entity states.
        let out = self.begun_dimension(layer, (&name, &arc, place), 5 | 128, after);
        out.real(42, angle.abs());
        out.put(100, "AcDb3PointAngularDimension");
        // AutoCAD measures anticlockwise from the first to the second extension line.
        let [first, second] = if angle < 0.0 { [angle, 0.0] } else { [0.0, angle] };
        out.point(13, &at(first, radius));
        out.point(14, &at(second, radius));
        out.point(15, vertex);
    }

    /// Writes the block of a dimension and returns its name.
    fn dimension_block(&mut self, content: impl FnOnce(&mut Self)) -> String {
        let name = format!("*D{}", self.spaces.len());
        self.add_space(name.clone());
        self.space = self.spaces.len() - 1;
        content(self);
        self.space = MODEL;
        name
    }

    /// Draws the head of an arrow with its tip at `tip`. The head extends from the tip along the unit vector
    /// `along`.
    fn head(&mut self, layer: &str, tip: &Vector3<f64>, along: &Vector3<f64>) {
        let (back, side) = (along * self.height, Vector3::z().cross(along) * (0.2 * self.height));
        self.face(layer, &[*tip, tip + back + side, tip + back - side], [false; 3]);
    }

    /// Begins a dimension with the given block, point on the line or arc, middle of the text, and kind.
    fn begun_dimension(
        &mut self,
        layer: &str,
        (block, through, middle): (&str, &Vector3<f64>, &Vector3<f64>),
        kind: u16,
        after: &str,
    ) -> &mut Codes {
        // `<>` represents the measured value.
        let text = if after.is_empty() { String::new() } else { format!("<>{}", safe(after)) };
        let out = self.entity("DIMENSION", layer);
        out.put(100, "AcDbDimension");
        out.put(2, block);
        out.point(10, through);
        out.point(11, middle);
        // Bit 32: only this dimension refers to its block.
        out.put(70, kind | 32);
        out.put(71, 5);
        out.put(1, text);
        out.put(3, STYLE);
        out
    }
}
