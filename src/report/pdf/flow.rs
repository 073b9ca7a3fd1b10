//! Text, pictures and tables that flow over pages from top to bottom.

use super::table::TypesetTable;
use crate::report::chart::words;
use crate::report::page::{PageFigure, PageTable};
use crate::report::sheet::ink::{TextStyle, put};
use crate::report::sheet::{BLOCK, FILING_MARGIN, Paper};
use std::fmt::Write;

/// Left edge of the text, mm.
pub const LEFT: f64 = FILING_MARGIN;
/// Width of the text, mm.
pub const WIDTH: f64 = BLOCK.0;
/// Top of the text on a page, mm.
const TOP: f64 = 16.0;
/// Bottom of the text on a page, mm.
const BOTTOM: f64 = 279.0;
/// Height of the font of paragraphs, mm.
const FONT: f64 = 2.9;
/// Distance between successive lines of a paragraph or a heading, mm.
const LINE: f64 = 4.2;
/// Greatest height of a picture, mm.
const HIGHEST: f64 = 106.0;

/// Content of a page, with the headings that begin on it.
#[derive(Default)]
pub struct FlowPage {
    pub body: String,
    pub headings: Vec<String>,
}

/// Pages under construction.
pub struct PageFlow {
    pages: Vec<FlowPage>,
    page: FlowPage,
    /// Vertical position at which the next content begins, mm from the top of the page.
    pub y: f64,
    bottom: f64,
    /// Number of pictures so far. The number makes the element names of the pictures unique.
    pictures: usize,
}

impl PageFlow {
    pub fn new() -> Self {
        Self { pages: Vec::new(), page: FlowPage::default(), y: TOP, bottom: BOTTOM, pictures: 0 }
    }

    /// Returns a flow on a single page of unlimited height. The flow begins at height 0.
    pub fn endless() -> Self {
        Self { y: 0.0, bottom: f64::INFINITY, ..Self::new() }
    }

    /// Returns all pages.
    pub fn finish(mut self) -> Vec<FlowPage> {
        self.turn();
        self.pages
    }

    /// Begins a new page unless the page is empty.
    fn turn(&mut self) {
        if !self.page.body.is_empty() {
            self.pages.push(std::mem::take(&mut self.page));
        }
        self.y = TOP;
    }

    /// Begins a new page if less than `height` mm are left.
    pub fn need(&mut self, height: f64) {
        if self.y + height > self.bottom {
            self.turn();
        }
    }

    pub fn space(&mut self, height: f64) {
        self.y += height;
    }

    /// Writes a heading that gets an entry in the table of contents. At least `below` mm of its page are left
    /// for the content that follows.
    pub fn heading(&mut self, said: &str, below: f64) {
        self.need(9.0 + below);
        self.y += 5.0;
        self.lines(said, TextStyle::plain(4.6).bold(), 6.0);
        self.page.headings.push(said.to_string());
        self.y += 0.5;
    }

    pub fn paragraph(&mut self, said: &str) {
        self.lines(said, TextStyle::plain(FONT), LINE);
        self.y += 1.2;
    }

    pub fn caption(&mut self, said: &str) {
        if !said.is_empty() {
            self.lines(said, TextStyle::plain(2.5), 3.6);
            self.y += 1.0;
        }
    }

    pub fn small_heading(&mut self, said: &str) {
        if !said.is_empty() {
            self.lines(said, TextStyle::plain(3.1).bold(), LINE);
            self.y += 1.0;
        }
    }

    /// Returns the height of a picture with its title and one line of caption, mm.
    pub fn height(figure: &PageFigure, width: f64) -> f64 {
        size(&figure.svg).map_or(0.0, |(own_width, own_height)| {
            let ratio = own_height / own_width;
            width.min(HIGHEST / ratio) * ratio + 13.0
        })
    }

    /// Writes a text in lines as wide as the page.
    pub fn lines(&mut self, said: &str, style: TextStyle, pitch: f64) {
        // A bold text is wider than its estimate.
        let room = if style.is_bold { WIDTH / 1.08 } else { WIDTH };
        for line in words::wrapped(said, style.size, room, usize::MAX) {
            self.need(pitch);
            self.y += pitch;
            put(&mut self.page.body, (LEFT, self.y), style, "", &line);
        }
    }

    /// Puts a picture with its title and its caption on one page.
    pub fn figure(&mut self, figure: &PageFigure, width: f64) {
        let Some((own_width, own_height)) = size(&figure.svg) else { return };
        let ratio = own_height / own_width;
        let width = width.min(HIGHEST / ratio);
        self.need(Self::height(figure, width));
        self.small_heading(&figure.title);
        self.picture(&figure.svg, width, width * ratio);
        self.caption(&figure.caption);
        self.y += 2.0;
    }

    /// Puts a picture in the middle of the page.
    pub fn picture(&mut self, svg: &str, width: f64, height: f64) {
        self.pictures += 1;
        let number = self.pages.len() * 1000 + self.pictures;
        let at = (LEFT + (WIDTH - width) / 2.0, self.y + 1.5);
        let _ = writeln!(self.page.body, "{}", nested(svg, number, at, (width, height)));
        self.y += height + 3.0;
    }

    /// Writes a table. Its rows may continue on the next pages, where the head is repeated.
    pub fn table(&mut self, table: &PageTable) {
        let set = TypesetTable::new(table, WIDTH);
        self.need(set.least_height() + 5.0);
        self.small_heading(&table.title);
        set.draw_head(&mut self.page.body, LEFT, &mut self.y);
        for row in 0..set.rows() {
            if self.y + set.row_height(row) > self.bottom {
                self.turn();
                set.draw_head(&mut self.page.body, LEFT, &mut self.y);
            }
            set.draw_row(&mut self.page.body, LEFT, &mut self.y, row);
        }
        self.y += 1.5;
        self.caption(&table.note);
        self.y += 2.5;
    }
}

/// Returns width and height of a picture from its `viewBox`, px.
pub fn size(svg: &str) -> Option<(f64, f64)> {
    let (_, after) = svg.split_once("viewBox=\"0 0 ")?;
    let (width, height) = after.split_once('"')?.0.split_once(' ')?;
    Some((width.parse().ok()?, height.parse().ok()?)).filter(|(width, _)| *width > 0.0)
}

/// Returns a picture as an element of a page, with its upper left corner at `(x, y)`, mm. The number becomes
/// a prefix of the element names of the picture.
fn nested(svg: &str, number: usize, (x, y): (f64, f64), (width, height): (f64, f64)) -> String {
    let place = format!("x=\"{x:.2}\" y=\"{y:.2}\" width=\"{width:.2}\" height=\"{height:.2}\"");
    let own = size(svg).map_or(String::new(), |(w, h)| format!(" width=\"{w}\" height=\"{h}\""));
    crate::report::page::scoped(&svg.replacen(&own, &format!(" {place}"), 1), number)
}

/// Returns the beginning of the SVG of a page.
pub fn opened(name: &str) -> String {
    crate::report::sheet::opened(&Paper::A4, name)
}
