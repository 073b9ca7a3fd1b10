//! Plots of budgets and searches.

use crate::{check, number, start, workcell};
use sweetspot::cell::Unit;
use sweetspot::compare::{Account, At, Stance};
use sweetspot::report::chart::convergence::Course;
use sweetspot::report::chart::{convergence, tornado};

#[test]
fn the_bars_of_a_budget_are_as_long_as_its_shares() {
    for name in ["hitachi_cell", "hitachi_paper", "drilling_cell", "scara_cell"] {
        let workcell = workcell(&format!("{name}.toml"));
        let a = start(&workcell);
        let Ok(stance) = Stance::at(&workcell, &a.layout, &a.maps, 0, At::Best) else { continue };
        let account = Account::new(stance);
        let svg = tornado(&account);
        check(&format!("tornado-{name}"), &svg);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let bars = document.descendants().filter(|n| n.has_attribute("x") && n.tag_name().name() == "rect");
        let widths: Vec<f64> = bars.map(|n| number(&n, "width")).collect();
        let statistical = account.stance.gauge.reading == sweetspot::cell::Reading::Statistical;
        let shares = account.budget.shares.iter();
        let shares: Vec<f64> = shares.map(|s| if statistical { s.of_variance } else { s.of_worst }).collect();
        assert!(widths.len() > 2, "{name}");
        for (width, share) in widths.iter().zip(&shares).take(16) {
            let wanted = widths[0] * share / shares[0];
            assert!((width - wanted).abs() < 0.02, "{name}: {width} for {share}");
        }
    }
}

#[test]
fn a_course_is_drawn_with_its_bound_or_without() {
    let trace = [(3, 0.0061), (17, 0.0052), (140, 0.0041), (2900, 0.00383)];
    let full = Course {
        trace: &trace,
        evaluations: 20_000,
        start: Some(0.0068),
        bound: Some(0.00371),
        unit: Unit::Length,
    };
    let svg = convergence(&full);
    check("convergence-full", &svg);
    assert!(svg.contains("3.23 % above"), "{svg}");
    let bare = Course { start: None, bound: None, ..full };
    check("convergence-bare", &convergence(&bare));
    assert!(convergence(&bare).contains("no bound was proven"));
    for (name, trace) in [("none", &trace[..0]), ("one", &trace[..1])] {
        let course = Course { trace, evaluations: 1, start: None, bound: None, unit: Unit::Length };
        check(&format!("convergence-{name}"), &convergence(&course));
    }
}
