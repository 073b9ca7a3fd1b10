//! Tree of links, and the chain through it from base to tip.

use super::model::*;
use crate::files::fault::{did_you_mean, listed, shown};
use crate::files::toml::document::Library;
use crate::files::toml::tree::At;
use std::collections::HashMap;

/// Tree of links: indices of the joints above and below each link.
pub struct Tree<'u> {
    urdf: &'u Urdf,
    links: HashMap<&'u str, usize>,
    /// For every link, the index of the joint whose child is this link; None for a link without a parent
    /// joint.
    above: Vec<Option<usize>>,
    /// For every link, the indices of the joints whose parent is this link.
    pub below: Vec<Vec<usize>>,
}

/// Chain of links from base to tip.
pub struct LinkChain {
    pub base: usize,
    pub tip: usize,
    pub joints: Vec<usize>,
}

impl<'u> Tree<'u> {
    /// Builds the tree. Returns None and records faults for unknown links, links with two parents and loops.
    pub fn new(urdf: &'u Urdf, lib: &mut Library<'_>) -> Option<Self> {
        let links: HashMap<_, _> = urdf.links.iter().enumerate().map(|(i, l)| (&*l.name.name, i)).collect();
        let none = vec![None; urdf.links.len()];
        let mut tree = Self { urdf, links, above: none, below: vec![Vec::new(); urdf.links.len()] };
        let before = lib.errors();
        if urdf.links.is_empty() {
            lib.error(urdf.at, "the robot has no link".into(), "add its <link> and <joint> elements");
        }
        for (j, joint) in urdf.joints.iter().enumerate() {
            let (parent, child) = (tree.link(&joint.parent, lib), tree.link(&joint.child, lib));
            let (Some(parent), Some(child)) = (parent, child) else { continue };
            tree.below[parent].push(j);
            if let Some(other) = tree.above[child].replace(j) {
                let names = (shown(&joint.child.name), shown(&urdf.joints[other].name.name));
                let message = format!("link `{}` is already the child of joint `{}`", names.0, names.1);
                lib.error(
                    joint.child.at,
                    message,
                    "a link can have only one parent joint: a closed loop cannot be read",
                );
            }
        }
        if lib.errors() == before {
            tree.refuse_circles(lib);
        }
        (lib.errors() == before).then_some(tree)
    }

    /// Returns the index of the link with this name; records a fault if there is no such link.
    pub fn link(&self, name: &Named, lib: &mut Library<'_>) -> Option<usize> {
        let found = self.links.get(&*name.name).copied();
        if found.is_none() {
            let names = || self.urdf.links.iter().map(|l| &*l.name.name);
            let help = match did_you_mean(&name.name, names()) {
                Some(near) => format!("did you mean `{}`?", shown(near)),
                None => format!("the links are: {}", listed(names())),
            };
            lib.error(name.at, format!("there is no link `{}`", shown(&name.name)), help);
        }
        found
    }

    /// Returns the index of the child link of a joint.
    pub fn child(&self, joint: usize) -> Option<usize> {
        self.links.get(&*self.urdf.joints[joint].child.name).copied()
    }

    /// Returns the index of the joint above a link, and the index of the parent link; None for a root.
    pub fn joint_above(&self, link: usize) -> Option<(usize, usize)> {
        Some((self.above[link]?, self.parent(link)?))
    }

    fn parent(&self, link: usize) -> Option<usize> {
        let joint = self.above[link]?;
        self.links.get(&*self.urdf.joints[joint].parent.name).copied()
    }

    /// Records a fault for every loop of links, once per loop.
    fn refuse_circles(&self, lib: &mut Library<'_>) {
        let mut walk = vec![0; self.above.len()];
        for start in 0..self.above.len() {
            let mut link = Some(start);
            while let Some(l) = link.filter(|&l| walk[l] == 0) {
                walk[l] = start + 1;
                link = self.parent(l);
            }
            let Some(again) = link.filter(|&l| walk[l] == start + 1) else { continue };
            let Some(joint) = self.above[again].map(|j| &self.urdf.joints[j]) else { continue };
            let message = format!("link `{}` is its own ancestor", shown(&joint.child.name));
            lib.error(joint.name.at, message, "follow its parent joints and break the loop");
        }
    }

    /// Returns the chain from the base link to the tip link.
    ///
    /// If the robot file names no base link, `base` is None and stands for the root of the tree. If the robot
    /// file names no tip link, `tip` is None and stands for the only leaf below the base. Some(None) stands
    /// for a name that no link has. `at` is the place where the robot file names the URDF.
    pub fn way(
        &self,
        base: Option<Option<usize>>,
        tip: Option<Option<usize>>,
        at: At,
        lib: &mut Library<'_>,
    ) -> Option<LinkChain> {
        let base = base.unwrap_or_else(|| self.root(at, lib));
        let tip = tip.unwrap_or_else(|| self.leaf(base?, at, lib));
        let (base, tip) = (base?, tip?);
        let mut joints = Vec::new();
        let mut link = tip;
        while link != base {
            let (Some(joint), Some(parent)) = (self.above[link], self.parent(link)) else {
                let name = |l: usize| shown(&self.urdf.links[l].name.name);
                let message =
                    format!("tip_link `{}` is not a descendant of base_link `{}`", name(tip), name(base));
                lib.error(at, message, "name two links of one chain, the base first");
                return None;
            };
            joints.push(joint);
            link = parent;
        }
        joints.reverse();
        Some(LinkChain { base, tip, joints })
    }

    /// Returns the only link without a parent joint; records a fault if there are several.
    pub fn root(&self, at: At, lib: &mut Library<'_>) -> Option<usize> {
        let roots: Vec<_> = (0..self.above.len()).filter(|&l| self.above[l].is_none()).collect();
        self.single(&roots, "links without a parent joint", "base_link", at, lib)
    }

    fn leaf(&self, base: usize, at: At, lib: &mut Library<'_>) -> Option<usize> {
        let (mut open, mut leaves) = (vec![base], Vec::new());
        while let Some(link) = open.pop() {
            let children = self.below[link].iter();
            open.extend(children.rev().filter_map(|&j| self.links.get(&*self.urdf.joints[j].child.name)));
            if self.below[link].is_empty() {
                leaves.push(link);
            }
        }
        self.single(&leaves, "links at the end of a chain", "tip_link", at, lib)
    }

    fn single(&self, found: &[usize], what: &str, key: &str, at: At, lib: &mut Library<'_>) -> Option<usize> {
        if let [one] = found {
            return Some(*one);
        }
        let names = listed(found.iter().map(|&l| &*self.urdf.links[l].name.name));
        let message = format!("the URDF has {} {what}", found.len());
        lib.error(at, message, format!("choose one of them with {key} = \"...\": {names}"));
        None
    }
}
