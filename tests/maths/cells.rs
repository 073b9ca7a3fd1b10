//! Tests valid cell files: the cell contains in SI units the values that the file states in mm and degrees.
#![allow(clippy::needless_range_loop, clippy::excessive_precision)]

use crate::common::{from_text, root, shipped, signed};
use nalgebra::{DMatrix, Vector3};
use std::f64::consts::PI;
use sweetspot::cell::*;

const DEG: f64 = PI / 180.0;

fn every_key() -> Cell {
    let text = std::fs::read_to_string(root().join("tests/data/every_key.toml")).unwrap();
    let loaded = from_text(&text).unwrap_or_else(|f| panic!("{f:#?}"));
    assert!(loaded.warnings.is_empty(), "{:#?}", loaded.warnings);
    loaded.cell
}

/// Loads the cell of the paper's robot with additional lines.
fn with(lines: &str) -> Cell {
    from_text(&format!("from = \"hitachi_cell.toml\"\n{lines}")).unwrap_or_else(|f| panic!("{f:#?}")).cell
}

fn set<'c>(cell: &'c Cell, name: &str) -> &'c ErrorSet {
    cell.robot.errors.iter().find(|e| e.name() == name).unwrap()
}

fn place(wanted: Parameter, axes: usize) -> usize {
    Parameter::of_robot(axes).position(|p| p == wanted).unwrap()
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-14 * a.abs().max(b.abs())
}

fn all_close(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| close(*a, *b))
}

#[test]
fn a_cell_without_optional_keys_has_the_defaults() {
    let cell = shipped("hitachi_cell.toml");
    let asked = (cell.reading, cell.quantity, cell.registration, cell.guard);
    assert_eq!(asked, (Reading::Signed, Quantity::P95, Registration::None, 0.01));
    assert!(cell.senses.is_empty() && cell.equipment.iter().all(|e| e.errors.is_none()));
    let plain = |o: &Operation| (o.limit, o.relative_to, o.teach) == (None, None, None);
    assert!(cell.operations.iter().all(plain));
    let errors = signed(&cell);
    assert_eq!(errors.dbeta, [0.0; 4]);
    assert_eq!((errors.base, errors.tool), ([0.0; 6], [0.0; 6]));
    assert_eq!(cell.interpretation_faults(), []);
}

#[test]
fn a_tolerance_set_is_read_as_worst_case_by_default() {
    assert_eq!(with("errors = \"table-3\"").reading, Reading::Signed);
    assert_eq!(with("errors = \"table-3-tolerance\"").reading, Reading::WorstCase);
    let table = "[equipment.worktable.errors]\nkind = \"tolerance\"\nposition_mm = [1, 1, 1]";
    assert_eq!(with(table).reading, Reading::WorstCase);
    // A taught frame moves with its equipment, so the tolerance of the equipment does not count.
    assert_eq!(with(&format!("registration = \"taught\"\n{table}")).reading, Reading::Signed);
}

#[test]
fn a_signed_error_set_is_read_in_si_units() {
    let cell = every_key();
    let ErrorSet::Signed(sample) = set(&cell, "sample") else { panic!("a tolerance") };
    assert!(all_close(&sample.dq, &[0.1 * DEG, 0.0, -0.1 * DEG, 0.0]));
    assert_eq!(sample.dr, [0.001, -0.002, 0.003, -0.004]);
    assert_eq!(sample.dl, [0.005, 0.006, 0.007, 0.008]);
    assert!(all_close(&sample.dalpha, &[0.1, 0.2, 0.3, 0.4].map(|v| v * DEG)));
    assert!(all_close(&sample.dbeta, &[0.0, -0.5 * DEG, 0.0, 0.0]));
    assert!(all_close(&sample.base, &[0.001, 0.002, 0.003, 0.1 * DEG, 0.2 * DEG, 0.3 * DEG]));
    assert!(all_close(&sample.tool, &[0.0, 0.0, 0.0, 0.0, 0.0, -0.4 * DEG]));
    assert!(all_close(&sample.joints[1], &[0.001, 0.002, 0.003, 0.1 * DEG, 0.2 * DEG, 0.3 * DEG]));
    assert!(all_close(&sample.joints[3], &[0.0, 0.0, 0.0, 0.0, 0.0, -0.5 * DEG]));
    assert_eq!([sample.joints[0], sample.joints[2]], [[0.0; 6]; 2]);
    let elastic = |parameter| sample.values()[place(parameter, 4)];
    assert!(
        close(elastic(Parameter::Elastic(1, 2)), -0.05 * DEG)
            && close(elastic(Parameter::Elastic(1, 1)), 0.1 * DEG)
    );
    assert!(
        close(elastic(Parameter::Compliance(2)), 0.002 * DEG) && elastic(Parameter::Elastic(2, 2)) == 0.0
    );
    // Writing and reading the list of values keeps the order of the parameters.
    assert_eq!(sample.values()[place(Parameter::Joint(1, 2), 4)], 0.003);
    assert_eq!(place(Parameter::Joint(1, 2), 4), 5 * 4 + 12 + 6 + 2);
    assert_eq!(SignedErrors::of_values("sample".into(), 4, &sample.values()), *sample);
}

