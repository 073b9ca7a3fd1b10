//! 3-D pictures without a browser: PNG by a software rasterizer, and SVG with hidden lines removed.
//!
//! A [`Drawing`] becomes a scene of bodies, lines and labels in the world frame, and a camera is fitted to
//! the scene. PNG and SVG show the same scene. Equal drawings give equal bytes, because no font file,
//! graphics driver or random number is used.

#[doc(hidden)] // public for tests/it
pub mod camera;
#[doc(hidden)] // public for tests/it
pub mod canvas;
mod edges;
mod floor;
#[doc(hidden)] // public for tests/it
pub mod font;
mod ink;
mod isometric;
mod labels;
mod marks;
mod palette;
mod scale;
mod scene;
mod strip;
#[doc(hidden)] // public for tests/it
pub mod trace;

pub use camera::ViewDirection;
pub use isometric::isometric;
pub use scale::Show;

use crate::drawing::Drawing;
use camera::{Camera, PictureFrame};
use canvas::DepthBuffer;
use ink::PixelImage;
use nalgebra::Vector3;
use palette::{Light, Palette, bytes, mixed};
use scale::ErrorScale;
use scene::{RasterScene, SceneBody};

/// Settings of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Operation whose error map is shown alone, with the robot at the spot of that operation. If None, the
    /// error maps of all operations are shown.
    pub operation: Option<usize>,
    /// Operation at whose spot the robot is drawn, while the error maps of all operations are shown. The
    /// field has no effect if `operation` is given. If both fields are None, the robot is at home.
    pub context: Option<usize>,
    /// Width of the picture, px.
    pub width: usize,
    pub height: usize,
    pub view: ViewDirection,
    /// Whether the picture uses perspective projection; otherwise the projection is parallel. SVG always uses
    /// parallel projection.
    pub perspective: bool,
    pub show: Show,
    /// Index into [`Drawing::lenses`]. The entry is the combination of error model and reading
    /// (interpretation of the error set) under which errors are shown.
    pub take: usize,
    /// Name of the sense (component of the error) whose values the colours show. If None, each map shows the
    /// sense of its operation.
    pub sense: Option<String>,
    pub envelope: bool,
    /// Whether equipment names and spot values are drawn.
    pub labels: bool,
    /// Whether a title is drawn above the scene, and a legend below the scene.
    pub legend: bool,
    pub dark: bool,
}

impl Default for Shot {
    fn default() -> Self {
        Self {
            operation: None,
            context: None,
            width: 1600,
            height: 1000,
            view: ViewDirection::Iso,
            perspective: true,
            show: Show::Resultant,
            take: 0,
            sense: None,
            envelope: false,
            labels: true,
            legend: true,
            dark: false,
        }
    }
}

/// Largest width and height of a picture, px.
const MAX_SIDE: usize = 6000;
/// Number of samples per pixel along each side.
const SAMPLES: usize = 3;

impl Shot {
    /// Checks the size of the picture, and checks that the drawing contains the operation and the errors to
    /// show.
    ///
    /// # Errors
    /// Returns a message if the size is out of range. The function also returns a message if the drawing
    /// lacks the operation or the combination of model and reading.
    fn check(&self, drawing: &Drawing<'_>) -> Result<(), String> {
        if !(64..=MAX_SIDE).contains(&self.width) || !(64..=MAX_SIDE).contains(&self.height) {
            return Err(format!(
                "the width and the height of a picture must be 64 to {MAX_SIDE} px, not {} by {}",
                self.width, self.height
            ));
        }
        if self.take >= drawing.lenses.len() {
            return Err(format!(
                "there are {} combinations of model and reading, but none has the number {}",
                drawing.lenses.len(),
                self.take
            ));
        }
        match self.operation {
            Some(k) if k >= drawing.cell.operations.len() => {
                Err(format!("there is no operation with the index {k} (operations are counted from 0)"))
            }
            _ => Ok(()),
        }
    }

    /// Returns the height of capital letters in this picture, px. Other sizes are multiples of this height.
    fn capital(&self) -> f64 {
        ((self.width as f64).min(1.6 * self.height as f64) / 125.0).clamp(7.0, 22.0)
    }

    /// Returns the rectangle of the picture in which the world is shown, px.
    fn frame(&self) -> PictureFrame {
        let (width, height, unit) = (self.width as f64, self.height as f64, self.capital());
        let side = 2.2 * unit;
        let (above, below) = if self.legend { (5.2 * unit, strip::HEIGHT * unit) } else { (side, side) };
        let height = (height - above - below).max(height / 4.0);
        PictureFrame { left: side, top: above, width: width - 2.0 * side, height }
    }
}

/// Scene with its camera, colours and error scale.
struct FittedScene {
    scene: RasterScene,
    camera: Camera,
    palette: Palette,
    scale: ErrorScale,
}

