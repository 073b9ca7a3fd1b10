//! International tolerance grades of ISO 286-1 for linear sizes up to 3150 mm: IT4 to IT14.
//!
//! The table holds the rounded values of the standard. The standard derives these values from a standard
//! tolerance factor in um, with the nominal size D in mm. The factor is `i = 0.45 D^(1/3) + 0.001 D` up to
//! 500 mm, and `I = 0.004 D + 2.1` above 500 mm.

use crate::units::m_from_mm;

/// First grade of the table.
pub const FIRST_IT_GRADE: usize = 4;
/// Last grade of the table.
pub const LAST_IT_GRADE: usize = 14;
/// Largest nominal size of the table, mm.
pub const MAX_NOMINAL_MM: f64 = 3150.0;

const GRADES: usize = LAST_IT_GRADE - FIRST_IT_GRADE + 1;

/// Largest nominal size of each row, mm, and the tolerances IT4 to IT14 of the row, um.
#[rustfmt::skip]
const TABLE: [(u32, [u32; GRADES]); 21] = [
    (3, [3, 4, 6, 10, 14, 25, 40, 60, 100, 140, 250]),
    (6, [4, 5, 8, 12, 18, 30, 48, 75, 120, 180, 300]),
    (10, [4, 6, 9, 15, 22, 36, 58, 90, 150, 220, 360]),
    (18, [5, 8, 11, 18, 27, 43, 70, 110, 180, 270, 430]),
    (30, [6, 9, 13, 21, 33, 52, 84, 130, 210, 330, 520]),
    (50, [7, 11, 16, 25, 39, 62, 100, 160, 250, 390, 620]),
    (80, [8, 13, 19, 30, 46, 74, 120, 190, 300, 460, 740]),
    (120, [10, 15, 22, 35, 54, 87, 140, 220, 350, 540, 870]),
    (180, [12, 18, 25, 40, 63, 100, 160, 250, 400, 630, 1000]),
    (250, [14, 20, 29, 46, 72, 115, 185, 290, 460, 720, 1150]),
    (315, [16, 23, 32, 52, 81, 130, 210, 320, 520, 810, 1300]),
    (400, [18, 25, 36, 57, 89, 140, 230, 360, 570, 890, 1400]),
    (500, [20, 27, 40, 63, 97, 155, 250, 400, 630, 970, 1550]),
    (630, [22, 32, 44, 70, 110, 175, 280, 440, 700, 1100, 1750]),
    (800, [25, 36, 50, 80, 125, 200, 320, 500, 800, 1250, 2000]),
    (1000, [28, 40, 56, 90, 140, 230, 360, 560, 900, 1400, 2300]),
    (1250, [33, 47, 66, 105, 165, 260, 420, 660, 1050, 1650, 2600]),
    (1600, [39, 55, 78, 125, 195, 310, 500, 780, 1250, 1950, 3100]),
    (2000, [46, 65, 92, 150, 230, 370, 600, 920, 1500, 2300, 3700]),
    (2500, [55, 78, 110, 175, 280, 440, 700, 1100, 1750, 2800, 4400]),
    (3150, [68, 96, 135, 210, 330, 540, 860, 1350, 2100, 3300, 5400]),
];

/// Returns the half width, m, of the grade IT`grade` for a nominal size in mm; None outside the table.
///
/// The grade is the full width of the tolerance zone, so its half is the plus-or-minus value.
pub fn it_half_width(grade: usize, nominal_mm: f64) -> Option<f64> {
    let column = grade.checked_sub(FIRST_IT_GRADE)?;
    let (_, row) = TABLE.iter().find(|(most, _)| nominal_mm > 0.0 && nominal_mm <= f64::from(*most))?;
    row.get(column).map(|um| 0.5 * m_from_mm(m_from_mm(f64::from(*um))))
}