#[test]
fn measured_errors_have_values_and_a_covariance() {
    let cell = every_key();
    let ErrorSet::Measured(measured) = set(&cell, "measured") else { panic!("not measured") };
    let (values, spreads) = (measured.mean.values(), &measured.spread.spreads);
    let [dl2, term, compliance] =
        [Parameter::Dl(1), Parameter::Elastic(1, 2), Parameter::Compliance(1)].map(|p| place(p, 4));
    assert_eq!([values[dl2], values[compliance]], [0.006, 0.0]);
    assert!(close(values[term], -0.05 * DEG));
    let share = |joint| values[place(Parameter::Periodic(joint), 4)];
    assert_eq!([share(0), share(1), share(2)], [1.0, 1.0, 0.0]);
    let waves = &measured.mean.periodic;
    assert!(waves.len() == 2 && waves[1].joint == 1 && all_close(&waves[0].cos, &[0.004 * DEG, 0.0]));
    assert!(all_close(&waves[0].sin, &[0.0, -0.01 * DEG]));
    let half = [0.5e-3, 0.02 * DEG, 0.001 * DEG].map(|deviation| 2.0 * deviation);
    assert!(all_close(&[dl2, term, compliance].map(|k| spreads[k].plus_minus), &half));
    assert_eq!(spreads[place(Parameter::Dr(0), 4)].plus_minus, 0.0);
    let matrix = &measured.spread.covariance.as_ref().unwrap().matrix;
    assert!(close(matrix[(0, 1)] * 1e6, -0.001 * DEG * 1e3));
}

#[test]
fn masses_of_links_tool_and_held_part_are_read_in_si_units() {
    let cell = every_key();
    let [link, tool] = &cell.robot.masses[..] else { panic!("{:?}", cell.robot.masses) };
    assert_eq!((link.link, link.mass, link.centre.as_slice()), (2, 12.5, &[-0.2, 0.0, 0.01][..]));
    assert_eq!((tool.link, tool.mass, tool.centre.as_slice()), (4, 3.0, &[0.0, 0.0, 0.05][..]));
}

#[test]
fn an_error_set_may_hold_joint_frames_only() {
    use Distribution::{Normal, Triangular, Uniform};
    let cell = every_key();
    let ErrorSet::Tolerance(set) = set(&cell, "joints-alone") else { panic!("a sample") };
    let at = |p| set.spreads[place(p, 4)];
    let components = |joint| [0, 1, 2, 3, 4, 5].map(|c| at(Parameter::Joint(joint, c)));
    assert_eq!(components(0).map(|s| s.plus_minus), [0.001, 0.001, 0.001, 0.0, 0.0, 0.0]);
    assert!(close(at(Parameter::Joint(2, 4)).plus_minus, 0.1 * DEG));
    let words = [Normal, Uniform, Normal, Normal, Triangular, Normal];
    assert_eq!([0, 1, 2, 3].map(|k| components(k).map(|s| s.distribution)), [words; 4]);
    assert_eq!(
        [Parameter::Dr(0), Parameter::Dl(1), Parameter::Dalpha(2)].map(|p| at(p).plus_minus),
        [0.0; 3]
    );
    let covariance = set.covariance.as_ref().unwrap();
    assert_eq!(covariance.parameters, [Parameter::Joint(2, 3), Parameter::Joint(1, 2)].map(|p| place(p, 4)));
    assert!(close(covariance.matrix[(0, 1)], 0.06 * DEG * 1e-3));
    assert!(close(at(Parameter::Joint(1, 2)).plus_minus, 1.5e-3));
}

