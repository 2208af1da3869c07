//! A small depth camera of its own: rays against upright boxes, projector shadow, sensor noise.
//! The scene lives in the camera frame (X right, Y down, Z forward); the camera looks straight
//! down, so a "top" is the face with the smaller Z.
#![allow(dead_code, unused_imports)]

use depal_frames::{BoxSize, DepthFrame, Intrinsics, Pose};
use depal_time::{RandomStream, RandomStreams};

pub use score::{PoseError, Score};

mod score;

/// An upright box: middle of the top, yaw about Z, full sides, top and bottom depth.
#[derive(Debug, Clone, Copy)]
pub struct Solid {
    pub x: f64,
    pub y: f64,
    pub yaw: f64,
    pub length: f64,
    pub width: f64,
    pub top: f64,
    pub bottom: f64,
    /// Turn about its own X through the middle of the top, radians.
    pub tilt: f64,
    /// True for a carton whose top should be found.
    pub wanted: bool,
}

pub struct Scene {
    pub solids: Vec<Solid>,
    pub floor: f64,
    /// The camera is turned about its X around a point on its axis, radians: all else leans.
    pub lean: f64,
}

pub const BASELINE: f64 = 0.3;

pub fn camera() -> Intrinsics {
    Intrinsics {
        width: 1280,
        height: 1024,
        fx: 1600.0,
        fy: 1600.0,
        cx: 639.5,
        cy: 511.5,
    }
}

pub fn carton() -> BoxSize {
    BoxSize::from_mm([400.0, 300.0, 250.0])
}

impl Solid {
    pub fn block(x: f64, y: f64, length: f64, width: f64, top: f64, bottom: f64) -> Self {
        Self {
            x,
            y,
            yaw: 0.0,
            length,
            width,
            top,
            bottom,
            tilt: 0.0,
            wanted: false,
        }
    }

    /// Out of the top, in the scene.
    fn normal(&self) -> depal_frames::Vector {
        let tilted = depal_frames::Vector::new(0.0, self.tilt.sin(), -self.tilt.cos());
        depal_frames::Rotation::new(depal_frames::Vector::z() * self.yaw) * tilted
    }

    /// Depths where the line `origin + s direction` (per unit s) enters; None when it misses.
    fn enter(&self, origin: [f64; 3], direction: [f64; 3]) -> Option<f64> {
        let (s, c) = self.yaw.sin_cos();
        let (ox, oy) = (origin[0] - self.x, origin[1] - self.y);
        let o = [ox * c + oy * s, oy * c - ox * s, origin[2] - self.top];
        let d = [
            direction[0] * c + direction[1] * s,
            direction[1] * c - direction[0] * s,
            direction[2],
        ];
        let (s, c) = self.tilt.sin_cos();
        let tilted = |p: [f64; 3]| [p[0], p[1] * c + p[2] * s, p[2] * c - p[1] * s];
        let (mut o, d) = (tilted(o), tilted(d));
        o[2] -= (self.bottom - self.top) / 2.0;
        let half = [
            self.length / 2.0,
            self.width / 2.0,
            (self.bottom - self.top) / 2.0,
        ];
        let (mut enter, mut leave) = (f64::MIN, f64::MAX);
        for k in 0..3 {
            let inverse = 1.0 / d[k];
            let (a, b) = ((-half[k] - o[k]) * inverse, (half[k] - o[k]) * inverse);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        (enter < leave && enter > 0.0).then_some(enter)
    }
}

/// Fast bits for pixels, started from a named stream.
struct Bits(u64);

impl Bits {
    /// SplitMix64.
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

fn unit(r: &mut Bits) -> f64 {
    (r.next() >> 11) as f64 / (1u64 << 53) as f64
}

/// Near normal with unit deviation from one draw: four 16 bit uniforms.
fn normal(r: &mut Bits) -> f64 {
    let bits = r.next();
    let sum: u64 = (0..4).map(|k| (bits >> (16 * k)) & 0xffff).sum();
    (sum as f64 / 65536.0 - 2.0) * 3f64.sqrt()
}

impl Scene {
    /// Exact depths; pixels the projector does not reach are 0.
    pub fn ideal(&self, k: &Intrinsics) -> Vec<f32> {
        let scene_from_camera = self.scene_from_camera();
        let camera_from_scene = scene_from_camera.inverse();
        let eye = scene_from_camera.translation.vector;
        let eye = [eye.x, eye.y, eye.z];
        let turned = |ray: depal_frames::Vector| {
            let r = scene_from_camera.rotation * ray;
            [r.x, r.y, r.z]
        };
        let mut depth = vec![0.0; k.width * k.height];
        for row in 0..k.height {
            for column in 0..k.width {
                let ray = turned(k.ray(column as f64, row as f64));
                depth[row * k.width + column] = (self.floor - eye[2]) / ray[2];
            }
        }
        for solid in &self.solids {
            let radius = solid.length.hypot(solid.width) / 2.0;
            let rise = radius * solid.tilt.sin().abs();
            let (mut u, mut v) = ([f64::MAX, f64::MIN], [f64::MAX, f64::MIN]);
            for corner in 0..8 {
                let sign = |bit: usize| if corner & bit == 0 { -1.0 } else { 1.0 };
                let z = if corner & 4 == 0 {
                    solid.top - rise
                } else {
                    solid.bottom + rise
                };
                let side = radius + rise + solid.tilt.sin().abs() * (solid.bottom - solid.top);
                let p = camera_from_scene
                    * depal_frames::Point::new(
                        solid.x + sign(1) * side,
                        solid.y + sign(2) * side,
                        z,
                    );
                let (pu, pv) = k.project(&p);
                u = [u[0].min(pu), u[1].max(pu)];
                v = [v[0].min(pv), v[1].max(pv)];
            }
            let range = |r: [f64; 2], n: usize| {
                (r[0].floor().clamp(0.0, n as f64) as usize)
                    ..(r[1].ceil().clamp(0.0, n as f64) as usize)
            };
            for row in range(v, k.height) {
                for column in range(u, k.width) {
                    let ray = turned(k.ray(column as f64, row as f64));
                    if let Some(z) = solid.enter(eye, ray) {
                        let d = &mut depth[row * k.width + column];
                        *d = d.min(z);
                    }
                }
            }
        }
        let projector = scene_from_camera * depal_frames::Point::new(BASELINE, 0.0, 0.0);
        let projector = [projector.x, projector.y, projector.z];
        let highest = self.solids.iter().fold(self.floor, |h, s| h.min(s.top));
        let mut lit = vec![0.0f32; depth.len()];
        for row in 0..k.height {
            for column in 0..k.width {
                let z = depth[row * k.width + column];
                let ray = turned(k.ray(column as f64, row as f64));
                let p: [f64; 3] = std::array::from_fn(|i| eye[i] + ray[i] * z);
                // From the projector to the point; s = 1 at the point.
                let d: [f64; 3] = std::array::from_fn(|i| p[i] - projector[i]);
                let below = (p[2] - highest).max(0.0);
                let shift = BASELINE * below / z + (0.3 + self.lean.tan().abs()) * below;
                let dark = self.solids.iter().any(|s| {
                    let near = s.length.max(s.width) * 0.75 + shift;
                    (s.x - p[0]).abs() < near
                        && (s.y - p[1]).abs() < near
                        && s.enter(projector, d)
                            .is_some_and(|enter| enter * z < z - 0.002)
                });
                lit[row * k.width + column] = if dark { 0.0 } else { z as f32 };
            }
        }
        lit
    }

