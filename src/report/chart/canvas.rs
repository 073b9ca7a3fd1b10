//! Canvas of a chart: heading, shapes, texts, legend.

use super::{WIDTH, words};
use crate::colours;
use crate::svg_text::escaped;
use std::fmt::Write;

/// Margin on every side, px.
pub const EDGE: f64 = 16.0;
/// Font size of the heading, px.
pub const HEAD: f64 = 16.0;
pub const BODY: f64 = 13.0;
/// Width of bold letters relative to regular letters.
const BOLD: f64 = 1.14;
pub const SMALL: f64 = 12.0;

/// Colour role in a chart, with one colour on white paper and one colour on black paper. A style sheet can
/// replace these colours through a CSS class.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ink {
    Paper,
    Text,
    Faint,
    Axis,
    Grid,
    Ground,
    Blue,
    Orange,
    Green,
    Vermilion,
    Purple,
    Sky,
    /// Colour of the chosen spot.
    Spot,
}

impl Ink {
    pub const ALL: [Ink; 13] = [
        Ink::Paper,
        Ink::Text,
        Ink::Faint,
        Ink::Axis,
        Ink::Grid,
        Ink::Ground,
        Ink::Blue,
        Ink::Orange,
        Ink::Green,
        Ink::Vermilion,
        Ink::Purple,
        Ink::Sky,
        Ink::Spot,
    ];

    /// Returns the CSS class, the colour on white and the colour on black.
    const fn told(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Ink::Paper => ("paper", "#ffffff", "#14181d"),
            Ink::Text => ("text", "#1b1f24", "#e6e9ed"),
            Ink::Faint => ("faint", "#57606a", "#a3adb8"),
            Ink::Axis => ("axis", "#8c959f", "#6b7682"),
            Ink::Grid => ("grid", "#e4e8ec", "#2b323a"),
            Ink::Ground => ("ground", "#eef2f6", "#232a32"),
            Ink::Blue => ("blue", colours::BLUE, "#4ba3d9"),
            Ink::Orange => ("orange", colours::ORANGE, colours::ORANGE),
            Ink::Green => ("green", colours::GREEN, "#2fc49a"),
            Ink::Vermilion => ("vermilion", colours::VERMILION, "#f07f2e"),
            Ink::Purple => ("purple", colours::PURPLE, "#dd9cc1"),
            Ink::Sky => ("sky", colours::SKY, colours::SKY),
            Ink::Spot => ("spot", "#bf3989", "#f27ac0"),
        }
    }

    /// Returns the SVG attributes of a filled shape.
    pub fn fill(self) -> String {
        let (class, light, _) = self.told();
        format!("class=\"fill-{class}\" fill=\"{light}\"")
    }

    /// Returns the SVG attributes of a text with a halo in the colour of the paper.
    fn haloed(self) -> String {
        let ((class, light, _), (paper, white, _)) = (self.told(), Ink::Paper.told());
        format!(
            "class=\"fill-{class} line-{paper}\" fill=\"{light}\" stroke=\"{white}\" stroke-width=\"3.5\" \
             stroke-linejoin=\"round\" paint-order=\"stroke\""
        )
    }

    /// Returns the SVG attributes of a line of the given width, px.
    pub fn line(self, width: f64) -> String {
        let (class, light, _) = self.told();
        format!("class=\"line-{class}\" fill=\"none\" stroke=\"{light}\" stroke-width=\"{width}\"")
    }
}

/// Returns the style sheet rules for charts on a dark page. Each rule is under a selector such as `.dark`.
pub fn dark_rules(scope: &str) -> String {
    Ink::ALL.iter().fold(String::new(), |mut out, ink| {
        let (class, _, dark) = ink.told();
        // Writing to a String cannot fail.
        let _ = writeln!(out, "{scope} .fill-{class}{{fill:{dark}}}{scope} .line-{class}{{stroke:{dark}}}");
        out
    })
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    pub fn word(self) -> &'static str {
        match self {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        }
    }
}

/// Entry of a legend: SVG of a mark, and the meaning of the mark. The mark is centred at (0, 0) and at most
/// 24 px wide.
pub struct LegendEntry {
    pub mark: String,
    pub said: String,
}

