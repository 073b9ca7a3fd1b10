//! Tests the ranked node loop of planar arms against the loop that judges every node. Both loops must give
//! the same bits.

use crate::common::{cases, data, shipped};
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::sync::atomic::AtomicBool;
use sweetspot::cell::{
    Attitude, Cell, Coordinate, ErrorSet, Frame, JointKind, Layout, MeasuredErrors, Model, NodeAggregation,
    Parameter, Place, Placement, Quantity, Reading, Robot, Row, Sense, SignedErrors, Spin, Unit,
};
use sweetspot::error_map::Outcome;
use sweetspot::layout::{Workcell, Workspace, evaluate_in};
use sweetspot::pose::Pose;
use sweetspot::proof::rank_nodes;
use sweetspot::reading::{WorkContext, WorkFrame};

/// Cell that is evaluated with ranking, with value fields if there are any, and with every node judged one by
/// one.
struct RankedPair {
    ranked: Workcell,
    with_fields: Option<Workcell>,
    judged: Workcell,
    memory: [Workspace; 3],
}

impl RankedPair {
    fn new(cell: &Cell) -> Result<Self, String> {
        let judged = Workcell::new(cell.clone())?.unranked();
        let ranked = Workcell::new(cell.clone())?;
        Ok(Self { ranked, with_fields: None, judged, memory: Default::default() })
    }

    /// Also compares the evaluation with value fields.
    fn with_fields(cell: &Cell) -> Result<Self, String> {
        let with_fields = Workcell::new(cell.clone())?;
        rank_nodes(&with_fields, &AtomicBool::new(false));
        Ok(Self { with_fields: Some(with_fields), ..Self::new(cell)? })
    }

    /// Compares the evaluations of a layout. Returns the numbers of operations with a spot, with only
    /// colliding postures, and out of reach.
    fn compare(&mut self, layout: &Layout) -> [usize; 3] {
        let got = evaluate_in(&self.ranked, layout, &mut self.memory[0]);
        let want = evaluate_in(&self.judged, layout, &mut self.memory[1]);
        assert_eq!((&got, got.cost.to_bits()), (&want, want.cost.to_bits()), "{layout:?}");
        if let Some(with_fields) = &self.with_fields {
            let by_field = evaluate_in(with_fields, layout, &mut self.memory[2]);
            assert_eq!((&by_field, by_field.cost.to_bits()), (&want, want.cost.to_bits()), "{layout:?}");
        }
        let mut counts = [0; 3];
        for (got, want) in got.outcomes.iter().zip(&want.outcomes) {
            let key = |outcome: &Outcome| match outcome {
                Outcome::Found(spot) => (0, spot.value.to_bits()),
                Outcome::AllCollide { nearest } => (1, nearest.value.to_bits()),
                Outcome::Unreachable { gap } => (2, gap.reach.to_bits() ^ gap.limits.to_bits()),
                Outcome::Uncertain { nearest, .. } => (3, nearest.value.to_bits()),
                Outcome::Unjudged(_) | Outcome::Refused { .. } => panic!("{outcome:?}"),
            };
            assert_eq!(key(got), key(want), "{layout:?}");
            if let Some(count) = counts.get_mut(key(got).0) {
                *count += 1;
            }
        }
        counts
    }
}

fn placed(x: f64, y: f64, z: f64, yaw_deg: f64) -> Placement {
    Placement { x, y, z, yaw: yaw_deg.to_radians() }
}

fn sum(a: [usize; 3], b: [usize; 3]) -> [usize; 3] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Peer set D has 1000 random and 1000 plausible layouts.
#[test]
fn ranking_does_not_change_the_layouts_of_peer_set_d() {
    for collision in [true, false] {
        let mut cell = shipped("hitachi_cell.toml");
        cell.collision = collision;
        let mut pair = RankedPair::new(&cell).unwrap();
        let mut counts = [0; 3];
        for x in data("d_layouts.bin").chunks_exact(7) {
            let mut layout = cell.start();
            layout.placements[0] = placed(x[0] * 1e-3, x[1] * 1e-3, x[3] * 1e-3, x[2]);
            layout.placements[1] = placed(x[4] * 1e-3, x[5] * 1e-3, 0.6, x[6]);
            counts = sum(counts, pair.compare(&layout));
        }
        let [found, collide, unreachable] = counts;
        assert!(found > 1000 && unreachable > 300, "{counts:?}");
        assert_eq!(collide > 10, collision, "{counts:?}");
    }
}

