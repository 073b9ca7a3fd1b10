//! The cell on paper.
use crate::drawing::Drawing;
pub fn sheet(_d: &Drawing<'_>, _o: Option<usize>) -> String {
    String::new()
}
