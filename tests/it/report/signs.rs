//! Tests that every picture and page describes a node in the same way.

use crate::common::from_text;
use std::collections::HashSet;
use sweetspot::assess::Assessment;
use sweetspot::drawing::{Detail, Drawing, node_glyph};
use sweetspot::error_map::NodeSign;
use sweetspot::layout::Workcell;
use sweetspot::raster::{Shot, isometric};
use sweetspot::report;
use sweetspot::report::page::assets;

/// Calls `look` with a cell in which some nodes are unusable only because of a singularity.
fn with_singular_nodes(look: impl FnOnce(&Assessment<'_>, &Drawing<'_>)) {
    let text = "schema = \"sweetspot/cell/1\"\nunits = { length = \"mm\", angle = \"deg\" }\n\
                from = \"wrist_cell.toml\"\ncollision = false\n[margins]\nsingularity = 0.2\n";
    let workcell = Workcell::new(from_text(text).unwrap().cell).unwrap();
    let a = Assessment::new("start", &workcell, workcell.cell.start());
    let count = |sign: NodeSign| a.maps.iter().map(|m| m.count(sign)).sum::<usize>();
    assert_eq!((count(NodeSign::Singular), count(NodeSign::Collision)), (24, 0));
    let detail = Detail { lenses: false, envelopes: false, nodes: usize::MAX };
    look(&a, &Drawing::new(&a, &detail).unwrap());
}

fn texts(svg: &str) -> HashSet<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let all = document.descendants().filter(|n| n.tag_name().name() == "text");
    all.filter_map(|n| n.text().map(str::to_string)).collect()
}

/// Returns the signs in the legend of a picture.
fn legend_signs(svg: &str) -> HashSet<NodeSign> {
    let texts = texts(svg);
    // Charts state the number of nodes after the label.
    let is_told = |label: &str| texts.iter().any(|t| t.split(" (").next() == Some(label));
    NodeSign::ALL.into_iter().filter(|sign| !sign.is_usable() && is_told(sign.label())).collect()
}

#[test]
fn a_picture_calls_a_singular_node_singular_and_not_colliding() {
    with_singular_nodes(|a, drawing| {
        let of_the_map: HashSet<NodeSign> = NodeSign::ALL
            .into_iter()
            .filter(|s| !s.is_usable() && a.maps.iter().any(|m| m.count(*s) > 0))
            .collect();
        assert!(of_the_map.contains(&NodeSign::Singular) && !of_the_map.contains(&NodeSign::Collision));
        // The PNG and this SVG are drawn from the same items.
        let picture = isometric(drawing, &Shot::default()).unwrap();
        assert_eq!(legend_signs(&picture), of_the_map);
        let red = "#cf222e";
        assert!(!picture.contains(red), "a node is crossed out");
        assert_eq!(legend_signs(&report::chart::error_map(a)), of_the_map);
    });
}

#[test]
fn the_pages_call_a_singular_node_singular_and_not_colliding() {
    with_singular_nodes(|a, drawing| {
        let viewer = report::json::drawings(std::slice::from_ref(drawing));
        let fields = viewer["drawings"][0]["fields"].as_array().unwrap().clone();
        let live = report::json::value(&report::json::answer(a));
        let nodes = live["operations"].as_array().unwrap().iter().map(|o| o["nodes"].clone());
        let table = assets::node_signs();
        let mut singular = [0, 0];
        for (k, all) in [fields, nodes.collect()].iter().enumerate() {
            for status in all.iter().flat_map(|f| f["status"].as_array().unwrap()) {
                // The scripts look up a status in their table, which has no default entry.
                let label = table[status.as_str().unwrap()]["label"].as_str().unwrap();
                assert!(["usable", "nearly singular", "out of reach"].contains(&label), "{label}");
                singular[k] += usize::from(label == "nearly singular");
            }
        }
        assert_eq!(singular, [24, 24]);
    });
}

