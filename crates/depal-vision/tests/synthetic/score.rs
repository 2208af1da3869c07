//! What was found, against the truth.

use std::f64::consts::PI;

use depal_frames::{Pose, Vector};

use super::{Scene, Solid};

/// One detected box against the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseError {
    pub xy_mm: f64,
    pub z_mm: f64,
    pub yaw_deg: f64,
    pub tilt_deg: f64,
}

#[derive(Debug, Default)]
pub struct Score {
    pub wanted: usize,
    pub found: usize,
    pub false_positives: usize,
    pub errors: Vec<PoseError>,
}

impl Score {
    /// Adds one frame's boxes `(camera_from_box, size)`.
    pub fn add<'a>(&mut self, scene: &Scene, boxes: impl Iterator<Item = &'a Pose>) {
        let mut open: Vec<&Solid> = scene.solids.iter().filter(|s| s.wanted).collect();
        self.wanted += open.len();
        for camera_from_box in boxes {
            let pose = scene.scene_from_camera() * camera_from_box;
            let p = pose.translation.vector;
            let nearest = open
                .iter()
                .enumerate()
                .map(|(i, s)| (i, (s.x - p.x).hypot(s.y - p.y), (s.top - p.z).abs()))
                .filter(|m| m.2 < 0.02)
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let Some((i, xy, z)) = nearest.filter(|m| m.1 < 0.02) else {
                self.false_positives += 1;
                continue;
            };
            let solid = open.remove(i);
            let x = pose.rotation * Vector::x();
            let mut yaw = x.y.atan2(x.x) - solid.yaw;
            yaw -= (yaw / PI).round() * PI;
            let normal = pose.rotation * Vector::z();
            self.found += 1;
            self.errors.push(PoseError {
                xy_mm: xy * 1e3,
                z_mm: z * 1e3,
                yaw_deg: yaw.abs().to_degrees(),
                tilt_deg: normal.angle(&solid.normal()).to_degrees(),
            });
        }
    }

    /// The given share of the errors is at most this.
    pub fn quantile(&self, share: f64, of: fn(&PoseError) -> f64) -> f64 {
        let mut values: Vec<f64> = self.errors.iter().map(of).collect();
        values.sort_by(f64::total_cmp);
        let last = values.len().saturating_sub(1);
        values
            .get((share * last as f64).round() as usize)
            .copied()
            .unwrap_or(f64::NAN)
    }

    pub fn line(&self) -> String {
        let q = |share, of| self.quantile(share, of);
        format!(
            "{:3}/{:3} fp {} | xy {:.2} {:.2} {:.2} | z {:.2} | yaw {:.3} {:.3} | tilt {:.3}",
            self.found,
            self.wanted,
            self.false_positives,
            q(0.5, |e| e.xy_mm),
            q(0.95, |e| e.xy_mm),
            q(1.0, |e| e.xy_mm),
            q(0.95, |e| e.z_mm),
            q(0.5, |e| e.yaw_deg),
            q(0.95, |e| e.yaw_deg),
            q(0.95, |e| e.tilt_deg),
        )
    }
}