#[test]
fn one_distribution_can_hold_for_all_rows() {
    let cell = every_key();
    let ErrorSet::Tolerance(bounds) = set(&cell, "bounds") else { panic!("a sample") };
    assert_eq!(bounds.spreads.len(), Parameter::count(4));
    let one = |s: &Spread| (s.distribution, s.sigmas) == (Distribution::Triangular, 3.0);
    assert!(bounds.spreads.iter().all(one) && bounds.covariance.is_none());
    let at = |p| bounds.spreads[place(p, 4)].plus_minus;
    assert_eq!([at(Parameter::Dr(1)), at(Parameter::Dl(3)), at(Parameter::Tool(2))], [0.002, 0.008, 0.009]);
    assert!(close(at(Parameter::Dalpha(2)), 0.3 * DEG));
    assert_eq!([at(Parameter::Dq(0)), at(Parameter::Dbeta(0)), at(Parameter::Base(0))], [0.0; 3]);
}

#[test]
fn each_row_can_have_its_own_distribution() {
    use Distribution::{Normal, Triangular, Uniform};
    let cell = every_key();
    let ErrorSet::Tolerance(set) = cell.error_set() else { panic!("a sample") };
    let of = |p| set.spreads[place(p, 4)].distribution;
    assert_eq!([0, 1, 2, 3].map(|i| of(Parameter::Dl(i))), [Normal, Normal, Uniform, Triangular]);
    assert_eq!([0, 1, 2, 3].map(|i| of(Parameter::Dr(i))), [Normal; 4]);
    // A covariance is normal, whatever its rows say.
    assert_eq!([0, 1, 2, 3].map(|i| of(Parameter::Dalpha(i))), [Uniform, Uniform, Normal, Uniform]);
    assert_eq!([0, 1].map(|c| of(Parameter::Base(c))), [Normal, Triangular]);
    assert_eq!([0, 5].map(|c| of(Parameter::Tool(c))), [Uniform; 2]);
    assert!(set.spreads.iter().all(|s| s.sigmas == 2.0));
}

#[test]
fn a_covariance_is_converted_from_the_units_of_the_file() {
    let cell = every_key();
    let ErrorSet::Tolerance(set) = cell.error_set() else { panic!("a sample") };
    let covariance = set.covariance.as_ref().unwrap();
    let parameters = [Parameter::Dalpha(2), Parameter::Dl(1), Parameter::Base(0)].map(|p| place(p, 4));
    assert_eq!(covariance.parameters, parameters);
    let (mm, deg) = (1e-3, DEG);
    let wanted = [
        [0.04 * deg * deg, -0.06 * mm * deg, 0.0],
        [-0.06 * mm * deg, 0.25 * mm * mm, 0.1 * mm * mm],
        [0.0, 0.1 * mm * mm, 4.0 * mm * mm],
    ];
    for i in 0..3 {
        for j in 0..3 {
            assert!(close(covariance.matrix[(i, j)], wanted[i][j]), "{i} {j}: {}", covariance.matrix[(i, j)]);
        }
    }
    assert_eq!(covariance.matrix, covariance.matrix.transpose());
    // The values are two standard deviations.
    let plus_minus = parameters.map(|k| set.spreads[k].plus_minus);
    assert!(all_close(&plus_minus, &[0.4 * deg, 1.0 * mm, 4.0 * mm]), "{plus_minus:?}");
    let deviation = set.spreads[parameters[1]].deviation();
    assert!(close(deviation * deviation, covariance.matrix[(1, 1)]));
}