#[test]
fn every_sign_has_a_name_a_label_and_a_glyph_of_its_own() {
    let all = NodeSign::ALL;
    assert_eq!(all.iter().map(|s| s.name()).collect::<HashSet<_>>().len(), all.len());
    assert_eq!(all.iter().map(|s| s.label()).collect::<HashSet<_>>().len(), all.len());
    for (k, sign) in all.into_iter().enumerate() {
        assert!(all[..k].iter().all(|other| node_glyph(*other) != node_glyph(sign)), "{sign:?}");
        assert_eq!(node_glyph(sign).is_none(), sign.is_usable());
    }
}

#[test]
fn every_sign_is_told_by_its_own_label_in_every_picture_and_page() {
    with_singular_nodes(|a, _| {
        for sign in NodeSign::ALL.into_iter().filter(|sign| !sign.is_usable()) {
            let mut drawing =
                Drawing::new(a, &Detail { lenses: false, envelopes: false, nodes: usize::MAX }).unwrap();
            drawing.fields.iter_mut().flat_map(|f| &mut f.nodes).for_each(|node| node.sign = sign);
            let picture = isometric(&drawing, &Shot::default()).unwrap();
            assert_eq!(legend_signs(&picture), HashSet::from([sign]));
            let chart = report::chart::heat_map(&drawing, 0, 0, drawing.fields[0].sense, (0.0, 0.001));
            assert!(texts(&chart).iter().any(|t| t.starts_with(sign.label())), "{sign:?}");
        }
    });
}

/// The scripts use only the table to draw and name a node.
#[test]
fn the_scripts_hold_the_table_of_signs_and_no_words_of_their_own() {
    let table = format!("const NODE_SIGN_TABLE = {};", assets::node_signs());
    let viewer = assets::viewer_js();
    let (before, after) = viewer.split_once(&table).expect("the table");
    #[cfg(feature = "view")]
    let live = assets::live_js();
    #[cfg(not(feature = "view"))]
    let live = "";
    for script in [before, after, live.as_ref()] {
        for sign in NodeSign::ALL {
            let quoted = format!("\"{}\"", sign.label());
            assert!(!script.contains(&quoted), "{quoted}");
        }
        for status in ["out-of-reach", "joint-limit", "not-converged", "collision", "singular", "retract"] {
            assert!(!script.contains(&format!("\"{status}\"")), "{status}");
        }
    }
}

/// All signs fit into the legend at once, without overlap.
#[test]
fn the_legend_of_a_picture_has_room_for_every_sign() {
    with_singular_nodes(|a, _| {
        let mut drawing =
            Drawing::new(a, &Detail { lenses: false, envelopes: false, nodes: usize::MAX }).unwrap();
        let nodes = drawing.fields.iter_mut().flat_map(|f| &mut f.nodes);
        nodes.zip(NodeSign::ALL.into_iter().cycle()).for_each(|(node, sign)| node.sign = sign);
        for (width, height) in [(1600, 1000), (640, 480)] {
            let shot = Shot { width, height, ..Shot::default() };
            let picture = isometric(&drawing, &shot).unwrap();
            assert_eq!(legend_signs(&picture).len(), NodeSign::ALL.len() - 1);
            let document = roxmltree::Document::parse(&picture).unwrap();
            let labels: Vec<[f64; 4]> = document
                .descendants()
                .filter(|n| NodeSign::ALL.iter().any(|s| n.text() == Some(s.label())))
                .filter(|n| n.tag_name().name() == "text")
                .map(|n| {
                    let number = |name: &str| n.attribute(name).unwrap().parse::<f64>().unwrap();
                    let (x, y, size) = (number("x"), number("y"), number("font-size"));
                    let wide = sweetspot::raster::font::width(n.text().unwrap(), size / 1.38);
                    [x, y - 0.7 * size, x + wide, y]
                })
                .collect();
            for (k, a) in labels.iter().enumerate() {
                assert!(a[2] <= width as f64 && a[3] <= height as f64, "{a:?}");
                let apart = |b: &[f64; 4]| a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
                assert!(labels[..k].iter().all(apart), "{a:?} {labels:?}");
            }
        }
    });
}
