//! Tests heat maps and drawings of a layout.

use super::{check, number, renamed, start};
use crate::common::workcell;
use sweetspot::assess::Assessment;
use sweetspot::cell::Reading;
use sweetspot::drawing::{Detail, Drawing};
use sweetspot::error_map::NodeSign;
use sweetspot::layout::Workcell;
use sweetspot::report;
use sweetspot::report::chart::{heat_map, layout_plan, layout_section};

#[test]
fn the_shipped_cells_have_heat_maps() {
    for name in ["hitachi_cell", "hitachi_paper", "drilling_cell", "scara_cell"] {
        let workcell = workcell(&format!("{name}.toml"));
        let a = start(&workcell);
        let detail = Detail { lenses: false, envelopes: false, nodes: 4000 };
        let drawing = Drawing::new(&a, &detail).unwrap();
        for (k, field) in drawing.fields.iter().enumerate() {
            check(&format!("plan-{name}-{k}"), &layout_plan(&a, &drawing, k));
            check(&format!("section-{name}-{k}"), &layout_section(&a, &drawing, k));
            for take in 0..field.takes.len() {
                let range = field.range(take, field.sense).unwrap();
                check(&format!("heat-{name}-{k}-{take}"), &heat_map(&drawing, k, take, field.sense, range));
            }
        }
    }
}

#[test]
fn a_heat_map_shows_hostile_names_as_text() {
    let workcell = Workcell::new(renamed(workcell("hitachi_cell.toml").cell)).unwrap();
    let a = start(&workcell);
    let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 30 }).unwrap();
    for k in 0..drawing.fields.len() {
        let sense = drawing.fields[k].sense;
        check(&format!("plan-hostile-{k}"), &layout_plan(&a, &drawing, k));
        check(&format!("section-hostile-{k}"), &layout_section(&a, &drawing, k));
        check(&format!("heat-hostile-{k}"), &heat_map(&drawing, k, 0, sense, (0.0, 0.01)));
    }
}

/// Returns all texts of a picture.
fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let all = document.descendants().filter(|n| n.tag_name().name() == "text");
    all.filter_map(|n| n.text().map(str::to_string)).collect()
}

#[test]
fn a_legend_lists_exactly_the_node_signs_in_the_map() {
    let workcell = workcell("hitachi_cell.toml");
    let a = start(&workcell);
    let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 4000 }).unwrap();
    for (k, map) in a.maps.iter().enumerate() {
        let svg = heat_map(&drawing, k, 0, drawing.fields[k].sense, (0.01, 0.02));
        let told = texts(&svg);
        let mut counted = map.count(NodeSign::Usable);
        for sign in NodeSign::ALL.into_iter().filter(|sign| !sign.is_usable()) {
            let wanted = format!("{} ({})", sign.label(), map.count(sign));
            assert_eq!(told.contains(&wanted), map.count(sign) > 0, "{wanted}: {told:?}");
            counted += map.count(sign);
        }
        assert_eq!(counted, map.nodes.len());
        // Every node has a title in the words of the map.
        assert_eq!(svg.matches("<title>(").count(), map.nodes.len());
    }
}

