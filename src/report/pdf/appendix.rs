//! Appendix: the sections of the report on upright, numbered pages.

use super::file::PdfPage;
use super::flow::{FlowPage, LEFT, PageFlow, WIDTH, opened};
use crate::drawing::Drawing;
use crate::report::page::{Subject, sections};
use crate::report::sheet::ink::{TextAnchor, TextStyle, put, stroke};
use crate::report::sheet::title::title;
use crate::report::sheet::{Paper, PaperSheet, SheetNumber};

/// Width of a picture, mm.
const PICTURE: f64 = 150.0;
/// Positions of the line above the footer and of the text of the footer, mm from the top of the page.
const FOOTER: (f64, f64) = (283.0, 287.0);

/// Returns the pages of the appendix without footers.
pub fn pages(subject: &Subject<'_>, drawings: &[Drawing<'_>]) -> Vec<FlowPage> {
    let mut flow = PageFlow::new();
    for section in sections(subject, drawings) {
        // The first picture or the beginning of the first table is on the same page as the heading.
        let first = section.figures.first().map_or(40.0, |figure| PageFlow::height(figure, PICTURE));
        flow.heading(&section.title, first + 6.0 * section.text.len() as f64);
        section.text.iter().for_each(|text| flow.paragraph(text));
        section.figures.iter().for_each(|figure| flow.figure(figure, PICTURE));
        section.tables.iter().for_each(|table| flow.table(table));
    }
    flow.finish()
}

/// Returns a page with its footer: title, number and revision of the drawing, and the number of the page.
pub fn finished(page: FlowPage, subject: &Subject<'_>, number: SheetNumber) -> PdfPage {
    let cell = subject.cell();
    let mut svg = opened(&cell.name) + &page.body;
    let (line, text) = FOOTER;
    stroke(&mut svg, &format!("M{LEFT} {line}h{WIDTH}"), "#57606a", 0.18);
    let block = &cell.title_block;
    let parts = [block.owner.as_deref(), Some(title(cell)), block.number.as_deref()];
    let mut said: Vec<String> = parts.into_iter().flatten().map(str::to_string).collect();
    said.extend(block.revision.iter().map(|revision| format!("revision {revision}")));
    said.extend(block.date.clone());
    let (said, style) = (said.join(", "), TextStyle::plain(2.4));
    put(&mut svg, (LEFT, text), style.fitted(&said, WIDTH - 30.0), "", &said);
    let number = format!("sheet {}", number.in_words());
    put(&mut svg, (LEFT + WIDTH, text), style.anchored(TextAnchor::End), "", &number);
    svg.push_str("</svg>\n");
    PdfPage { sheet: PaperSheet { svg, paper: Paper::A4 }, headings: page.headings }
}