/// Returns a sense of up to six directions of any length.
fn weighted(rng: &mut ChaCha8Rng) -> Sense {
    let direction = |rng: &mut ChaCha8Rng| Vector3::from_fn(|_, _| rng.random_range(-30.0..30.0));
    let rows: Vec<_> = (0..rng.random_range(1..=6)).map(|_| direction(rng)).collect();
    let rows: Vec<_> = rows.into_iter().map(|direction| Row { turns: false, direction }).collect();
    Sense::new("weighted", Frame::World, Vector3::zeros(), Unit::Length, &rows)
}

/// Returns a cell with random robot, errors, limits, tool, base, senses, orientations and grids.
fn drawn(rng: &mut ChaCha8Rng) -> Cell {
    let shop = ["hitachi_cell.toml", "hitachi_paper.toml", "hitachi_paper_parallelogram.toml"];
    let mut cell = shipped(shop[rng.random_range(0..shop.len())]);
    cell.collision = rng.random_range(0..4) == 0;
    if rng.random_range(0..2) == 0 {
        let at = |rng: &mut ChaCha8Rng| rng.random_range(-0.3..0.3);
        let yaw = rng.random_range(-3.0..3.0);
        cell.base = [at(rng), at(rng), at(rng), yaw].map(Coordinate::Fixed);
    }
    let robot = &mut cell.robot;
    let axes = robot.joints.len();
    for (k, joint) in robot.joints.iter_mut().enumerate() {
        let width = joint.limits.1 - joint.limits.0;
        joint.limits.0 -= rng.random_range(-0.2..0.5) * width;
        joint.limits.1 += rng.random_range(-0.2..0.5) * width;
        joint.theta += rng.random_range(-0.5..0.5);
        if k == 0 && rng.random_range(0..2) == 0 {
            joint.alpha = -joint.alpha;
        }
        joint.r += if rng.random_range(0..2) == 0 { rng.random_range(-0.05..0.05) } else { 0.0 };
        joint.l += if rng.random_range(0..2) == 0 { rng.random_range(-0.1..0.1) } else { 0.0 };
    }
    if rng.random_range(0..3) == 0 {
        robot.mount = Pose::from_translation_yaw(Vector3::new(0.1, -0.05, 0.2), 0.7);
    }
    let size = [1e-2, 1e-4, 1e-8][rng.random_range(0..3)];
    let joints = rng.random_range(0..3) == 0;
    let value = |p: Parameter| match p {
        Parameter::Joint(..) if !joints => 0.0,
        p if p.is_elastic() => 0.0,
        _ => rng.random_range(-size..size),
    };
    let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
    cell.robot.errors[cell.errors] = ErrorSet::Signed(SignedErrors::of_values("drawn".into(), axes, &values));
    let senses = ["x", "y", "z", "xy", "xyz"];
    for operation in &mut cell.operations {
        operation.sense = Sense::plain(senses[rng.random_range(0..senses.len())]).unwrap();
        if rng.random_range(0..4) == 0 {
            operation.sense = weighted(rng);
        }
        if let Place::Grid { divisions, .. } = &mut operation.place {
            *divisions = (rng.random_range(1..12), rng.random_range(1..9));
        }
        let down = rng.random_range(0..2) == 0;
        let elevation = if down { -std::f64::consts::FRAC_PI_2 } else { rng.random_range(-1.5..0.5) };
        operation.attitude = Attitude::elevation(elevation);
        operation.attitude.tolerance = if rng.random_range(0..3) == 0 { 0.1 } else { 0.0 };
    }
    cell
}

