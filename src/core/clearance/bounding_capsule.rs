//! Bounding capsules and bounding boxes, whose closed-form distances decide most pairs of solids.
//!
//! Only pairs near contact are left to parry3d.

use super::bodies::plain;
use crate::cell::{Shape, extent};
use crate::pose::Pose;
use nalgebra::Vector3;
use parry3d::partitioning::BvhNode;
use parry3d::shape::TriMesh;

/// Distance from contact, m, within which parry3d decides instead of the closed forms.
///
/// This distance exceeds the errors of parry3d: 4e-5 m for a hull and a ball, 1.2e-5 m for capsules. The
/// rounding errors of the closed forms are far smaller.
pub(super) const CONTACT_MARGIN: f64 = 1e-4;

/// Verdict of the closed forms on two solids.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ContactVerdict {
    /// The solids are farther apart than [`CONTACT_MARGIN`].
    Apart,
    /// The solids overlap deeper than [`CONTACT_MARGIN`].
    Touching,
    /// The closed forms cannot decide.
    Unclear,
}

/// Capsule that equals or contains a solid: all points within `radius` of the segment from `a` to `b`, m.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct BoundingCapsule {
    pub(super) a: Vector3<f64>,
    pub(super) b: Vector3<f64>,
    pub(super) radius: f64,
    /// Whether the capsule is the solid itself.
    pub(super) is_solid: bool,
}

/// Box that equals or contains a solid, m. The edges are parallel to the axes of the frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct BoundingBox {
    pub(super) centre: Vector3<f64>,
    /// Half lengths of the edges.
    pub(super) half: Vector3<f64>,
    /// Whether the box is the solid itself.
    pub(super) is_solid: bool,
}

impl BoundingCapsule {
    /// Returns the bounding capsule, in the carrier frame, of a shape enlarged by `slack` (m).
    ///
    /// `mount` is the pose, in the carrier frame, of the frame in which the file gives the shape.
    pub(super) fn new(shape: &Shape, mount: &Pose, slack: f64) -> Self {
        let new = |a: &Vector3<f64>, b: &Vector3<f64>, radius: f64, is_solid| {
            let (a, b) = (mount.transform(a), mount.transform(b));
            Self { a, b, radius: radius + slack, is_solid }
        };
        match shape {
            Shape::Sphere { centre, radius } => new(centre, centre, *radius, true),
            Shape::Capsule { a, b, radius } => new(a, b, *radius, true),
            other => {
                // The segment runs along the longest side of the bounding box. The radius is half the
                // diagonal of the face perpendicular to that side.
                let (low, high) = extent(other);
                let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
                let mut along = Vector3::zeros();
                along[half.imax()] = half.max();
                new(&(middle - along), &(middle + along), (half - along).norm(), false)
            }
        }
    }

    /// Converts the capsule to another frame, in which the present frame of the capsule has the pose `pose`.
    pub(super) fn at(&self, pose: &Pose) -> Self {
        Self { a: pose.transform(&self.a), b: pose.transform(&self.b), ..*self }
    }

    /// Converts the capsule to another frame, whose pose in the present frame of the capsule is `pose`.
    pub(super) fn seen_from(&self, pose: &Pose) -> Self {
        let seen = |p: &Vector3<f64>| pose.rotation.tr_mul(&(p - pose.translation));
        Self { a: seen(&self.a), b: seen(&self.b), ..*self }
    }

    /// Returns the low and the high corner of the axis-aligned bounding box.
    pub(super) fn bounds(&self) -> (Vector3<f64>, Vector3<f64>) {
        (self.a.inf(&self.b).add_scalar(-self.radius), self.a.sup(&self.b).add_scalar(self.radius))
    }

    /// Returns the verdict, given the squared distance (m^2) of the capsule's segment from another shape.
    ///
    /// `both_solid` states whether the capsule and the other shape are the solids themselves, not only bounds
    /// of them. A small distance between mere bounds does not mean contact.
    fn verdict(&self, squared: f64, both_solid: bool) -> ContactVerdict {
        if squared > (self.radius + CONTACT_MARGIN).powi(2) {
            ContactVerdict::Apart
        } else if both_solid
            && self.radius > CONTACT_MARGIN
            && squared < (self.radius - CONTACT_MARGIN).powi(2)
        {
            ContactVerdict::Touching
        } else {
            ContactVerdict::Unclear
        }
    }

    /// Returns the verdict on the capsule and a box in the same frame.
    pub(super) fn against_box(&self, other: &BoundingBox) -> ContactVerdict {
        let (a, along) = (self.a - other.centre, self.b - self.a);
        let room = other.half.add_scalar(self.radius + CONTACT_MARGIN) + along.abs() / 2.0;
        let middle = (a + along / 2.0).abs();
        if middle.x > room.x || middle.y > room.y || middle.z > room.z {
            return ContactVerdict::Apart;
        }
        self.verdict(segment_to_box_squared(&a, &along, &other.half), self.is_solid && other.is_solid)
    }

    /// Returns the distance of the capsule from a box in the same frame, m; negative if capsule and box
    /// overlap.
    pub(super) fn gap_to_box(&self, other: &BoundingBox) -> f64 {
        let (a, along) = (self.a - other.centre, self.b - self.a);
        segment_to_box_squared(&a, &along, &other.half).sqrt() - self.radius
    }

    /// Returns the distance of the capsule from another capsule in the same frame, m; negative if the
    /// capsules overlap.
    pub(super) fn gap_to(&self, other: &Self) -> f64 {
        segments_apart_squared(&self.a, &self.b, &other.a, &other.b).sqrt() - self.radius - other.radius
    }

