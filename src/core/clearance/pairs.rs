//! Pairs of solids that can collide while the robot moves with a given load.

use super::bounding_sphere::BoundingSphere;
use super::contact::{Hit, SolidRef};
use super::placed_solids::PlacedSolids;
use super::robot_solids::RobotSolid;
use super::scene::Scene;

/// Parts that the robot holds during a move.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Load {
    /// Index of each operation whose parts are held. The flag states whether these parts may touch the
    /// equipment of that operation.
    held: [Option<(usize, bool)>; 2],
}

/// Two solids that may collide. The robot moves at least one of the two.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Pair {
    /// First solid of the pair, as an index into [`Scene::bounding_spheres`].
    pub link: usize,
    pub(super) against: Against,
}

/// Second solid of a [`Pair`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Against {
    Floor,
    /// Index of a solid among the placed solids of a layout.
    Placed(usize),
    /// Index of another solid of the robot, which is nearer to the base than the first solid.
    Own(usize),
}

impl Load {
    /// Returns the load during an operation; the robot holds nothing if `operation` is None.
    pub fn of(operation: Option<usize>) -> Self {
        Self { held: [operation.map(|o| (o, true)), None] }
    }

    /// Returns the load while the robot moves from one operation to another: the held parts of both
    /// operations.
    ///
    /// Each argument is a pair: the index of an operation, and a flag. If the flag is true, the part of this
    /// operation is allowed to rest on the surface during the motion.
    pub fn between(from: (usize, bool), to: (usize, bool)) -> Self {
        Self { held: [Some(from), Some(to)] }
    }

    pub(super) fn has(&self, link: &RobotSolid) -> bool {
        link.operation.is_none_or(|o| self.held.iter().flatten().any(|h| h.0 == o))
    }

    pub(super) fn spares(&self, link: &RobotSolid, equipment: usize) -> bool {
        let rests = || self.held.iter().flatten().any(|h| Some(h.0) == link.operation && h.1);
        link.may_touch == Some(equipment) && rests()
    }
}

impl Pair {
    /// Returns the index of the second solid if it belongs to the robot; None for equipment, fence and floor.
    pub fn partner(&self) -> Option<usize> {
        if let Against::Own(other) = self.against { Some(other) } else { None }
    }
}

impl Scene {
    /// Returns the bounding spheres of all robot solids and all held parts.
    pub fn bounding_spheres(&self) -> &[BoundingSphere] {
        &self.bounding_spheres
    }

    /// Returns the first contact of the robot base with equipment or fence, if there is one. No posture can
    /// avoid this contact.
    pub fn base_hit(&self, placed: &PlacedSolids) -> Option<Hit> {
        placed.base_hit
    }

    /// Calls `visit` with every pair that can collide while the arm moves. There is no such pair if
    /// collisions are not checked.
    pub fn each_pair(&self, placed: &PlacedSolids, load: Load, mut visit: impl FnMut(Pair)) {
        if !self.enabled {
            return;
        }
        self.outer_pairs(placed, load).filter(|p| self.links[p.link].frame > 0).for_each(&mut visit);
        for (less, more) in self.self_pairs(load) {
            visit(Pair { link: more, against: Against::Own(less) });
        }
    }

    /// Returns the pairs of robot solids that must not touch while the robot moves with a given load. The
    /// solid nearer to the base comes first.
    pub(super) fn self_pairs(&self, load: Load) -> impl Iterator<Item = (usize, usize)> + '_ {
        let there = move |k: usize| load.has(&self.links[k]);
        let checked = self.checked.iter().copied().filter(move |(a, b)| there(*a) && there(*b));
        checked.map(|(a, b)| if self.links[a].frame < self.links[b].frame { (a, b) } else { (b, a) })
    }

    /// Returns the pairs of a robot solid with floor, equipment or fence.
    pub(super) fn outer_pairs<'s>(
        &'s self,
        placed: &'s PlacedSolids,
        load: Load,
    ) -> impl Iterator<Item = Pair> + 's {
        let links = self.links.iter().enumerate().filter(move |(_, l)| load.has(l) && !l.is_pedestal());
        links.flat_map(move |(k, link)| {
            let floor = (link.frame > 0).then_some(Pair { link: k, against: Against::Floor });
            let bodies = placed.bodies.iter().enumerate();
            let bodies = bodies.filter(move |(_, b)| !load.spares(link, b.id.0));
            bodies.map(move |(b, _)| Pair { link: k, against: Against::Placed(b) }).chain(floor)
        })
    }

    /// Returns the index of the equipment to which the second solid of a pair belongs.
    ///
    /// The index after the last piece of equipment denotes fence and keep-out boxes. None denotes the floor
    /// or the robot.
    pub fn equipment_of(&self, placed: &PlacedSolids, pair: Pair) -> Option<usize> {
        match pair.against {
            Against::Placed(k) => Some(placed.bodies[k].id.0),
            Against::Floor | Against::Own(_) => None,
        }
    }

    /// Returns the two solids of a pair as a contact.
    pub fn hit_of(&self, placed: &PlacedSolids, pair: Pair) -> Hit {
        let other = match pair.against {
            Against::Floor => SolidRef::Floor,
            Against::Placed(k) => self.name(placed.bodies[k].id),
            Against::Own(other) => self.links[other].id,
        };
        Hit { solid: self.links[pair.link].id, other }
    }
}
