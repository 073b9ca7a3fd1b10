//! Axes: scales from values to px, round ticks, gridlines.

use super::canvas::{Anchor, ChartCanvas, Ink, SMALL};
use super::words;

/// Axis: span of values and position in the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisScale {
    pub low: f64,
    pub high: f64,
    /// Positions of `low` and `high`, px.
    pub px: (f64, f64),
    is_log: bool,
}

impl AxisScale {
    /// Returns a linear axis. An empty span is widened; a span that is not finite becomes 0 to 1.
    pub fn linear(low: f64, high: f64, px: (f64, f64)) -> Self {
        let (low, high) = if low.is_finite() && high.is_finite() { (low, high) } else { (0.0, 1.0) };
        let pad = if high > low { 0.0 } else { low.abs().max(1e-9) * 0.5 };
        Self { low: low - pad, high: high + pad, px, is_log: false }
    }

    /// Returns a logarithmic axis. A lower end of 0 or less becomes 1e-12; an empty span becomes one decade.
    pub fn log(low: f64, high: f64, px: (f64, f64)) -> Self {
        let low = if low > 0.0 && low.is_finite() { low } else { 1e-12 };
        let high = if high > low { high } else { low * 10.0 };
        Self { low, high, px, is_log: true }
    }

    /// Returns the position of a value, px. A value beyond an end of the axis gets the position of that end.
    pub fn at(&self, value: f64) -> f64 {
        let value = if value.is_nan() { self.low } else { value.clamp(self.low, self.high) };
        let share = match self.is_log {
            true => (value / self.low).ln() / (self.high / self.low).ln(),
            false => (value - self.low) / (self.high - self.low),
        };
        self.px.0 + share * (self.px.1 - self.px.0)
    }

    /// Returns round values on the axis, each with its label. A linear axis has approximately `about`
    /// values; a logarithmic axis has powers of ten.
    pub fn ticks(&self, about: f64) -> Vec<(f64, String)> {
        if self.is_log {
            return self.decades();
        }
        let step = step(self.high - self.low, about);
        round_numbers(self.low, self.high, step).map(|v| (v, words::number(v, step))).collect()
    }

    /// Returns the powers of ten on the axis. An axis of less than three decades also has 2 and 5 times each
    /// power.
    fn decades(&self) -> Vec<(f64, String)> {
        let few = (self.high / self.low).log10() < 3.0;
        let parts = if few { &[1.0, 2.0, 5.0][..] } else { &[1.0] };
        let (first, last) = (self.low.log10().floor() as i32, self.high.log10().ceil() as i32);
        let all = (first..=last).flat_map(|k| parts.iter().map(move |p| (k, p * 10f64.powi(k))));
        let inside = |v: f64| v >= self.low * (1.0 - 1e-9) && v <= self.high * (1.0 + 1e-9);
        all.filter(|(_, v)| inside(*v)).map(|(k, v)| (v, words::number(v, 10f64.powi(k)))).collect()
    }
}

/// Returns 1, 2 or 5 times a power of ten: a step that divides a span into approximately `about` parts.
pub fn step(span: f64, about: f64) -> f64 {
    let apart = (span / about).max(f64::MIN_POSITIVE);
    let decade = 10f64.powf(apart.log10().floor());
    [1.0, 2.0, 5.0].map(|s| s * decade).into_iter().find(|s| *s >= apart * 0.999).unwrap_or(10.0 * decade)
}

/// Returns the multiples of a step from `low` to `high`.
pub fn round_numbers(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let slack = step * 1e-6;
    let (first, last) = (((low - slack) / step).ceil(), ((high + slack) / step).floor());
    let count = (last - first).clamp(-1.0, 1e4) + 1.0;
    (0..count as usize).map(move |k| (first + k as f64) * step)
}

/// Draws both axes of a plot with gridlines, numbers and names. The x axis points to the right, the y axis
/// up.
pub fn draw(canvas: &mut ChartCanvas, x: &AxisScale, y: &AxisScale, names: (&str, &str)) {
    across(canvas, x, y, names.0);
    upwards(canvas, x, y, names.1);
    let ((left, right), (bottom, top)) = (x.px, y.px);
    canvas.path(&format!("M{left:.1} {top:.1}V{bottom:.1}H{right:.1}"), &Ink::Axis.line(1.0));
    canvas.y = canvas.y.max(bottom + if names.0.is_empty() { 22.0 } else { 40.0 });
}

/// Draws the horizontal axis.
pub fn across(canvas: &mut ChartCanvas, x: &AxisScale, y: &AxisScale, name: &str) {
    let ((left, right), (bottom, top)) = (x.px, y.px);
    let mut free = f64::MIN;
    for (value, said) in x.ticks(((right - left) / 80.0).max(2.0)) {
        let px = x.at(value);
        canvas.path(&format!("M{px:.1} {top:.1}V{bottom:.1}"), &Ink::Grid.line(1.0));
        let half = words::width(&said, SMALL) / 2.0;
        if px - half > free {
            canvas.text((px, bottom + 17.0), Anchor::Middle, Ink::Faint, &said);
            free = px + half + 4.0;
        }
    }
    let name = words::shortened(name, SMALL + 1.0, right - 20.0);
    canvas.text((right, bottom + 36.0), Anchor::End, Ink::Text, &name);
}

/// Draws the vertical axis.
pub fn upwards(canvas: &mut ChartCanvas, x: &AxisScale, y: &AxisScale, name: &str) {
    let ((left, right), (bottom, top)) = (x.px, y.px);
    for (value, said) in y.ticks(((bottom - top) / 52.0).max(2.0)) {
        let py = y.at(value);
        canvas.path(&format!("M{left:.1} {py:.1}H{right:.1}"), &Ink::Grid.line(1.0));
        canvas.text((left - 7.0, py + 4.5), Anchor::End, Ink::Faint, &said);
    }
    let name = words::shortened(name, SMALL + 1.0, right - 20.0);
    canvas.text((16.0, top - 10.0), Anchor::Start, Ink::Text, &name);
}