/// Grids without area, constant fields and maps without a usable node also give a picture.
#[test]
fn maps_of_few_nodes_or_constant_values_are_drawn() {
    let workcell = workcell("hitachi_paper.toml");
    let a = start(&workcell);
    let detail = Detail { lenses: false, envelopes: false, nodes: 4000 };
    let (sense, full) = {
        let drawing = Drawing::new(&a, &detail).unwrap();
        (drawing.fields[0].sense, drawing.fields[0].clone())
    };
    let usable: Vec<usize> = full.usable().collect();
    let draw = |name: &str, change: &dyn Fn(&mut sweetspot::drawing::Field)| {
        let mut drawing = Drawing::new(&a, &detail).unwrap();
        change(&mut drawing.fields[0]);
        let range = drawing.fields[0].range(0, sense).unwrap_or((0.0, 0.0));
        let svg = heat_map(&drawing, 0, 0, sense, range);
        check(&format!("heat-odd-{name}"), &svg);
        svg
    };
    for keep in [0, 1, 2] {
        draw(&format!("{keep}"), &|field| {
            for k in usable.iter().skip(keep) {
                field.nodes[*k].sign = NodeSign::Attitude;
            }
            (field.best, field.spot, field.refined) = (None, None, None);
        });
    }
    let flat = draw("constant", &|field| {
        field.takes[0].values[sense].iter_mut().for_each(|v| *v = v.map(|_| 0.004));
    });
    assert!(!flat.contains("iso-lines every"));
    let other = draw("other", &|field| field.takes[0].best = field.usable().last());
    assert!(texts(&other).contains(&"spot in this reading".to_string()));
    // The nodes are points along the first axis.
    let dots = draw("points", &|field| field.size = (field.nodes.len(), 1));
    assert!(dots.matches("<circle").count() >= usable.len());
    let row = draw("row", &|field| {
        field.nodes.truncate(11);
        field.takes[0].values[sense].truncate(11);
        field.size = (11, 1);
        (field.best, field.takes[0].best, field.spot, field.refined) = (None, None, None, None);
    });
    check("heat-odd-row", &row);
}

/// The position of the spot in the picture agrees with the numbers at the axes.
#[test]
fn the_spot_is_drawn_where_the_axes_place_it() {
    let workcell = workcell("hitachi_paper.toml");
    let a = start(&workcell);
    let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 4000 }).unwrap();
    let svg = heat_map(&drawing, 0, 0, drawing.fields[0].sense, (0.003, 0.006));
    let document = roxmltree::Document::parse(&svg).unwrap();
    let all = || document.descendants().filter(|n| n.tag_name().name() == "text");
    // The numbers of the x axis are at the bottom, each below its gridline.
    let ticks: Vec<(f64, f64)> = all()
        .filter(|n| n.attribute("text-anchor") == Some("middle"))
        .filter_map(|n| Some((n.text()?.parse().ok()?, number(&n, "x"))))
        .filter(|(value, _): &(f64, f64)| value.abs() >= 500.0)
        .collect();
    let (first, last) = (ticks[0], ticks[ticks.len() - 1]);
    assert!(ticks.len() >= 2 && last.0 > first.0, "{ticks:?}");
    let ring = document.descendants().filter(|n| n.tag_name().name() == "circle");
    let ring = ring.filter(|n| n.attribute("r") == Some("8.0")).map(|n| number(&n, "cx")).next().unwrap();
    let at = first.0 + (ring - first.1) * (last.0 - first.0) / (last.1 - first.1);
    let spot = a.spot(0).unwrap().0;
    let own = a.layout.placements[0].pose().inverse().transform(&spot.position);
    assert!((at - sweetspot::units::mm_from_m(own.x)).abs() < 1.0, "{at} {own}");
}

/// The map shows every node sign, the fence and the keep-out boxes. It cuts off no text, and draws only some
/// of many nodes.
#[test]
fn the_heat_map_of_a_cell_shows_every_node() {
    for name in ["hitachi_cell", "drilling_cell"] {
        let workcell = workcell(&format!("{name}.toml"));
        let a = start(&workcell);
        let svg = report::chart::error_map(&a);
        keep(&format!("map-{name}"), &svg);
        let told = texts(&svg);
        assert_eq!(told.contains(&"fence".to_string()), a.cell.fence.is_some());
        let refined = a.refined.iter().any(Option::is_some);
        assert_eq!(told.contains(&"spot between the nodes".to_string()), refined);
        for sign in NodeSign::ALL.into_iter().filter(|sign| !sign.is_usable()) {
            let count: usize = a.maps.iter().map(|m| m.count(sign)).sum();
            let is_told = told.contains(&format!("{} ({count})", sign.label()));
            assert_eq!(is_told, count > 0, "{name}: {sign:?}");
        }
        assert_eq!(svg.matches("<title>(").count(), a.maps.iter().map(|m| m.nodes.len()).sum::<usize>());
    }
}

