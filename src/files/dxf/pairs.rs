//! Group codes of a DXF file with their values: two lines each.

use super::DxfFault;
use crate::files::fault::shown;

/// Largest number of group codes of a drawing.
const MAX_PAIRS: usize = 4_000_000;

/// Largest absolute value of a number in a drawing, in the unit of the drawing. No workcell needs a larger
/// number in any unit.
const MAX_NUMBER: f64 = 1e9;

const DAMAGED: &str = "save the drawing again as DXF (ASCII) in the CAD program";

/// Group code with its value, and the line of the value, counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GroupCode<'t> {
    pub code: i32,
    pub value: &'t str,
    pub line: usize,
}

impl GroupCode<'_> {
    /// Returns whether the pair has group code 0 and this name. Such a pair begins or ends an entity or a
    /// section.
    pub fn begins(&self, name: &str) -> bool {
        self.code == 0 && self.value == name
    }

    /// Returns the value as a number; fails if the value is not a number or exceeds [`MAX_NUMBER`].
    pub fn number(&self) -> Result<f64, DxfFault> {
        let number = self.value.parse::<f64>().ok().filter(|v| v.abs() <= MAX_NUMBER);
        number.ok_or_else(|| {
            let message = format!(
                "the value of group code {} must be a number, not `{}`",
                self.code,
                shown(self.value)
            );
            DxfFault::new(self.line, message, DAMAGED)
        })
    }

    /// Returns the value as a whole number; fails if the value is not a whole number.
    pub fn whole(&self) -> Result<i64, DxfFault> {
        self.value.parse().map_err(|_| {
            let message = format!(
                "the value of group code {} must be a whole number, not `{}`",
                self.code,
                shown(self.value)
            );
            DxfFault::new(self.line, message, DAMAGED)
        })
    }
}

/// Returns the group codes of a drawing up to EOF, without comments.
pub fn pairs(text: &str) -> Result<Vec<GroupCode<'_>>, DxfFault> {
    let mut lines = text.lines().map(str::trim).enumerate();
    let mut all = Vec::new();
    while let Some((at, code)) = lines.next() {
        let code: i32 = code.parse().map_err(|_| {
            DxfFault::new(at, format!("a group code is a whole number, not `{}`", shown(code)), DAMAGED)
        })?;
        let Some((line, value)) = lines.next() else {
            return Err(DxfFault::new(at, "the drawing is cut off after a group code", DAMAGED));
        };
        let pair = GroupCode { code, value, line };
        if pair.begins("EOF") {
            return Ok(all);
        }
        if all.len() == MAX_PAIRS {
            let help = "delete what the plan does not need";
            return Err(DxfFault::new(
                at,
                format!("the drawing has more than {MAX_PAIRS} group codes"),
                help,
            ));
        }
        if code != 999 {
            all.push(pair);
        }
    }
    let last = text.lines().count().saturating_sub(1);
    Err(DxfFault::new(last, "the drawing is cut off: it does not end with EOF", DAMAGED))
}
