//! stub
use super::Shot;
use crate::drawing::Drawing;
/// stub
pub fn isometric(_d: &Drawing<'_>, _s: &Shot) -> Result<String, String> {
    Ok(String::new())
}
