//! Documents that only the pages of sweetspot use: the drawings of the 3-D viewer and the state of the live
//! page.
//!
//! The types of the documents for other programs are in [`crate::record`].

mod drawing;
mod live;
mod live_records;
mod viewer_records;

pub use drawing::drawings;
pub use live::{answer, form, lens_list, numbers, value};
pub use live_records::{
    LiveLayoutTrial, LivePulse, LiveQuestion, LiveReach, LiveRefusal, LiveRegions, LiveSaved, LiveSearch,
    LiveStanding, LiveState, LiveStep,
};