fn staged(drawing: &Drawing<'_>, shot: &Shot) -> Result<FittedScene, String> {
    shot.check(drawing)?;
    let palette = Palette::of(shot.dark);
    let scale = ErrorScale::of(drawing, shot);
    let shown = drawing.fields.iter().filter(|f| shot.operation.is_none_or(|o| o == f.operation));
    let nodes: Vec<Vector3<f64>> = shown.flat_map(|f| f.nodes.iter().map(|n| n.position)).collect();
    let mean = nodes.iter().sum::<Vector3<f64>>() / nodes.len().max(1) as f64;
    let work = if nodes.is_empty() { Vector3::new(0.0, -1.0, 0.0) } else { mean - drawing.base.translation };
    let mut scene = RasterScene::of(drawing, shot, &palette);
    // Glyphs are aligned with the horizontal direction of the picture, as in the legend.
    scene.right = shot.view.axes(shot.perspective, &work)[0];
    if shot.show != Show::Nothing {
        marks::add(&mut scene, drawing, shot, &palette, &scale);
    }
    scene.add_names(drawing, shot);
    let camera = Camera::fitted(shot.view, shot.perspective, &work, &scene.points(), &shot.frame());
    floor::lay(&mut scene, &palette, drawing.floor);
    Ok(FittedScene { scene, camera, palette, scale })
}

/// Returns the picture as PNG with 8 bits per colour.
///
/// # Errors
/// Returns a message if the size is out of range or the picture cannot be encoded. `shot` selects an
/// operation, and a combination of model and reading. The function also returns a message if the drawing
/// lacks one of the two.
pub fn png(drawing: &Drawing<'_>, shot: &Shot) -> Result<Vec<u8>, String> {
    let stage = staged(drawing, shot)?;
    let mut sheet = PixelImage::of(&rendered(&stage, shot), SAMPLES);
    if shot.labels {
        labels::write(&mut sheet, &stage, shot);
    }
    if shot.legend {
        strip::write(&mut sheet, &strip::items(drawing, &stage, shot));
    }
    encoded(&sheet)
}

fn rendered(stage: &FittedScene, shot: &Shot) -> DepthBuffer<[u8; 3]> {
    let (width, height) = (shot.width * SAMPLES, shot.height * SAMPLES);
    let mut canvas = DepthBuffer::new(width, height, bytes(stage.palette.paper));
    let light = Light::of(&stage.camera);
    let (solid, clear): (Vec<&SceneBody>, Vec<&SceneBody>) =
        stage.scene.bodies.iter().partition(|b| b.opacity >= 1.0);
    solid.iter().for_each(|body| paint(&mut canvas, body, &stage.camera, &light));
    let pixel = shot.capital() / 10.0 * SAMPLES as f64;
    let lift = stage.scene.size * 0.002;
    for body in stage.scene.bodies.iter().filter(|b| b.has_edges) {
        let palette = &stage.palette;
        let (colour, width) =
            if body.is_sign { (palette.rim(body.colour), 0.5) } else { (palette.edge(body.colour), 0.9) };
        for line in edges::of(body, &stage.camera) {
            let [a, b] = line.map(|p| sampled(&stage.camera, &stage.camera.before(&p, lift)));
            canvas.stroke(&a, &b, width * pixel, |v| *v = bytes(colour));
        }
    }
    for line in &stage.scene.lines {
        for [a, b] in line.spans() {
            let [a, b] = [a, b].map(|p| sampled(&stage.camera, &stage.camera.before(&p, line.lift)));
            canvas.stroke(&a, &b, line.width * pixel, |v| *v = bytes(line.colour));
        }
    }
    paint_clear(&mut canvas, &clear, &stage.camera);
    canvas
}

fn sampled(camera: &Camera, p: &Vector3<f64>) -> camera::ScreenPoint {
    let seen = camera.seen(p);
    camera::ScreenPoint { at: seen.at * SAMPLES as f64, ..seen }
}

/// Paints a body with colours that are interpolated between its corners.
fn paint(canvas: &mut DepthBuffer<[u8; 3]>, body: &SceneBody, camera: &Camera, light: &Light) {
    let corners: Vec<camera::ScreenPoint> =
        body.mesh.positions.iter().map(|p| sampled(camera, &camera.before(p, body.lift))).collect();
    let tones = body.tones(light);
    for t in &body.mesh.triangles {
        let t = t.map(|i| i as usize);
        let [a, b, c] = t.map(|i| tones[i]);
        canvas.fill(&t.map(|i| corners[i]), true, |v, s| {
            *v = bytes(body.toned(a * s[0] + b * s[1] + c * s[2]));
        });
    }
}

/// Paints the triangles of transparent bodies. Farther triangles are painted first.
fn paint_clear(canvas: &mut DepthBuffer<[u8; 3]>, bodies: &[&SceneBody], camera: &Camera) {
    let mut faces = Vec::new();
    for body in bodies {
        for t in &body.mesh.triangles {
            let t = t.map(|i| i as usize);
            let corners = t.map(|i| sampled(camera, &body.mesh.positions[i]));
            let near: f64 = corners.iter().map(|c| c.near).sum();
            faces.push((near, corners, body.colour, body.opacity));
        }
    }
    faces.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, corners, colour, opacity) in faces {
        canvas.fill(&corners, false, |v, _| {
            let behind = v.map(|c| f32::from(c) / 255.0);
            *v = bytes(mixed(behind, colour, opacity));
        });
    }
}

fn encoded(sheet: &PixelImage) -> Result<Vec<u8>, String> {
    let (width, height) = (sheet.width as u32, sheet.height as u32);
    let mut out = Vec::new();
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let write = |encoder: png::Encoder<'_, &mut Vec<u8>>| -> Result<(), png::EncodingError> {
        let data: Vec<u8> = sheet.pixels.iter().flat_map(|p| bytes(*p)).collect();
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&data)?;
        writer.finish()
    };
    write(encoder).map_err(|e| format!("cannot encode the picture as PNG: {e}"))?;
    Ok(out)
}
