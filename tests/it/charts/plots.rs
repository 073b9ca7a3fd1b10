//! Tests plots of budgets and searches.

use super::{check, number, start};
use crate::common::workcell;
use sweetspot::assess::{Assessment, BudgetReport, ErrorDistribution, NodeChoice, PostureContext};
use sweetspot::cell::{Reading, Unit};
use sweetspot::layout::Workcell;
use sweetspot::report::chart::{
    ConvergenceHistory, convergence, discrepancy, histogram, misplacement, pareto, tornado,
};
use sweetspot::search;

/// Checks that the lengths of the bars of a budget are proportional to the shares.
fn budget(name: &str, workcell: &Workcell, a: &Assessment<'_>) {
    let context = PostureContext::at(workcell, &a.layout, &a.maps, 0, NodeChoice::Best)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let account = BudgetReport::new(context);
    let svg = tornado(&account);
    check(&format!("tornado-{name}"), &svg);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let bars = document.descendants().filter(|n| n.has_attribute("x") && n.tag_name().name() == "rect");
    let widths: Vec<f64> = bars.map(|n| number(&n, "width")).collect();
    let statistical = account.context.evaluator.reading == Reading::Statistical;
    let shares = account.budget.shares.iter();
    let shares: Vec<f64> = shares.map(|s| if statistical { s.of_variance } else { s.of_worst }).collect();
    assert!(widths.len() > 2, "{name}");
    for (width, share) in widths.iter().zip(&shares).take(16) {
        let wanted = widths[0] * share / shares[0];
        assert!((width - wanted).abs() < 0.02, "{name}: {width} for {share}");
    }
}

#[test]
fn a_convergence_chart_is_drawn_with_and_without_a_bound() {
    let trace = [(3, 0.0061), (17, 0.0052), (140, 0.0041), (2900, 0.00383)];
    let full = ConvergenceHistory {
        trace: &trace,
        evaluations: 20_000,
        start: Some(0.0068),
        bound: Some(0.00371),
        unit: Unit::Length,
    };
    let svg = convergence(&full);
    check("convergence-full", &svg);
    assert!(svg.contains("3.23 % above"), "{svg}");
    let bare = ConvergenceHistory { start: None, bound: None, ..full };
    check("convergence-bare", &convergence(&bare));
    assert!(convergence(&bare).contains("no bound was proven"));
    for (name, trace) in [("none", &trace[..0]), ("one", &trace[..1])] {
        let course =
            ConvergenceHistory { trace, evaluations: 1, start: None, bound: None, unit: Unit::Length };
        check(&format!("convergence-{name}"), &convergence(&course));
    }
}

#[test]
fn tornado_bars_are_as_long_as_the_shares_they_show() {
    for name in ["hitachi_paper", "scara_cell"] {
        let mut cell = workcell(&format!("{name}.toml")).cell;
        let limit = if name == "scara_cell" { Some(0.0003) } else { cell.operations[0].limit };
        cell.operations[0].limit = limit;
        let workcell = Workcell::new(cell).unwrap();
        let a = start(&workcell);
        budget(name, &workcell, &a);
        let d = ErrorDistribution::at_spot(&a, 0).unwrap();
        let svg = histogram(a.cell, &d);
        assert_eq!(svg.contains("requirement"), limit.is_some());
        check(&format!("histogram-{name}"), &svg);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let bars = document.descendants().filter(|n| n.has_attribute("x") && n.tag_name().name() == "rect");
        let bars: Vec<_> = bars.map(|n| (number(&n, "x"), number(&n, "height"))).collect();
        let counts: Vec<u32> = d.samples.histogram.counts.iter().copied().filter(|c| *c > 0).collect();
        assert_eq!((bars.len(), counts.iter().sum::<u32>() as usize), (counts.len(), d.samples.samples));
        let (tallest, most) =
            (bars.iter().map(|b| b.1).fold(0.0, f64::max), *counts.iter().max().unwrap() as f64);
        for ((_, height), count) in bars.iter().zip(&counts) {
            assert!((height - tallest * f64::from(*count) / most).abs() < 0.02);
        }
        // The histogram agrees with the percentile of the sorted samples.
        let h = &d.samples.histogram;
        let below = ((d.samples.p95.value - h.low) / h.width()).floor() as usize;
        let share =
            |parts: usize| f64::from(h.counts[..parts].iter().sum::<u32>()) / d.samples.samples as f64;
        assert!(share(below) <= 0.95 && share(below + 1) >= 0.95, "{name}");
        assert!(
            d.figures.worst >= d.samples.p99.value && d.signed.is_none_or(|s| s <= d.figures.worst * 1.0001)
        );
    }
}