#[test]
fn a_singular_covariance_is_accepted() {
    let set = "[robot.errors.x]\nkind = \"tolerance\"\nsource = \"\"\ndr_mm = [0, 0, 0, 0]\ndl_mm = [0, 0, 0, 0]\n\
        dalpha_deg = [0, 0, 0, 0]\n";
    let ones = "covariance = { parameters = [\"dl1\", \"dq1\", \"dl3\"], matrix = [[1, 1, 0], [1, 1, 0], [0, 0, 0]] }";
    let cell = with(&format!("errors = \"x\"\n{set}{ones}"));
    let ErrorSet::Tolerance(set) = cell.error_set() else { panic!("a sample") };
    let wanted = DMatrix::from_fn(3, 3, |i, j| match (i, j) {
        (0, 0) => 1e-6,
        (1, 1) => DEG * DEG,
        (0, 1) | (1, 0) => 1e-3 * DEG,
        _ => 0.0,
    });
    let matrix = &set.covariance.as_ref().unwrap().matrix;
    assert!((matrix - &wanted).abs().max() < 1e-18, "{matrix}");
    assert_eq!(set.spreads[place(Parameter::Dl(2), 4)].plus_minus, 0.0);
}

#[test]
fn a_prismatic_joint_has_its_errors_in_mm() {
    let robot = r#"schema = "sweetspot/cell/1"
units = { length = "mm", angle = "deg" }
errors = "slides"
[robot]
name = "gantry"
source = "made up"
footprint = { size_mm = [100, 100] }
tool = { position_mm = [0, 0, 0], axis = [1, 0, 0] }
[[robot.joint]]
name = "slide"
kind = "prismatic"
theta_deg = 0
r_mm = 500
l_mm = 500
alpha_deg = 0
limits_mm = [0, 500]
[robot.errors.slides]
kind = "tolerance"
source = "made up"
dr_mm = [0]
dl_mm = [0]
dalpha_deg = [0]
dbeta_deg = [0]
covariance = { parameters = ["dq1"], matrix = [[4]] }
[equipment.table]
surface = { size_mm = [500, 500] }
placement = { x_mm = 0, y_mm = 1000, z_mm = 0 }
[operation.work]
on = "table"
grid = [1, 1]
bend_deg = 0
sense = "rotation@tool"
limit_deg = 0.5
"#;
    let cell = from_text(robot).unwrap_or_else(|f| panic!("{f:#?}")).cell;
    let ErrorSet::Tolerance(set) = cell.error_set() else { panic!("a sample") };
    assert!(close(set.covariance.as_ref().unwrap().matrix[(0, 0)], 4e-6));
    assert!(close(set.spreads[0].plus_minus, 6e-3));
    let work = &cell.operations[0];
    assert_eq!(
        (work.sense.name.as_str(), work.sense.frame, work.sense.unit),
        ("rotation@tool", Frame::Tool, Unit::Angle)
    );
    assert!(close(work.limit.unwrap(), 0.5 * DEG));
    assert_eq!(cell.unit(), Unit::Angle);
}

#[test]
fn equipment_errors_are_read_in_si_units() {
    let cell = every_key();
    let errors = |name: &str| cell.equipment.iter().find(|e| e.name == name).unwrap().errors;
    assert_eq!(errors("conveyor"), Some(FrameErrors::Signed([-0.001, 0.0, 0.0, 0.0, 0.0, 0.0])));
    let Some(FrameErrors::Tolerance(spreads)) = errors("worktable") else { panic!("a sample") };
    assert!(all_close(&spreads.map(|s| s.plus_minus), &[0.001, 0.002, 0.003, 0.1 * DEG, 0.0, 0.0]));
    use Distribution::{Normal, Triangular, Uniform};
    let wanted = [Uniform, Normal, Normal, Triangular, Normal, Normal];
    assert_eq!(spreads.map(|s| s.distribution), wanted);
    assert_eq!(spreads.map(|s| s.sigmas), [4.0; 6]);
}

