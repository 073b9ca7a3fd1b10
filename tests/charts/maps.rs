//! Heat maps and drawings of a layout.

use crate::{check, renamed, start, workcell};
use sweetspot::drawing::{Detail, Drawing};
use sweetspot::layout::Workcell;
use sweetspot::report::chart::heat_map;

#[test]
fn the_shipped_cells_have_heat_maps() {
    for name in ["hitachi_cell", "hitachi_paper", "drilling_cell", "scara_cell"] {
        let workcell = workcell(&format!("{name}.toml"));
        let a = start(&workcell);
        let detail = Detail { lenses: name == "hitachi_paper", envelopes: false, nodes: 4000 };
        let drawing = Drawing::new(&a, &detail).unwrap();
        for (k, field) in drawing.fields.iter().enumerate() {
            for take in 0..field.takes.len() {
                let range = field.range(take, field.sense).unwrap();
                check(&format!("heat-{name}-{k}-{take}"), &heat_map(&drawing, k, take, field.sense, range));
            }
        }
    }
}

#[test]
fn a_heat_map_says_names_as_they_are() {
    let workcell = Workcell::new(renamed(workcell("hitachi_cell.toml").cell)).unwrap();
    let a = start(&workcell);
    let drawing = Drawing::new(&a, &Detail { lenses: false, envelopes: false, nodes: 30 }).unwrap();
    for k in 0..drawing.fields.len() {
        let sense = drawing.fields[k].sense;
        check(&format!("heat-hostile-{k}"), &heat_map(&drawing, k, 0, sense, (0.0, 0.01)));
    }
}
