//! Rays against boxes with rounded edges.

use depal_frames::nalgebra::Matrix3;
use depal_frames::{Pose, Vector};

/// A box whose edges and corners are rounded: all that is within `radius` of a smaller box.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RoundedBox {
    /// The eye in the box's frame.
    eye: Vector,
    box_from_view: Matrix3<f64>,
    /// Half sides of the smaller box.
    inner: Vector,
    radius: f64,
}

impl RoundedBox {
    /// `half`: half sides with the rounding.
    pub fn new(view_from_box: &Pose, half: &Vector, radius: f64) -> Self {
        let box_from_view = view_from_box.rotation.inverse().to_rotation_matrix();
        Self {
            eye: -(box_from_view * view_from_box.translation.vector),
            box_from_view: box_from_view.into_inner(),
            inner: half.map(|side| (side - radius).max(0.0)),
            radius,
        }
    }

    /// Outward unit normal at a point of the surface, in the view's frame.
    pub fn normal_at(&self, point: &Vector) -> Vector {
        let local = self.box_from_view * point + self.eye;
        let arm = self.beyond(&local, 1.0);
        self.box_from_view.tr_mul(&arm.normalize())
    }

    /// A ray of the view in the box's frame.
    #[inline(always)]
    pub fn turned(&self, ray: &Vector) -> Vector {
        self.box_from_view * ray
    }

    /// From the nearest point of the smaller box, when both are drawn to `scale`.
    #[inline(always)]
    fn beyond(&self, local: &Vector, scale: f64) -> Vector {
        let past = |k: usize| {
            let side = self.inner[k] * scale;
            local[k] - local[k].clamp(-side, side)
        };
        Vector::new(past(0), past(1), past(2))
    }

    /// 1/z where `ray`, which is turned to the box, meets the surface. `sharp`: the same of the sharp box
    /// around it; none when the ray passes by.
    ///
    /// The squared distance from the smaller box is convex along the ray, and quadratic as long as the
    /// same sides are passed. Nearly always they are at the hit what they are at the entry. All lengths
    /// are multiplied by `sharp`, which spares divisions.
    #[inline(always)]
    pub fn meet(&self, ray: &Vector, sharp: f64) -> Option<f64> {
        let start = self.eye * sharp + ray;
        let arm = self.beyond(&start, sharp);
        let radius = self.radius * sharp;
        let (mut a, mut b, mut c) = (0.0, 0.0, -radius * radius);
        for k in 0..3 {
            let along = if arm[k] == 0.0 { 0.0 } else { ray[k] };
            a += along * along;
            b += along * arm[k];
            c += arm[k] * arm[k];
        }
        if c <= 0.0 {
            return Some(sharp);
        }
        if b >= 0.0 {
            return None; // once the distance grows it never falls again
        }
        let discriminant = b * b - a * c;
        if discriminant >= 0.0 {
            // The hit is c / root further on.
            let root = discriminant.sqrt() - b;
            let mut same = true;
            for k in 0..3 {
                let hit = start[k] * root + ray[k] * c;
                let past = hit.abs() > self.inner[k] * sharp * root;
                same &= (past == (arm[k] != 0.0)) & (hit * arm[k] >= 0.0);
            }
            if same {
                return Some(sharp * root / (root + c));
            }
        }
        let further = self.walk(&(start / sharp), ray)?;
        Some(1.0 / (1.0 / sharp + further))
    }

    /// How many times `ray` reaches from a point outside to the surface, piece by piece: in each the same
    /// sides are passed.
    #[cold]
    #[inline(never)]
    fn walk(&self, start: &Vector, ray: &Vector) -> Option<f64> {
        // Where each coordinate is: below (-1), within (0) or beyond (1) the smaller box.
        let mut place = [0, 1, 2]
            .map(|k| i32::from(start[k] > self.inner[k]) - i32::from(start[k] < -self.inner[k]));
        let heading = [0, 1, 2].map(|k| i32::from(ray[k] > 0.0) - i32::from(ray[k] < 0.0));
        let mut from = 0.0;
        loop {
            // Where this piece ends, and what changes there.
            let (mut end, mut turning) = (f64::INFINITY, None);
            for k in 0..3 {
                if heading[k] == 0 || place[k] == heading[k] {
                    continue;
                }
                let side = match place[k] {
                    0 => f64::from(heading[k]) * self.inner[k],
                    other => f64::from(other) * self.inner[k],
                };
                let crossing = ((side - start[k]) / ray[k]).max(from);
                if crossing < end {
                    (end, turning) = (crossing, Some(k));
                }
            }
            let (mut a, mut b, mut c) = (0.0, 0.0, -self.radius * self.radius);
            for k in (0..3).filter(|k| place[*k] != 0) {
                let arm = start[k] - f64::from(place[k]) * self.inner[k];
                a += ray[k] * ray[k];
                b += ray[k] * arm;
                c += arm * arm;
            }
            let discriminant = b * b - a * c;
            if b < 0.0 && discriminant >= 0.0 {
                let hit = c / (discriminant.sqrt() - b);
                if hit <= end {
                    return Some(hit.max(from));
                }
            }
            // Convex: once it grows it never falls again.
            let growing = a * end + b >= 0.0;
            let k = turning.filter(|_| !growing)?;
            place[k] += heading[k];
            from = end;
        }
    }
}