#[test]
fn the_plane_of_a_sense_is_orthonormal() {
    let cell = every_key();
    let slot = cell.sense("slot").unwrap();
    assert_eq!((slot.frame, slot.unit), (Frame::Tool, Unit::Length));
    assert_eq!(slot.point, Vector3::new(0.0, 0.05, 0.1));
    let [a, b] = slot.rows() else { panic!("{:?}", slot.rows()) };
    assert!(!a.turns && !b.turns);
    // The weight is 2.
    assert!((a.direction.norm() - 2.0).abs() < 1e-15 && (b.direction.norm() - 2.0).abs() < 1e-15);
    assert!(a.direction.dot(&b.direction).abs() < 1e-15);
    let normal = a.direction.cross(&b.direction) / 4.0;
    assert!((normal - Vector3::new(1.0, 1.0, 1.0).normalize()).norm() < 1e-15);
    let rows = |lines: &str| with(&format!("[sense.s]\n{lines}")).senses[0].rows().to_vec();
    assert_eq!(rows("plane = [0, 0, 7]"), Sense::plain("xy").unwrap().rows());
    // The size of an error in the plane does not depend on the vectors that span it.
    for normal in ["[1, 0, 0]", "[0, 1, 0]", "[-1, 2, 0.5]", "[1e-9, 0, -3]"] {
        let rows = rows(&format!("plane = {normal}"));
        let dots =
            [(0, 0), (1, 1), (0, 1)].map(|(i, j): (usize, usize)| rows[i].direction.dot(&rows[j].direction));
        assert!((dots[0] - 1.0).abs() < 1e-15 && (dots[1] - 1.0).abs() < 1e-15 && dots[2].abs() < 1e-15);
    }
}

#[test]
fn a_lever_turns_rotations_into_lengths() {
    let cell = every_key();
    let screw = cell.sense("screw").unwrap();
    assert_eq!((screw.frame, screw.unit), (Frame::Surface, Unit::Angle));
    assert_eq!(screw.rows(), [Row { turns: true, direction: Vector3::z() }]);
    let lid = cell.sense("lid").unwrap();
    assert_eq!((lid.frame, lid.unit, lid.rows().len()), (Frame::World, Unit::Length, 6));
    assert_eq!(lid.rows()[..2], *Sense::plain("xy").unwrap().rows());
    assert!((lid.rows()[2].direction - Vector3::new(0.0, 0.3, 0.4)).norm() < 1e-15);
    for (k, axis) in [Vector3::x(), Vector3::y(), Vector3::z()].into_iter().enumerate() {
        let row = lid.rows()[3 + k];
        // One degree counts as 2 mm.
        assert!(row.turns && (row.direction * DEG - axis * 0.002).norm() < 1e-17, "{row:?}");
    }
    // A sense of rotations that all have a weight in mm per degree is a length.
    let cell = with("[sense.s]\naxis = [1, 0, 0]\nmm_per_deg = 3");
    assert_eq!(cell.senses[0].unit, Unit::Length);
    let cell = with("[sense.s]\nterm = [{ of = \"rx\" }, { of = \"ry\", weight = 2 }]");
    assert_eq!(cell.senses[0].unit, Unit::Angle);
    assert_eq!(cell.senses[0].rows()[1].direction, Vector3::new(0.0, 2.0, 0.0));
}

#[test]
fn a_plain_sense_is_found_by_its_word() {
    let cell = every_key();
    assert_eq!(cell.senses.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["slot", "screw", "lid"]);
    for word in PLAIN.iter().flat_map(|p| ["", "@world", "@surface", "@tool"].map(|f| format!("{p}{f}"))) {
        assert_eq!(cell.sense(&word).unwrap().name, word.trim_end_matches("@world"));
    }
    for word in ["", "w", "xy@", "@tool", "slot@tool", "slo"] {
        assert!(cell.sense(word).is_none(), "{word}");
    }
}

#[test]
fn limits_relative_operations_and_taught_points_are_read() {
    let cell = every_key();
    let [assembly, picking, glueing, ..] = &cell.operations[..] else { panic!("{:?}", cell.operations) };
    assert_eq!((assembly.sense.name.as_str(), assembly.limit), ("slot", Some(0.0005)));
    assert_eq!((picking.sense.name.as_str(), picking.limit), ("xy@surface", Some(0.002)));
    assert_eq!((glueing.limit, glueing.relative_to), (None, Some(0)));
    assert_eq!(glueing.teach, Some([(-0.7, -0.3), (0.75, -0.35), (-0.7, 0.3)]));
    let asked = (cell.reading, cell.quantity, cell.registration, cell.guard);
    assert_eq!(asked, (Reading::Statistical, Quantity::P99, Registration::Taught, 0.025));
}

