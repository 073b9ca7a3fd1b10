//! Tests the document of the viewer and the assets of the pages.

use crate::common::{keep_to_look_at, workcell};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use sweetspot::assess::Assessment;
use sweetspot::cell::Reading;
use sweetspot::drawing::{Detail, Drawing, PartCarrier};
use sweetspot::report;
use sweetspot::report::page::{assets, script_json};
use sweetspot::units::mm_from_m;

fn floats(value: &Value) -> Vec<f64> {
    let bytes = STANDARD.decode(value.as_str().unwrap()).unwrap();
    bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap()))).collect()
}

/// Checks that two lengths (mm) are equal, except for rounding to f32.
fn same(a: f64, b: f64) {
    assert!((a - b).abs() <= 1e-3 || a.is_nan() && b.is_nan(), "{a} and {b}");
}

/// Returns a page that shows only a document, for inspection by people.
fn page(document: &Value) -> String {
    let (css, js) = (assets::VIEWER_CSS, assets::viewer_js());
    let policy = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'";
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>viewer</title>\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{policy}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <style>body{{margin:12px}}@media (prefers-color-scheme:dark){{body{{background:#0d1117}}}}\n{css}</style></head>\n\
         <body><div id=\"view\"><p>No WebGL here.</p></div>\n<script type=\"application/json\" id=\"document\">{}</script>\n\
         <script>{js}</script><script>globalThis.viewer = sweetspotViewer(document.getElementById(\"view\"), \
         JSON.parse(document.getElementById(\"document\").textContent));</script></body></html>\n",
        script_json(document)
    )
}

#[test]
fn the_drawing_document_agrees_with_the_drawing() {
    let workcell = workcell("hitachi_cell.toml");
    let start = Assessment::new("start", &workcell, workcell.cell.start());
    let mut other = workcell.cell.start();
    other.placements[0].y += 0.05;
    other.placements[1].x -= 0.05;
    let moved = Assessment::new("moved", &workcell, other);
    let drawings = [&start, &moved].map(|a| Drawing::new(a, &Detail::FULL).unwrap());
    let document = report::json::drawings(&drawings);
    let spots = drawings.iter().map(|d| d.movement.stops.len());
    assert_eq!(spots.collect::<Vec<_>>(), [4, 4], "both layouts are feasible");
    keep_to_look_at("sweetspot-viewer.html", &page(&document));
    assert_eq!(document["schema"], "sweetspot/drawing/1");
    for (drawing, written) in drawings.iter().zip(document["drawings"].as_array().unwrap()) {
        assert_eq!(written["name"], drawing.name);
        check_parts(drawing, written, &document["meshes"]);
        check_fields(drawing, written);
        check_movement(drawing, written);
    }
    // Meshes that both drawings show are written once.
    let meshes = document["meshes"].as_array().unwrap().len();
    assert!(meshes <= drawings[0].parts.len() + 1, "{meshes}");
}

fn check_parts(drawing: &Drawing<'_>, written: &Value, meshes: &Value) {
    let parts = written["parts"].as_array().unwrap();
    assert_eq!(parts.len(), drawing.parts.len());
    for (part, written) in drawing.parts.iter().zip(parts) {
        assert_eq!(written["name"], part.name);
        assert_eq!(written["kind"], part.kind.name());
        match part.carrier {
            PartCarrier::Link(k) => assert_eq!(written["link"], k),
            PartCarrier::World(at) => {
                let numbers = written["at"].as_array().unwrap();
                let p = at.transform(&nalgebra::Vector3::new(0.1, 0.2, 0.3));
                let n = |k: usize| numbers[k].as_f64().unwrap();
                for r in 0..3 {
                    let mm = 100.0 * n(r) + 200.0 * n(3 + r) + 300.0 * n(6 + r) + n(9 + r);
                    same(mm, mm_from_m(p[r]));
                }
            }
        }
        let mesh = &meshes[written["mesh"].as_u64().unwrap() as usize];
        let positions = floats(&mesh["positions"]);
        assert_eq!(positions.len(), 3 * part.mesh.positions.len());
        for (p, own) in positions.chunks_exact(3).zip(&part.mesh.positions) {
            (0..3).for_each(|k| same(p[k], mm_from_m(own[k])));
        }
        let indices = STANDARD.decode(mesh["indices"].as_str().unwrap()).unwrap();
        let indices = indices.chunks_exact(4).map(|b| u32::from_le_bytes(b.try_into().unwrap()));
        assert!(indices.eq(part.mesh.triangles.iter().flatten().copied()));
    }
}

fn check_fields(drawing: &Drawing<'_>, written: &Value) {
    for (field, written) in drawing.fields.iter().zip(written["fields"].as_array().unwrap()) {
        assert_eq!(
            written["senses"][field.sense]["name"],
            drawing.cell.operations[field.operation].sense.name
        );
        let positions = floats(&written["positions"]);
        assert_eq!(positions.len(), 3 * field.nodes.len());
        for (k, node) in field.nodes.iter().enumerate() {
            same(positions[3 * k + 2], mm_from_m(node.position.z));
            assert_eq!(written["status"][k], node.sign.name());
            assert_eq!(written["reason"][k], node.reason);
        }
        for (take, written) in field.takes.iter().zip(written["takes"].as_array().unwrap()) {
            let error = floats(&written["error"]);
            for (k, own) in take.error.iter().enumerate() {
                same(error[3 * k], own.map_or(f64::NAN, |e| mm_from_m(e.x)));
            }
            for (s, own) in take.values.iter().enumerate() {
                let values = floats(&written["values"][s]);
                let unit = field.senses[s].unit;
                values
                    .iter()
                    .zip(own)
                    .for_each(|(v, own)| same(*v, own.map_or(f64::NAN, |v| unit.from_si(v))));
            }
        }
    }
    let signed = drawing.lenses.iter().map(|l| l.reading == Reading::Signed);
    assert!(signed.eq(written["lenses"].as_array().unwrap().iter().map(|l| l["signed"] == true)));
}

fn check_movement(drawing: &Drawing<'_>, written: &Value) {
    let (own, written) = (&drawing.movement, &written["movement"]);
    let times: Vec<f64> =
        written["times_s"].as_array().unwrap().iter().map(|t| t.as_f64().unwrap()).collect();
    let frames = floats(&written["frames"]);
    let links = own.home().len();
    assert_eq!(frames.len(), 12 * links * times.len());
    assert!(times.len() < own.times.len() && times.windows(2).all(|t| t[0] < t[1]));
    assert!((times[times.len() - 1] - own.duration()).abs() < 1e-6);
    for (stop, written) in own.stops.iter().zip(written["stops"].as_array().unwrap()) {
        let time = written["time_s"].as_f64().unwrap();
        let k = times.iter().position(|t| (t - time).abs() < 1e-6).expect("every stop is shown");
        let exact = stop.operation.map_or(own.home(), |o| own.at(o).unwrap());
        let tcp = exact[links - 1].translation;
        (0..3).for_each(|c| same(frames[12 * (k * links + links - 1) + 9 + c], mm_from_m(tcp[c])));
    }
}

#[test]
fn the_document_of_99_nodes_under_nine_lenses_is_small() {
    let workcell = workcell("hitachi_paper.toml");
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let drawing = Drawing::new(&a, &Detail::FULL).unwrap();
    assert_eq!((drawing.fields[0].nodes.len(), drawing.lenses.len()), (99, 9));
    let document = report::json::drawings(&[drawing]);
    keep_to_look_at("sweetspot-viewer-paper.html", &page(&document));
    // Two layouts may share only their meshes.
    let bytes = document.to_string().len() + document["drawings"][0].to_string().len();
    assert!(bytes < 500_000, "{bytes} bytes");
}

#[test]
fn no_name_can_leave_its_script_element() {
    let name = "</script><script>alert(1)</script><!-- & \u{2028}\u{2029} \" \\ ";
    let value = json!({ name: [name] });
    let text = script_json(&value);
    assert!(!text.contains(['<', '>', '&', '\u{2028}', '\u{2029}']));
    assert_eq!(serde_json::from_str::<Value>(&text).unwrap(), value);
}

/// An asset must not contain text that ends its element, and must not request anything.
#[test]
fn the_page_assets_stay_in_their_elements_and_request_nothing() {
    for text in [assets::viewer_js(), assets::VIEWER_CSS.to_string()] {
        for word in [
            "</",
            "<!--",
            "innerHTML",
            "eval(",
            "Function(",
            "fetch(",
            "XMLHttp",
            "import(",
            "@import",
            "url(",
        ] {
            assert!(!text.contains(word), "{word}");
        }
        // The namespace of SVG is not an address that is requested.
        assert_eq!(text.matches("http").count(), text.matches("http://www.w3.org/2000/svg").count());
    }
}
