//! Tests the file formats that `calibrate` reads. Each file contains the same simulated measurements of a
//! UR10.

use crate::cli::sandbox::{Sandbox, items, number};
use nalgebra::{Isometry3, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::fmt::Write;

/// Offset r (m), common normal l (m) and twist alpha (rad) of the rows of the UR10.
const ROWS_OF_UR10: [(f64, f64, f64); 6] = [
    (0.1273, 0.0, std::f64::consts::FRAC_PI_2),
    (0.0, -0.612, 0.0),
    (0.0, -0.5723, 0.0),
    (0.163941, 0.0, std::f64::consts::FRAC_PI_2),
    (0.1157, 0.0, -std::f64::consts::FRAC_PI_2),
    (0.0922, 0.0, 0.0),
];

/// Positions of three reflectors in the frame of the flange, m.
const REFLECTORS: [[f64; 3]; 3] = [[0.03, 0.02, 0.11], [-0.09, 0.01, 0.06], [0.02, 0.1, 0.04]];

/// Posture (rad) with the pose of the flange in the frame of the tracker (m).
struct Shot {
    q: [f64; 6],
    flange: Isometry3<f64>,
}

impl Shot {
    /// Returns the position of a reflector in the frame of the tracker, mm.
    fn seen(&self, reflector: usize) -> Vector3<f64> {
        let [x, y, z] = REFLECTORS[reflector];
        (self.flange * nalgebra::Point3::new(x, y, z)).coords * 1e3
    }

    fn degrees(&self) -> [f64; 6] {
        self.q.map(f64::to_degrees)
    }
}

/// Returns the pose of the flange in the base frame, as the product of the rows.
fn flange(q: &[f64; 6]) -> Isometry3<f64> {
    q.iter().zip(ROWS_OF_UR10).fold(Isometry3::identity(), |t, (q, (r, l, alpha))| {
        t * Isometry3::rotation(Vector3::z() * *q)
            * Isometry3::translation(l, 0.0, r)
            * Isometry3::rotation(Vector3::x() * alpha)
    })
}

fn shots(count: usize) -> Vec<Shot> {
    let tracker = Isometry3::from_parts(
        Translation3::new(3.1, -1.2, 0.4),
        UnitQuaternion::from_euler_angles(0.01, -0.02, 2.1),
    );
    let shot = |i: usize| {
        let q = [1.1, 0.7, 0.9, 1.3, 0.4, 0.8].map(|f| 1.5 * (f * (i * i + 1) as f64).sin());
        Shot { q, flange: tracker * flange(&q) }
    };
    (0..count).map(shot).collect()
}

/// Returns a table with a header and, for each posture, a line of the numbers that `row` returns.
fn table(header: &str, separator: &str, row: impl Fn(&Shot) -> Vec<f64>) -> String {
    let mut text = format!("{header}\n");
    for shot in shots(60) {
        let numbers: Vec<_> = row(&shot).iter().map(|v| format!("{v:.7}")).collect();
        writeln!(text, "{}", numbers.join(separator)).unwrap();
    }
    text
}

fn joints_and_position(shot: &Shot) -> Vec<f64> {
    shot.degrees().into_iter().chain(shot.seen(0).iter().copied()).collect()
}

/// Calibrates with a file and checks that the nominal arm explains every position to a micrometre.
///
/// Returns the text that the command prints on stderr.
fn explained(shop: &Sandbox, name: &str, bytes: &[u8], options: &[&str], poses: usize) -> String {
    shop.write_bytes(name, bytes);
    let ran = shop.run(&[&["calibrate", "ur10", name, "--json"][..], options].concat());
    ran.no_panic();
    assert_eq!(ran.code, Some(0), "{name}: {}", ran.err);
    let document: serde_json::Value = serde_json::from_str(&ran.out).unwrap();
    let session = &items(&document["sessions"])[0];
    assert_eq!(number(&session["poses"]) as usize, poses, "{name}: {}", ran.err);
    assert!(number(&session["before"]["max_mm"]) < 1e-3, "{name}: {session}");
    ran.err
}

const PLAIN: &str = "q1,q2,q3,q4,q5,q6,x,y,z";

#[test]
fn separators_and_decimal_signs_are_found() {
    let shop = Sandbox::new();
    let plain = table(PLAIN, ",", joints_and_position);
    explained(&shop, "plain.csv", plain.as_bytes(), &[], 60);
    let shapes = [
        ("semicolon.csv", plain.replace(',', ";").replace('.', ",")),
        ("tab.txt", plain.replace(',', "\t").replace('.', ",")),
        ("bar.csv", plain.replace(',', " | ")),
        ("blanks.txt", plain.replace(',', "   ")),
        ("blanks_and_commas.txt", plain.replace(',', "  ").replace('.', ",")),
        ("comma_and_blank.csv", plain.replace(',', ", ")),
        ("crlf.csv", plain.replace('\n', "\r\n")),
        ("bom.csv", format!("\u{feff}{plain}")),
        ("quotes.csv", plain.lines().map(|l| format!("\"{}\"\n", l.replace(',', "\",\""))).collect()),
        (
            "quoted_commas.csv",
            plain.lines().map(|l| format!("\"{}\"\n", l.replace(',', "\",\"").replace('.', ","))).collect(),
        ),
        (
            "fortran.txt",
            plain
                .replace(',', " ")
                .lines()
                .map(|l| {
                    if l.starts_with('q') {
                        format!("{l}\n")
                    } else {
                        l.split(' ').map(|v| format!(" {v}D+00")).collect::<String>() + "\n"
                    }
                })
                .collect(),
        ),
    ];
    for (name, text) in shapes {
        let said = explained(&shop, name, text.as_bytes(), &[], 60);
        assert!(said.contains("in deg") && said.contains("in mm"), "{said}");
    }
    let wide =
        |bytes: fn(u16) -> [u8; 2], text: &str| -> Vec<u8> { text.encode_utf16().flat_map(bytes).collect() };
    let marked = format!("\u{feff}{plain}");
    explained(&shop, "le.csv", &wide(u16::to_le_bytes, &marked), &[], 60);
    explained(&shop, "be.csv", &wide(u16::to_be_bytes, &marked), &[], 60);
    explained(&shop, "unmarked.csv", &wide(u16::to_le_bytes, &plain), &[], 60);
    // The byte 0xb0 is the degree sign in Windows-1252.
    let old: Vec<u8> =
        plain.replacen("q1", "q1 [#]", 1).bytes().map(|b| if b == b'#' { 0xb0 } else { b }).collect();
    explained(&shop, "old.csv", &old, &[], 60);
}

#[test]
fn comments_units_and_preambles_are_read_past() {
    let shop = Sandbox::new();
    let rows = table("", ";", joints_and_position);
    let named = PLAIN.replace(',', ";");
    let shapes = [
        ("comment.csv", format!("# made by hand\n% and by foot\n{named}{rows}# the end\n")),
        ("units.csv", format!("{named}\ndeg;deg;deg;deg;deg;deg;mm;mm;mm{rows}")),
        ("brackets.csv", format!("{named}\n[deg];[deg];[deg];[deg];[deg];[deg];[mm];[mm];[mm]{rows}")),
        ("commented_names.csv", format!("# {named}{rows}")),
        ("preamble.csv", format!("Report;UR10\nDate;2026-11-25\nOperator;A. N. Other\n\n{named}{rows}")),
        ("again.csv", format!("{named}{rows}{named}\n")),
        ("trailing.csv", format!("{named}{}", rows.replace('\n', ";\n"))),
        ("footer.csv", format!("{named}{rows}end of the table\n")),
    ];
    for (name, text) in shapes {
        explained(&shop, name, text.as_bytes(), &[], 60);
    }
    let said = explained(&shop, "none.csv", rows.trim_start().as_bytes(), &[], 60);
    assert!(said.contains("no names of columns") && said.contains("--column q1=NUMBER"), "{said}");
    // Without names, the user states columns by number.
    let moved = table("", ",", |shot| [shot.seen(0).as_slice(), &shot.degrees()[..]].concat());
    let by_number: Vec<String> = ["x=1", "y=2", "z=3", "q1=4", "q2=5", "q3=6", "q4=7", "q5=8", "q6=9"]
        .iter()
        .flat_map(|c| ["--column".into(), (*c).to_string()])
        .collect();
    let by_number: Vec<&str> = by_number.iter().map(String::as_str).collect();
    explained(&shop, "moved.csv", moved.trim_start().as_bytes(), &by_number, 60);
}

#[test]
fn names_of_many_programs_are_understood() {
    let shop = Sandbox::new();
    for (k, header) in [
        "J1 [deg],J2 [deg],J3 [deg],J4 [deg],J5 [deg],J6 [deg],X (mm),Y (mm),Z (mm)",
        "Axis 1,Axis 2,Axis 3,Axis 4,Axis 5,Axis 6,Measured X,Measured Y,Measured Z",
        "joint_1_deg,joint_2_deg,joint_3_deg,joint_4_deg,joint_5_deg,joint_6_deg,px,py,pz",
        "theta1,theta2,theta3,theta4,theta5,theta6,tcp_x,tcp_y,tcp_z",
        "A1,A2,A3,A4,A5,A6,pos_x,pos_y,pos_z",
        "actual_q_0,actual_q_1,actual_q_2,actual_q_3,actual_q_4,actual_q_5,x_mm,y_mm,z_mm",
        "S,L,U,R,B,T,x,y,z",
        "rob1.j1,rob1.j2,rob1.j3,rob1.j4,rob1.j5,rob1.j6,leica_x,leica_y,leica_z",
    ]
    .into_iter()
    .enumerate()
    {
        explained(
            &shop,
            &format!("names{k}.csv"),
            table(header, ",", joints_and_position).as_bytes(),
            &[],
            60,
        );
    }
    // Commanded values, velocities and deviations are not measured positions.
    let header = "goal_x,goal_y,goal_z,target_q1,q1,q2,q3,q4,q5,q6,vel_x,vel_y,vel_z,std_x,std_y,std_z,measured_x,measured_y,measured_z";
    let text = table(header, ",", |shot| {
        let q = shot.degrees();
        [&[1.0, 2.0, 3.0, 4.0][..], &q, &[9.0, 8.0, 7.0], &[0.01, 0.01, 0.01], shot.seen(0).as_slice()]
            .concat()
    });
    let said = explained(&shop, "goal.csv", text.as_bytes(), &[], 60);
    assert!(said.contains("position measured_x, measured_y, measured_z in mm"), "{said}");
}

#[test]
fn a_unit_in_a_name_that_does_not_fit_is_contradicted() {
    let shop = Sandbox::new();
    let header = "q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,x_m,y_m,z_m";
    let said = explained(&shop, "units.csv", table(header, ",", joints_and_position).as_bytes(), &[], 60);
    assert!(said.contains("states joints in rad, but only deg fits"), "{said}");
    assert!(said.contains("states positions in m, but only mm fits"), "{said}");
}

#[test]
fn reflectors_of_one_row_are_read_and_may_be_missing() {
    let shop = Sandbox::new();
    let headers = [
        format!("{},x1,y1,z1,x2,y2,z2,x3,y3,z3", &PLAIN[..17]),
        format!("{},smr1_x,smr1_y,smr1_z,smr2_x,smr2_y,smr2_z,smr3_x,smr3_y,smr3_z", &PLAIN[..17]),
        format!("{},X1 [mm],Y1 [mm],Z1 [mm],X2 [mm],Y2 [mm],Z2 [mm],X3 [mm],Y3 [mm],Z3 [mm]", &PLAIN[..17]),
    ];
    let all = |shot: &Shot| {
        let seen: Vec<f64> = (0..3).flat_map(|k| shot.seen(k).iter().copied().collect::<Vec<_>>()).collect();
        [&shot.degrees()[..], &seen].concat()
    };
    for (k, header) in headers.iter().enumerate() {
        let text = table(header, ",", all);
        let said = explained(&shop, &format!("wide{k}.csv"), text.as_bytes(), &[], 180);
        assert!(said.contains("reflectors"), "{said}");
        // In row 1, the line of sight to the second reflector is broken. In row 2, all lines of sight are
        // broken.
        let broken = text.lines().enumerate().map(|(k, line)| {
            let mut fields: Vec<_> = line.split(',').collect();
            match k {
                1 => fields[9..12].copy_from_slice(&["", "nan", "-"]),
                2 => fields[6..15].fill(""),
                _ => {}
            }
            fields.join(",") + "\n"
        });
        let broken: String = broken.collect();
        let said = explained(&shop, &format!("broken{k}.csv"), broken.as_bytes(), &[], 176);
        assert!(said.contains("1 rows without a measured position"), "{said}");
    }
}

/// Returns the angles a, b and c of a rotation matrix `Rx(a) Ry(b) Rz(c)`.
fn intrinsic_xyz(r: &Rotation3<f64>) -> [f64; 3] {
    // The inverse is Rz(-c) Ry(-b) Rx(-a), whose angles nalgebra gives.
    let (a, b, c) = r.inverse().euler_angles();
    [-a, -b, -c]
}

#[test]
fn the_convention_of_orientations_is_found() {
    let shop = Sandbox::new();
    let turned = |shot: &Shot| shot.flange.rotation * UnitQuaternion::from_euler_angles(0.3, -0.5, 1.0);
    let matrix = |shot: &Shot| turned(shot).to_rotation_matrix();
    type Numbers<'a> = Box<dyn Fn(&Shot) -> Vec<f64> + 'a>;
    let degrees = |angles: [f64; 3]| angles.map(f64::to_degrees).to_vec();
    let fixed = |shot: &Shot| {
        let (roll, pitch, yaw) = turned(shot).euler_angles();
        [roll, pitch, yaw]
    };
    let quaternion = |shot: &Shot| {
        let q = turned(shot);
        [q.w, q.i, q.j, q.k]
    };
    let cases: [(&str, Numbers<'_>, &str); 8] = [
        ("rx,ry,rz", Box::new(move |s| degrees(intrinsic_xyz(&matrix(s)))), "Rx Ry Rz, about moving axes"),
        ("rx,ry,rz", Box::new(move |s| degrees(fixed(s))), "about fixed axes"),
        (
            "a,b,c",
            Box::new(move |s| {
                let [r, p, y] = fixed(s);
                degrees([y, p, r])
            }),
            "A, B, C",
        ),
        (
            "rx,ry,rz",
            Box::new(move |s| turned(s).scaled_axis().iter().copied().collect()),
            "a rotation vector",
        ),
        ("qw,qx,qy,qz", Box::new(move |s| quaternion(s).to_vec()), "scalar first"),
        ("Q0,Q1,Q2,Q3", Box::new(move |s| quaternion(s).to_vec()), "scalar first"),
        (
            "Q0,Q1,Q2,Q3",
            Box::new(move |s| {
                let [w, i, j, k] = quaternion(s);
                vec![i, j, k, w]
            }),
            "scalar last",
        ),
        (
            "r11,r12,r13,r21,r22,r23,r31,r32,r33",
            Box::new(move |s| matrix(s).matrix().transpose().iter().copied().collect()),
            "a matrix",
        ),
    ];
    for (k, (names, numbers, words)) in cases.iter().enumerate() {
        let header = format!("{},{names}", PLAIN.replace('q', "J"));
        let text = table(&header, ",", |shot| [joints_and_position(shot), numbers(shot)].concat());
        let said = explained(&shop, &format!("rotations{k}.csv"), text.as_bytes(), &[], 60);
        assert!(said.contains(words), "{names}: {said}");
        assert!(
            said.contains("the orientations of the nominal arm differ from the measured ones by 0 deg rms"),
            "{names}: {said}"
        );
    }
    let header = format!("{PLAIN},rx,ry,rz");
    let noise = table(&header, ",", |shot| [joints_and_position(shot), shot.q[..3].to_vec()].concat());
    let said = explained(&shop, "noise.csv", noise.as_bytes(), &[], 60);
    assert!(said.contains("no convention explains the orientations (at best"), "{said}");
}

#[test]
fn joints_come_from_a_second_table() {
    let shop = Sandbox::new();
    let all = shots(60);
    // An export of a tracker has a preamble, uncertainties, a quaternion and a temperature, but no joints.
    let mut points = String::from(
        "Leica AT960 export\nUnits: mm\n\nPoint\tX\tY\tZ\tU95 X\tU95 Y\tU95 Z\tQ0\tQ1\tQ2\tQ3\tTemperature\n",
    );
    for (k, shot) in all.iter().enumerate() {
        let (p, q) = (shot.seen(0), shot.flange.rotation);
        writeln!(
            points,
            "P{k}\t{:.6}\t{:.6}\t{:.6}\t0.02\t0.02\t0.01\t{:.8}\t{:.8}\t{:.8}\t{:.8}\t21.5",
            p.x, p.y, p.z, q.w, q.i, q.j, q.k
        )
        .unwrap();
    }
    // The postures are in reverse order.
    let mut joints = String::from("point,q1,q2,q3,q4,q5,q6\n");
    for (k, shot) in all.iter().enumerate().rev() {
        writeln!(joints, "P{k},{}", shot.degrees().map(|q| q.to_string()).join(",")).unwrap();
    }
    shop.write("joints.csv", &joints);
    let said = explained(&shop, "leica.txt", points.as_bytes(), &["--joints", "joints.csv"], 60);
    for words in
        ["matched by the column `Point`", "scalar first", "uncertainty U95 X, U95 Y, U95 Z (2 standard"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
    // Without a common column, rows are matched by their order.
    let unnamed: String = all.iter().map(|s| s.degrees().map(|q| q.to_string()).join(" ") + "\n").collect();
    shop.write("ordered.txt", &unnamed);
    let said = explained(&shop, "leica.txt", points.as_bytes(), &["--joints", "ordered.txt"], 60);
    assert!(said.contains("matched by their order"), "{said}");
    let half: Vec<_> = unnamed.lines().take(30).collect();
    shop.write("short.txt", &half.join("\n"));
    let refused = shop.run(&["calibrate", "ur10", "leica.txt", "--joints", "short.txt"]);
    assert!(
        refused.code == Some(2) && refused.err.contains("no common column identifies the postures"),
        "{}",
        refused.err
    );
    let alone = shop.run(&["calibrate", "ur10", "leica.txt"]);
    assert!(alone.code == Some(2) && alone.err.contains("--joints FILE"), "{}", alone.err);
}

#[test]
fn suspect_rows_are_left_out_with_words() {
    let shop = Sandbox::new();
    let text = table(PLAIN, ",", joints_and_position);
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    let (joints, position) = {
        let fields = |k: usize| lines[k].split(',').map(String::from).collect::<Vec<_>>();
        (fields(30)[..6].join(","), fields(40)[6..].join(","))
    };
    lines.push(lines[1].clone());
    // These rows repeat the joints of row 30 with another position, and the position of row 40 with another
    // posture.
    lines.insert(31, format!("{joints},1000,2000,300"));
    lines.insert(42, format!("1,2,3,4,5,6,{position}"));
    let said = explained(&shop, "suspect.csv", (lines.join("\n") + "\n").as_bytes(), &[], 60);
    for words in [
        "line 64 repeats an earlier row",
        "line 32 repeats the joint coordinates",
        "line 43 repeats the position",
    ] {
        assert!(said.contains(words), "{words}: {said}");
    }
    let still = table(PLAIN, ",", |shot| {
        let q = [shot.q[0], shot.q[1], 0.7, shot.q[3], shot.q[4], shot.q[5]];
        let at = flange(&q) * nalgebra::Point3::new(0.03, 0.02, 0.11);
        [q.map(f64::to_degrees).to_vec(), at.coords.iter().map(|v| v * 1e3).collect()].concat()
    });
    let said = explained(&shop, "still.csv", still.as_bytes(), &[], 60);
    assert!(
        said.contains("joints that never move: q3 (elbow)")
            && said.contains("in the base frame of the robot"),
        "{said}"
    );
}

#[test]
fn hostile_tables_are_refused_in_words() {
    let shop = Sandbox::new();
    let refused = |name: &str, bytes: &[u8], said: &str| {
        shop.write_bytes(name, bytes);
        let ran = shop.run(&["calibrate", "ur10", name]);
        ran.no_panic();
        assert!(ran.code == Some(2) && ran.err.contains(said), "{name}: {:?} {}", ran.code, ran.err);
        assert!(ran.err.len() < 20_000, "{name}: {} bytes", ran.err.len());
    };
    let row = |n: usize| format!("{}\n", vec!["1"; n].join(","));
    refused(
        "wide.csv",
        format!("{}\n{}", vec!["column"; 1_000_000].join(","), row(1_000_000)).as_bytes(),
        "more than 100000",
    );
    refused(
        "huge.csv",
        format!("{PLAIN}\n1e308,0,0,0,0,0,0,0,0\n0,0,0,0,0,0,1e308,0,0\n").as_bytes(),
        "not a finite number",
    );
    refused("infinite.csv", format!("{PLAIN}\ninf,0,0,0,0,0,0,0,0\n").as_bytes(), "not a finite number");
    refused("binary.csv", &[1, 2, 0, 0, 0, 7, 255, 0, 0, 0], "not text");
    refused("odd.csv", &[0xff, 0xfe, 0x00, 0xd8, 0x41, 0x00], "UTF-16");
    refused("quotes.csv", format!("{PLAIN}\n\"\"\"\"\"\"\n").as_bytes(), "no row of numbers");
    refused("same.csv", format!("{PLAIN}\n{}", row(9).repeat(50)).as_bytes(), "");
}

/// Every column may state its own unit of length, and u means a standard uncertainty.
#[test]
fn lengths_in_several_units_are_converted_to_the_unit_of_the_positions() {
    let read = |text: &str| {
        let joints = ["q1", "q2", "q3", "q4"];
        sweetspot::files::measured::read("t.csv", text, &joints, &[], None)
            .unwrap_or_else(|f| panic!("{f:#?}"))
    };
    let head = "q1 [deg],q2 [deg],q3 [mm],q4 [deg]";
    let of =
        |position: &str| read(&format!("{head},{position}\n10,20,100,30,0.5,0.6,0.7,20\n")).rows[0].numbers;
    let metres = of("x [m],y [m],z [m],u [um]");
    assert!((metres.joints[2] - 0.1).abs() < 1e-15 && metres.joints[0] == 10.0, "{metres:?}");
    assert!((metres.sigma.unwrap() - 20e-6).abs() < 1e-18, "{metres:?}");
    let expanded = of("x [m],y [m],z [m],U95 [um]");
    assert!((expanded.sigma.unwrap() - 10e-6).abs() < 1e-18, "{expanded:?}");
    // Centimetres become millimetres.
    let centimetres = of("x [cm],y [cm],z [cm],sigma [cm]");
    assert!((centimetres.position - Vector3::new(5.0, 6.0, 7.0)).norm() < 1e-12, "{centimetres:?}");
    assert!(
        (centimetres.joints[2] - 100.0).abs() < 1e-12 && centimetres.sigma == Some(200.0),
        "{centimetres:?}"
    );
    let inches = of("x [inch],y [inch],z [inch],sigma");
    assert!((inches.joints[2] - 100.0 / 25.4).abs() < 1e-12 && inches.sigma == Some(20.0), "{inches:?}");
    // Without a stated unit, no number is converted.
    assert_eq!(of("x,y,z,sigma").joints[2], 100.0);
}

#[test]
fn reflectors_may_differ_in_the_last_letter_of_their_names() {
    let columns = |a: &str, b: &str| {
        let of = |name: &str| ["x", "y", "z"].map(|axis| format!("{name}.{axis}")).join(",");
        let text = format!("q1,q2,{},{}\n1,2,3,4,5,6,7,8\n", of(a), of(b));
        sweetspot::files::measured::read("t.csv", &text, &["q1", "q2"], &[], None).unwrap().reflectors.len()
    };
    assert_eq!(columns("nestA", "nestB"), 2);
    assert_eq!(columns("smr1", "smr2"), 2);
    assert_eq!(columns("tracker", "station"), 1);
}

/// The controller of a palletizer states four joints; the passive joint of the arm has no column.
#[test]
fn a_table_may_leave_out_passive_joints() {
    use sweetspot::calibration::Deformed;
    let shop = Sandbox::new();
    let robot = crate::common::robots().into_iter().find(|(name, _)| name == "abb_irb460").unwrap().1;
    let chain = sweetspot::robot::Chain::new(&robot);
    let active: Vec<usize> = (0..chain.axes()).filter(|&i| !chain.links[i].is_passive()).collect();
    assert_eq!((active.len(), chain.axes()), (4, 5));
    let write = |header: &str, extra: bool| {
        let mut text = header.to_string();
        for k in 0..60 {
            let q = chain.halton_sample(k + 5);
            let at =
                Deformed::new(&chain, &q, &[], &[]).interface.transform(&Vector3::new(0.1, 0.05, -0.2)) * 1e3;
            let joints = active.iter().map(|&i| format!("{:.7}", q[i].to_degrees()));
            let external = extra.then(|| "50".to_string());
            let noise = |axis: usize| 0.02 * (1.7 * (3 * k + axis) as f64).sin();
            let position = at.iter().enumerate().map(|(axis, v)| format!("{:.6}", v + 500.0 + noise(axis)));
            writeln!(text, "{}", joints.chain(external).chain(position).collect::<Vec<_>>().join(","))
                .unwrap();
        }
        text
    };
    for (name, text) in [
        ("four.csv", write("q1,q2,q3,q4,x,y,z\n", false)),
        ("without_names.csv", write("", false)),
        ("with_external_axis.csv", write("q1,q2,q3,q4,q5,x,y,z\n", true)),
    ] {
        shop.write(name, &text);
        let ran = shop.done(&["calibrate", "abb_irb460", name, "--json"]);
        let before = number(&items(&ran.document()["sessions"])[0]["before"]["rms_mm"]);
        assert!(before < 0.05, "{name}: {before} mm: {}", ran.err);
        assert!(!ran.err.contains("leveller") && !ran.err.contains("are added"), "{name}: {}", ran.err);
    }
}
