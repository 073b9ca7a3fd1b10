//! Colours and lighting of pictures.

use super::camera::Camera;
use crate::colours;
use crate::drawing::{GlyphTone, PartKind};
use nalgebra::Vector3;

/// Colour as red, green and blue components, each from 0 to 1.
pub type Colour = [f32; 3];

/// Colours of a picture, except the colours of the error scale.
pub struct Palette {
    pub paper: Colour,
    pub floor: Colour,
    pub grid: Colour,
    pub text: Colour,
    pub faint: Colour,
    pub ring: Colour,
    warning: Colour,
    alarm: Colour,
    pub spot: Colour,
    pub envelope: Colour,
    is_dark: bool,
}

impl Palette {
    /// Returns the palette for a dark or a light background.
    pub fn of(is_dark: bool) -> Self {
        let [paper, floor, grid, text, faint, ring, warning, alarm, spot, envelope] = if is_dark {
            [
                0x12161b, 0x20262d, 0x323a44, 0xe8ecf0, 0xa3adb8, 0xaab4be, 0xf0b429, 0xff7b72, 0xff6ac1,
                0x58b4f0,
            ]
        } else {
            [
                0xffffff, 0xeef0f2, 0xd9dde2, 0x1b1f24, 0x57606a, 0x57606a, 0xb86e00, 0xcf222e, 0xc2187f,
                0x0969a8,
            ]
        }
        .map(rgb);
        Self { paper, floor, grid, text, faint, ring, warning, alarm, spot, envelope, is_dark }
    }

    /// Returns the colour of a glyph of the severity `tone`.
    pub fn of_tone(&self, tone: GlyphTone) -> Colour {
        match tone {
            GlyphTone::Quiet => self.ring,
            GlyphTone::Warning => self.warning,
            GlyphTone::Alarm => self.alarm,
        }
    }

    /// Returns the colour and the opacity of a kind of part.
    pub fn of_kind(&self, kind: PartKind) -> (Colour, f32) {
        let (light, dark, opacity) = match kind {
            PartKind::Robot => (0xf0a04b, 0xd9853a, 1.0),
            PartKind::Tool => (0x6b7683, 0x8a95a1, 1.0),
            PartKind::HeldPart => (0x56b4e9, 0x56b4e9, 1.0),
            PartKind::Equipment => (0xc6ced8, 0x56626f, 1.0),
            PartKind::Obstacle => (0x98a2ae, 0x434c57, 1.0),
            PartKind::Fence => (0xe69f00, 0xe69f00, 0.13),
            PartKind::KeepOut => (0xd55e00, 0xff8f4a, 0.22),
        };
        (rgb(if self.is_dark { dark } else { light }), opacity)
    }

    /// Returns the colour of the edges of a solid whose surface has the colour `colour`.
    pub fn edge(&self, colour: Colour) -> Colour {
        mixed(colour, [0.0, 0.0, 0.05], if self.is_dark { 0.62 } else { 0.58 })
    }

    /// Returns the colour of the rim of an arrow of the colour `colour`. The rim contrasts with the
    /// background.
    pub fn rim(&self, colour: Colour) -> Colour {
        if self.is_dark { mixed(colour, [1.0; 3], 0.4) } else { mixed(colour, [0.0; 3], 0.35) }
    }
}

/// Returns the colour of the code 0xRRGGBB.
pub fn rgb(code: u32) -> Colour {
    [16, 8, 0].map(|shift| (code >> shift & 0xff) as f32 / 255.0)
}

/// Returns the colour of the error scale at a position from 0 (least error) to 1 (greatest error).
pub fn scale(share: f64) -> Colour {
    colours::viridis(share).map(|c| f32::from(c) / 255.0)
}

/// Returns a mixture of two colours. The share 0 gives `a`, and the share 1 gives `b`.
pub fn mixed(a: Colour, b: Colour, share: f32) -> Colour {
    std::array::from_fn(|k| a[k] + (b[k] - a[k]) * share)
}

/// Returns the components of a colour as bytes.
pub fn bytes(colour: Colour) -> [u8; 3] {
    colour.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}

/// Returns a colour in hexadecimal notation, such as `#0072b2`.
pub fn hex(colour: Colour) -> String {
    let [r, g, b] = bytes(colour);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Lambertian shading: ambient light and two lamps that move with the eye.
pub struct Light {
    key: Vector3<f64>,
    fill: Vector3<f64>,
}

impl Light {
    /// Returns the lighting of a scene that a camera shows.
    pub fn of(camera: &Camera) -> Self {
        let towards =
            |r: f64, u: f64, b: f64| (camera.right * r + camera.up * u + camera.back * b).normalize();
        Self { key: towards(-0.55, 0.75, 0.45), fill: towards(0.85, 0.1, 0.4) }
    }

    /// Returns the brightness of a surface with the unit normal `normal`, as a factor of the surface's
    /// colour.
    pub fn on(&self, normal: &Vector3<f64>) -> f32 {
        let (key, fill) = (normal.dot(&self.key).max(0.0), normal.dot(&self.fill).max(0.0));
        (0.56 + 0.46 * key + 0.16 * fill) as f32
    }
}

/// Returns a colour multiplied by a brightness, with components of at most 1.
pub fn lit(colour: Colour, brightness: f32) -> Colour {
    colour.map(|c| (c * brightness).min(1.0))
}
