//! Prints on a flat face: painted into a finished picture, so that renderer and sensor need not know of them.
//!
//! A print never takes depth away, however dark its ink, and does not shine.

use depal_frames::{Point, Pose, Vector};

use crate::{CameraSpec, Capture, RenderShape, capture};

/// A point farther than this from the print's plane does not belong to the printed face, metres.
const FACE_TOLERANCE: f64 = 0.001;
/// Rays per pixel and direction: a disc's edge darkens a pixel by the share of it that is covered.
const SUBPIXELS: usize = 4;
/// As in the sensor: distance for which the axial noise is given, metres; signal at which it is as given;
/// least and largest factor of a strong or weak signal.
const NOISE_DISTANCE: f64 = 3.0;
const NOISE_SIGNAL: f64 = 0.5;
const SIGNAL_FACTORS: (f64, f64) = (0.5, 3.0);

/// Discs printed on a flat face of a solid. The print's frame: origin on the face, Z out of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Decal {
    /// Where the print's frame stands in the world, metres.
    pub world_from_decal: Pose,
    /// Id of the solid that carries it, as in [`RenderShape::id`].
    pub id: u32,
    /// Centre (x, y) and radius of each disc in the print's frame, metres.
    pub discs: Vec<([f64; 2], f64)>,
    /// Albedo of the bare face: that of the solid's material.
    pub bare: f64,
    /// Albedo of the ink.
    pub ink: f64,
}

/// As [`capture`], with prints on some of the shapes.
pub fn capture_with_decals(
    spec: &CameraSpec,
    world_from_camera: &Pose,
    shapes: &[RenderShape],
    decals: &[Decal],
    noise_seed: u64,
) -> Capture {
    let mut shot = capture(spec, world_from_camera, shapes, noise_seed);
    for (number, decal) in decals.iter().enumerate() {
        let noise = Noise {
            key: mix(noise_seed ^ mix(number as u64 + 0x5eed)),
        };
        decal.paint(spec, world_from_camera, &mut shot, noise);
    }
    shot
}

impl Decal {
    /// Darkens the intensity by the covered share of each pixel (after the lens, if it blurs), and adds the
    /// noise that depth has on a face as dark as the ink. Where something stands before the face, or the
    /// face is not seen, nothing changes.
    fn paint(&self, spec: &CameraSpec, world_from_camera: &Pose, shot: &mut Capture, noise: Noise) {
        let i = spec.intrinsics;
        let camera_from_decal = world_from_camera.inverse() * self.world_from_decal;
        let normal = camera_from_decal.rotation * Vector::z();
        let plane = normal.dot(&camera_from_decal.translation.vector);
        if plane >= 0.0 || spec.sensor.blackout {
            return; // seen from behind or edge on
        }
        let Some(window) = self.window(spec, &camera_from_decal) else {
            return;
        };
        let face = Face {
            normal,
            plane,
            decal_from_camera: camera_from_decal.inverse(),
        };
        let mut covered = vec![0.0_f64; window.width() * window.height()];
        for v in window.rows.0..=window.rows.1 {
            for u in window.columns.0..=window.columns.1 {
                let pixel = v * i.width + u;
                let ray = i.ray(u as f64, v as f64);
                let point = ray * f64::from(shot.ideal_depth[pixel]);
                // Another solid, or another face of this one?
                if shot.ids[pixel] == self.id
                    && (normal.dot(&point) - plane).abs() <= FACE_TOLERANCE
                {
                    covered[window.at(u, v)] = self.share(spec, &face, u, v);
                }
            }
        }
        if spec.sensor.blur {
            covered = window.blurred(&covered);
        }
        let quantum = spec.sensor.quantum;
        for v in window.rows.0..=window.rows.1 {
            for u in window.columns.0..=window.columns.1 {
                let share = covered[window.at(u, v)];
                if share == 0.0 {
                    continue;
                }
                let pixel = v * i.width + u;
                let factor = 1.0 - share * (1.0 - self.ink / self.bare);
                // The sensor's own noise was scaled with the light; what is lacking is added.
                let lacking = spec.sensor.intensity_noise * (1.0 - factor * factor).max(0.0).sqrt();
                let grey = f64::from(shot.frame.intensity[pixel]) * factor;
                let grey = grey + lacking * noise.normal(2 * pixel as u64);
                shot.frame.intensity[pixel] = (grey + 0.5).clamp(0.0, 255.0) as u8;

                let depth = &mut shot.frame.depth[pixel];
                if share > 0.5 && *depth > 0.0 {
                    let ray = i.ray(u as f64, v as f64);
                    let cosine = -normal.dot(&ray) / ray.norm();
                    let more = self.more_noise(spec, f64::from(*depth), cosine);
                    let noisy = f64::from(*depth) + more * noise.normal(2 * pixel as u64 + 1);
                    *depth = if quantum > 0.0 {
                        ((noisy / quantum).round() * quantum) as f32
                    } else {
                        noisy as f32
                    };
                }
            }
        }
    }

