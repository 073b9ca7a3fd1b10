//! Keys of the senses that a cell defines.

use super::key::*;
use super::parts::*;
use crate::cell::{Frame, PLAIN};

/// Keys that say which component of the error a term measures.
pub const WAYS: [&str; 4] = ["of", "direction", "plane", "axis"];

/// Keys that define a sense: the keys of one term, or `term`, a list of terms.
pub const WAYS_OF_SENSE: [&str; 5] = ["of", "direction", "plane", "axis", "term"];

fn plain() -> Vec<String> {
    PLAIN.map(String::from).to_vec()
}

fn lengths() -> Vec<String> {
    PLAIN.into_iter().filter(|word| !word.starts_with('r')).map(String::from).collect()
}

key_table! {
    /// Keys that terms and senses have in common.
    any_term, "a term", "Error component that is assessed.", {
        OF = Key::new("of", ValueKind::Word(plain), "Error along or about axes of the frame.").example("\"xy\"");
        DIRECTION = direction("direction", "Error along this vector.");
        PLANE = direction("plane", "Error in the plane perpendicular to this vector.");
        AXIS = direction("axis", "Rotation about this vector.");
        WEIGHT = number("weight", NumberRange::Positive, "Weight of the term.").default(Literal::Number(1.0));
        LEVER = number("mm_per_deg", NumberRange::Positive, "Length in mm that counts as much as one degree of rotation. A sense can thus combine rotations with lengths.").example("2");
    }
    rules [
        Rule::OneAtMost(&WAYS),
        Rule::When { key: "of", words: lengths, needs: &[], never: &["mm_per_deg"] },
        Rule::Excludes("mm_per_deg", &["weight", "direction", "plane"]),
    ];
}

key_table! {
    term, "a term", "Term of a sense.", {}
    extends super::any_term::TABLE;
    rules [Rule::AnyOf(&WAYS)];
}

key_table! {
    sense, "a sense", "Sense: the error component that is assessed.", {
        FRAME = word::<Frame>("frame", "Frame of the directions.").default(Literal::Word(Frame::World.name()));
        POINT = vector_or_zero("point_mm", "Point whose error is measured. The coordinates are relative to the TCP, in the axes of the tool frame.");
        TERM = Key::new("term", ValueKind::List(&ValueKind::Table(&term::TABLE), (1, UNBOUNDED), "terms"), "Terms that together make one sense.").example("[{ of = \"xy\" }, { of = \"rz\", mm_per_deg = 1 }]");
    }
    extends super::any_term::TABLE;
    rules [
        Rule::AnyOf(&WAYS_OF_SENSE),
        Rule::Excludes("term", &["of", "direction", "plane", "axis", "weight", "mm_per_deg"]),
    ];
}
