//! Tests the exports for paper: the set-out drawing as SVG, and the complete result as PDF.

use crate::cli::sandbox::*;
use roxmltree::{Document, Node};

/// Entries of a title block, and the texts that a sheet must show.
const TITLE_BLOCK: &str = "\n[title_block]\nowner = \"Example Automation\"\ntitle = \"Cell 3\"\nnumber = \"L-0417\"\n\
                           revision = \"B\"\ndate = \"2026-11-26\"\nauthor = \"A. Author\"\n\
                           approved_by = \"B. Engineer\"\ngeneral_tolerance = \"ISO 2768-c\"\n";

/// Writes the shipped cell with a title block, placement tolerances and the lines `more`.
fn titled(shop: &Sandbox, more: &str) {
    let cell = shop.text(CELL);
    let untitled = cell.split("\n[title_block]").next().unwrap();
    let cell = untitled.replace(
        "[equipment.worktable]\n",
        "[equipment.worktable]\nplacement_tolerance = { x_mm = 2, y_mm = 2, yaw_deg = 0.05 }\n",
    );
    shop.write("cells/titled.toml", &(cell + TITLE_BLOCK + more));
}

fn sheet(shop: &Sandbox) -> String {
    shop.done(&["export", "cells/titled.toml", "--to", "svg", "-o", "sheet.svg"]);
    shop.text("sheet.svg")
}

fn texts(document: &Document<'_>) -> Vec<String> {
    let all =
        document.descendants().filter(|n| n.has_tag_name("text") && n.attribute("aria-hidden").is_none());
    all.filter_map(|n| n.text().map(str::to_string)).collect()
}

/// Returns the position of a text, mm on paper.
fn place(document: &Document<'_>, said: &str) -> (f64, f64) {
    let is_it = |n: &Node<'_, '_>| n.has_tag_name("text") && n.text() == Some(said);
    let node = document.descendants().find(is_it).unwrap_or_else(|| panic!("no text {said}"));
    let number = |key: &str| node.attribute(key).unwrap().parse::<f64>().unwrap();
    (number("x"), number("y"))
}

#[test]
fn the_sheet_has_title_block_tolerances_yaw_and_all_names() {
    let shop = Sandbox::new();
    titled(&shop, "");
    let svg = sheet(&shop);
    let document = Document::parse(&svg).unwrap();
    let told = texts(&document);
    let has = |said: &str| told.iter().any(|t| t == said);
    for said in [
        "Example Automation",
        "Cell 3",
        "L-0417",
        "B",
        "2026-11-26",
        "A. Author",
        "B. Engineer",
        "ISO 2768-c",
        "1/1",
        "worktable",
        "conveyor",
        "cabinet",
        "post",
        "machine",
    ] {
        assert!(has(said), "no {said:?} in {told:?}");
    }
    // The yaw of the worktable has a tolerance, and the yaw of the conveyor has none.
    assert!(has("10\u{b0} \u{b1}0.05\u{b0}") && has("80\u{b0}"), "{told:?}");
    // The permitted displacement of the corner is smaller than the tolerance of the frame, because the yaw
    // also moves the corner.
    let map = shop.json(&["map", "cells/titled.toml"]);
    let at = &map["layout"]["worktable"];
    let [x, y] = ["x_mm", "y_mm"].map(|key| number(&at[key]));
    let dimension = |axis: usize| {
        let along = told.iter().filter(|t| t.starts_with("A ") && t.contains('\u{b1}'));
        let all: Vec<f64> = along.map(|t| t.split('\u{b1}').nth(1).unwrap().parse().unwrap()).collect();
        all.get(axis).copied()
    };
    let widest = [0, 1].into_iter().filter_map(dimension).fold(0.0, f64::max);
    assert!(widest < 2.0 && widest > 0.5, "{told:?} for a frame at {x} {y}");
}

#[test]
fn the_sheet_is_to_scale_and_cuts_no_reach() {
    let shop = Sandbox::new();
    titled(&shop, "");
    let svg = sheet(&shop);
    let document = Document::parse(&svg).unwrap();
    let told = texts(&document);
    let scale = told.iter().find_map(|t| t.strip_prefix("1:")).unwrap();
    let ratio: f64 = scale.parse().unwrap();
    // The letters mark corners, whose positions relative to the base are in the list.
    let (a, b) = (place(&document, "A"), place(&document, "B"));
    let row = |name: &str| -> Vec<f64> {
        let at = told.iter().position(|t| t == name).unwrap();
        told[at + 1..at + 3].iter().map(|t| t.parse().unwrap()).collect()
    };
    let (table, conveyor) = (row("A worktable"), row("B conveyor"));
    let on_paper = [b.0 - a.0, a.1 - b.1].map(|mm| mm * ratio);
    for k in 0..2 {
        let in_cell = conveyor[k] - table[k];
        assert!((on_paper[k] - in_cell).abs() < 0.02 * ratio, "{on_paper:?} and {table:?} {conveyor:?}");
    }
    // The lines of the reach stay inside the frame of the sheet.
    let root = document.root_element();
    let size = ["width", "height"]
        .map(|key| root.attribute(key).unwrap().trim_end_matches("mm").parse::<f64>().unwrap());
    let reach = document.descendants().filter(|n| n.attribute("class") == Some("reach"));
    let mut points = 0;
    for path in reach {
        assert!(path.attribute("clip-path").is_none());
        for pair in path.attribute("d").unwrap().split(['M', 'L', 'Z']).filter(|p| !p.is_empty()) {
            let (x, y) = pair.split_once(' ').unwrap();
            let (x, y): (f64, f64) = (x.parse().unwrap(), y.parse().unwrap());
            assert!(x > 20.0 && x < size[0] - 10.0 && y > 10.0 && y < size[1] - 10.0, "{x} {y} on {size:?}");
            points += 1;
        }
    }
    assert!(points > 50, "{points}");
}

