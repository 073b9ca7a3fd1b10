//! Constructors of keys, and keys that several tables share.

use super::key::*;
use serde_json::{Value, json};

/// Declares a table of keys as a module: a constant for each key, and `TABLE` with all keys.
macro_rules! key_table {
    ($(#[$doc:meta])* $name:ident, $what:literal, $help:literal,
     { $($key:ident = $entry:expr;)* } $(extends $base:path;)? $(rules $rules:expr;)? $(refused $refused:expr;)?
    ) => {
        $(#[$doc])*
        pub mod $name {
            #[allow(unused_imports)]
            use super::*;
            $(pub const $key: Key = $entry;)*
            pub const TABLE: KeyTable =
                KeyTable::new($what, $help, &[$($key),*])$(.extends(&$base))?$(.rules(&$rules))?$(.refused(&$refused))?;
        }
    };
}
pub(crate) use key_table;

/// Coordinate that may have any value that a file may contain.
const ANYWHERE: ValueKind = ValueKind::Coordinate(-LARGEST, LARGEST);

pub const FINITE: ValueKind = ValueKind::Number(NumberRange::Finite);
pub const POSITIVE: ValueKind = ValueKind::Number(NumberRange::Positive);
pub const VECTOR: ValueKind = ValueKind::List(&FINITE, (3, 3), "numbers");
pub const SIZES: ValueKind = ValueKind::List(&POSITIVE, (3, 3), "numbers");
pub const PLAN: ValueKind = ValueKind::List(&FINITE, (2, 2), "numbers");
pub const PLAN_SIZES: ValueKind = ValueKind::List(&POSITIVE, (2, 2), "numbers");

pub const fn number(name: &'static str, range: NumberRange, help: &'static str) -> Key {
    Key::new(name, ValueKind::Number(range), help)
}

/// Returns the key of a number that defaults to 0.
pub const fn number_or_zero(name: &'static str, range: NumberRange, help: &'static str) -> Key {
    number(name, range, help).default(Literal::Number(0.0))
}

pub const fn vector(name: &'static str, help: &'static str) -> Key {
    Key::new(name, VECTOR, help)
}

/// Returns the key of a vector that defaults to 0.
pub const fn vector_or_zero(name: &'static str, help: &'static str) -> Key {
    vector(name, help).default(Literal::Zeros(3))
}

/// Returns the key of a direction: a vector that is not 0.
pub const fn direction(name: &'static str, help: &'static str) -> Key {
    Key::new(name, ValueKind::Checked(&VECTOR, not_zero), help).example("[0, 0, 1]")
}

fn not_zero() -> Value {
    json!({ "not": { "enum": [[0, 0, 0]] } })
}

/// Returns the JSON Schema of a list without repetition.
pub fn unique() -> Value {
    json!({ "uniqueItems": true })
}

pub const fn coordinate(name: &'static str, help: &'static str) -> Key {
    Key::new(name, ANYWHERE, help)
}

pub const fn text(name: &'static str, help: &'static str) -> Key {
    Key::new(name, ValueKind::Text, help)
}

pub const fn boolean(name: &'static str, default: bool, help: &'static str) -> Key {
    Key::new(name, ValueKind::Boolean, help).default(Literal::Boolean(default))
}

pub const fn table(name: &'static str, of: &'static KeyTable, help: &'static str) -> Key {
    Key::new(name, ValueKind::Table(of), help)
}

pub const fn word<W: Word>(name: &'static str, help: &'static str) -> Key {
    Key::new(name, ValueKind::word::<W>(), help)
}

/// Returns the key `from`, which names the file from which a table takes the keys that it lacks.
pub const fn from(example: &'static str) -> Key {
    let help = "File that supplies the keys left out here; a list given here replaces the list of that file.";
    Key::new("from", ValueKind::Path, help).example(example)
}

/// Returns the key `schema`, which states the kind of the file.
pub const fn schema(name: &'static str) -> Key {
    Key::new("schema", ValueKind::Exactly(name), "Kind of the file, and version of its format.")
        .default(Literal::Word(name))
}

key_table! {
    units, "`units`", "Units of all numbers of the file.", {
        LENGTH = Key::new("length", ValueKind::Exactly("mm"), "Unit of lengths.").required();
        ANGLE = Key::new("angle", ValueKind::Exactly("deg"), "Unit of angles.").required();
    }
}

/// Key `units` of a file.
pub const UNITS: Key = table("units", &units::TABLE, "Units of all numbers of the file.")
    .example("{ length = \"mm\", angle = \"deg\" }");

pub const SOURCE: Key = text("source", "Source of the numbers.").example("\"data sheet, revision 3\"");

/// Key of the orientation of a frame or solid.
pub const RPY: Key = vector_or_zero(
    "rpy_deg",
    "Orientation: rotations about the fixed x, y and z axes, in this order (roll, pitch, yaw).",
);

key_table! {
    placement, "`placement`", "Placement: x, y, z and the rotation about z.", {
        X = coordinate("x_mm", "Position along x. A number fixes the position. A search chooses the position within a range { min, max, start }, or from a list of allowed values.").required().remedy("add x_mm = 0, or { min = -500, max = 500 } to let a search choose it");
        Y = coordinate("y_mm", "Position along y. A number fixes the position. A search chooses the position within a range { min, max, start }, or from a list of allowed values.").required().remedy("add y_mm = 0, or { min = -500, max = 500 } to let a search choose it");
        Z = coordinate("z_mm", "Position along z. A number fixes the position. A search chooses the position within a range { min, max, start }, or from a list of allowed values.").required().remedy("add z_mm = 0, or { min = -500, max = 500 } to let a search choose it");
        YAW = coordinate("yaw_deg", "Rotation about z. A number fixes the rotation. A search chooses the rotation within a range { min, max, start }, or from a list of allowed values.").default(Literal::Number(0.0));
    }
}

key_table! {
    range, "a range", "Range in which a search chooses the value.", {
        MIN = number("min", NumberRange::Finite, "Low end, in the unit of the key.").required();
        MAX = number("max", NumberRange::Finite, "High end, in the unit of the key.").required();
        START = number("start", NumberRange::Finite, "Value in the layout before a search; if left out, the middle of the range.");
    }
}

key_table! {
    placement_tolerance, "a placement tolerance", "Tolerance of a placement.", {
        X = number_or_zero("x_mm", NumberRange::UpTo(500.0), "Plus-or-minus value of x.");
        Y = number_or_zero("y_mm", NumberRange::UpTo(500.0), "Plus-or-minus value of y.");
        Z = number_or_zero("z_mm", NumberRange::UpTo(500.0), "Plus-or-minus value of z.");
        YAW = number_or_zero("yaw_deg", NumberRange::UpTo(45.0), "Plus-or-minus value of the rotation about z.");
    }
}