    fn scene_from_camera(&self) -> Pose {
        let middle = depal_frames::Vector::new(0.0, 0.0, 2.5);
        let turn = depal_frames::Rotation::new(depal_frames::Vector::x() * self.lean);
        Pose::from_parts((middle - turn * middle).into(), turn)
    }

    /// Share of a top that camera and projector reach.
    pub fn seen_share(&self, solid: &Solid) -> f64 {
        let k = camera();
        let ideal = self.ideal(&k);
        let (s, c) = solid.yaw.sin_cos();
        let mut seen = 0;
        for i in 0..50 {
            for j in 0..50 {
                let x = (f64::from(i) / 49.0 - 0.5) * (solid.length - 0.01);
                let y = (f64::from(j) / 49.0 - 0.5) * (solid.width - 0.01);
                let p = depal_frames::Point::new(
                    solid.x + x * c - y * s,
                    solid.y + x * s + y * c,
                    solid.top,
                );
                let (u, v) = k.project(&p);
                let z = f64::from(ideal[v.round() as usize * k.width + u.round() as usize]);
                seen += i32::from((z - solid.top).abs() < 0.002);
            }
        }
        f64::from(seen) / 2500.0
    }

    /// What the sensor delivers.
    pub fn frame(&self, seed: u64) -> DepthFrame {
        self.frame_of(camera(), seed)
    }

