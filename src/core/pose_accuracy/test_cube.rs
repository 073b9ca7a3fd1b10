//! Test cube of ISO 9283, with its place in the working space and the postures at the five poses.

use crate::cell::{Attitude, Azimuth, JointVector, Rectangle, Robot, Spin};
use crate::reach::{Branch, Cost, Inverse, Reach, ToolAttitudes};
use crate::robot::Chain;
use nalgebra::Vector3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// Lengths of the edges of the cubes in the standard, m.
const EDGES: [f64; 4] = [1.0, 0.63, 0.4, 0.25];

/// Shorter edges, m, for arms in whose working space no cube of the standard fits.
const SMALLER_EDGES: [f64; 5] = [0.16, 0.1, 0.063, 0.04, 0.025];

/// Distance of the poses P2 to P5 from the centre, as a share of half a diagonal.
const OUTWARDS: f64 = 0.8;

/// Directions from the base axis in which the cube is tried: along x, then along y, -y and -x.
const FRONTS: [(f64, f64); 4] = [(1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (-1.0, 0.0)];

/// One of the five poses of the test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TestPose {
    /// Position of the TCP in the base frame, m.
    pub position: Vector3<f64>,
    pub joints: JointVector,
}

/// Test cube with the postures of the robot at the five poses P1 to P5.
#[derive(Debug, Clone, PartialEq)]
pub struct TestCube {
    /// Length of an edge, m. The edges are parallel to the axes of the base frame.
    pub edge: f64,
    /// Whether the standard specifies a cube of this size.
    pub is_standard: bool,
    /// Centre of the cube in the base frame, m.
    pub centre: Vector3<f64>,
    /// Required attitude of the tool at all poses, relative to the base frame. Azimuth and spin may be free.
    pub attitude: Attitude,
    pub poses: [TestPose; 5],
}

impl TestCube {
    /// Returns the first tried cube that fits in the working space of the robot; None if no tried cube fits.
    ///
    /// The corners of the cube and the five poses are reachable within the joint limits with one attitude of
    /// the tool, whose azimuth and spin may be free. The cube is beside the robot base. The tried centres lie
    /// on a grid. If the cube fits at several centres, the centre nearest to their mean is chosen.
    ///
    /// Cubes are tried in four groups, each from the largest to the smallest size:
    ///
    /// 1. cubes of the standard that are above the base plane
    /// 2. cubes of the standard at any height
    /// 3. smaller cubes that are above the base plane
    /// 4. smaller cubes at any height
    pub fn largest(robot: &Robot, chain: &Chain, inverse: &Inverse) -> Option<Self> {
        let search = CubeSearch { robot, chain, inverse };
        let sizes = |above: bool, edges: &'static [f64]| edges.iter().map(move |edge| (above, *edge));
        let mut sizes = sizes(true, &EDGES).chain(sizes(false, &EDGES));
        let mut smaller =
            [true, false].into_iter().flat_map(|above| SMALLER_EDGES.iter().map(move |edge| (above, *edge)));
        sizes.find_map(|size| search.cube(size)).or_else(|| smaller.find_map(|size| search.cube(size)))
    }
}

/// Search for the test cube in the working space of a robot.
struct CubeSearch<'a> {
    robot: &'a Robot,
    chain: &'a Chain,
    inverse: &'a Inverse,
}

