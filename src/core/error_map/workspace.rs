//! Memory that one thread keeps from layout to layout, so that the node loop allocates no memory.

use super::candidate::PostureCandidate;
use super::family_queue::SpinFamily;
use super::mapper::Mapper;
use super::operation_setup::ValueScratch;
use super::simd::Ranking;
use crate::allocation::FigureScratch;
use crate::clearance::ContactMemory;
use crate::reach::ToolAttitudes;
use crate::robot::{Frames, Posture};

/// Memory of the search for spots, kept from layout to layout.
#[derive(Default)]
pub struct MapperWorkspace {
    pub(super) candidates: Vec<PostureCandidate>,
    pub(super) families: Vec<SpinFamily>,
    pub(super) attitudes: ToolAttitudes,
    pub(super) ranking: Ranking,
    /// Memory for the joint price of all operations.
    pub(super) price: FigureScratch,
    /// Memory of each operation.
    postures: Vec<PostureMemory>,
}

/// Memory for judging the postures of one operation.
pub struct PostureMemory {
    pub scratch: ValueScratch,
    pub frames: Frames,
    pub contacts: ContactMemory,
    /// Buffer into which the inverse kinematics writes a posture.
    pub posture: Posture,
    /// First members of the spin families found so far ([`super::candidate::PostureCandidate::first`]).
    pub firsts: Vec<Posture>,
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
            posture: mapper.inverse().scratch(),
            firsts: Vec::new(),
            members: Vec::new(),
        }
    }
}

/// Parts of a workspace that the walk of one operation borrows.
pub struct WalkMemory<'w> {
    pub candidates: &'w mut Vec<PostureCandidate>,
    pub families: &'w mut Vec<SpinFamily>,
    pub ranking: &'w mut Ranking,
    pub postures: &'w mut PostureMemory,
}

impl MapperWorkspace {
    /// Lends the memory of one operation. Missing memory is created first.
    pub(super) fn of(&mut self, mapper: &Mapper, operation: usize) -> WalkMemory<'_> {
        for missing in self.postures.len()..=operation {
            self.postures.push(PostureMemory::new(mapper, missing));
        }
        let Self { candidates, families, ranking, postures, .. } = self;
        let postures = &mut postures[operation];
        postures.posture = mapper.inverse().scratch();
        WalkMemory { candidates, families, ranking, postures }
    }
}
