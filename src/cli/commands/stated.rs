//! Calibrations that a file states: `calibrate` uses their errors, and fits no measurement.

use super::{suggest, suggest_with};
use crate::calibration::{errors_between, errors_of_frames, no_errors, nominal_frames};
use crate::cell::{Robot, SignedErrors};
use crate::cli::arguments::CalibrateArguments;
use crate::cli::output::path_word;
use crate::cli::{Exit, json_text, loading, output};
use crate::files::measured::decode;
use crate::files::stated::{StatedCalibration, read_conf, read_yaml};
use crate::files::{Fault, LoadedRobot, load_robot, shown, toml_string};
use crate::pose::Pose;
use crate::record::CalibrationDocument;
use crate::report;
use crate::robot::Chain;
use crate::units::{deg_from_rad, mm_from_m, rounded};
use std::path::Path;

/// Largest distance, m, between a stated joint frame and the nominal joint frame. A calibration with a larger
/// distance is refused, because it probably belongs to another robot.
const OTHER_ARM: f64 = 0.02;

/// Largest angle, rad, between a stated joint frame and the nominal joint frame. A calibration with a larger
/// angle is refused, because it probably belongs to another robot.
const OTHER_TURN: f64 = 0.05;

/// STL mesh that replaces every mesh of a URDF, except that [`OBJ`] replaces OBJ meshes. Only the kinematics
/// of the URDF is used.
const STL: &str = "solid a\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n\
                   facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n\
                   facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n\
                   facet normal -1 0 0\nouter loop\nvertex 0 1 0\nvertex 0 0 0\nvertex 0 0 1\nendloop\nendfacet\n\
                   endsolid a\n";
const OBJ: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";

fn has_extension(path: &Path, extensions: &[&str]) -> bool {
    path.extension().is_some_and(|own| extensions.iter().any(|e| own.eq_ignore_ascii_case(e)))
}

/// Returns whether a file has the extension of a URDF.
pub fn is_urdf(path: &Path) -> bool {
    has_extension(path, &["urdf"])
}

/// Returns whether a file has the extension of a file that contains a calibration: YAML, conf or URDF.
/// `calibrate` takes the errors from such a file, and fits nothing.
pub fn states_calibration(path: &Path) -> bool {
    has_extension(path, &["yaml", "yml", "conf", "urdf"])
}

/// Returns the text of a URDF without its collision shapes, which a calibration does not need. The lines keep
/// their numbers.
fn without_collisions(text: &str) -> String {
    let (mut out, mut rest) = (String::new(), text);
    while let Some(start) = rest.find("<collision") {
        let (before, element) = rest.split_at(start);
        out.push_str(before);
        let is_tag =
            element["<collision".len()..].starts_with(|c: char| c.is_whitespace() || "/>".contains(c));
        let head = element.find('>').map_or(element.len(), |end| end + 1);
        let is_empty = element[..head].ends_with("/>");
        let end = match (is_tag, is_empty) {
            (false, _) => "<collision".len(),
            (true, true) => head,
            (true, false) => {
                element.find("</collision>").map_or(element.len(), |at| at + "</collision>".len())
            }
        };
        match is_tag {
            true => out.extend(element[..end].chars().filter(|c| *c == '\n')),
            false => out.push_str(&element[..end]),
        }
        rest = &element[end..];
    }
    out + rest
}