#[test]
fn ranking_does_not_change_the_value_of_random_cells() {
    let mut rng = ChaCha8Rng::seed_from_u64(5);
    let mut counts = [0; 3];
    let mut ranked = 0;
    for _ in 0..300 {
        let cell = drawn(&mut rng);
        let Ok(mut pair) = RankedPair::new(&cell) else { continue };
        ranked += usize::from(pair.ranked.is_ranked());
        for _ in 0..20 {
            let mut layout = cell.start();
            for at in &mut layout.placements {
                at.x += rng.random_range(-0.5..0.5);
                at.y += rng.random_range(-0.5..0.5);
                at.yaw += rng.random_range(-3.0..3.0);
                // A surface without rotation on the base axis has nodes of equal value.
                if rng.random_range(0..6) == 0 {
                    (at.x, at.y, at.yaw) = (0.0, 0.0, 0.0);
                }
            }
            counts = sum(counts, pair.compare(&layout));
        }
    }
    assert!(ranked > 200, "{ranked}");
    assert!(counts.iter().all(|c| *c > 50), "{counts:?}");
}

/// Cells whose spin is free or whose errors are random, each with the number of layouts to compare.
const BOUNDED_CELLS: [(&str, usize); 7] = [
    ("ur_cell.toml", 100),
    ("scara_cell.toml", 100),
    ("palletizer_cell.toml", 100),
    ("five_axis_cell.toml", 100),
    ("wrist_cell.toml", 40),
    ("track_cell.toml", 6),
    ("panda_cell.toml", 3),
];

/// Returns a layout near the start layout of a cell.
fn near_start(cell: &Cell, rng: &mut ChaCha8Rng) -> Layout {
    let mut layout = cell.start();
    for at in &mut layout.placements {
        at.x += rng.random_range(-0.4..0.4);
        at.y += rng.random_range(-0.4..0.4);
        at.yaw += rng.random_range(-1.0..1.0);
    }
    layout
}

/// Spin families have bounds, and their members are judged only if the bound is below the best value. The
/// cells are tested as shipped, and with another quantity, sense, spin, tool errors, or without collisions.
#[test]
fn spin_families_do_not_change_the_layouts_of_shipped_cells() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut counts = [0; 3];
    for (name, layouts) in BOUNDED_CELLS {
        for variant in 0..6 {
            let mut cell = shipped(name);
            cell.search.ideal = variant % 2 == 0;
            vary(&mut cell, variant, &mut rng);
            // The field of a redundant arm takes seconds in a test.
            let pair = if name == "panda_cell.toml" { RankedPair::new } else { RankedPair::with_fields };
            let Ok(mut pair) = pair(&cell) else { panic!("{name} {variant}") };
            for _ in 0..layouts.div_ceil(2) {
                counts = sum(counts, pair.compare(&near_start(&cell, &mut rng)));
            }
        }
    }
    assert!(counts.iter().all(|c| *c > 50), "{counts:?}");
}

/// Changes a setting on which the bounds depend.
fn vary(cell: &mut Cell, variant: usize, rng: &mut ChaCha8Rng) {
    cell.collision = variant != 1;
    let quantities = [Quantity::P95, Quantity::Rms, Quantity::Mean, Quantity::P99];
    cell.quantity = quantities[variant % 4];
    let axes = cell.robot.joints.len();
    if variant >= 2
        && let ErrorSet::Signed(_) = &cell.robot.errors[cell.errors]
    {
        let values: Vec<f64> = Parameter::of_robot(axes)
            .map(|p| {
                if matches!(p, Parameter::Joint(..)) || p.is_elastic() {
                    0.0
                } else {
                    rng.random_range(-2e-4..2e-4)
                }
            })
            .collect();
        cell.robot.errors[cell.errors] =
            ErrorSet::Signed(SignedErrors::of_values("drawn".into(), axes, &values));
    }
    for operation in &mut cell.operations {
        if variant >= 3 {
            operation.sense = weighted(rng);
        }
        if variant == 4 {
            operation.attitude.spin = Spin::Free;
            // The TCP of a six-axis arm is beside the tool axis, so all joints change the spin.
            cell.robot.tool.translation.x += if axes == 6 { 0.04 } else { 0.0 };
        }
        if variant == 5 {
            operation.attitude.tolerance = 0.05;
            operation.sense = Sense::plain("xyz").unwrap();
        }
    }
}