#[test]
fn free_coordinates_places_and_stopping_rules_are_read() {
    let cell = every_key();
    let [.., welding, dotting] = &cell.operations[..] else { panic!("{:?}", cell.operations) };
    let area = Rectangle { centre: (0.1, 0.05), size: (0.2, 0.1) };
    assert_eq!(
        (&welding.place, welding.over),
        (&Place::Grid { area, divisions: (4, 4) }, NodeAggregation::P95)
    );
    assert_eq!(dotting.place, Place::Points(vec![(-0.04, 0.0), (0.04, 0.0)]));
    assert_eq!(dotting.over, NodeAggregation::Mean);
    let shelf = cell.equipment.iter().position(|e| e.name == "shelf").unwrap();
    assert_eq!(cell.equipment[shelf].on.map(|k| cell.equipment[k].name.as_str()), Some("worktable"));
    let free: Vec<_> = cell.free().into_iter().map(|(slot, _)| slot).collect();
    let own = [Slot::Base(0), Slot::Base(2), Slot::Equipment(shelf, 0), Slot::Equipment(shelf, 3)];
    let angles = [Slot::Attitude(3, 0), Slot::Attitude(3, 1), Slot::Attitude(3, 2), Slot::Attitude(4, 0)];
    assert!(own.iter().chain(&angles).all(|slot| free.contains(slot)), "{free:?}");
    let SearchSettings { objective, indifference, gap, stagnation, robust, .. } = cell.search;
    assert_eq!((objective, indifference), (Objective::Lexicographic, 0.005));
    assert_eq!((gap, stagnation, robust), (Some(0.01), Some(5000), true));
}

#[test]
fn changes_from_the_command_line_are_validated_again() {
    let mut cell = every_key();
    assert_eq!(cell.interpretation_faults(), []);
    let about = |cell: &Cell| cell.interpretation_faults().iter().map(|f| f.about).collect::<Vec<_>>();
    cell.quantity = Quantity::Yield;
    assert_eq!(about(&cell), [2, 3, 4].map(About::Operation));
    cell.reading = Reading::Signed;
    assert_eq!(about(&cell), [About::Reading]);
    // Without the taught frame the tolerance of the table counts.
    cell.registration = Registration::None;
    assert_eq!(about(&cell), [About::Reading, About::Reading]);
    cell.reading = Reading::WorstCase;
    cell.operations[1].sense = cell.sense("screw").unwrap();
    assert_eq!(about(&cell), [About::Sense(1)]);
    cell.reading = Reading::Statistical;
    assert_eq!(about(&cell), [2, 3, 4].map(About::Operation));
    cell.operations[2..].iter_mut().for_each(|o| o.limit = Some(0.001));
    assert_eq!(cell.interpretation_faults(), []);
}

#[test]
fn senses_of_two_units_are_allowed_where_none_is_added() {
    let more = "reading = \"statistical\"\nquantity = \"yield\"\n[operation.assembly]\nlimit_mm = 1\n\
        [operation.picking]\nsense = \"rotation\"\nlimit_deg = 1\n";
    assert_eq!(with(more).unit(), Unit::Share);
}

#[test]
fn table_3_of_the_paper_is_read_as_a_tolerance_set() {
    let cell = shipped("hitachi_cell.toml");
    let (ErrorSet::Signed(sample), ErrorSet::Tolerance(tolerance)) =
        (set(&cell, "table-3"), set(&cell, "table-3-tolerance"))
    else {
        panic!("{:?}", cell.robot.errors)
    };
    let magnitudes: Vec<_> = sample.values().into_iter().map(Spread::of_magnitude).collect();
    assert_eq!(tolerance.spreads, magnitudes);
}