/// Reads a URDF as a robot whose tool frame is the frame of the tip link.
///
/// `links` names base and tip of the chain; None means the root link and the only link without children.
pub fn robot_of_urdf(path: &Path, links: Option<(&str, &str)>) -> Result<LoadedRobot, Exit> {
    // Collada meshes cannot be read, but their content is not needed here.
    let text = String::from_utf8_lossy(&loading::read_data(path)?).replace(".dae", ".stl");
    let text = without_collisions(&text);
    let name = path.file_name().map_or("robot.urdf".into(), |name| name.to_string_lossy().into_owned());
    let links = links.map_or(String::new(), |(base, tip)| {
        format!("base_link = {}\ntip_link = {}\n", toml_string(base), toml_string(tip))
    });
    let robot = format!(
        "schema = \"sweetspot/robot/1\"\nunits = {{ length = \"mm\", angle = \"deg\" }}\nurdf = {}\n{links}\
         tool = {{ position_mm = [0, 0, 0], axis = [0, 0, 1] }}\nfootprint = {{ size_mm = [100, 100] }}\n\
         [errors.none]\nkind = \"signed\"\nsource = \"none\"\njoints = []\n",
        toml_string(&name)
    );
    let read = load_robot("robot.toml", &mut |asked| {
        Ok(match asked {
            "robot.toml" => robot.clone().into_bytes(),
            asked if asked == name => text.clone().into_bytes(),
            asked if asked.to_ascii_lowercase().ends_with(".obj") => OBJ.into(),
            _ => STL.into(),
        })
    });
    read.map_err(|mut faults| {
        faults.iter_mut().for_each(|fault| fault.file = path.to_string_lossy().into_owned());
        output::faults(&faults);
        Exit::BadInput
    })
}

/// Runs `sweetspot calibrate` for a file that contains a calibration.
pub fn calibrate_as_stated(robot: &Robot, path: &Path, a: &CalibrateArguments) -> Result<Exit, Exit> {
    if a.data.len() > 1 || !a.test.is_empty() || a.joints.is_some() {
        output::error(&format!("{} contains a calibration: give no other file with it", path_word(path)));
        output::talk(
            "  help: give either tables of measured positions, or one file that contains a calibration",
        );
        return Err(Exit::BadInput);
    }
    let of_a_fit = [
        ("--elastic", a.elastic),
        ("--harmonics", a.harmonics.is_some()),
        ("--prior", a.prior.is_some()),
        ("--poses", a.poses.is_some()),
        ("--column", !a.column.is_empty()),
        ("--choose", a.planning.choose.is_some()),
        ("--svg", a.svg.is_some()),
    ];
    for (option, _) in of_a_fit.iter().filter(|(_, is_given)| *is_given) {
        output::talk(&format!(
            "note: {option} is ignored: a file that contains a calibration has no positions to fit"
        ));
    }
    let (errors, source) =
        if is_urdf(path) { of_urdf(robot, path)? } else { of_universal_robots(robot, path)? };
    let document = CalibrationDocument::stated(robot, &errors);
    if a.json {
        json_text::print(&document)?;
    } else if a.toml {
        output::data(&report::measured_errors::stated_table(robot, &errors, &source))?;
        let file = if is_urdf(&a.robot) {
            "a robot file".into()
        } else {
            format!("a copy of {}", path_word(&a.robot))
        };
        suggest(&format!("check CELL, with this table in {file}"));
    } else {
        output::data(&report::text::stated_calibration(&document, &source))?;
        suggest_with(&format!("calibrate {} {} --toml", path_word(&a.robot), path_word(path)), &a.packages);
    }
    Ok(Exit::Done)
}