/// Elastic errors depend on the posture, so spin families may have no bound. Each error set has elastic
/// errors in another form.
#[test]
fn bounds_do_not_change_the_layouts_of_elastic_cells() {
    let mut rng = ChaCha8Rng::seed_from_u64(18);
    let mut counts = [0; 3];
    let cells = [
        ("ur_cell.toml", 24),
        ("five_axis_cell.toml", 30),
        ("wrist_cell.toml", 12),
        ("hitachi_cell.toml", 30),
    ];
    for (name, layouts) in cells {
        for form in 0..4 {
            let mut cell = shipped(name);
            cell.search.ideal = true;
            cell.robot.errors = vec![elastic_set(&cell.robot, form, &mut rng)];
            (cell.errors, cell.quantity) = (0, Quantity::P95);
            cell.reading = if form < 2 { Reading::Signed } else { Reading::Statistical };
            let pair = if form % 3 == 0 { RankedPair::with_fields } else { RankedPair::new };
            let Ok(mut pair) = pair(&cell) else { panic!("{name} {form}") };
            for _ in 0..layouts / 2 {
                counts = sum(counts, pair.compare(&near_start(&cell, &mut rng)));
            }
        }
    }
    assert!(counts.iter().all(|c| *c > 20), "{counts:?}");
}

/// Returns an error set with errors of rows and elastic errors. The set is a signed sample in forms 0 and 1,
/// tolerances in form 2, and measured errors in form 3.
///
/// In forms 0 and 2, no elastic term depends on the spin of the last joint.
fn elastic_set(robot: &Robot, form: usize, rng: &mut ChaCha8Rng) -> ErrorSet {
    let axes = robot.axes();
    let value = |p: Parameter| match p {
        Parameter::Dl(_) | Parameter::Dr(_) => rng.random_range(-3e-4..3e-4),
        Parameter::Dq(_) | Parameter::Dalpha(_) => rng.random_range(-2e-4..2e-4),
        Parameter::Elastic(joint, _) if robot.joints[joint].kind == JointKind::Prismatic => 0.0,
        Parameter::Elastic(_, link) if form.is_multiple_of(2) && link + 1 == axes => 0.0,
        Parameter::Elastic(..) => rng.random_range(-3e-3..3e-3),
        _ => 0.0,
    };
    let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
    let sample = SignedErrors::of_values("elastic".into(), axes, &values);
    let spread = ErrorSet::Signed(sample.clone()).tolerance();
    match form {
        0 | 1 => ErrorSet::Signed(sample),
        2 => ErrorSet::Tolerance(spread),
        _ => ErrorSet::Measured(Box::new(MeasuredErrors { mean: sample, spread, ranges: None })),
    }
}

/// Errors of the joint frames and of the tool. If the tool errors are isotropic about the tool axis, all
/// spins of a family have one value. In form 2 they are not, and in form 3 a joint frame is not isotropic
/// either.
#[test]
fn isotropic_tool_errors_do_not_change_the_layouts() {
    let mut rng = ChaCha8Rng::seed_from_u64(27);
    let mut counts = [0; 3];
    for (name, layouts) in [("ur_cell.toml", 20), ("wrist_cell.toml", 8), ("scara_cell.toml", 20)] {
        for form in 0..4 {
            let mut cell = shipped(name);
            cell.search.ideal = form != 1;
            let axes = cell.robot.axes();
            let mut size = || rng.random_range(0.5e-4..3e-4);
            let [slide, along, turn, twist] = [size(), size(), size(), size()];
            let value = |p: Parameter| match p {
                Parameter::Joint(joint, component) if component < 3 && (form, joint) == (3, 1) => {
                    slide * (1.0 + component as f64)
                }
                Parameter::Joint(_, component) if component < 3 => slide,
                Parameter::Joint(_, 5) => twist,
                Parameter::Joint(..) => turn,
                Parameter::Tool(2) if form == 1 => along,
                Parameter::Tool(component) if form >= 2 => along * (1.0 + component as f64),
                Parameter::Tool(_) => slide,
                _ => 0.0,
            };
            let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
            let sample = SignedErrors::of_values("frames".into(), axes, &values);
            cell.robot.errors = vec![ErrorSet::Tolerance(ErrorSet::Signed(sample).tolerance())];
            (cell.errors, cell.reading) = (0, Reading::Statistical);
            cell.quantity = [Quantity::P95, Quantity::Rms, Quantity::P99, Quantity::Mean][form];
            cell.model = [Model::Nonlinear, Model::Linear][form % 2];
            for (k, operation) in cell.operations.iter_mut().enumerate() {
                operation.sense = Sense::plain(["xyz", "xy"][k % 2]).unwrap();
                if (form + k).is_multiple_of(2) {
                    operation.over = NodeAggregation::Max;
                }
            }
            let Ok(mut pair) = RankedPair::with_fields(&cell) else { panic!("{name} {form}") };
            check_values(&pair.ranked, form);
            for _ in 0..layouts / 2 {
                counts = sum(counts, pair.compare(&near_start(&cell, &mut rng)));
            }
        }
    }
    assert!(counts.iter().all(|c| *c > 10), "{counts:?}");
}

