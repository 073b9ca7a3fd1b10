//! Tests the colours of the pictures.

use sweetspot::colours::{viridis, viridis_hex};

/// The lightness of the palette (luma of Rec. 709) increases, which black-and-white printers need.
#[test]
fn the_viridis_palette_grows_lighter() {
    let luma = |[r, g, b]: [u8; 3]| 0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b);
    let all: Vec<f64> = (0..=50).map(|k| luma(viridis(f64::from(k) / 50.0))).collect();
    assert!(all.windows(2).all(|w| w[0] < w[1]), "{all:?}");
    assert_eq!(
        (viridis_hex(-1.0), viridis_hex(2.0), viridis_hex(f64::NAN)),
        ("#440154".into(), "#fde725".into(), "#440154".into())
    );
}
