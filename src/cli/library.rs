//! Built-in robots and equipment: the files of cells/robots and some of cells/equipment, embedded in the
//! program.

use crate::files;
use crate::files::{LoadedRobot, ReadFile};

/// Name and text of every robot file in cells/robots, sorted by name.
pub const ROBOTS: [(&str, &str); 42] = [
    ("abb_irb120", include_str!("../../cells/robots/abb_irb120.toml")),
    ("abb_irb1200", include_str!("../../cells/robots/abb_irb1200.toml")),
    ("abb_irb140", include_str!("../../cells/robots/abb_irb140.toml")),
    ("abb_irb460", include_str!("../../cells/robots/abb_irb460.toml")),
    ("abb_irb4600", include_str!("../../cells/robots/abb_irb4600.toml")),
    ("abb_irb6700", include_str!("../../cells/robots/abb_irb6700.toml")),
    ("adept_cobra_s600", include_str!("../../cells/robots/adept_cobra_s600.toml")),
    ("comau_ns16", include_str!("../../cells/robots/comau_ns16.toml")),
    ("denso_vs060", include_str!("../../cells/robots/denso_vs060.toml")),
    ("doosan_m1013", include_str!("../../cells/robots/doosan_m1013.toml")),
    ("fanuc_crx10ia", include_str!("../../cells/robots/fanuc_crx10ia.toml")),
    ("fanuc_lrmate200id", include_str!("../../cells/robots/fanuc_lrmate200id.toml")),
    ("fanuc_m20ia", include_str!("../../cells/robots/fanuc_m20ia.toml")),
    ("fanuc_r2000ic_165f", include_str!("../../cells/robots/fanuc_r2000ic_165f.toml")),
    ("franka_panda", include_str!("../../cells/robots/franka_panda.toml")),
    ("hitachi_pw10", include_str!("../../cells/robots/hitachi_pw10.toml")),
    ("hitachi_pw10_parallelogram", include_str!("../../cells/robots/hitachi_pw10_parallelogram.toml")),
    ("hitachi_pw10_urdf", include_str!("../../cells/robots/hitachi_pw10_urdf.toml")),
    ("kawasaki_rs007n", include_str!("../../cells/robots/kawasaki_rs007n.toml")),
    ("kinova_gen3", include_str!("../../cells/robots/kinova_gen3.toml")),
    ("kuka_iiwa14", include_str!("../../cells/robots/kuka_iiwa14.toml")),
    ("kuka_kr10_r1100", include_str!("../../cells/robots/kuka_kr10_r1100.toml")),
    ("kuka_kr150_r3100_2", include_str!("../../cells/robots/kuka_kr150_r3100_2.toml")),
    ("kuka_kr16_2", include_str!("../../cells/robots/kuka_kr16_2.toml")),
    ("kuka_kr6_r900", include_str!("../../cells/robots/kuka_kr6_r900.toml")),
    ("kuka_youbot", include_str!("../../cells/robots/kuka_youbot.toml")),
    ("motoman_gp12", include_str!("../../cells/robots/motoman_gp12.toml")),
    ("motoman_gp25", include_str!("../../cells/robots/motoman_gp25.toml")),
    ("motoman_gp8", include_str!("../../cells/robots/motoman_gp8.toml")),
    ("puma560", include_str!("../../cells/robots/puma560.toml")),
    ("puma560_on_track", include_str!("../../cells/robots/puma560_on_track.toml")),
    ("stanford_arm", include_str!("../../cells/robots/stanford_arm.toml")),
    ("staubli_tx2_60", include_str!("../../cells/robots/staubli_tx2_60.toml")),
    ("staubli_tx2_90", include_str!("../../cells/robots/staubli_tx2_90.toml")),
    ("techman_tm5_900", include_str!("../../cells/robots/techman_tm5_900.toml")),
    ("ufactory_xarm6", include_str!("../../cells/robots/ufactory_xarm6.toml")),
    ("ur10", include_str!("../../cells/robots/ur10.toml")),
    ("ur10e", include_str!("../../cells/robots/ur10e.toml")),
    ("ur16e", include_str!("../../cells/robots/ur16e.toml")),
    ("ur20", include_str!("../../cells/robots/ur20.toml")),
    ("ur3e", include_str!("../../cells/robots/ur3e.toml")),
    ("ur5e", include_str!("../../cells/robots/ur5e.toml")),
];

/// Name and text of the URDF files that the built-in robots refer to.
const URDFS: [(&str, &str); 1] =
    [("hitachi_pw10.urdf", include_str!("../../cells/robots/hitachi_pw10.urdf"))];

/// Name and text of the equipment files that the first cells use.
const EQUIPMENT: [(&str, &str); 5] = [
    ("bench", include_str!("../../cells/equipment/bench.toml")),
    ("conveyor", include_str!("../../cells/equipment/conveyor.toml")),
    ("feeder", include_str!("../../cells/equipment/feeder.toml")),
    ("pallet", include_str!("../../cells/equipment/pallet.toml")),
    ("worktable", include_str!("../../cells/equipment/worktable.toml")),
];

/// Returns the text of a built-in file by its path in cells/; None if the file is not built in.
pub fn file(path: &str) -> Option<&'static str> {
    let (folder, name) = path.split_once('/')?;
    let stem = name.strip_suffix(".toml");
    match (folder, stem) {
        ("robots", Some(stem)) => text(stem),
        ("robots", None) => URDFS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text),
        ("equipment", stem) => {
            EQUIPMENT.iter().find(|(known, _)| Some(*known) == stem).map(|(_, text)| *text)
        }
        _ => None,
    }
}

/// Returns the text of the robot file of a built-in robot; None if no built-in robot has this name.
pub fn text(name: &str) -> Option<&'static str> {
    ROBOTS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

/// Reads a built-in robot by its name. Returns None if no built-in robot has this name.
pub fn robot(name: &str) -> Option<Result<LoadedRobot, Vec<files::Fault>>> {
    text(name)?;
    let read: &mut ReadFile<'_> = &mut |path: &str| {
        let urdf = || URDFS.iter().find(|(known, _)| *known == path).map(|(_, text)| *text);
        let text = path.strip_suffix(".toml").and_then(text).or_else(urdf);
        text.map(|text| text.as_bytes().to_vec()).ok_or_else(|| "it is not built in".to_string())
    };
    Some(files::load_robot(&format!("{name}.toml"), read))
}
