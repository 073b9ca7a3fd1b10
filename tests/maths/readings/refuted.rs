//! Tests that samples replace the first-order figures everywhere if the samples refute these figures.

use crate::common::shipped;
use crate::readings::norm::near;
use std::sync::atomic::AtomicBool;
use sweetspot::assess::{Assessment, BudgetReport, Explanation, NodeChoice, PostureContext};
use sweetspot::cell::*;
use sweetspot::layout::Workcell;
use sweetspot::proof::{Covers, ProofOptions, WhyNot, prove};

/// Returns the cell of the paper with one normal error of the first joint, which turns the arm by `deviation`
/// rad at one standard deviation.
fn turned_by(deviation: f64) -> Workcell {
    let mut cell = shipped("hitachi_paper.toml");
    let mut spreads = vec![Spread::of_magnitude(0.0); Parameter::count(cell.robot.axes())];
    spreads[0] = Spread { plus_minus: 3.0 * deviation, distribution: Distribution::Normal, sigmas: 3.0 };
    cell.robot.errors = vec![ErrorSet::Tolerance(Tolerance {
        name: "turn".into(),
        spreads,
        covariance: None,
        costs: Vec::new(),
    })];
    (cell.errors, cell.model, cell.operations[0].limit) = (0, Model::Nonlinear, Some(1.0));
    (cell.reading, cell.quantity) = (Reading::Statistical, Quantity::P99);
    Workcell::new(cell).unwrap()
}

#[test]
fn figures_of_samples_replace_refuted_ones_in_every_report() {
    for (deviation, holds) in [(1e-4, true), (0.9, false)] {
        let workcell = turned_by(deviation);
        let layout = workcell.cell.start();
        let first_order = workcell.maps(&layout)[0].value.unwrap();
        let a = Assessment::new("start", &workcell, layout.clone());
        assert_eq!(a.first_order_holds(0), Some(holds));
        let p99 = a.samples[0].as_ref().unwrap().p99.value;
        let value = if holds { first_order } else { p99 };
        assert!(holds == ((first_order / p99 - 1.0).abs() < 0.01), "{first_order} {p99}");
        assert_eq!((a.maps[0].value, a.evaluation.objective), (Some(value), Some(value)));
        assert_eq!(a.requirement(0).unwrap().margin, 1.0 - value);
        assert_eq!(a.spot(0).unwrap().1.value, value);
        let context = || PostureContext::at(&workcell, &layout, &a.maps, 0, NodeChoice::Best).ok().unwrap();
        let (budget, explanation) = (BudgetReport::new(context()), Explanation::new(context()));
        for (judged, check) in [(&budget.judged, &budget.check), (&explanation.judged, &explanation.check)] {
            let check = check.as_ref().unwrap();
            near(judged.value, value, 1e-12 * value);
            assert_eq!(check.confirmed, holds);
            near(check.samples.p95.value, a.samples[0].as_ref().unwrap().p95.value, 1e-12);
        }
        // A bound of first-order figures does not hold for figures of samples.
        let proof = prove(&workcell, &ProofOptions::default(), &AtomicBool::new(false));
        assert_eq!(proof.covers, Covers::Everything);
        let (proven, gap) = a.proven(&proof);
        if holds {
            assert_eq!((proven, gap), (proof.clone(), Some(value / proof.bound.unwrap() - 1.0)));
        } else {
            assert_eq!((proven.bound, gap, proven.covers), (None, None, Covers::Nothing));
            assert_eq!(proven.operations[0].value, Err(WhyNot::Refuted));
        }
    }
}
