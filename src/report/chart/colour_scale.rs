//! Colour scale of a heat map: colour bands, and the bar that explains them.

use super::axes::{AxisScale, round_numbers, step};
use super::canvas::{Anchor, ChartCanvas, Ink};
use super::words;
use crate::colours::viridis_hex;

/// Number of colour bands from one iso-line to the next.
const BANDS: f64 = 4.0;

/// Colour scale over a span of values in the unit of the chart.
pub struct ColourScale {
    low: f64,
    high: f64,
    /// Difference between the values of neighbouring iso-lines.
    pub step: f64,
}

impl ColourScale {
    /// Returns the colour scale from `low` to `high`. The scale has only one colour if `high` exceeds `low`
    /// by at most 1e-9 of `high`.
    pub fn new(low: f64, high: f64) -> Self {
        let high = if high - low > 1e-9 * high.abs() { high } else { low };
        Self { low, high, step: step(high - low, 8.0) }
    }

    /// Returns the values of the iso-lines.
    pub fn levels(&self) -> Vec<f64> {
        let Self { low, high, .. } = *self;
        if high > low { round_numbers(low, high, self.step).collect() } else { Vec::new() }
    }

    /// Returns the lower edge and the colour of each band.
    pub fn bands(&self) -> Vec<(f64, String)> {
        let Self { low, high, .. } = *self;
        let apart = self.step / BANDS;
        let mut edges = vec![low];
        if high > low {
            edges.extend(round_numbers(low, high, apart).filter(|e| *e > low && *e < high));
        }
        let upper = edges.iter().skip(1).copied().chain([high]);
        let share = |v: f64| if high > low { (v - low) / (high - low).max(f64::MIN_POSITIVE) } else { 0.5 };
        let colours: Vec<_> =
            edges.iter().zip(upper).map(|(a, b)| viridis_hex(share((a + b) / 2.0))).collect();
        edges.into_iter().zip(colours).collect()
    }

    pub fn colour(&self, value: f64) -> String {
        let bands = self.bands();
        let below = bands.iter().rev().find(|(edge, _)| value >= *edge).or(bands.first());
        below.map_or_else(|| viridis_hex(0.5), |(_, colour)| colour.clone())
    }

    /// Draws the colour bar with its values. Returns the position of the lower end of the bar, px.
    pub fn draw_bar(&self, canvas: &mut ChartCanvas, word: &str, (left, top): (f64, f64), tall: f64) -> f64 {
        let Self { low, high, .. } = *self;
        if high <= low {
            let colour = viridis_hex(0.5);
            canvas.put(&format!("<path d=\"M{left:.1} {top:.1}h16v16h-16z\" fill=\"{colour}\"/>"));
            canvas.text((left + 23.0, top + 13.0), Anchor::Start, Ink::Text, &words::figure(low));
            return top + 16.0;
        }
        let bar = AxisScale::linear(low, high, (top + tall, top));
        let bands = self.bands();
        let upper = bands.iter().skip(1).map(|b| b.0).chain([high]);
        for ((edge, colour), upper) in bands.iter().zip(upper) {
            let (from, to) = (bar.at(*edge), bar.at(upper));
            // Each band is drawn a little taller, so that no gap shows.
            let tall = from - to + 0.4;
            canvas.put(&format!("<path d=\"M{left:.1} {from:.1}h16v{:.1}h-16z\" fill=\"{colour}\"/>", -tall));
        }
        let mut free = f64::INFINITY;
        for level in self.levels() {
            let y = bar.at(level);
            canvas.path(&format!("M{left:.1} {y:.1}h20"), &Ink::Text.line(1.0));
            let said = words::number(level, self.step);
            if y > free {
                continue;
            }
            free = y - 14.0;
            canvas.text((left + 24.0, y + 4.5), Anchor::Start, Ink::Text, &said);
        }
        canvas.text((left, top - 10.0), Anchor::Start, Ink::Text, word);
        top + tall
    }
}
