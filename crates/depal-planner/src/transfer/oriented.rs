//! Boxes in any orientation: whether two meet, and a distance below which they cannot be apart.

use depal_frames::{Point, Pose};

/// A box around a solid, or the solid itself; base frame, metres.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Oriented {
    pub centre: [f64; 3],
    /// Unit vectors along the sides.
    pub axes: [[f64; 3]; 3],
    pub half: [f64; 3],
}

#[inline]
fn magnitudes(rows: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut out = *rows;
    for row in &mut out {
        for value in row {
            *value = value.abs();
        }
    }
    out
}

#[inline]
fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Two boxes seen from the first one: where the second's centre is, and the cosines between the axes.
struct Relation {
    at: [f64; 3],
    cosines: [[f64; 3]; 3],
}

impl Oriented {
    /// `frame_from_box` and half of each side.
    pub fn new(pose: &Pose, half: [f64; 3]) -> Self {
        let turn = pose.rotation.to_rotation_matrix();
        let column = |i: usize| [turn[(0, i)], turn[(1, i)], turn[(2, i)]];
        let t = pose.translation.vector;
        Self {
            centre: [t.x, t.y, t.z],
            axes: [column(0), column(1), column(2)],
            half,
        }
    }

    /// Half extents of the box around it along the base's axes.
    pub fn extents(&self) -> [f64; 3] {
        let mut extents = [0.0; 3];
        for (axis, half) in self.axes.iter().zip(&self.half) {
            for k in 0..3 {
                extents[k] += axis[k].abs() * half;
            }
        }
        extents
    }

    pub fn corners(&self) -> [Point; 8] {
        std::array::from_fn(|k| {
            let side = |i: usize| {
                if k >> i & 1 == 0 {
                    self.half[i]
                } else {
                    -self.half[i]
                }
            };
            let (x, y, z) = (side(0), side(1), side(2));
            let at = |c: usize| {
                self.centre[c] + self.axes[0][c] * x + self.axes[1][c] * y + self.axes[2][c] * z
            };
            Point::new(at(0), at(1), at(2))
        })
    }

    #[inline]
    fn relation(&self, other: &Self) -> Relation {
        let (c, o) = (&self.centre, &other.centre);
        let between = [o[0] - c[0], o[1] - c[1], o[2] - c[2]];
        let mut relation = Relation {
            at: [0.0; 3],
            cosines: [[0.0; 3]; 3],
        };
        for i in 0..3 {
            relation.at[i] = dot(&between, &self.axes[i]);
            for j in 0..3 {
                relation.cosines[i][j] = dot(&self.axes[i], &other.axes[j]);
            }
        }
        relation
    }

    /// Whether it meets the other one made thicker on every side by `padding`, m.
    ///
    /// Separating axes: the faces of both and the products of their edges
    /// (S. Gottschalk, M. Lin, D. Manocha, "OBBTree", SIGGRAPH 1996).
    pub fn meets(&self, other: &Self, padding: f64) -> bool {
        let Relation { at, cosines: c } = self.relation(other);
        let (a, b) = (&self.half, &other.half.map(|half| half + padding));
        let turned = magnitudes(&c);
        for i in 0..3 {
            if at[i].abs() > a[i] + dot(&turned[i], b) {
                return false;
            }
        }
        for j in 0..3 {
            let way = at[0] * c[0][j] + at[1] * c[1][j] + at[2] * c[2][j];
            let reach = a[0] * turned[0][j] + a[1] * turned[1][j] + a[2] * turned[2][j];
            if way.abs() > b[j] + reach {
                return false;
            }
        }
        for i in 0..3 {
            let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
            for j in 0..3 {
                let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
                let way = at[i2] * c[i1][j] - at[i1] * c[i2][j];
                let reach = a[i1] * turned[i2][j]
                    + a[i2] * turned[i1][j]
                    + b[j1] * turned[i][j2]
                    + b[j2] * turned[i][j1];
                // Parallel edges give no axis; rounding must not part what meets.
                if way.abs() > reach + 1e-12 {
                    return false;
                }
            }
        }
        true
    }

    /// They are at least this far apart, m; 0 when that cannot be told.
    ///
    /// Each lies in its own box along the other's axes; the way between these is exact where a face is nearest.
    pub fn least_distance(&self, other: &Self) -> f64 {
        let Relation { at, cosines: c } = self.relation(other);
        let (a, b) = (&self.half, &other.half);
        let turned = magnitudes(&c);
        let (mut first, mut second) = (0.0, 0.0);
        for i in 0..3 {
            let gap = (at[i].abs() - a[i] - dot(&turned[i], b)).max(0.0);
            first += gap * gap;
            let way = at[0] * c[0][i] + at[1] * c[1][i] + at[2] * c[2][i];
            let reach = a[0] * turned[0][i] + a[1] * turned[1][i] + a[2] * turned[2][i];
            let gap = (way.abs() - b[i] - reach).max(0.0);
            second += gap * gap;
        }
        first.max(second).sqrt()
    }
}
