//! A picture of what was found: the outline and the long axis of each top face over the image.

use depal_frames::{DepthFrame, Point};
use depal_vision::DetectedBox;

const OUTLINE: [u8; 3] = [40, 230, 80];
const LONG_AXIS: [u8; 3] = [240, 60, 60];

/// Red, green, blue per pixel. The ground is the intensity image, or the depth when there is none.
pub fn overlay(frame: &DepthFrame, boxes: &[DetectedBox]) -> Vec<[u8; 3]> {
    let mut picture = Picture {
        frame,
        pixels: ground(frame),
    };
    for found in boxes {
        let (x, y) = (found.size.length / 2.0, found.size.width / 2.0);
        let at = |x: f64, y: f64| found.camera_from_box * Point::new(x, y, 0.0);
        let corners = [at(-x, -y), at(x, -y), at(x, y), at(-x, y)];
        for k in 0..4 {
            picture.line(corners[k], corners[(k + 1) % 4], OUTLINE);
        }
        picture.line(at(0.0, 0.0), at(0.5 * x, 0.0), LONG_AXIS);
    }
    picture.pixels
}

fn ground(frame: &DepthFrame) -> Vec<[u8; 3]> {
    if frame.intensity.len() == frame.depth.len() {
        return frame.intensity.iter().map(|&g| [g; 3]).collect();
    }
    let mut valid: Vec<f32> = frame.depth.iter().copied().filter(|&z| z > 0.0).collect();
    valid.sort_unstable_by(f32::total_cmp);
    let share = |part: usize| valid.get(valid.len() * part / 100).copied().unwrap_or(1.0);
    let (near, far) = (share(1), share(98));
    let scale = 200.0 / (far - near).max(1e-3);
    frame
        .depth
        .iter()
        .map(|&z| {
            if z > 0.0 {
                [(235.0 - (z - near) * scale).clamp(20.0, 240.0) as u8; 3]
            } else {
                [0; 3]
            }
        })
        .collect()
}

struct Picture<'a> {
    frame: &'a DepthFrame,
    pixels: Vec<[u8; 3]>,
}

impl Picture<'_> {
    /// Two pixels thick; what lies outside the image is left out.
    fn line(&mut self, a: Point, b: Point, colour: [u8; 3]) {
        let i = &self.frame.intrinsics;
        if a.z <= 0.0 || b.z <= 0.0 {
            return;
        }
        let (start, end) = (i.project(&a), i.project(&b));
        let length = (end.0 - start.0).abs().max((end.1 - start.1).abs());
        let steps = length.clamp(1.0, 40_000.0).ceil();
        for k in 0..=steps as usize {
            let t = k as f64 / steps;
            let u = (start.0 + (end.0 - start.0) * t).round();
            let v = (start.1 + (end.1 - start.1) * t).round();
            for (du, dv) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
                let (u, v) = (u + du, v + dv);
                if u >= 0.0 && v >= 0.0 && u < i.width as f64 && v < i.height as f64 {
                    self.pixels[v as usize * i.width + u as usize] = colour;
                }
            }
        }
    }
}
