//! Tests the solids that move with the robot: tools from files, held parts, link meshes, and self-collision.

use crate::common::{buildable, root, shipped};
use nalgebra::Vector3;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use sweetspot::cell::{Cell, MAX_JOINTS, Placement, Shape};
use sweetspot::clearance::{Allowed, ContactMemory, Hit, PlacedSolids, Remember, Scene, SolidRef};
use sweetspot::error_map::NodeSign;
use sweetspot::files;
use sweetspot::files::Fault;
use sweetspot::layout::Workcell;
use sweetspot::pose::Pose;

type V = Vector3<f64>;
type Frames = [Pose; MAX_JOINTS + 1];

/// Loads a cell from files in memory, with the shipped files beside them.
fn load(files: &[(&str, &str)]) -> Result<Cell, Vec<Fault>> {
    let files: BTreeMap<_, _> = files.iter().copied().collect();
    let loaded = files::load("cell.toml", &mut |path: &str| match files.get(path) {
        Some(text) => Ok(text.as_bytes().to_vec()),
        None => std::fs::read(root().join("cells").join(path)).map_err(|_| "no such file".to_string()),
    });
    loaded.map(|l| l.cell)
}

fn sound(files: &[(&str, &str)]) -> Cell {
    load(files).unwrap_or_else(|f| panic!("{f:#?}"))
}

fn refused(text: &str) -> Vec<String> {
    load(&[("cell.toml", text)]).unwrap_err().iter().map(|f| format!("{}: {}", f.message, f.help)).collect()
}

fn hit(cell: &Cell, frames: &Frames, operation: Option<usize>) -> Option<String> {
    let scene = Scene::new(cell);
    let mut placed = PlacedSolids::default();
    scene.place(&cell.start(), &mut placed);
    let hit = scene.hit(&placed, frames, operation);
    let mut memory = ContactMemory::default();
    for _ in 0..2 {
        assert_eq!(scene.is_free(&placed, frames, operation, &mut memory), hit.is_none());
    }
    hit.map(|h| h.in_words(cell))
}

/// Returns frames that are high above the cell and far apart, except the last frame.
fn lifted(last: Pose) -> Frames {
    let mut frames: Frames = std::array::from_fn(|k| at(0.0, 0.0, 90.0 + 10.0 * k as f64));
    (frames[0], frames[4]) = (Pose::identity(), last);
    frames
}

fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose { translation: V::new(x, y, z), ..Pose::identity() }
}

// --- tools and held parts -----------------------------------------------------------------------

const GRIPPER: &str = "schema = \"sweetspot/tool/1\"\nunits = { length = \"mm\", angle = \"deg\" }\nname = \"G\"\n\
    position_mm = [0, 0, 150]\naxis = [0, 0, 1]\n\
    solid = [{ name = \"jaws\", box = { centre_mm = [0, 0, 75], size_mm = [40, 40, 150] } }]\n";

#[test]
fn a_tool_file_replaces_the_tool_of_the_robot() {
    let cell = "from = \"hitachi_paper.toml\"\n[robot]\ntool = { from = \"gripper.toml\" }\n";
    let robot = sound(&[("cell.toml", cell), ("gripper.toml", GRIPPER)]).robot;
    assert_eq!(robot.tool.translation, V::new(0.0, 0.0, 0.15));
    assert_eq!(robot.tool_axis, V::z());
    let last = robot.solids.last().unwrap();
    assert_eq!((last.link, &last.solid.name[..]), (4, "jaws"));
    // Keys beside `from` override the keys of its file. The tool of the robot file has no effect.
    let turned = "from = \"hitachi_paper.toml\"\n[robot.tool]\nfrom = \"gripper.toml\"\naxis = [0, 1, 0]\n";
    let robot = sound(&[("cell.toml", turned), ("gripper.toml", GRIPPER)]).robot;
    assert_eq!((robot.tool_axis, robot.tool.translation.z), (V::y(), 0.15));
    // A robot file may also name a tool file in its own folder.
    let with = std::fs::read_to_string(root().join("cells/robots/hitachi_pw10.toml")).unwrap();
    let with =
        with.replace("[tool]\nposition_mm = [0, 0, 0]\naxis = [1, 0, 0]", "[tool]\nfrom = \"../g.toml\"");
    let cell = "from = \"hitachi_paper.toml\"\n[robot]\nfrom = \"robots/with.toml\"\n";
    let robot = sound(&[("cell.toml", cell), ("robots/with.toml", &with), ("g.toml", GRIPPER)]).robot;
    assert_eq!(robot.solids.last().unwrap().solid.name, "jaws");
}

