//! Camera: projection from the world frame (m) to the picture (px).

use nalgebra::{Point2, Vector3};

/// Direction of view.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ViewDirection {
    /// Isometric view from the side of the robot on which the nodes of the operations lie.
    #[default]
    Iso,
    Top,
    /// View along the y axis of the world.
    Front,
    /// View along the negative x axis of the world.
    Side,
}

impl ViewDirection {
    /// All directions of view.
    pub const ALL: [Self; 4] = [Self::Iso, Self::Top, Self::Front, Self::Side];

    /// Returns the name of this view as the command line states it, for example `iso`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Iso => "iso",
            Self::Top => "top",
            Self::Front => "front",
            Self::Side => "side",
        }
    }

    /// Returns three unit vectors of the view in the world frame: right, up and backward (towards the eye).
    ///
    /// The argument `work` is the direction from the robot base to the nodes of the operations.
    pub fn axes(self, perspective: bool, work: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let (x, y, z) = (Vector3::x(), Vector3::y(), Vector3::z());
        match self {
            Self::Top => [x, y, z],
            Self::Front => [x, z, -y],
            Self::Side => [y, z, x],
            Self::Iso => {
                // The view is along a space diagonal of a cube. In perspective, the eye is a little higher.
                let x = if work.x < -1e-9 { -1.0 } else { 1.0 };
                let y = if work.y > 1e-9 { 1.0 } else { -1.0 };
                let back = Vector3::new(x, y, if perspective { 1.2 } else { 1.0 }).normalize();
                let right = z.cross(&back).normalize();
                [right, back.cross(&right), back]
            }
        }
    }
}

/// Projected point: the position in the picture (px to the right and down) and the nearness to the eye.
///
/// The value `near` is larger for points nearer to the eye. For the points of a plane, `near` is a linear
/// function of the picture coordinates. It may therefore be interpolated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScreenPoint {
    pub at: Point2<f64>,
    pub near: f64,
}

/// Rectangle of the picture in which the world is shown, px.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PictureFrame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

/// Camera: directions of view, projection and scale.
#[derive(Debug, Clone, PartialEq)]
pub struct Camera {
    pub right: Vector3<f64>,
    pub up: Vector3<f64>,
    /// Direction towards the eye, in the world frame.
    pub back: Vector3<f64>,
    centre: Vector3<f64>,
    /// Distance of the eye from the centre of the scene, m; None for a parallel projection.
    distance: Option<f64>,
    /// Scale of the picture at the centre of the scene, px per m.
    pub scale: f64,
    shift: (f64, f64),
}

/// Distance of the eye from the centre of the scene, as a multiple of the radius of the scene.
const EYE_DISTANCE: f64 = 4.2;

impl Camera {
    /// Returns a camera that shows all `points` (world frame, m) inside the rectangle `frame` of the picture.
    pub fn fitted(
        view: ViewDirection,
        perspective: bool,
        work: &Vector3<f64>,
        points: &[Vector3<f64>],
        frame: &PictureFrame,
    ) -> Self {
        let [right, up, back] = view.axes(perspective, work);
        let bounds = points.iter().map(|p| (*p, *p)).reduce(|(lo, hi), (p, q)| (lo.inf(&p), hi.sup(&q)));
        let (low, high) = bounds.unwrap_or((Vector3::repeat(-1.0), Vector3::repeat(1.0)));
        let centre = (low + high) / 2.0;
        let radius = ((high - low).norm() / 2.0).max(1e-3);
        let distance = perspective.then_some(radius * EYE_DISTANCE);
        let mut camera = Self { right, up, back, centre, distance, scale: 1.0, shift: (0.0, 0.0) };
        let seen = points.iter().map(|p| camera.seen(p).at).map(|p| (p, p));
        let (a, b) = seen.reduce(|(a, b), (p, q)| (a.inf(&p), b.sup(&q))).unwrap_or_default();
        let size = (b - a).map(|side| side.max(1e-6));
        camera.scale = (frame.width / size.x).min(frame.height / size.y);
        let middle = |lo: f64, hi: f64| (lo + hi) / 2.0 * camera.scale;
        camera.shift = (
            frame.left + frame.width / 2.0 - middle(a.x, b.x),
            frame.top + frame.height / 2.0 - middle(a.y, b.y),
        );
        camera
    }

    /// Returns the projection of a point (world frame, m).
    pub fn seen(&self, p: &Vector3<f64>) -> ScreenPoint {
        let from = p - self.centre;
        let (x, y, z) = (from.dot(&self.right), from.dot(&self.up), from.dot(&self.back));
        let (grown, near) = match self.distance {
            // In the picture, the reciprocal of the distance varies linearly over a plane; the distance
            // itself does not.
            Some(d) => {
                let away = (d - z).max(0.01 * d);
                (d / away, d / away)
            }
            None => (1.0, z),
        };
        let scale = self.scale * grown;
        ScreenPoint { at: Point2::new(self.shift.0 + x * scale, self.shift.1 - y * scale), near }
    }

    /// Returns the unit vector from a point to the eye.
    pub fn to_eye(&self, p: &Vector3<f64>) -> Vector3<f64> {
        match self.distance {
            Some(d) => (self.centre + self.back * d - p).try_normalize(1e-12).unwrap_or(self.back),
            None => self.back,
        }
    }

    /// Returns the point `p` shifted towards the eye by `lift` (m). The shift does not move the point in
    /// the picture.
    pub fn before(&self, p: &Vector3<f64>, lift: f64) -> Vector3<f64> {
        p + self.to_eye(p) * lift
    }
}