#[test]
fn the_projection_decides_which_view_is_above() {
    let shop = Sandbox::new();
    for (projection, front_is_above) in [("first-angle", true), ("third-angle", false)] {
        titled(&shop, &format!("projection = \"{projection}\"\n"));
        let svg = sheet(&shop);
        let document = Document::parse(&svg).unwrap();
        let (plan, front) = (place(&document, "plan"), place(&document, "front, seen along y"));
        assert_eq!(front.1 < plan.1, front_is_above, "{projection}");
        // One view is exactly below the other.
        assert_eq!(front.0, plan.0);
    }
}

#[cfg(not(feature = "pdf"))]
#[test]
fn a_build_without_the_pdf_writer_says_how_to_get_it() {
    let shop = Sandbox::new();
    let ran = shop.run(&["export", CELL, "--to", "pdf"]);
    assert_eq!(ran.code, Some(2));
    assert!(
        ran.err.contains("this build has no PDF writer") && ran.err.contains("--features pdf"),
        "{}",
        ran.err
    );
}

#[cfg(feature = "pdf")]
mod pdf {
    use super::*;
    use std::io::Read;

    /// Returns the objects of a PDF: dictionary and, if there is one, the decompressed stream.
    fn objects(pdf: &[u8]) -> Vec<(String, Vec<u8>)> {
        let find = |from: usize, what: &[u8]| {
            pdf[from..].windows(what.len()).position(|w| w == what).map(|at| from + at)
        };
        let (mut all, mut from) = (Vec::new(), 0);
        while let Some(start) = find(from, b" 0 obj\n") {
            let end = find(start, b"endobj").unwrap();
            let stream = find(start, b"stream\n").filter(|at| *at < end);
            let words = String::from_utf8_lossy(&pdf[start..stream.unwrap_or(end)]).into_owned();
            let bytes = stream.map_or(Vec::new(), |at| {
                let close = find(at, b"endstream").unwrap();
                let raw = &pdf[at + 7..close];
                let mut out = Vec::new();
                match words.contains("FlateDecode") {
                    true => drop(flate2::read::ZlibDecoder::new(raw).read_to_end(&mut out)),
                    false => out = raw.to_vec(),
                }
                out
            });
            all.push((words, bytes));
            // A compressed stream may contain the end mark by chance. The next object is found anyway.
            from = end;
        }
        all
    }

    #[test]
    fn a_pdf_has_numbered_pages_to_scale_and_embedded_fonts() {
        let shop = Sandbox::new();
        titled(&shop, "");
        let ran = shop.done(&["export", "cells/titled.toml", "--to", "pdf"]);
        assert!(ran.err.contains("wrote titled.pdf"), "{}", ran.err);
        let pdf = shop.read("titled.pdf");
        assert!(pdf.starts_with(b"%PDF-1.") && pdf.ends_with(b"%%EOF"));
        let all = objects(&pdf);
        let of = |kind: &str| all.iter().filter(|(words, _)| words.contains(kind)).collect::<Vec<_>>();
        let pages: Vec<_> =
            of("/Type /Page").into_iter().filter(|(w, _)| !w.contains("/Type /Pages")).collect();
        assert!(pages.len() > 4, "{}", pages.len());
        let tree = of("/Type /Pages");
        assert!(tree[0].0.contains(&format!("/Count {}", pages.len())), "{}", tree[0].0);
        // A4 is 595.28 by 841.89 points.
        for (words, _) in &pages {
            let media = words.split("/MediaBox [").nth(1).unwrap().split(']').next().unwrap();
            let sides: Vec<f64> = media.split(' ').map(|n| n.parse().unwrap()).collect();
            let short = sides[2].min(sides[3]);
            assert!((short - 595.28).abs() < 0.1 || (short - 841.89).abs() < 0.1, "{media}");
        }
        // The PDF contains the file of every font.
        let fonts = of("/Type /FontDescriptor");
        assert!(!fonts.is_empty());
        assert!(fonts.iter().all(|(words, _)| words.contains("/FontFile") && words.contains("NotoSans")));
        assert!(of("/Subtype /Type1 ").is_empty(), "a font that the viewer must have");
        assert!(
            all.iter()
                .any(|(words, _)| words.contains("/Title (Cell 3)") && words.contains("/Author (A. Author)"))
        );
        let contents = all.iter().filter(|(words, _)| words.contains("/Dest")).count();
        assert!(contents >= 5, "{contents} entries in the table of contents");
        // The same cell gives the same pages and fonts, but the PDF crate numbers the fonts in random order.
        shop.done(&["export", "cells/titled.toml", "--to", "pdf", "-o", "again.pdf"]);
        let sorted = |all: Vec<(String, Vec<u8>)>| {
            let mut streams: Vec<_> = all.into_iter().map(|(_, bytes)| bytes).collect();
            streams.sort();
            streams
        };
        assert!(sorted(objects(&shop.read("again.pdf"))) == sorted(all));
    }
}
