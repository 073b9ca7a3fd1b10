//! Stroke font: letters as polylines, so that pictures have text without font files.
//!
//! Each letter is drawn on a grid. The baseline is at height 3. Lower-case letters reach up to 9, capitals up
//! to 12 (hexadecimal c), and descenders down to 0. Two hexadecimal digits give a point: the distance to the
//! right, then the height. A stroke that begins with ~ is a curve, and a stroke of one point is a dot.

use nalgebra::Vector2;

/// Height of capitals above the baseline, in steps of the font's grid.
pub const CAPITAL: f64 = 9.0;
const BASE: f64 = 3.0;
/// Space between two letters, in steps of the font's grid.
const LETTER_GAP: f64 = 2.3;
const SPACE: f64 = 2.2;

/// Strokes of the characters from the space (code 32) to the tilde (code 126).
const GLYPHS: [&str; 95] = [
    "",
    "0c06 03",
    "0c09 2c29",
    "2c13 5c43 0969 0666",
    "~6a4c2c0b086764432305 3d32",
    "6c03 ~0a0c2c29090a ~444666634344",
    "~63191b2c3c4b4a0604233367",
    "0c09",
    "~2d0b0422",
    "~0d2b2402",
    "2b25 0a46 4a06",
    "3a34 0767",
    "1402",
    "0747",
    "03",
    "4d02",
    "~1c0a051343555a4c1c",
    "0a2c23 0343",
    "~0a1c5c6a6803 0363",
    "~0b1c5c6b6828 ~286864531304",
    "434c0666",
    "6c0c07 ~0718586764531304",
    "~5c2c090513536567581806",
    "0c6c23",
    "~1c0a18485a4c1c ~18051343554818",
    "~1343666a5c1c0a08175769",
    "08 03",
    "18 1402",
    "5a0754",
    "0868 0565",
    "0a5704",
    "~0b1c4c5b592726 23",
    "~4828254548 ~4845656a5c1c0a051353",
    "033c63 1656",
    "030c ~0c4c5b594808 ~085867645303",
    "~6a5c1c0a05135365",
    "030c ~0c3c6a653303",
    "6c0c0363 0858",
    "6c0c03 0858",
    "~6a5c1c0a05135365 656737",
    "0c03 6c63 0868",
    "0c03",
    "~4c44331305",
    "0c03 6c06 2863",
    "0c0353",
    "030c376c63",
    "030c636c",
    "~3c1c0a051353656a5c3c",
    "030c ~0c5c6b685707",
    "~3c1c0a051353656a5c3c 4562",
    "030c ~0c5c6b685707 3763",
    "~6a4c2c0b086764432305",
    "0c6c 3c33",
    "~0c051353656c",
    "0c336c",
    "0c234b638c",
    "0c63 6c03",
    "0c386c 3833",
    "0c6c0363",
    "2d0d0222",
    "0d42",
    "0d2d2202",
    "0a3c6a",
    "0262",
    "0c2a",
    "~5849190705134354 5953",
    "0c03 ~0819495755431304",
    "~5849190705134354",
    "~5849190705134354 5c53",
    "0656 ~565849190705134354",
    "~3c2c1b19 1913 0939",
    "~5849190705134354 ~5951401001",
    "0c03 ~0719495753",
    "0903 0b",
    "~29211000 2b",
    "0c03 4905 2753",
    "~0c041323",
    "0903 ~0719394743 ~4759798783",
    "0903 ~0719495753",
    "~190705134355574919",
    "0900 ~0819495755431304",
    "~5849190705134354 5950",
    "0903 ~071939",
    "~58491908075554431304",
    "~1c142333 0939",
    "~0905134355 5953",
    "092349",
    "0923486389",
    "0953 5903",
    "0923 4910",
    "09590353",
    "~3d1d1807 ~07161131",
    "0d01",
    "~0d2d2837 ~37262101",
    "~06184658",
];

/// Strokes of a box, drawn for a character that the font does not have.
const UNKNOWN: &str = "030c6c6303";

fn glyph(c: char) -> &'static str {
    let index = (c as usize).checked_sub(32);
    index.and_then(|k| GLYPHS.get(k).copied()).unwrap_or(UNKNOWN)
}

/// Returns the width of a text without margins, in the unit of `capital`. The argument `capital` is the
/// height of the capitals.
pub fn width(text: &str, capital: f64) -> f64 {
    let all: f64 = text.chars().map(advance).sum();
    (all - LETTER_GAP).max(0.0) * capital / CAPITAL
}

fn advance(c: char) -> f64 {
    let strokes = glyph(c).split(' ').flat_map(points);
    if c == ' ' { SPACE + LETTER_GAP } else { strokes.map(|p| p.x).fold(0.0, f64::max) + LETTER_GAP }
}

/// Returns the strokes of a text that starts at the point `at` of the baseline. The y axis points down.
///
/// Capitals have the height `capital`.
pub fn strokes(text: &str, at: Vector2<f64>, capital: f64) -> Vec<Vec<Vector2<f64>>> {
    let unit = capital / CAPITAL;
    let (mut x, mut all) = (0.0, Vec::new());
    for c in text.chars() {
        for stroke in glyph(c).split(' ').filter(|s| !s.is_empty()) {
            let place = |p: Vector2<f64>| at + Vector2::new(x + p.x, BASE - p.y) * unit;
            let line = if stroke.starts_with('~') { rounded(&points(stroke)) } else { points(stroke) };
            all.push(line.into_iter().map(place).collect());
        }
        x += advance(c);
    }
    all
}

fn points(stroke: &str) -> Vec<Vector2<f64>> {
    let digits: Vec<f64> = stroke.chars().filter_map(|c| c.to_digit(16)).map(f64::from).collect();
    digits.chunks_exact(2).map(|p| Vector2::new(p[0], p[1])).collect()
}

/// Returns a line smoothed by two rounds of corner cutting (Chaikin 1974). The ends of an open line do not
/// move, and a closed line remains closed.
fn rounded(line: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let closed = line.first() == line.last();
    let mut line = line.to_vec();
    for _ in 0..2 {
        let ends = (line.first().copied(), line.last().copied());
        let cut = line.windows(2).flat_map(|p| [p[0] * 0.75 + p[1] * 0.25, p[0] * 0.25 + p[1] * 0.75]);
        let mut next: Vec<_> = cut.collect();
        match (closed, ends, next.first().copied()) {
            (true, _, Some(first)) => next.push(first),
            (false, (Some(first), Some(last)), _) => {
                next.insert(0, first);
                next.push(last);
            }
            _ => {}
        }
        line = next;
    }
    line
}
