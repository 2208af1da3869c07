//! The points of a depth image seen from the side, as a picture for people.

use depal_frames::{DepthFrame, Intrinsics, Point, Rotation, Vector};

/// Size of the picture in pixels.
const WIDTH: usize = 800;
const HEIGHT: usize = 640;
/// The viewer stands this far round the pallet and leans back this far from the camera's own view, radians; negative,
/// so that what is nearer to the camera is higher in the picture.
const TURN: f64 = 0.45;
const TILT: f64 = -0.95;
/// Share of the picture that the points fill; the outermost hundredth on each side may lie beyond.
const FILLED: f64 = 0.94;

/// The points as a second viewer sees them. The value of a pixel is still the depth from the camera, so that colours
/// mean what they mean in the depth image; which point hides which is decided from where the viewer stands.
pub fn seen_from_the_side(frame: &DepthFrame) -> DepthFrame {
    let points = points(frame);
    let middle = points.iter().map(|p| p.coords).sum::<Vector>() / points.len().max(1) as f64;
    let turned = Rotation::from_axis_angle(&Vector::x_axis(), TILT)
        * Rotation::from_axis_angle(&Vector::z_axis(), TURN);
    // Parallel rays: what is parallel in the cell stays so, and nothing can be behind the viewer.
    let seen: Vec<(Point, f32)> = points
        .iter()
        .map(|p| (Point::from(turned * (p.coords - middle)), p.z as f32))
        .collect();
    let across = Span::of(seen.iter().map(|(p, _)| p.x));
    let down = Span::of(seen.iter().map(|(p, _)| p.y));
    let pixels_per_metre = FILLED
        * (WIDTH as f64 / across.length().max(1e-3)).min(HEIGHT as f64 / down.length().max(1e-3));

    let mut nearest = vec![f64::INFINITY; WIDTH * HEIGHT];
    let mut depth = vec![0.0; WIDTH * HEIGHT];
    for (p, value) in &seen {
        let u = ((p.x - across.middle()) * pixels_per_metre + WIDTH as f64 / 2.0).floor();
        let v = ((p.y - down.middle()) * pixels_per_metre + HEIGHT as f64 / 2.0).floor();
        // Two by two pixels a point, so that no face shows what is behind it.
        for (u, v) in [(u, v), (u + 1.0, v), (u, v + 1.0), (u + 1.0, v + 1.0)] {
            if (0.0..WIDTH as f64).contains(&u) && (0.0..HEIGHT as f64).contains(&v) {
                let n = v as usize * WIDTH + u as usize;
                if p.z < nearest[n] {
                    nearest[n] = p.z;
                    depth[n] = *value;
                }
            }
        }
    }
    DepthFrame {
        intrinsics: Intrinsics {
            width: WIDTH,
            height: HEIGHT,
            ..frame.intrinsics
        },
        depth,
        intensity: Vec::new(),
    }
}

/// The valid points in the camera frame, metres.
fn points(frame: &DepthFrame) -> Vec<Point> {
    let i = &frame.intrinsics;
    let valid = frame.depth.iter().enumerate().filter(|(_, z)| **z > 0.0);
    valid
        .map(|(n, z)| i.deproject((n % i.width) as f64, (n / i.width) as f64, f64::from(*z)))
        .collect()
}

/// Where the values lie, without the outermost hundredth on each side.
struct Span {
    from: f64,
    to: f64,
}

impl Span {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut values: Vec<f64> = values.collect();
        values.sort_unstable_by(f64::total_cmp);
        let at = |percent: usize| values.get(values.len() * percent / 100).copied();
        Self {
            from: at(1).unwrap_or(0.0),
            to: at(99).unwrap_or(0.0),
        }
    }

    fn length(&self) -> f64 {
        self.to - self.from
    }

    fn middle(&self) -> f64 {
        f64::midpoint(self.from, self.to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A plate at 1 m over a floor at 2 m: the plate hides what lies behind it for the viewer, not for the camera.
    #[test]
    fn near_things_hide_far_ones_and_keep_their_depth() {
        let (width, height) = (320, 256);
        let depth = (0..width * height)
            .map(|n| {
                let (u, v) = (n % width, n / width);
                if (120..200).contains(&u) && (90..166).contains(&v) {
                    1.0
                } else {
                    2.0
                }
            })
            .collect();
        let intrinsics = Intrinsics {
            width,
            height,
            fx: 300.0,
            fy: 300.0,
            cx: 159.5,
            cy: 127.5,
        };
        let side = seen_from_the_side(&DepthFrame {
            intrinsics,
            depth,
            intensity: Vec::new(),
        });
        let count = |value: f32| side.depth.iter().filter(|z| **z == value).count();
        assert!(
            count(1.0) > 1_000 && count(2.0) > 20_000,
            "{} and {}",
            count(1.0),
            count(2.0)
        );
        assert_eq!(count(1.0) + count(2.0) + count(0.0), WIDTH * HEIGHT);
    }

    #[test]
    fn no_point_is_an_empty_picture() {
        let intrinsics = Intrinsics {
            width: 4,
            height: 2,
            fx: 1.0,
            fy: 1.0,
            cx: 0.0,
            cy: 0.0,
        };
        let side = seen_from_the_side(&DepthFrame {
            intrinsics,
            depth: vec![0.0; 8],
            intensity: Vec::new(),
        });
        assert!(side.depth.iter().all(|z| *z == 0.0));
    }
}