/// The robot files state the published values (m and rad) in mm and degrees. Huge offsets that cancel are not
/// a fault.
#[test]
fn the_calibrated_arms_have_signed_error_sets() {
    for (file, first_theta, second_d, reach) in [
        ("ur10", -7.290070070824746e-05, 1.4442162376284788, 1.5560),
        ("ur10e", 1.59613525316931737e-07, 303.469135666158195, 1.5953),
    ] {
        let text = format!(
            "schema = \"sweetspot/cell/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nerrors = \"factory\"\n\
            [robot]\nfrom = \"robots/{file}.toml\"\n[equipment.table]\nsurface = {{ size_mm = [500, 500] }}\n\
            placement = {{ x_mm = 700, y_mm = 0, z_mm = 0 }}\n[operation.work]\non = \"table\"\ngrid = [2, 2]\n\
            bend_deg = -90\nsense = \"xyz\"\n"
        );
        let loaded = from_text(&text).unwrap_or_else(|f| panic!("{f:#?}"));
        assert!(loaded.warnings.is_empty(), "{:#?}", loaded.warnings);
        let cell = loaded.cell;
        let errors = signed(&cell);
        assert!(close(errors.dq[0], first_theta) && close(errors.dr[1], second_d), "{errors:?}");
        assert_eq!(
            cell.robot.joints.iter().map(|j| j.limits).collect::<Vec<_>>(),
            [(-2.0 * PI, 2.0 * PI); 6]
        );
        let alpha: Vec<f64> = cell.robot.joints.iter().map(|j| j.alpha).collect();
        assert_eq!(alpha, [PI / 2.0, 0.0, 0.0, PI / 2.0, -PI / 2.0, 0.0]);
        assert!((cell.robot.reach() - reach).abs() < 1e-3, "{}", cell.robot.reach());
        assert!(matches!(set(&cell, "placeholder"), ErrorSet::Tolerance(_)));
    }
}

#[test]
fn motion_constraints_and_the_fence_are_read_in_si_units() {
    let cell = every_key();
    let picking = cell.operations.iter().find(|o| o.name == "picking").unwrap();
    assert_eq!((picking.approach, picking.retract), (0.05, 0.0605));
    assert_eq!((cell.operations[0].approach, cell.operations[0].retract), (0.0, 0.0));
    let deg = std::f64::consts::PI / 180.0;
    let margins = cell.margins;
    assert!((margins.turn - 5.0 * deg).abs() < 1e-15);
    assert_eq!((margins.slide, margins.singularity), (0.01, 0.02));
    let rules = cell.transfer.unwrap();
    assert_eq!((rules.lift, rules.cycle, rules.via.len()), (0.2, true, 2));
    assert!((rules.via[1][3] - 20.5 * deg).abs() < 1e-15);
    let fence = cell.fence.unwrap();
    assert_eq!((fence.corners.len(), fence.corners[2], fence.height), (4, (3.0, 3.5), Some(2.2)));
    // Missing keys constrain nothing. A missing `via` stands for the home posture of the robot, and an empty
    // list for no posture.
    let plain = shipped("hitachi_cell.toml");
    assert_eq!((plain.margins.turn, plain.transfer, plain.fence), (0.0, None, None));
    let base = "from = \"hitachi_cell.toml\"\n[transfer]\n";
    let rules = |more: &str| from_text(&format!("{base}{more}")).unwrap().cell.transfer;
    assert_eq!(rules("").unwrap().via, [plain.robot.home]);
    assert!((rules("via = [0, 0, 0, 45]").unwrap().via[0][3] - 45.0 * deg).abs() < 1e-15);
    assert_eq!(rules("via = []").unwrap().via.len(), 0);
    assert_eq!(rules("check = false"), None);
    // Clockwise corners are reversed.
    let text = "from = \"hitachi_cell.toml\"\n[fence]\npolygon_mm = [[0, 0], [0, 2000], [3000, 0]]\n";
    let turned = from_text(text).unwrap().cell.fence.unwrap();
    assert_eq!(turned.corners, [(3.0, 0.0), (0.0, 2.0), (0.0, 0.0)]);
}

#[test]
fn pareto_goals_keep_their_order() {
    let search = every_key().search;
    assert_eq!(search.pareto.iter().collect::<Vec<_>>(), [Goal::Travel, Goal::Error]);
    assert_eq!(search.keep, 12);
    let plain = shipped("hitachi_cell.toml").search;
    assert!(plain.pareto.is_empty() && plain.keep == 0);
}