#[test]
fn wrong_tools_are_refused() {
    let named = GRIPPER.replace("jaws", "forearm");
    let cell = "from = \"hitachi_paper.toml\"\n[robot]\ntool = { from = \"gripper.toml\" }\n";
    let faults = load(&[("cell.toml", cell), ("gripper.toml", &named)]).unwrap_err();
    assert!(
        faults[0].message.contains("has the same name as a solid of the robot: `forearm`"),
        "{faults:#?}"
    );
    let faults =
        refused("from = \"hitachi_paper.toml\"\n[robot]\ntool = { from = \"equipment/worktable.toml\" }\n");
    assert!(
        faults[0].contains("is an equipment file: a file with schema = \"sweetspot/tool/1\""),
        "{faults:?}"
    );
}

#[test]
fn held_parts_collide_only_in_their_operation() {
    let text = |more: &str| {
        format!(
            "from = \"hitachi_cell.toml\"\n[operation.picking]\n\
             held = {{ solid = [{{ name = \"crate\", box = {{ centre_mm = [0, 0, 50], size_mm = [300, 300, 100] }} }}]{more} }}\n"
        )
    };
    let cell = sound(&[("cell.toml", &text(""))]);
    let (assembly, picking) = (0, 1);
    assert_eq!(
        (&cell.operations[picking].name[..], cell.operations[picking].held.solids.len()),
        ("picking", 1)
    );
    // The tool points down, so the z axis of the TCP, along which the part extends, is horizontal. At 140 mm
    // beside the edge of the table, the tool is free but the part is not.
    let down = Pose::from_translation_rpy(V::zeros(), V::new(0.0, std::f64::consts::FRAC_PI_2, 0.0));
    let table = cell.start().placements[0];
    let place = |dx: f64, z: f64| {
        let edge = table.pose().transform(&V::new(0.0, -0.35 - dx, 0.0));
        lifted(Pose { translation: V::new(edge.x, edge.y, z), ..down })
    };
    assert_eq!(hit(&cell, &place(0.12, 0.58), Some(assembly)), None);
    assert_eq!(hit(&cell, &place(0.12, 0.58), None), None);
    assert_eq!(
        hit(&cell, &place(0.12, 0.58), Some(picking)).as_deref(),
        Some("crate touches worktable (slab)")
    );
    assert_eq!(hit(&cell, &place(0.40, 0.58), Some(picking)), None);
    // The part lies on the conveyor. Contact is allowed only with the equipment of the operation, and only if
    // the file requests this.
    let belt = cell.start().placements[1];
    let lying = lifted(Pose { translation: V::new(belt.x, belt.y, 0.70), ..down });
    assert_eq!(hit(&cell, &lying, Some(picking)).as_deref(), Some("crate touches conveyor (belt)"));
    let spared = sound(&[("cell.toml", &text(", touches_surface = true"))]);
    assert_eq!(hit(&spared, &lying, Some(picking)), None);
    assert!(hit(&spared, &place(0.12, 0.58), Some(picking)).is_some());
    // The part exists only in the map of its own operation.
    let count = |cell: &Cell| {
        let workcell = Workcell::new(cell.clone()).unwrap();
        workcell.maps(&cell.start()).iter().map(|m| m.count(NodeSign::Usable)).collect::<Vec<_>>()
    };
    let (without, with) = (count(&buildable("hitachi_cell.toml")), count(&cell));
    assert_eq!(without[assembly], with[assembly]);
    assert!(with[picking] < without[picking], "{without:?} {with:?}");
}

