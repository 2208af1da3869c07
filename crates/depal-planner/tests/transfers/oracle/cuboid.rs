//! Boxes: whether they meet, and how far they are apart.

use depal_frames::nalgebra::{Matrix3, Vector3};
use depal_frames::{PlacedShape, Pose, Shape};

/// A box: centre, axes, half sides; m.
pub(super) struct Cuboid {
    pub(super) centre: Vector3<f64>,
    axes: Matrix3<f64>,
    pub(super) half: Vector3<f64>,
}

impl Cuboid {
    pub(super) fn new(frame: &Pose, placed: &PlacedShape, grown: f64) -> Self {
        let Shape::Cuboid { half_extents } = &placed.shape else {
            panic!("the oracle knows boxes only");
        };
        let pose = frame * placed.pose;
        Self {
            centre: pose.translation.vector,
            axes: pose.rotation.to_rotation_matrix().into_inner(),
            half: half_extents.add_scalar(grown),
        }
    }

    /// Separating axes of two boxes, the classic fifteen.
    pub(super) fn meets(&self, other: &Self) -> bool {
        let between = other.centre - self.centre;
        let reach = self.half.norm() + other.half.norm();
        if between.norm_squared() > reach * reach {
            return false;
        }
        let spread = |c: &Cuboid, axis: &Vector3<f64>| -> f64 {
            (0..3)
                .map(|i| (c.axes.column(i).dot(axis) * c.half[i]).abs())
                .sum()
        };
        let apart = |axis: Vector3<f64>| {
            axis.norm_squared() > 1e-12
                && between.dot(&axis).abs() > spread(self, &axis) + spread(other, &axis)
        };
        let (a, b) = (&self.axes, &other.axes);
        let faces = (0..3).any(|i| apart(a.column(i).into()) || apart(b.column(i).into()));
        !(faces || (0..9).any(|k| apart(a.column(k / 3).cross(&b.column(k % 3)))))
    }
}

/// Exact distance of two boxes that do not meet: corners to the other box, and edges to edges.
pub(super) fn gap(a: &Cuboid, b: &Cuboid) -> f64 {
    let corners = |c: &Cuboid| -> Vec<Vector3<f64>> {
        (0..8)
            .map(|k| {
                let side = |i: usize| {
                    if k >> i & 1 == 0 {
                        -c.half[i]
                    } else {
                        c.half[i]
                    }
                };
                c.centre + c.axes * Vector3::new(side(0), side(1), side(2))
            })
            .collect()
    };
    let to_box = |c: &Cuboid, p: &Vector3<f64>| {
        let at = c.axes.transpose() * (p - c.centre);
        at.zip_map(&c.half, |x, h| (x.abs() - h).max(0.0)).norm()
    };
    let (first, second) = (corners(a), corners(b));
    let mut least = f64::INFINITY;
    for p in &first {
        least = least.min(to_box(b, p));
    }
    for p in &second {
        least = least.min(to_box(a, p));
    }
    let edges: Vec<(usize, usize)> = (0..8)
        .flat_map(|k| {
            (0..3)
                .filter(move |i| k >> i & 1 == 0)
                .map(move |i| (k, k | 1 << i))
        })
        .collect();
    for &(i, j) in &edges {
        for &(k, l) in &edges {
            least = least.min(between_segments(first[i], first[j], second[k], second[l]));
        }
    }
    least
}

/// Distance of the segments `p` to `q` and `r` to `s`.
fn between_segments(p: Vector3<f64>, q: Vector3<f64>, r: Vector3<f64>, s: Vector3<f64>) -> f64 {
    let (d1, d2, w) = (q - p, s - r, p - r);
    let (a, b, e) = (d1.dot(&d1), d1.dot(&d2), d2.dot(&d2));
    let (c, f) = (d1.dot(&w), d2.dot(&w));
    let square = a * e - b * b;
    let mut t = if square > 1e-12 * a * e {
        ((b * f - c * e) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let mut u = ((b * t + f) / e).clamp(0.0, 1.0);
    t = ((b * u - c) / a).clamp(0.0, 1.0);
    u = ((b * t + f) / e).clamp(0.0, 1.0);
    (w + d1 * t - d2 * u).norm()
}