/// The value at a posture is the figure that a map reports for the same posture, with the spin of this
/// posture.
fn check_values(workcell: &Workcell, form: usize) {
    for operation in 0..workcell.cell.operations.len() {
        let (evaluator, chain) = (workcell.evaluator(operation), workcell.inverse().chain());
        let mut memory = evaluator.memory();
        let (work, world) = (Pose::identity(), nalgebra::Matrix3::identity());
        let site = WorkFrame { equipment: operation, work, world, taught: None };
        let context = WorkContext { site, reference: None };
        for sample in 0..5 {
            let frames = chain.frames(&chain.posture(&chain.halton_sample(sample)));
            let value = evaluator.value(&context, &frames, &mut memory);
            let figures = &evaluator.judge(&context, &frames, &mut memory).figures[evaluator.own()];
            let figure = [figures.p95, figures.rms, figures.p99, figures.mean][form];
            assert!((value - figure).abs() < 1e-9 * figure, "form {form}: {value} {figure}");
        }
    }
}

/// A worst case has bounds at every posture. An operation at every node needs the best posture of each node.
#[test]
fn bounds_do_not_change_worst_cases_and_operations_at_every_node() {
    let mut rng = ChaCha8Rng::seed_from_u64(26);
    let mut counts = [0; 3];
    let cells = [
        ("ur_cell.toml", cases(1, 2)),
        ("scara_cell.toml", cases(2, 3)),
        ("five_axis_cell.toml", cases(1, 3)),
        ("wrist_cell.toml", 1),
        ("hitachi_cell.toml", 12),
    ];
    for (name, layouts) in cells {
        for form in 0..8 {
            let mut cell = shipped(name);
            cell.search.ideal = form != 3;
            let axes = cell.robot.axes();
            let size = if form == 4 { 2e-2 } else { 3e-4 };
            let value = |p: Parameter| if p.is_elastic() { 0.0 } else { rng.random_range(0.0..size) };
            let values: Vec<f64> = Parameter::of_robot(axes).map(value).collect();
            let sample = SignedErrors::of_values("drawn".into(), axes, &values);
            let spread = ErrorSet::Signed(sample.clone()).tolerance();
            cell.robot.errors = vec![match form {
                5 => ErrorSet::Measured(Box::new(MeasuredErrors { mean: sample, spread, ranges: None })),
                6 => ErrorSet::Signed(sample),
                _ => ErrorSet::Tolerance(spread),
            }];
            (cell.errors, cell.model) = (0, [Model::Nonlinear, Model::Linear, Model::SecondOrder][form % 3]);
            cell.reading = match form {
                6 => Reading::Signed,
                7 => Reading::Statistical,
                _ => Reading::WorstCase,
            };
            for (k, operation) in cell.operations.iter_mut().enumerate() {
                operation.sense = Sense::plain(["xyz", "xy", "z"][rng.random_range(0..3)]).unwrap();
                if form == 2 {
                    operation.sense = weighted(&mut rng);
                }
                if form % 4 != k % 2 {
                    operation.over = NodeAggregation::Max;
                }
                if let Place::Grid { divisions, .. } = &mut operation.place {
                    *divisions = (divisions.0.min(2), divisions.1.min(2));
                }
            }
            let pair = if form % 4 == 0 { RankedPair::with_fields } else { RankedPair::new };
            let Ok(mut pair) = pair(&cell) else { panic!("{name} {form}") };
            for _ in 0..layouts {
                counts = sum(counts, pair.compare(&near_start(&cell, &mut rng)));
            }
        }
    }
    assert!(counts.iter().all(|c| *c > 20), "{counts:?}");
}