// --- the robot against itself -------------------------------------------------------------------

#[test]
fn a_self_collision_names_both_links_and_can_be_allowed() {
    let folded = lifted(at(0.0, 0.1, 0.2));
    let cell = shipped("hitachi_cell.toml");
    assert_eq!(hit(&cell, &folded, None).as_deref(), Some("tool touches base"));
    for (text, allowed) in [
        ("self_collision = false", None),
        ("self_collision = { allowed = [[\"tool\", \"base\"]] }", Some(Allowed::Given)),
    ] {
        let cell = sound(&[("cell.toml", &format!("from = \"hitachi_cell.toml\"\n[robot]\n{text}\n"))]);
        assert_eq!(hit(&cell, &folded, None), None, "{text}");
        let scene = Scene::new(&cell);
        let pair = (SolidRef::Robot(0), SolidRef::Robot(5));
        let found = scene.self_collision_pairs().iter().find(|p| (p.a, p.b) == pair);
        assert_eq!(found.and_then(|p| p.allowed), allowed, "{text}");
    }
}

#[test]
fn wrong_lists_of_pairs_are_refused() {
    let said = |value: &str| {
        refused(&format!("from = \"hitachi_cell.toml\"\n[robot]\nself_collision = {value}\n")).join("\n")
    };
    assert!(said("{ allowed = [[\"tool\", \"bass\"]] }").contains("no solid `bass`: did you mean \"base\"?"));
    assert!(said("{ allowed = [[\"tool\"]] }").contains("must be a list of 2 names"));
    assert!(said("{ allowed = true }").contains("must be a list of pairs"));
    assert!(said("{}").contains("`allowed` is missing"));
    assert!(said("\"no\"").contains("must be a TOML table"));
}

/// Solids of links that overlap in every posture may touch. Solids that move apart may not touch.
#[test]
fn links_that_touch_in_every_posture_are_allowed() {
    let mut cell = shipped("hitachi_cell.toml");
    // A ball with a radius of 3 m around the base always contains the forearm. A ball of 0.5 m does not.
    for (radius, want) in [(3.0, Some(Allowed::AlwaysTouch)), (0.5, None)] {
        cell.robot.solids[0].solid.shape = Shape::Sphere { centre: V::zeros(), radius };
        let scene = Scene::new(&cell);
        let found = scene
            .self_collision_pairs()
            .iter()
            .find(|p| (p.a, p.b) == (SolidRef::Robot(0), SolidRef::Robot(4)));
        assert_eq!(found.unwrap().allowed, want);
    }
}

// --- link meshes --------------------------------------------------------------------------------

/// Returns a closed L-shaped mesh of two bars, 400 mm long and 100 mm thick (coordinates in m). The vertices
/// are the corners of the outline at the bottom and at the top.
fn angle_mesh() -> (Vec<V>, Vec<[u32; 3]>) {
    let outline = [(0.0, 0.0), (0.4, 0.0), (0.4, 0.1), (0.1, 0.1), (0.1, 0.4), (0.0, 0.4)];
    let level = |z: f64| outline.map(|(x, y)| V::new(x, y, z));
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
    }
    for a in 0..6 {
        let b = (a + 1) % 6;
        triangles.extend([[a, b, b + 6], [a, b + 6, a + 6]]);
    }
    ([level(0.0), level(0.1)].concat(), triangles)
}

/// Returns a cell with only the L-shaped mesh on its last link, and a ball or box that can be placed
/// anywhere.
fn with_angle(part: &str) -> Cell {
    let text = format!(
        "from = \"hitachi_paper.toml\"\ncollision = true\nfloor_mm = -100000\n[robot]\n\
         solid = [{{ name = \"angle\", link = 4, mesh = {{ file = \"angle.obj\", units = \"m\", centre_mm = [10, 20, 30], rpy_deg = [10, 20, 30] }} }}]\n\
         [obstacle.probe]\nfootprint = {{ size_mm = [500, 500] }}\nplacement = {{ x_mm = 0, y_mm = 3000, z_mm = 0 }}\nsolid = [{{ name = \"probe\", {part} }}]\n"
    );
    let (vertices, triangles) = angle_mesh();
    let vertex = |v: &V| format!("v {} {} {}\n", v.x, v.y, v.z);
    let face = |t: &[u32; 3]| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
    let obj: String = vertices.iter().map(vertex).chain(triangles.iter().map(face)).collect();
    sound(&[("cell.toml", &text), ("angle.obj", &obj)])
}

