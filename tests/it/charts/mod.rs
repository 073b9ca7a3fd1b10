//! Tests the charts of a report: they are well formed, agree with their records, and exist for every input.
//!
//! If the environment variable SWEETSPOT_CHARTS names a folder, the tests write their charts there.

mod iso;
mod maps;
mod outline;
mod plots;
mod scales;
mod texts;

use sweetspot::assess::Assessment;
use sweetspot::cell::Cell;
use sweetspot::layout::Workcell;

/// Hostile name.
pub const HOSTILE: &str = "<script>alert('x')</script> & \"quoted\" ]]> \u{1} 溶接作業台";

pub fn start(workcell: &Workcell) -> Assessment<'_> {
    Assessment::new("start", workcell, workcell.cell.start())
}

/// Returns a cell in which every name is hostile.
pub fn renamed(mut cell: Cell) -> Cell {
    cell.name = HOSTILE.into();
    cell.robot.name = HOSTILE.into();
    cell.equipment.iter_mut().for_each(|e| e.name = format!("{HOSTILE} {}", e.name));
    cell.operations.iter_mut().for_each(|o| o.name = format!("{HOSTILE} {}", o.name));
    cell
}

/// Returns a numeric attribute of an element.
pub fn number(node: &roxmltree::Node<'_, '_>, attribute: &str) -> f64 {
    node.attribute(attribute).unwrap().parse().unwrap()
}

/// Checks that a chart is well formed, has no style, id or script, has numbers only in its geometry, and has
/// every text inside the picture. Writes the chart to a file if SWEETSPOT_CHARTS is set.
pub fn check(name: &str, svg: &str) {
    keep(name, svg);
    let document = roxmltree::Document::parse(svg).unwrap_or_else(|e| panic!("{name}: {e}\n{svg}"));
    let root = document.root_element();
    assert_eq!((root.tag_name().name(), root.attribute("role")), ("svg", Some("img")), "{name}");
    assert!(root.attribute("aria-label").is_some_and(|said| !said.is_empty()));
    let title = root.children().find(|n| n.has_tag_name(("http://www.w3.org/2000/svg", "title")));
    assert!(title.is_some_and(|t| t.text().is_some()), "{name} has no title");
    let dark = sweetspot::report::chart::dark_rules(".dark");
    for node in root.descendants().filter(|n| n.is_element()) {
        // The dark style of a page has a rule for every class.
        let classes = node.attribute("class").unwrap_or_default().split_whitespace();
        classes.for_each(|class| assert!(dark.contains(&format!(".dark .{class}{{")), "{name}: {class}"));
        let tag = node.tag_name().name();
        let known = ["svg", "title", "rect", "path", "circle", "text", "g"];
        assert!(known.contains(&tag), "{name}: <{tag}>");
        for attribute in node.attributes() {
            let (key, value) = (attribute.name(), attribute.value());
            assert!(!key.starts_with("on") && !["style", "id", "href"].contains(&key), "{name}: {key}");
            let is_geometry = !["aria-label", "class", "font-family"].contains(&key);
            assert!(
                !is_geometry || !value.contains("NaN") && !value.contains("inf"),
                "{name}: {key}={value}"
            );
        }
    }
    inside(name, &root, 720.0);
}

/// Writes a chart and the style sheet of dark pages if SWEETSPOT_CHARTS is set.
pub fn keep(name: &str, svg: &str) {
    crate::common::keep_to_look_at("dark.css", &sweetspot::report::chart::dark_rules("svg"));
    crate::common::keep_to_look_at(&format!("{name}.svg"), svg);
}

/// Checks that no text begins or ends outside the picture. The check assumes narrower letters than the
/// charts.
pub fn inside(name: &str, root: &roxmltree::Node<'_, '_>, width: f64) {
    let size: Vec<f64> = root.attribute("viewBox").unwrap().split(' ').map(|v| v.parse().unwrap()).collect();
    assert_eq!(size[2], width);
    for text in root.descendants().filter(|n| n.tag_name().name() == "text") {
        let said = text.text().unwrap_or_default();
        let font = text.attribute("font-size").map_or(13.0, |v| v.parse().unwrap());
        let wide: f64 = said.chars().map(|c| if (c as u32) > 0x2e80 { 1.0 } else { 0.5 } * font).sum();
        let shifted = text.ancestors().any(|n| n.attribute("transform").is_some());
        assert!(font >= 11.0 && !shifted, "{name}: {said}");
        let (x, y) = (number(&text, "x"), number(&text, "y"));
        let left = match text.attribute("text-anchor") {
            Some("end") => x - wide,
            Some("middle") => x - wide / 2.0,
            _ => x,
        };
        assert!(left >= 0.0 && left + wide <= width, "{name}: {said:?} from {left} to {}", left + wide);
        assert!(y >= 8.0 && y <= size[3], "{name}: {said:?} at {y} of {}", size[3]);
    }
}
