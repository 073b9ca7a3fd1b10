//! PDF file: pages, fonts, table of contents, title and author.

use crate::cell::Cell;
use crate::report::sheet::PaperSheet;
use crate::report::sheet::title::title;
use pdf_writer::{Content, Finish, Name, Pdf, Rect, Ref, TextStr};
use rayon::prelude::*;
use std::sync::Arc;
use svg2pdf::ConversionOptions;
use svg2pdf::usvg::{self, fontdb};

/// Points of PDF per pixel of SVG.
const POINTS: f32 = 0.75;
/// Name of the font family in the pages.
const FAMILY: &str = "Noto Sans";

/// Page with the headings that the table of contents lists.
pub struct PdfPage {
    pub sheet: PaperSheet,
    pub headings: Vec<String>,
}

/// Returns the fonts that texts may use. The fonts of the machine are not used, so a page looks the same
/// everywhere.
fn options() -> usvg::Options<'static> {
    let mut fonts = fontdb::Database::new();
    [notosans::REGULAR_TTF, notosans::BOLD_TTF]
        .into_iter()
        .for_each(|font| fonts.load_font_data(font.to_vec()));
    fonts.set_sans_serif_family(FAMILY);
    usvg::Options { fontdb: Arc::new(fonts), font_family: FAMILY.into(), ..usvg::Options::default() }
}

/// Returns the bytes of the PDF file.
///
/// # Errors
/// Fails if a page is not an SVG that can be converted.
pub fn bytes(pages: &[PdfPage], cell: &Cell) -> Result<Vec<u8>, String> {
    let options = options();
    let converted = pages.par_iter().map(|page| {
        let tree = usvg::Tree::from_str(&page.sheet.svg, &options).map_err(|e| e.to_string())?;
        let (chunk, drawn) =
            svg2pdf::to_chunk(&tree, ConversionOptions::default()).map_err(|e| e.to_string())?;
        Ok((chunk, drawn, (tree.size().width() * POINTS, tree.size().height() * POINTS)))
    });
    let converted: Vec<_> = converted.collect::<Result<_, String>>()?;
    let mut next = Ref::new(1);
    let [catalog, tree, info] = [0; 3].map(|_| next.bump());
    let leaves: Vec<[Ref; 2]> = pages.iter().map(|_| [next.bump(), next.bump()]).collect();
    let mut pdf = Pdf::new();
    pdf.pages(tree).kids(leaves.iter().map(|[page, _]| *page)).count(leaves.len() as i32);
    for ([leaf, content], (chunk, drawn, (width, height))) in leaves.iter().zip(&converted) {
        // The PDF objects of a page get the next free object numbers.
        let (first, mut last) = (next.get() - 1, next.get());
        let moved = |old: Ref| Ref::new(first + old.get());
        let chunk = chunk.renumber(|old| {
            last = last.max(moved(old).get());
            moved(old)
        });
        next = Ref::new(last + 1);
        let (width, height, drawn) = (*width, *height, moved(*drawn));
        let mut written = pdf.page(*leaf);
        written.media_box(Rect::new(0.0, 0.0, width, height)).parent(tree).contents(*content);
        written.resources().x_objects().pair(Name(b"S"), drawn);
        written.finish();
        let mut placed = Content::new();
        placed.transform([width, 0.0, 0.0, height, 0.0, 0.0]).x_object(Name(b"S"));
        pdf.stream(*content, &placed.finish());
        pdf.extend(&chunk);
    }
    let heights: Vec<f32> = converted.iter().map(|(.., (_, height))| *height).collect();
    let outline = contents(&mut pdf, (pages, &heights), &leaves, &mut next);
    let mut root = pdf.catalog(catalog);
    root.pages(tree).lang(TextStr("en"));
    root.outlines(outline);
    root.finish();
    let mut about = pdf.document_info(info);
    about.title(TextStr(title(cell)));
    if let Some(author) = &cell.title_block.author {
        about.author(TextStr(author));
    }
    about.creator(TextStr(concat!("sweetspot ", env!("CARGO_PKG_VERSION"))));
    about.finish();
    Ok(pdf.finish())
}

/// Writes the table of contents and returns its reference.
fn contents(
    pdf: &mut Pdf,
    (pages, heights): (&[PdfPage], &[f32]),
    leaves: &[[Ref; 2]],
    next: &mut Ref,
) -> Ref {
    let outline = next.bump();
    let entries = pages.iter().zip(leaves).zip(heights).flat_map(|((page, [leaf, _]), height)| {
        page.headings.iter().map(move |heading| (heading, *leaf, height))
    });
    let entries: Vec<_> = entries.map(|entry| (next.bump(), entry)).collect();
    let ids: Vec<Ref> = entries.iter().map(|(id, _)| *id).collect();
    for (k, (id, (heading, leaf, height))) in entries.iter().enumerate() {
        let mut item = pdf.outline_item(*id);
        item.title(TextStr(heading)).parent(outline);
        item.dest().page(*leaf).xyz(0.0, **height, None);
        if let Some(before) = k.checked_sub(1) {
            item.prev(ids[before]);
        }
        if let Some(after) = ids.get(k + 1) {
            item.next(*after);
        }
    }
    let mut written = pdf.outline(outline);
    if let [first, .., last] = ids[..] {
        written.first(first).last(last).count(ids.len() as i32);
    }
    outline
}