const POINT: &str = "sphere = { centre_mm = [0, 0, 0], radius_mm = 0.001 }";

/// Returns whether the L-shaped mesh touches the probe at a point of the mesh file.
fn touches(cell: &Cell, point: &V, remember: &mut Remember<'_>) -> bool {
    let Shape::Mesh { pose, .. } = &cell.robot.solids[0].solid.shape else { panic!("no mesh") };
    let frame = Pose::from_translation_rpy(V::new(0.2, -0.1, 0.7), V::new(0.4, -0.5, 0.6));
    let p = (frame * *pose).transform(point);
    let mut layout = cell.start();
    *layout.placements.last_mut().unwrap() = Placement { x: p.x, y: p.y, z: p.z, yaw: 0.0 };
    let scene = Scene::remembering(cell, remember);
    let mut placed = PlacedSolids::default();
    scene.place(&layout, &mut placed);
    let hit = scene.hit(&placed, &lifted(frame), None);
    assert!(hit.is_none_or(|h| h.solid == SolidRef::Robot(0) && h != Hit { other: SolidRef::Floor, ..h }));
    hit.is_some()
}

/// The collision shape is never smaller than the mesh, and it consists of two bars, whichever decomposition
/// was cached.
#[test]
fn a_link_mesh_collides_on_its_whole_surface() {
    let cell = with_angle(POINT);
    let (vertices, triangles) = angle_mesh();
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let surface: Vec<V> = (0..300)
        .map(|k| {
            let [a, b, c] = triangles[k % triangles.len()].map(|i| vertices[i as usize]);
            let (s, t): (f64, f64) = (rng.random(), rng.random());
            let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
            a + (b - a) * s + (c - a) * t
        })
        .collect();
    let garbage: [&[u8]; 5] =
        [&[], &[255; 20], &[0; 20], &[0; 7], &[3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3, 2, 3, 8, 4]];
    let mut asked = 0;
    for point in &surface {
        assert!(touches(&cell, point, &mut |_, compute| compute()), "{point}");
        for kept in garbage {
            assert!(touches(&cell, point, &mut |_, _| kept.to_vec()), "{point}, kept {kept:?}");
        }
        asked += 1;
    }
    assert_eq!(asked, 300);
    let own = &mut |_: &[u8], compute: &dyn Fn() -> Vec<u8>| compute();
    for (x, y, want) in
        [(0.05, 0.05, true), (0.3, 0.05, true), (0.05, 0.3, true), (0.3, 0.3, false), (0.2, 0.2, false)]
    {
        assert_eq!(touches(&cell, &V::new(x, y, 0.05), own), want, "{x} {y}");
    }
    for outside in [V::new(0.2, -0.01, 0.05), V::new(0.41, 0.05, 0.05), V::new(0.05, 0.05, 0.12)] {
        assert!(!touches(&cell, &outside, own), "{outside}");
    }
}

/// The decomposition of a mesh is computed once and depends on its content alone.
#[test]
fn the_convex_decomposition_is_cached_by_content() {
    let mut cell = with_angle(POINT);
    let keys = |cell: &Cell| {
        let mut keys = Vec::new();
        Scene::remembering(cell, &mut |key, compute| {
            keys.push(key.to_vec());
            compute()
        });
        keys
    };
    let first = keys(&cell);
    assert_eq!(first.len(), 1);
    assert_eq!(keys(&cell), first);
    if let Shape::Mesh { vertices, .. } = &mut cell.robot.solids[0].solid.shape {
        vertices[3].z += 1e-9;
    }
    assert_ne!(keys(&cell), first);
}