    /// Covered share of a pixel.
    fn share(&self, spec: &CameraSpec, face: &Face, u: usize, v: usize) -> f64 {
        let mut hits = 0usize;
        for k in 0..SUBPIXELS * SUBPIXELS {
            let part = |n: usize| (n as f64 + 0.5) / SUBPIXELS as f64 - 0.5;
            let ray = spec.intrinsics.ray(
                u as f64 + part(k % SUBPIXELS),
                v as f64 + part(k / SUBPIXELS),
            );
            let on_plane = Point::from(ray * (face.plane / face.normal.dot(&ray)));
            let p = face.decal_from_camera * on_plane;
            let inside = |([x, y], radius): &([f64; 2], f64)| {
                let (dx, dy) = (p.x - x, p.y - y);
                dx * dx + dy * dy <= radius * radius
            };
            hits += usize::from(self.discs.iter().any(inside));
        }
        hits as f64 / (SUBPIXELS * SUBPIXELS) as f64
    }

    /// Standard deviation that the ink adds to the face's own, metres. The projector is taken to see
    /// the face as squarely as the camera does.
    fn more_noise(&self, spec: &CameraSpec, depth: f64, cosine: f64) -> f64 {
        if !spec.sensor.radiometric_noise {
            return 0.0;
        }
        let sigma = spec.sensor.axial_noise * (depth / NOISE_DISTANCE).powi(2) / cosine.max(0.05);
        let weak = |albedo: f64| {
            (NOISE_SIGNAL / (albedo * cosine).max(1e-6))
                .sqrt()
                .clamp(SIGNAL_FACTORS.0, SIGNAL_FACTORS.1)
        };
        sigma
            * (weak(self.ink).powi(2) - weak(self.bare).powi(2))
                .max(0.0)
                .sqrt()
    }

    /// Pixels that the print can touch; none when it is outside the picture.
    fn window(&self, spec: &CameraSpec, camera_from_decal: &Pose) -> Option<Window> {
        let i = spec.intrinsics;
        let whole = Window {
            columns: (0, i.width.checked_sub(1)?),
            rows: (0, i.height.checked_sub(1)?),
        };
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for ([x, y], radius) in &self.discs {
            for (dx, dy) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let corner = Point::new(x + dx * radius, y + dy * radius, 0.0);
                let corner = camera_from_decal * corner;
                if corner.z < 1e-3 {
                    return Some(whole);
                }
                let (u, v) = i.project(&corner);
                low = [low[0].min(u), low[1].min(v)];
                high = [high[0].max(u), high[1].max(v)];
            }
        }
        // Two pixels for the blur and the pixels' own size.
        let span = |k: usize, last: usize| {
            let first = (low[k] - 2.0).floor().max(0.0);
            let last = (high[k] + 2.0).ceil().min(last as f64);
            (first <= last).then_some((first as usize, last as usize))
        };
        Some(Window {
            columns: span(0, whole.columns.1)?,
            rows: span(1, whole.rows.1)?,
        })
    }
}

/// The printed face in the camera frame.
struct Face {
    normal: Vector,
    plane: f64,
    decal_from_camera: Pose,
}

/// A rectangle of pixels, first and last included.
struct Window {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl Window {
    fn width(&self) -> usize {
        self.columns.1 - self.columns.0 + 1
    }

    fn height(&self) -> usize {
        self.rows.1 - self.rows.0 + 1
    }

    fn at(&self, u: usize, v: usize) -> usize {
        (v - self.rows.0) * self.width() + u - self.columns.0
    }

    /// The lens: 1-2-1 in both directions.
    fn blurred(&self, values: &[f64]) -> Vec<f64> {
        let (width, height) = (self.width(), self.height());
        let pass = |values: &[f64], step: usize, count: usize, place: &dyn Fn(usize) -> usize| {
            (0..values.len())
                .map(|k| {
                    let n = place(k);
                    let before = if n == 0 { k } else { k - step };
                    let after = if n + 1 == count { k } else { k + step };
                    0.25 * (values[before] + 2.0 * values[k] + values[after])
                })
                .collect::<Vec<f64>>()
        };
        let across = pass(values, 1, width, &|k| k % width);
        pass(&across, width, height, &|k| k / width)
    }
}

/// Normal numbers addressed by number: order and threads do not matter.
#[derive(Clone, Copy)]
struct Noise {
    key: u64,
}

impl Noise {
    /// By the method of Box and Muller (Annals of Mathematical Statistics 29, 1958, 610-611).
    fn normal(self, n: u64) -> f64 {
        let unit = |word: u64| ((word >> 11) as f64 + 0.5) / (1u64 << 53) as f64;
        let first = mix(self.key.wrapping_add(n.wrapping_mul(0x9E37_79B9_7F4A_7C15)));
        let radius = (-2.0 * unit(first).ln()).sqrt();
        radius * (std::f64::consts::TAU * unit(mix(first ^ self.key))).cos()
    }
}

/// Bijective 64-bit finaliser (SplitMix64, Steele, Lea and Flood 2014).
fn mix(mut x: u64) -> u64 {
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}
