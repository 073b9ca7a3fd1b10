//! Keys of `[title_block]`.

use super::key::*;
use super::parts::*;
use crate::cell::Projection;

words!(Projection);

const fn entry(name: &'static str, help: &'static str) -> Key {
    Key::new(name, ValueKind::Name, help)
}

key_table! {
    title_block, "a title block", "Title block of the drawings (ISO 7200).", {
        OWNER = entry("owner", "Legal owner of the drawing: the company.").example("\"Example Automation Ltd\"");
        TITLE = entry("title", "Title of the drawing; if left out, the name of the cell.").example("\"Assembly cell 3\"");
        NUMBER = entry("number", "Identification number of the drawing.").example("\"L-0417\"");
        REVISION = entry("revision", "Revision of the drawing.").example("\"B\"");
        DATE = entry("date", "Date of issue.").example("\"2026-11-26\"");
        AUTHOR = entry("author", "Person who made the drawing.").example("\"A. Author\"");
        APPROVED_BY = entry("approved_by", "Person who approves the drawing; if left out, the field stays empty for a signature.").example("\"B. Engineer\"");
        GENERAL_TOLERANCE = entry("general_tolerance", "General tolerance of the dimensions without an individual tolerance.").example("\"ISO 2768-c\"");
        PROJECTION = word::<Projection>("projection", "Projection method of ISO 5456-2: the plan view is below the front view (first-angle) or above it (third-angle).").default(Literal::Word(Projection::FirstAngle.name()));
    }
}
