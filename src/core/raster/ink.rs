//! Picture of pixels: averages of the samples, with text and the symbols of the legend on top.

use super::canvas::DepthBuffer;
use super::font;
use super::palette::Colour;
use nalgebra::Vector2;

/// Picture as pixels, row by row from the top left. Colour components are from 0 to 1.
pub struct PixelImage {
    pub width: usize,
    pub height: usize,
    pub pixels: Vec<Colour>,
}

impl PixelImage {
    /// Returns a picture in which each pixel is the mean of `fine` by `fine` samples.
    pub fn of(canvas: &DepthBuffer<[u8; 3]>, fine: usize) -> Self {
        let (width, height) = (canvas.width / fine, canvas.height / fine);
        let share = 1.0 / (255.0 * (fine * fine) as f32);
        let mut pixels = vec![[0.0f32; 3]; width * height];
        for (k, row) in canvas.value.chunks_exact(canvas.width).take(height * fine).enumerate() {
            let line = &mut pixels[k / fine * width..][..width];
            for (pixel, samples) in line.iter_mut().zip(row.chunks_exact(fine)) {
                for sample in samples {
                    pixel.iter_mut().zip(sample).for_each(|(sum, c)| *sum += f32::from(*c) * share);
                }
            }
        }
        Self { width, height, pixels }
    }

    /// Draws a polyline with round ends. Points and width are in px.
    pub fn line(&mut self, points: &[Vector2<f64>], width: f64, colour: Colour) {
        let dot = [points.first().copied().unwrap_or_default(); 2];
        let spans: Vec<&[Vector2<f64>]> =
            if points.len() == 1 { vec![&dot] } else { points.windows(2).collect() };
        let (low, high) =
            points.iter().fold((Vector2::repeat(f64::MAX), Vector2::repeat(f64::MIN)), |(lo, hi), p| {
                (lo.inf(p), hi.sup(p))
            });
        self.cover(low, high, width / 2.0 + 1.0, colour, |p| {
            let near = spans.iter().map(|s| distance(p, s[0], s[1])).fold(f64::MAX, f64::min);
            (width / 2.0 + 0.5 - near).min(width)
        });
    }

    /// Fills the rectangle between two corners, given in px.
    pub fn rectangle(&mut self, low: Vector2<f64>, high: Vector2<f64>, colour: Colour) {
        self.cover(low, high, 1.0, colour, |p| {
            let inside = |k: usize| (p[k] - low[k] + 0.5).min(high[k] - p[k] + 0.5).clamp(0.0, 1.0);
            inside(0) * inside(1)
        });
    }

    fn cover(
        &mut self,
        low: Vector2<f64>,
        high: Vector2<f64>,
        margin: f64,
        colour: Colour,
        share: impl Fn(Vector2<f64>) -> f64,
    ) {
        let span = |lo: f64, hi: f64, size: usize| {
            let end = (hi + margin).ceil().clamp(0.0, size as f64) as usize;
            ((lo - margin).floor().max(0.0) as usize).min(end)..end
        };
        for row in span(low.y, high.y, self.height) {
            for column in span(low.x, high.x, self.width) {
                let share = share(Vector2::new(column as f64 + 0.5, row as f64 + 0.5)).clamp(0.0, 1.0) as f32;
                let pixel = &mut self.pixels[row * self.width + column];
                pixel.iter_mut().zip(colour).for_each(|(p, c)| *p += (c - *p) * share);
            }
        }
    }

    /// Writes a text that starts at the point `at` of the baseline, with capitals `capital` px high.
    pub fn text(&mut self, text: &str, at: Vector2<f64>, capital: f64, colour: Colour) {
        for stroke in font::strokes(text, at, capital) {
            self.line(&stroke, weight(capital), colour);
        }
    }

    /// Writes a text with a rim of another colour, which keeps the text readable over any background.
    pub fn rimmed(&mut self, text: &str, at: Vector2<f64>, capital: f64, colour: Colour, rim: Colour) {
        for stroke in font::strokes(text, at, capital) {
            self.line(&stroke, weight(capital) + 0.55 * capital, rim);
        }
        self.text(text, at, capital, colour);
    }
}

/// Returns the line width, px, of a text whose capitals are `capital` px high.
fn weight(capital: f64) -> f64 {
    (0.135 * capital).max(1.0)
}

/// Returns the distance of the point `p` from the segment between `a` and `b`.
pub fn distance(p: Vector2<f64>, a: Vector2<f64>, b: Vector2<f64>) -> f64 {
    let along = b - a;
    let share = ((p - a).dot(&along) / along.norm_squared().max(1e-12)).clamp(0.0, 1.0);
    (p - a - along * share).norm()
}