    /// What a sensor with other intrinsics delivers.
    pub fn frame_of(&self, k: Intrinsics, seed: u64) -> DepthFrame {
        let ideal = self.ideal(&k);
        let (w, h) = (k.width, k.height);
        let mut r = Bits(RandomStreams::new(seed).stream("sensor").next_u64());
        let mut jittered = vec![0.0f32; w * h];
        for v in 0..h {
            for u in 0..w {
                let su = (u as f64 + 0.3 * normal(&mut r))
                    .round()
                    .clamp(0.0, (w - 1) as f64) as usize;
                let sv = (v as f64 + 0.3 * normal(&mut r))
                    .round()
                    .clamp(0.0, (h - 1) as f64) as usize;
                jittered[v * w + u] = ideal[sv * w + su];
            }
        }
        // Correlated half of the noise: a coarse lattice, blended.
        const CELL: usize = 4;
        let (cw, ch) = (w / CELL + 2, h / CELL + 2);
        let coarse: Vec<f64> = (0..cw * ch).map(|_| normal(&mut r) * 1.5).collect();
        let mut depth = vec![0.0f32; w * h];
        for v in 0..h {
            for u in 0..w {
                let i = v * w + u;
                let mut z = jittered[i];
                let (mut low, mut high) = (f32::MAX, 0.0f32);
                for dv in v.saturating_sub(1)..=(v + 1).min(h - 1) {
                    for du in u.saturating_sub(1)..=(u + 1).min(w - 1) {
                        let n = ideal[dv * w + du];
                        if n > 0.0 {
                            low = low.min(n);
                            high = high.max(n);
                        }
                    }
                }
                if high > low + 0.005 {
                    let chance = unit(&mut r);
                    if chance < 0.3 {
                        z = 0.0;
                    } else if chance < 0.4 {
                        z = f32::midpoint(low, high);
                    }
                }
                if unit(&mut r) < 0.002 {
                    z = 0.0;
                }
                if z > 0.0 {
                    let (fu, fv) = (
                        (u % CELL) as f64 / CELL as f64,
                        (v % CELL) as f64 / CELL as f64,
                    );
                    let at = |i: usize, j: usize| coarse[(v / CELL + j) * cw + u / CELL + i];
                    let blend = (at(0, 0) * (1.0 - fu) + at(1, 0) * fu) * (1.0 - fv)
                        + (at(0, 1) * (1.0 - fu) + at(1, 1) * fu) * fv;
                    let sigma = 0.0005 * f64::from(z) * f64::from(z) / 9.0;
                    let noisy = f64::from(z) + sigma * (0.5f64.sqrt() * (normal(&mut r) + blend));
                    z = ((noisy * 1e4).round() * 1e-4) as f32;
                }
                depth[i] = z;
            }
        }
        DepthFrame {
            intrinsics: k,
            depth,
            intensity: vec![128; w * h],
        }
    }
}

/// Camera 3.7 m above the floor, EUR pallet 0.144 m high, layers of eight cartons.
pub const FLOOR: f64 = 3.7;
pub const PALLET_TOP: f64 = FLOOR - 0.144;

/// The pallet's boards and blocks.
pub fn pallet() -> Vec<Solid> {
    let mut solids = Vec::new();
    for (y, width) in [
        (-0.3275, 0.145),
        (-0.1636, 0.1),
        (0.0, 0.145),
        (0.1636, 0.1),
        (0.3275, 0.145),
    ] {
        solids.push(Solid::block(
            0.0,
            y,
            1.2,
            width,
            PALLET_TOP,
            PALLET_TOP + 0.022,
        ));
    }
    for x in [-0.5275, 0.0, 0.5275] {
        solids.push(Solid::block(
            x,
            0.0,
            0.145,
            0.8,
            PALLET_TOP + 0.022,
            PALLET_TOP + 0.044,
        ));
        for y in [-0.35, 0.0, 0.35] {
            solids.push(Solid::block(x, y, 0.145, 0.1, PALLET_TOP + 0.044, FLOOR));
        }
    }
    solids
}

/// Cartons of one layer (1 = lowest); slots not in `slots` stay empty. Two by four, long side
/// along Y: 4 x 300 mm along X, 2 x 400 mm along Y. Below 2 mm gaps nothing is turned or shifted.
pub fn layer(
    number: usize,
    gap: f64,
    slots: &[usize],
    wanted: bool,
    r: &mut RandomStream,
) -> Vec<Solid> {
    let top = PALLET_TOP - 0.25 * number as f64;
    let free = f64::from(u8::from(gap >= 0.002));
    slots
        .iter()
        .map(|&slot| {
            let (i, j) = ((slot % 4) as f64 - 1.5, (slot / 4) as f64 - 0.5);
            // Turned less where the gap leaves no room: a corner moves by half a side times yaw.
            let most = (gap / 0.4 * 0.6).min(0.5f64.to_radians()) * free;
            let shift = (gap * 0.15).min(0.001) * free;
            Solid {
                x: i * (0.3 + gap) + r.uniform(-shift, shift),
                y: j * (0.4 + gap) + r.uniform(-shift, shift),
                yaw: std::f64::consts::FRAC_PI_2 + r.uniform(-most, most),
                length: 0.4,
                width: 0.3,
                top: top + r.uniform(-0.0005, 0.0005) * free,
                bottom: top + 0.25,
                tilt: 0.0,
                wanted,
            }
        })
        .collect()
}

/// A pallet whose highest full layer is `layers`, seen with the layers below as one block.
pub fn stack(layers: usize, gap: f64, seed: u64) -> Scene {
    let mut r = RandomStreams::new(seed).stream("stack");
    let mut solids = pallet();
    if layers > 1 {
        let top = PALLET_TOP - 0.25 * (layers - 1) as f64;
        solids.push(Solid::block(0.0, 0.0, 1.2, 0.8, top, PALLET_TOP));
    }
    solids.extend(layer(layers, gap, &[0, 1, 2, 3, 4, 5, 6, 7], true, &mut r));
    Scene {
        solids,
        floor: FLOOR,
        lean: 0.0,
    }
}