/// Chart under construction.
pub struct ChartCanvas {
    name: String,
    body: String,
    width: f64,
    /// Vertical position of the lower end of everything drawn so far, px.
    pub y: f64,
}

impl ChartCanvas {
    /// Begins a chart with a heading and lines of text under it.
    pub fn new(heading: &str, under: &[String]) -> Self {
        Self::wide(heading, under, WIDTH)
    }

    /// Begins a chart with a given width, px.
    pub fn wide(heading: &str, under: &[String], width: f64) -> Self {
        let mut canvas = Self { name: heading.to_string(), body: String::new(), width, y: EDGE };
        let room = width - 2.0 * EDGE;
        for line in words::wrapped(heading, BOLD * HEAD, room, 3) {
            canvas.y += 18.0;
            let (y, fill) = (canvas.y - 3.0, Ink::Text.fill());
            canvas.put(&format!(
                "<text x=\"{EDGE}\" y=\"{y}\" font-size=\"{HEAD}\" font-weight=\"600\" {fill}>{}</text>",
                escaped(&line)
            ));
        }
        under.iter().for_each(|said| canvas.paragraph(said));
        canvas.y += 10.0;
        canvas
    }

    pub fn put(&mut self, markup: &str) {
        self.body.push_str(markup);
        self.body.push('\n');
    }

    /// Writes a paragraph of faint text.
    pub fn paragraph(&mut self, said: &str) {
        for line in words::wrapped(said, BODY, self.width - 2.0 * EDGE, 4) {
            self.y += 17.0;
            self.text((EDGE, self.y), Anchor::Start, Ink::Faint, &line);
        }
    }

    /// Writes a text at a position on its baseline.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, ink: Ink, said: &str) {
        if said.is_empty() {
            return;
        }
        let (fill, anchor) = (ink.fill(), anchor.word());
        self.put(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {fill}>{}</text>",
            escaped(said)
        ));
    }

    /// Writes a text over a picture, with a halo in the colour of the paper.
    pub fn label(&mut self, (x, y): (f64, f64), anchor: Anchor, ink: Ink, said: &str) {
        let (paint, anchor, said) = (ink.haloed(), anchor.word(), escaped(said));
        self.put(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" font-size=\"{SMALL}\" {paint}>{said}</text>"
        ));
    }

    /// Writes a bold heading over a panel.
    pub fn heading(&mut self, (x, y): (f64, f64), said: &str) {
        let fill = Ink::Text.fill();
        self.put(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-weight=\"600\" {fill}>{}</text>",
            escaped(said)
        ));
    }

    pub fn path(&mut self, d: &str, paint: &str) {
        if !d.is_empty() {
            self.put(&format!("<path d=\"{d}\" {paint}/>"));
        }
    }

    /// Draws the entries of a legend side by side, in as many rows as they need.
    pub fn legend(&mut self, entries: &[LegendEntry]) {
        let (mut x, mut is_open) = (EDGE, false);
        for LegendEntry { mark, said } in entries {
            let said = words::shortened(said, BODY, self.width - 2.0 * EDGE - 32.0);
            let wide = 32.0 + words::width(&said, BODY) + 14.0;
            if !is_open || x + wide > self.width - EDGE + 14.0 {
                (x, is_open) = (EDGE, true);
                self.y += 22.0;
            }
            let y = self.y;
            self.put(&format!("<g transform=\"translate({:.1} {:.1})\">{mark}</g>", x + 12.0, y - 4.5));
            self.text((x + 30.0, y), Anchor::Start, Ink::Text, &said);
            x += wide;
        }
    }

    pub fn finish(self) -> String {
        let (height, name, paper) = (self.y + EDGE, escaped(&self.name), Ink::Paper.fill());
        let width = self.width;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" role=\"img\" aria-label=\"{name}\" font-family=\"system-ui, sans-serif\" \
             font-size=\"{BODY}\">\n<title>{name}</title>\n<rect width=\"100%\" height=\"100%\" {paper}/>\n{}</svg>\n",
            self.body
        )
    }
}
