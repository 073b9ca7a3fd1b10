//! Title block of the drawings of a cell (ISO 7200).

/// Entries of the title block; an entry that the cell file leaves out is None.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct TitleBlock {
    /// Legal owner of the drawing.
    pub owner: Option<String>,
    /// Title of the drawing; the name of the cell replaces a missing title.
    pub title: Option<String>,
    pub number: Option<String>,
    pub revision: Option<String>,
    /// Date of issue.
    pub date: Option<String>,
    pub author: Option<String>,
    pub approved_by: Option<String>,
    /// General tolerance, which applies to dimensions without an individual tolerance.
    pub general_tolerance: Option<String>,
    pub projection: Projection,
}

/// Projection method of ISO 5456-2, which determines whether the plan is above or below the front view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Projection {
    /// First-angle projection: the plan is below the front view.
    #[default]
    FirstAngle,
    /// Third-angle projection: the plan is above the front view.
    ThirdAngle,
}

impl Projection {
    /// All projection methods.
    pub const ALL: [Projection; 2] = [Projection::FirstAngle, Projection::ThirdAngle];

    /// Returns the name of this projection method as it appears in files, for example `first-angle`.
    pub const fn name(self) -> &'static str {
        match self {
            Projection::FirstAngle => "first-angle",
            Projection::ThirdAngle => "third-angle",
        }
    }
}