/// Returns the errors of a calibrated URDF relative to the nominal URDF of the robot.
fn of_urdf(robot: &Robot, path: &Path) -> Result<(SignedErrors, String), Exit> {
    let refuse = |message: String, help: &str| {
        output::error(&format!("{}: {message}", path_word(path)));
        output::talk(&format!("  help: {help}"));
        Exit::BadInput
    };
    let Some(origin) = &robot.urdf else {
        let help = "give the nominal URDF of the arm as the robot, or a robot file with the key urdf";
        return Err(refuse(format!("the robot {} was not read from a URDF", shown(&robot.name)), help));
    };
    let calibrated = robot_of_urdf(path, Some((&origin.base_link, &origin.tip_link)))?.robot;
    let names = |robot: &Robot| robot.joints.iter().map(|joint| joint.name.clone()).collect::<Vec<_>>();
    let help = "give two URDF files of one arm that have the same joints with different origins";
    if names(robot) != names(&calibrated) {
        return Err(refuse(
            "the joints of its chain differ from the joints of the nominal URDF".into(),
            help,
        ));
    }
    let nominal = Chain::new(robot);
    let mut built = Chain::new(&calibrated);
    // The tool of a robot file is fixed to the tip link of either URDF.
    built.tool = built.tool * origin.tip.inverse() * nominal.tool;
    let errors = errors_between(&nominal, &built).map_err(|k| {
        let joint = shown(&robot.joints[k].name);
        refuse(format!("the axis of joint {joint} has a different direction in the nominal URDF"), help)
    })?;
    let source = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    output::talk(&format!(
        "note: {}: the joint origins and the tip link are compared with the nominal URDF; the differences of the joint origins become errors of the joint frames, and the difference of the tip link becomes an error of the tool",
        path_word(path)
    ));
    Ok((errors, source))
}

/// Returns the errors that a file of Universal Robots states.
fn of_universal_robots(robot: &Robot, path: &Path) -> Result<(SignedErrors, String), Exit> {
    let file = path.to_string_lossy();
    let refuse = |faults: Vec<Fault>| {
        output::faults(&faults);
        Exit::BadInput
    };
    let text = decode(&loading::read_data(path)?)
        .map_err(|why| refuse(vec![Fault::of_file(&file, why, "give the file as text")]))?;
    let read = if has_extension(path, &["conf"]) { read_conf } else { read_yaml };
    let stated = read(&file, &text).map_err(refuse)?;
    let name = path.file_name().map_or(String::new(), |name| name.to_string_lossy().into_owned());
    let chain = Chain::new(robot);
    if chain.axes() != 6 {
        let message = format!(
            "the file describes a six-axis arm, but {} has {} axes",
            shown(&robot.name),
            chain.axes()
        );
        return Err(refuse(vec![Fault::of_file(
            &file,
            message,
            "give the robot to which the calibration belongs",
        )]));
    }
    match stated {
        StatedCalibration::Frames { frames, hash } => {
            refuse_other_arm(robot, &chain, &frames, path)?;
            let hash = hash.map_or(String::new(), |hash| format!(", hash {}", shown(&hash)));
            output::talk(&format!(
                "note: {}: the errors describe the joint frames; the error of joint 1 includes the error of \
                 the base, and the file states no tool",
                path_word(path)
            ));
            Ok((errors_of_frames(&chain, &frames), format!("{name}{hash}")))
        }
        StatedCalibration::Rows { theta, a, d, alpha } => {
            let rows = SignedErrors { dq: theta, dr: d, dl: a, dalpha: alpha, ..no_errors(6) };
            output::talk(&format!(
                "note: {}: the errors describe the D-H rows; base and tool are nominal",
                path_word(path)
            ));
            Ok((rows, name))
        }
    }
}

/// Refuses frames that are too far from the nominal frames.
fn refuse_other_arm(robot: &Robot, chain: &Chain, frames: &[Pose], path: &Path) -> Result<(), Exit> {
    for (k, (nominal, stated)) in nominal_frames(chain).iter().zip(frames).enumerate() {
        let off = nominal.inverse() * *stated;
        let distance = off.translation.norm();
        let turn = nalgebra::Rotation3::from_matrix_unchecked(off.rotation).scaled_axis().norm();
        if distance > OTHER_ARM || turn > OTHER_TURN {
            output::error(&format!(
                "{}: the frame of joint {} is {} mm and {} deg from the frame of {}",
                path_word(path),
                k + 1,
                rounded(mm_from_m(distance), 1),
                rounded(deg_from_rad(turn), 1),
                shown(&robot.name)
            ));
            output::talk("  help: give the robot to which the calibration belongs: see `sweetspot robots`");
            return Err(Exit::BadInput);
        }
    }
    Ok(())
}
