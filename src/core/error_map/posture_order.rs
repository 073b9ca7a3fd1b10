//! Order in which a search judges the postures of an operation.

use super::mapper::Mapper;
use crate::cell::Attitude;
use crate::reach::{Cost, ToolAttitudes};

/// Order in which the search for the spot of an operation judges postures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PostureOrder {
    /// Nodes in ascending order of a lower bound of their error. The search ends when this bound exceeds the
    /// best value found.
    RankedNodes,
    /// Spin families (postures that differ in the last joint alone) in ascending order of a lower bound of
    /// their error. The search ends when this bound exceeds the best value found.
    SpinFamilies,
    /// Postures in ascending order of a lower bound of their value. The search ends when this bound exceeds
    /// the best value found.
    BoundedPostures,
    /// Every posture, because the search uses no lower bound. The text states why the search cannot use spin
    /// families.
    EveryPosture(&'static str),
}

impl PostureOrder {
    /// Returns the name of this order as it appears in documents, for example `ranked-nodes`.
    pub fn name(&self) -> &'static str {
        match self {
            Self::RankedNodes => "ranked-nodes",
            Self::SpinFamilies => "spin-families",
            Self::BoundedPostures => "bounded-postures",
            Self::EveryPosture(_) => "every-posture",
        }
    }

    /// Describes the order in words, as a verb phrase such as "judges every posture".
    pub fn in_words(&self) -> String {
        match self {
            Self::RankedNodes => "skips nodes whose lower bound exceeds the best value found".into(),
            Self::SpinFamilies => "skips spin families whose lower bound exceeds the best value found".into(),
            Self::BoundedPostures => "skips postures whose lower bound exceeds the best value found".into(),
            Self::EveryPosture(why) => format!("judges every posture: {why}"),
        }
    }

    /// Returns the reason why every posture is judged; None if bounds exclude postures.
    pub fn reason(&self) -> Option<&'static str> {
        match self {
            Self::EveryPosture(why) => Some(why),
            Self::RankedNodes | Self::SpinFamilies | Self::BoundedPostures => None,
        }
    }
}

impl Mapper {
    /// Returns the order in which a search judges the postures of an operation. The operation requires the
    /// attitude `attitude`.
    pub fn posture_order(&self, operation: usize, attitude: &Attitude) -> PostureOrder {
        let attitudes = self.arm.inverse.tool_attitudes(attitude, 0.0);
        let ranker =
            self.rankers[operation].as_ref().filter(|_| !self.setups[operation].over.needs_every_node());
        if ranker.is_some_and(|ranker| ranker.takes(&attitudes)) {
            return PostureOrder::RankedNodes;
        }
        match self.lacks_families(operation, &attitudes) {
            None => PostureOrder::SpinFamilies,
            Some(_) if self.has_bounds(operation) => PostureOrder::BoundedPostures,
            Some(why) => PostureOrder::EveryPosture(why),
        }
    }

    /// Returns whether a search may use lower bounds for the values of the postures of an operation. Such a
    /// bound takes much less time to compute than the value.
    pub(super) fn has_bounds(&self, operation: usize) -> bool {
        let setup = &self.setups[operation];
        setup.is_priced || self.ranks && setup.has_bounds()
    }

    /// Returns the reason why a search cannot use the spin families of an operation; None if the search can
    /// use the families.
    pub(super) fn lacks_families(&self, operation: usize, attitudes: &ToolAttitudes) -> Option<&'static str> {
        if !self.ranks {
            Some("the use of lower bounds is switched off")
        } else if self.setups[operation].is_priced {
            Some("no lower bound of the cost of tolerances is known for a spin family")
        } else if self.arm.inverse.cost() == Cost::Numeric {
            Some("the inverse kinematics of the arm is numeric")
        } else if !self.arm.inverse.has_spin_families(attitudes) {
            Some("the postures at a target do not form families in which only the last joint differs")
        } else if !self.setups[operation].evaluator.has_spin_bound() {
            Some("no lower bound of the error is known for a spin family under this reading and sense")
        } else {
            None
        }
    }
}