#[test]
fn a_set_without_errors_has_no_histogram() {
    let mut workcell = workcell("hitachi_paper.toml");
    for set in &mut workcell.cell.robot.errors {
        if let sweetspot::cell::ErrorSet::Signed(s) = set {
            for list in [&mut s.dq, &mut s.dr, &mut s.dl, &mut s.dalpha, &mut s.dbeta] {
                list.fill(0.0);
            }
        }
    }
    let workcell = Workcell::new(workcell.cell).unwrap();
    let a = start(&workcell);
    let why = ErrorDistribution::at_spot(&a, 0).unwrap_err();
    assert!(why.contains("the error does not vary at this spot"), "{why}");
    // If there is nothing to draw, the chart of the budget states the reason.
    let context = PostureContext::at(&workcell, &a.layout, &a.maps, 0, NodeChoice::Best)
        .unwrap_or_else(|e| panic!("{e:?}"));
    let svg = tornado(&BudgetReport::new(context));
    check("tornado-none", &svg);
    assert!(svg.contains("no parameter has an effect"));
    check("discrepancy-none", &discrepancy(&a));
}

#[test]
fn the_misplacement_chart_shows_the_allowed_misplacement() {
    for name in ["hitachi_cell"] {
        let workcell = crate::common::workcell(&format!("{name}.toml"));
        let a = start(&workcell).misplaced();
        for (k, r) in a.robustness.iter().enumerate() {
            let Some(r) = r else { continue };
            let svg = misplacement(a.cell, k, r);
            check(&format!("misplacement-{name}-{k}"), &svg);
            let document = roxmltree::Document::parse(&svg).unwrap();
            let bars =
                document.descendants().filter(|n| n.has_attribute("x") && n.tag_name().name() == "rect");
            let widths: Vec<f64> = bars.map(|n| number(&n, "width")).collect();
            let slopes: Vec<(f64, bool)> = r
                .gradient
                .iter()
                .filter_map(|(slot, g)| Some((g.as_ref()?.abs(), slot.is_angle())))
                .collect();
            assert_eq!(widths.len(), slopes.len());
            // The lengths of the bars are compared with each other, px per m/m.
            let lengths = || widths.iter().zip(&slopes).filter(|(_, s)| !s.1);
            let px: f64 = lengths().map(|(w, _)| w).sum::<f64>() / lengths().map(|(_, s)| s.0).sum::<f64>();
            for (width, (slope, _)) in lengths() {
                assert!((width - px * slope).abs() < 0.05, "{width} {slope}");
            }
        }
    }
}

#[test]
fn a_pareto_chart_has_one_point_per_layout() {
    let mut cell = workcell("hitachi_cell.toml").cell;
    cell.search.pareto = sweetspot::cell::Goals::of(&[
        sweetspot::cell::Goal::Error,
        sweetspot::cell::Goal::Footprint,
        sweetspot::cell::Goal::Clearance,
    ])
    .unwrap();
    cell.search.budget = 400;
    let workcell = Workcell::new(cell).unwrap();
    let settings = workcell.cell.search;
    let stop = std::sync::atomic::AtomicBool::new(false);
    let record = search::search(&workcell, &settings, &search::Watch { progress: &|_| (), stop: &stop });
    let svg = pareto(&workcell.cell, &record).unwrap();
    check("pareto-hitachi_cell", &svg);
    assert_eq!(svg.matches("<circle").count(), record.alternatives.len());
    check("convergence-hitachi_cell", &convergence(&ConvergenceHistory::of(&record, workcell.cell.unit())));
    for name in ["hitachi_cell", "hitachi_paper"] {
        let workcell = crate::common::workcell(&format!("{name}.toml"));
        check(&format!("discrepancy-{name}"), &discrepancy(&start(&workcell)));
    }
}
