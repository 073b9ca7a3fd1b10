//! Glyphs that mark unusable nodes: one table for all pictures.
//!
//! Pictures made in Rust use the table directly. The JavaScript of the viewer and of the live page gets the
//! table as JSON.

use crate::error_map::NodeSign;

/// Style of the circle round a node.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GlyphRing {
    None,
    Full,
    Dashed,
}

/// Severity of a glyph. Each kind of picture has its own colour for each severity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GlyphTone {
    /// No posture for the node was found, or the error at the node cannot be computed.
    Quiet,
    /// The posture is nearly singular.
    Warning,
    /// The posture collides, or the approach to the node or the retract from it is blocked.
    Alarm,
}

impl GlyphTone {
    /// Returns the name of the CSS class that sets the colour of the glyph.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quiet => "grey",
            Self::Warning => "orange",
            Self::Alarm => "red",
        }
    }
}

/// Open polyline of a glyph, with x to the right and y down. The unit is the radius of the circle round a
/// node.
pub type GlyphStroke = &'static [(f64, f64)];

/// Glyph that marks an unusable node: a circle and strokes of one colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeGlyph {
    pub ring: GlyphRing,
    pub strokes: &'static [GlyphStroke],
    pub tone: GlyphTone,
}

/// Absolute value of x and y of the points at 45 degrees on the circle round a node. The unit is the radius
/// of this circle.
const C: f64 = std::f64::consts::FRAC_1_SQRT_2;

const RISING: GlyphStroke = &[(-C, C), (C, -C)];
const FALLING: GlyphStroke = &[(-C, -C), (C, C)];
const LEVEL: GlyphStroke = &[(-C, 0.0), (C, 0.0)];
const UPRIGHT: GlyphStroke = &[(0.0, -C), (0.0, C)];
const SQUARE: GlyphStroke = &[(-C, -C), (C, -C), (C, C), (-C, C), (-C, -C)];
const DOWN: GlyphStroke = &[(-C, -0.6 * C), (0.0, 0.7 * C), (C, -0.6 * C)];
const UP: GlyphStroke = &[(-C, 0.6 * C), (0.0, -0.7 * C), (C, 0.6 * C)];

/// Returns the glyph for a class of nodes.
///
/// Returns None for a usable node, which is drawn as a dot in the colour of its error.
pub fn node_glyph(sign: NodeSign) -> Option<NodeGlyph> {
    let glyph = |ring, strokes, tone| Some(NodeGlyph { ring, strokes, tone });
    match sign {
        NodeSign::Usable => None,
        NodeSign::OutOfReach => glyph(GlyphRing::Full, &[], GlyphTone::Quiet),
        NodeSign::JointLimit => glyph(GlyphRing::Dashed, &[], GlyphTone::Quiet),
        NodeSign::Attitude => glyph(GlyphRing::Full, &[RISING], GlyphTone::Quiet),
        NodeSign::NotConverged => glyph(GlyphRing::None, &[SQUARE], GlyphTone::Quiet),
        NodeSign::Collision => glyph(GlyphRing::None, &[FALLING, RISING], GlyphTone::Alarm),
        NodeSign::Singular => glyph(GlyphRing::None, &[LEVEL, UPRIGHT], GlyphTone::Warning),
        NodeSign::ApproachBlocked => glyph(GlyphRing::None, &[DOWN], GlyphTone::Alarm),
        NodeSign::RetractBlocked => glyph(GlyphRing::None, &[UP], GlyphTone::Alarm),
        NodeSign::Unjudged => glyph(GlyphRing::None, &[LEVEL], GlyphTone::Quiet),
    }
}
