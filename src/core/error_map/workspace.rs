//! Memory that one thread keeps from layout to layout, so that the node loop allocates no memory.

use super::candidate::PostureCandidate;
use super::family_queue::SpinFamily;
use super::mapper::Mapper;
use super::node_ranking::NodeRanking;
use super::operation_setup::ValueScratch;
use crate::allocation::FigureScratch;
use crate::cell::JointVector;
use crate::clearance::ContactMemory;
use crate::motion::LineEnds;
use crate::reach::ToolAttitudes;
use crate::robot::{Frames, Posture};

/// Memory of the search for spots, kept from layout to layout.
#[derive(Default)]
pub struct MapperWorkspace {
    pub(super) candidates: Vec<PostureCandidate>,
    pub(super) families: Vec<SpinFamily>,
    pub(super) attitudes: ToolAttitudes,
    pub(super) ranking: NodeRanking,
    /// Memory for the joint price of all operations.
    pub(super) price: FigureScratch,
    /// Memory of each operation.
    postures: Vec<PostureMemory>,
}

/// Work that the search for spots has done with the memory of a thread.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct WalkCounts {
    /// Number of nodes at which the inverse kinematics was solved.
    pub nodes: u64,
    /// Number of postures for which a value or a lower bound was computed. A bound that holds for all members
    /// of a spin family counts once.
    pub postures: u64,
    /// Number of postures that were checked for contact.
    pub contacts: u64,
}

impl std::iter::Sum for WalkCounts {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |a, b| Self {
            nodes: a.nodes + b.nodes,
            postures: a.postures + b.postures,
            contacts: a.contacts + b.contacts,
        })
    }
}

/// Memory for judging the postures of one operation.
pub struct PostureMemory {
    pub scratch: ValueScratch,
    pub frames: Frames,
    pub contacts: ContactMemory,
    pub counts: WalkCounts,
    /// Ends of the approach and retract lines of the usable postures found since the memory was last lent.
    pub lines: Vec<LineEnds>,
    /// Buffer into which the inverse kinematics writes a posture.
    pub posture: Posture,
    /// First members of the spin families found so far ([`super::candidate::PostureCandidate::first`]).
    pub firsts: Vec<Posture>,
    /// Buffer for the spin families of one node.
    pub opened: Vec<SpinFamily>,
    /// Spin families of all nodes of an operation that happens at every node.
    pub collected: Vec<SpinFamily>,
    /// Buffer for the members of a spin family: branch indices and postures.
    pub members: Vec<(u64, Posture)>,
}

impl PostureMemory {
    /// Creates the memory of one operation.
    pub fn new(mapper: &Mapper, operation: usize) -> Self {
        Self {
            scratch: ValueScratch {
                evaluator: mapper.evaluator(operation).memory(),
                figure: FigureScratch::default(),
            },
            frames: Frames::default(),
            contacts: ContactMemory::default(),
            counts: WalkCounts::default(),
            lines: Vec::new(),
            posture: mapper.inverse().scratch(),
            firsts: Vec::new(),
            opened: Vec::new(),
            collected: Vec::new(),
            members: Vec::new(),
        }
    }
}

/// Parts of a workspace that the walk of one operation borrows.
pub struct WalkMemory<'w> {
    pub candidates: &'w mut Vec<PostureCandidate>,
    pub families: &'w mut Vec<SpinFamily>,
    pub ranking: &'w mut NodeRanking,
    pub postures: &'w mut PostureMemory,
}

impl MapperWorkspace {
    /// Returns the work done so far.
    pub fn counts(&self) -> WalkCounts {
        self.postures.iter().map(|memory| memory.counts).sum()
    }

    /// Returns the ends of the approach and retract lines at a posture; None if they are not known.
    pub(super) fn line_ends(&self, operation: usize, joints: &JointVector) -> Option<LineEnds> {
        self.postures.get(operation)?.lines.iter().find(|ends| ends.spot == *joints).copied()
    }

    /// Lends the memory of one operation. Missing memory is created first.
    pub(super) fn of(&mut self, mapper: &Mapper, operation: usize) -> WalkMemory<'_> {
        for missing in self.postures.len()..=operation {
            self.postures.push(PostureMemory::new(mapper, missing));
        }
        let Self { candidates, families, ranking, postures, .. } = self;
        let postures = &mut postures[operation];
        postures.posture = mapper.inverse().scratch();
        postures.lines.clear();
        WalkMemory { candidates, families, ranking, postures }
    }
}
