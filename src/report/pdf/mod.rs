//! The answer as PDF in three parts: a page with the answer, the set-out drawing to scale, and the report as
//! an appendix.
//!
//! Every page is an SVG in mm, and one crate converts all of them. The embedded font is Noto Sans, under the
//! SIL Open Font License.

mod answer;
mod appendix;
mod file;
mod flow;
mod table;

use super::page::Subject;
use super::sheet::{PaperSheet, SheetNumber, sheet};
use crate::drawing::Drawing;
use file::PdfPage;

/// Returns the PDF about a layout or the result of a search. `drawings` has one entry per layout, the
/// recommended layout last. The robot is drawn at the spot of `operation`, or at home.
///
/// # Errors
/// Fails if a picture cannot be drawn or a page cannot be converted.
pub fn pdf(
    subject: &Subject<'_>,
    drawings: &[Drawing<'_>],
    operation: Option<usize>,
) -> Result<Vec<u8>, String> {
    let drawing = drawings.last().ok_or("there is no layout to draw")?;
    let appendix = appendix::pages(subject, drawings);
    let count = 2 + appendix.len();
    let number = |number: usize| SheetNumber { number, count };
    let page = |sheet: PaperSheet, title: &str| PdfPage { sheet, headings: vec![title.to_string()] };
    let mut pages = vec![
        page(answer::page(subject, drawing, operation, number(1))?, "Answer"),
        page(sheet(drawing, operation, number(2)), "Set-out drawing"),
    ];
    let rest = appendix.into_iter().enumerate();
    pages.extend(rest.map(|(k, page)| appendix::finished(page, subject, number(3 + k))));
    file::bytes(&pages, subject.cell())
}