    /// Returns the verdict on the capsule and the triangles of a mesh in the same frame.
    ///
    /// The traversal of the bounding volume hierarchy visits the nearest nodes first and stops at a clear
    /// verdict.
    pub(super) fn against_mesh(&self, mesh: &TriMesh) -> ContactVerdict {
        let (least, most) = (self.radius - CONTACT_MARGIN, self.radius + CONTACT_MARGIN);
        let enough = if self.is_solid { least } else { most };
        let (low, high) = self.bounds();
        let (low, high) = (low.add_scalar(-CONTACT_MARGIN), high.add_scalar(CONTACT_MARGIN));
        let from_node = |node: &BvhNode, best: f64| {
            let (from, to) = (plain(node.mins()), plain(node.maxs()));
            if best < enough || !overlapping((&low, &high), (&from, &to)) {
                return f64::MAX;
            }
            // Distance from the bounding sphere of the node; negative if the sphere contains a point of the
            // segment.
            let middle = point_to_segment_squared(&((from + to) / 2.0), &self.a, &self.b);
            middle.sqrt() - (to - from).norm() / 2.0
        };
        let from_triangle = |k: u32, _| {
            let corners = mesh.triangle(k).vertices().map(plain);
            Some(segment_to_triangle_squared(&self.a, &self.b, &corners).sqrt())
        };
        match mesh.bvh().find_best(most, from_node, from_triangle) {
            None => ContactVerdict::Apart,
            Some((_, apart)) => self.verdict(apart * apart, self.is_solid),
        }
    }
}

/// Returns whether two axis-aligned boxes, each given by its low and its high corner, share a point.
pub(super) fn overlapping(a: (&Vector3<f64>, &Vector3<f64>), b: (&Vector3<f64>, &Vector3<f64>)) -> bool {
    (0..3).all(|i| a.0[i] <= b.1[i] && b.0[i] <= a.1[i])
}

/// Returns the squared distance between the segments ab and cd, m^2.
///
/// The function computes the nearest points of the two lines and clamps them to the segments in turn (C.
/// Ericson, Real-Time Collision Detection, 2005, section 5.1.9).
pub(super) fn segments_apart_squared(
    a: &Vector3<f64>,
    b: &Vector3<f64>,
    c: &Vector3<f64>,
    d: &Vector3<f64>,
) -> f64 {
    let (u, v, w) = (b - a, d - c, a - c);
    let (uu, vv, uv, uw, vw) = (u.dot(&u), v.dot(&v), u.dot(&v), u.dot(&w), v.dot(&w));
    let held = |over: f64, under: f64| if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    let s = held(uv * vw - uw * vv, uu * vv - uv * uv);
    let t = held(uv * s + vw, vv);
    // If t was clamped to an end, the nearest s changes.
    let s = held(uv * t - uw, uu);
    (w + u * s - v * t).norm_squared()
}

fn point_to_segment_squared(p: &Vector3<f64>, a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    let (along, from) = (b - a, p - a);
    let (over, under) = (from.dot(&along), along.norm_squared());
    let t = if under > 0.0 { (over / under).clamp(0.0, 1.0) } else { 0.0 };
    (from - along * t).norm_squared()
}

/// Returns the squared distance (m^2) between a box around the origin and a segment.
///
/// The segment leads from `a` to `a + along`, and the box has the half edge lengths `half`. The squared
/// distance of the point `a + t along` from the box is a convex function of t. The planes of the six faces
/// divide the segment into at most seven parts. In each part, the squared distance is quadratic in t, so its
/// derivative is linear. The minimum lies in the part in which the derivative changes sign, or at an end of
/// the segment.
fn segment_to_box_squared(a: &Vector3<f64>, along: &Vector3<f64>, half: &Vector3<f64>) -> f64 {
    let outside = |t: f64| {
        let x = a + along * t;
        x - x.sup(&-half).inf(half)
    };
    let slope = |t: f64| outside(t).dot(along);
    let (mut low, mut high) = ((0.0, slope(0.0)), (1.0, slope(1.0)));
    if low.1 >= 0.0 {
        return outside(0.0).norm_squared();
    }
    if high.1 <= 0.0 {
        return outside(1.0).norm_squared();
    }
    for i in 0..3 {
        for side in [-half[i], half[i]] {
            // For a segment parallel to the plane, t is NaN or infinite, and the condition below is false.
            let t = (side - a[i]) / along[i];
            if low.0 < t && t < high.0 {
                let here = (t, slope(t));
                *if here.1 <= 0.0 { &mut low } else { &mut high } = here;
            }
        }
    }
    outside(low.0 - low.1 * (high.0 - low.0) / (high.1 - low.1)).norm_squared()
}

/// Returns the squared distance between the segment ab and a triangle, m^2; 0 if the segment pierces the
/// triangle.
fn segment_to_triangle_squared(a: &Vector3<f64>, b: &Vector3<f64>, corners: &[Vector3<f64>; 3]) -> f64 {
    let [p, q, r] = corners;
    let edges = [(p, q), (q, r), (r, p)];
    let nearest = edges.iter().map(|(c, d)| segments_apart_squared(a, b, c, d)).fold(f64::MAX, f64::min);
    let normal = (q - p).cross(&(r - p));
    let above = |x: &Vector3<f64>| edges.iter().all(|(c, d)| (*d - *c).cross(&(x - *c)).dot(&normal) >= 0.0);
    let (from, to) = (normal.dot(&(a - p)), normal.dot(&(b - p)));
    if from * to < 0.0 {
        return if above(&a.lerp(b, from / (from - to))) { 0.0 } else { nearest };
    }
    let (end, height) = if from.abs() < to.abs() { (a, from) } else { (b, to) };
    if normal != Vector3::zeros() && above(end) {
        nearest.min(height * height / normal.norm_squared())
    } else {
        nearest
    }
}