impl CubeSearch<'_> {
    /// Returns a cube with edges of the length `edge` (m); None if no such cube fits. If `above` is true,
    /// the cube must be above the base plane.
    fn cube(&self, (above, edge): (bool, f64)) -> Option<TestCube> {
        for attitude in self.attitudes() {
            if self.inverse.refusal(&attitude).is_some() {
                continue;
            }
            let attitudes = self.inverse.tool_attitudes(&attitude, 0.0);
            let fronts = if self.is_numeric() { &FRONTS[..1] } else { &FRONTS };
            for &front in fronts {
                let fitting = self.centres(edge, above, front, &attitudes);
                let Some(centre) = middle(&fitting) else { continue };
                if let Some(poses) = self.postures(&points(&centre, edge, front), &attitudes) {
                    let is_standard = EDGES.contains(&edge);
                    return Some(TestCube { edge, is_standard, centre, attitude, poses });
                }
            }
        }
        None
    }

    /// Returns the orientations to try: downward, oblique and level tools, first with fixed spins, then
    /// with any spin.
    fn attitudes(&self) -> Vec<Attitude> {
        let elevations = match self.inverse.fixed_elevation() {
            Some(elevation) => vec![elevation],
            None => vec![-FRAC_PI_2, -FRAC_PI_4, 0.0],
        };
        let spins = [0.0, FRAC_PI_2, -FRAC_PI_2, std::f64::consts::PI];
        let free = elevations.iter().map(|elevation| Attitude::elevation(*elevation)).collect();
        if self.is_numeric() {
            return free;
        }
        let held = |elevation: f64| {
            spins.map(|spin| Attitude {
                azimuth: Azimuth::Surface(0.0),
                spin: Spin::At(vec![spin]),
                ..Attitude::elevation(elevation)
            })
        };
        elevations.iter().flat_map(|elevation| held(*elevation)).chain(free).collect()
    }

    /// Returns whether the inverse kinematics is numeric. A numeric solution takes about a millisecond for
    /// each point.
    fn is_numeric(&self) -> bool {
        self.inverse.cost() == Cost::Numeric
    }

    /// Returns the centres at which a cube fits, on a grid in the vertical plane through the base axis.
    fn centres(
        &self,
        edge: f64,
        above: bool,
        front: (f64, f64),
        attitudes: &ToolAttitudes,
    ) -> Vec<Vector3<f64>> {
        // Arms with a redundant joint or numeric inverse kinematics need much time for each point.
        let count = match self.inverse.cost() {
            Cost::Low | Cost::Middle => 24,
            Cost::High => 8,
            Cost::Numeric => 6,
        };
        let reach = self.robot.reach();
        let shoulder = self.chain.mount.translation.z + self.robot.joints.first().map_or(0.0, |j| j.r);
        let step = reach / f64::from(count);
        let beside = edge / 2.0 + self.robot_base(front);
        let mut scratch = self.inverse.scratch();
        let mut fitting = Vec::new();
        for (i, k) in (1..=count).flat_map(|i| (-count..=count).map(move |k| (i, k))) {
            let (radius, height) = (step * f64::from(i), shoulder + step * f64::from(k));
            if radius < beside || above && height < edge / 2.0 {
                continue;
            }
            let centre = Vector3::new(front.0 * radius, front.1 * radius, height);
            let mut needed: Vec<_> =
                points(&centre, edge, front).into_iter().chain(corners(&centre, edge)).collect();
            // The farthest points are the least likely to be in reach.
            let far = |p: &Vector3<f64>| (p - Vector3::z() * shoulder).norm_squared();
            needed.sort_by(|a, b| far(b).total_cmp(&far(a)));
            if needed.into_iter().all(|point| self.inverse.reaches(&point, attitudes, &mut scratch)) {
                fitting.push(centre);
            }
        }
        fitting
    }

    /// Returns the distance (m) by which the footprint of the robot base extends from the base axis in the
    /// direction `front`.
    fn robot_base(&self, front: (f64, f64)) -> f64 {
        let Rectangle { centre, size } = self.robot.footprint;
        let along = |v: (f64, f64)| front.0 * v.0 + front.1 * v.1;
        along(centre) + along((front.0 * size.0, front.1 * size.1)).abs() / 2.0
    }

    /// Returns the postures at the poses. Each posture is the branch nearest to the posture at the previous
    /// pose.
    fn postures(&self, points: &[Vector3<f64>; 5], attitudes: &ToolAttitudes) -> Option<[TestPose; 5]> {
        let mut before = self.robot.home;
        let mut poses = [TestPose { position: Vector3::zeros(), joints: before }; 5];
        for (pose, point) in poses.iter_mut().zip(points) {
            let Reach::Branches(branches) = self.inverse.branches(point, attitudes) else { return None };
            let usable = branches.iter().filter(|branch| branch.is_usable());
            let nearest = usable.min_by(|a, b| far(a, &before).total_cmp(&far(b, &before)))?;
            *pose = TestPose { position: *point, joints: nearest.joints };
            before = nearest.joints;
        }
        Some(poses)
    }
}

/// Returns the squared distance of a branch from joint coordinates, in mixed units (rad and m).
fn far(branch: &Branch, from: &JointVector) -> f64 {
    branch.joints.iter().zip(from).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Returns the poses P1 to P5 in the diagonal plane that rises away from the base axis.
fn points(centre: &Vector3<f64>, edge: f64, front: (f64, f64)) -> [Vector3<f64>; 5] {
    let outwards = Vector3::new(front.0, front.1, 1.0) * (OUTWARDS * edge / 2.0);
    let aside = Vector3::new(-front.1, front.0, 0.0) * (OUTWARDS * edge / 2.0);
    let [low, high] = [centre - outwards, centre + outwards];
    [*centre, high + aside, high - aside, low - aside, low + aside]
}

fn corners(centre: &Vector3<f64>, edge: f64) -> impl Iterator<Item = Vector3<f64>> {
    let signs = [-0.5, 0.5];
    let (centre, x) = (*centre, signs.into_iter());
    let xy = x.flat_map(move |x| signs.map(|y| (x, y)));
    xy.flat_map(move |(x, y)| signs.map(|z| centre + Vector3::new(x, y, z) * edge))
}

/// Returns the point nearest to the mean of the points.
fn middle(points: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let nearest = |a: &&Vector3<f64>, b: &&Vector3<f64>| (*a - mean).norm().total_cmp(&(*b - mean).norm());
    points.iter().min_by(nearest).copied()
}