#[test]
fn a_map_of_many_nodes_is_thinned_and_says_so() {
    let workcell = workcell("hitachi_paper.toml");
    let mut a: Assessment<'_> = start(&workcell);
    let few = a.maps[0].nodes.clone();
    a.maps[0].nodes = (0..100_000)
        .map(|k| sweetspot::error_map::NodeRecord { i: k % 400, j: k / 400, ..few[k % few.len()].clone() })
        .collect();
    let svg = report::chart::error_map(&a);
    let drawn = svg.matches("<title>(").count();
    assert!((1000..=4000).contains(&drawn) && svg.len() < 2_000_000, "{drawn} nodes, {} bytes", svg.len());
    assert!(
        texts(&svg).iter().any(|t| t.contains("along each axis, one in every 5 nodes is drawn")),
        "{drawn}"
    );
}

#[test]
fn the_names_of_a_map_are_not_cut_at_the_edge() {
    let workcell = Workcell::new(renamed(workcell("hitachi_cell.toml").cell)).unwrap();
    let svg = report::chart::error_map(&start(&workcell));
    keep("map-hostile", &svg);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let width: f64 = document.root_element().attribute("width").unwrap().parse().unwrap();
    crate::charts::inside("map-hostile", &document.root_element(), width);
}

fn keep(name: &str, svg: &str) {
    crate::charts::keep(name, svg);
    roxmltree::Document::parse(svg).unwrap();
}

/// An unsigned error has two arrows in opposite directions, and a signed error has one arrow.
#[test]
fn errors_without_a_sign_have_arrows_either_way() {
    let cases = [
        ("hitachi_cell", Reading::Signed, 1),
        ("wrist_cell", Reading::WorstCase, 2),
        ("wrist_cell", Reading::Statistical, 2),
    ];
    for (name, reading, ways) in cases {
        let mut cell = workcell(&format!("{name}.toml")).cell;
        cell.reading = reading;
        let workcell = Workcell::new(cell).unwrap();
        let svg = report::chart::error_map(&start(&workcell));
        let document = roxmltree::Document::parse(&svg).unwrap();
        let is_node = |n: &roxmltree::Node<'_, '_>| {
            n.has_tag_name("title") && n.text().is_some_and(|t| t.starts_with('(') && t.contains("): "))
        };
        let groups = document.descendants().filter(is_node).filter_map(|title| title.parent());
        let paths = groups
            .filter(|g| g.attribute("stroke").is_some())
            .filter_map(|g| g.children().find(|n| n.has_tag_name("path")).and_then(|n| n.attribute("d")));
        let shafts: Vec<usize> = paths.map(|d| d.matches('M').count()).collect();
        assert!(!shafts.is_empty() && shafts.iter().all(|n| *n == ways), "{reading:?}: {shafts:?}");
        let either =
            texts(&svg).iter().any(|t| t.contains("drawn in both directions along the worst-case error"));
        assert_eq!(either, ways == 2, "{reading:?}");
    }
}

/// The ring of an operation at every node marks its worst node, which is not a spot that anybody chose.
#[test]
fn the_ring_of_an_operation_at_every_node_is_named_the_worst_node() {
    use sweetspot::cell::NodeAggregation;
    for over in [NodeAggregation::Best, NodeAggregation::Max] {
        let mut cell = workcell("panda_cell.toml").cell;
        cell.operations.truncate(1);
        cell.operations[0].over = over;
        let workcell = Workcell::new(cell).unwrap();
        let a = start(&workcell);
        assert!(a.spot(0).is_some());
        let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 4000 }).unwrap();
        let range = drawing.fields[0].range(0, drawing.fields[0].sense).unwrap();
        let heat = heat_map(&drawing, 0, 0, drawing.fields[0].sense, range);
        for svg in [report::chart::error_map(&a), layout_plan(&a, &drawing, 0), heat] {
            let is_worst = over == NodeAggregation::Max;
            assert_eq!(svg.contains("worst node"), is_worst, "{over:?}");
            assert_eq!(svg.contains("chosen spot"), !is_worst, "{over:?}");
        }
    }
}
