//! The judgement of what was measured of a pallet.

use depal_frames::{Point, Vector};
use depal_vision::DetectedBox;

use super::Scene;
use crate::{generator::at, rendered::Carton};

/// True for a point (own axes of a carton) under or in another one.
pub fn holds(other: &Carton, p: &Vector, margin: f64) -> bool {
    let (s, c) = other.yaw.sin_cos();
    let (dx, dy) = (p.x - other.x, p.y - other.y);
    let (x, y) = (dx * c + dy * s, dy * c - dx * s);
    x.abs() < other.size[0] / 2.0 - margin && y.abs() < other.size[1] / 2.0 - margin
}

/// Points of a top, `margin` inside.
pub fn grid(carton: &Carton, count: i32, margin: f64) -> Vec<Vector> {
    let mut points = Vec::new();
    for i in 0..count {
        for j in 0..count {
            let at = |n: i32, side: f64| {
                ((f64::from(n) + 0.5) / f64::from(count) - 0.5) * (side - 2.0 * margin)
            };
            let p = Vector::new(at(i, carton.size[0]), at(j, carton.size[1]), 0.0);
            points.push(carton.rotation() * p + Vector::new(carton.x, carton.y, carton.top));
        }
    }
    points
}

/// True when another carton stands on it.
pub fn is_covered(cartons: &[Carton], n: usize) -> bool {
    let on_it = |o: &Carton| o.top - o.size[2] > cartons[n].top - 0.02;
    cartons.iter().filter(|o| on_it(o)).any(|o| {
        grid(&cartons[n], 60, 0.003)
            .iter()
            .any(|p| holds(o, p, 0.0))
    })
}

/// Share of a top that higher cartons hide from the camera.
fn hidden(cartons: &[Carton], n: usize) -> f64 {
    let eye = at().translation.vector;
    let points = grid(&cartons[n], 20, 0.0);
    let blocked = |p: &Vector| {
        cartons.iter().enumerate().any(|(k, o)| {
            k != n
                && (1..60).any(|s| {
                    let q = p + (eye - p) * (f64::from(s) * 0.004);
                    q.z < o.top && q.z > o.top - o.size[2] && holds(o, &q, 0.0)
                })
        })
    };
    points.iter().filter(|p| blocked(p)).count() as f64 / points.len() as f64
}

/// What became of one picture.
#[derive(Debug, Default, Clone)]
pub struct Verdict {
    /// Uncovered cartons, wholly in view.
    pub wanted: usize,
    pub found: usize,
    /// Reports of a carton that is there, but something stands on it.
    pub covered: usize,
    /// Reports that hold most of two cartons or more.
    pub spanning: usize,
    /// Other reports that are no carton.
    pub wrong: usize,
    /// Measured less true side of what was found, mm.
    pub off_mm: Vec<f64>,
    pub xy_mm: Vec<f64>,
    pub notes: Vec<String>,
}

impl Verdict {
    pub fn absorb(&mut self, other: Self) {
        self.wanted += other.wanted;
        self.found += other.found;
        self.covered += other.covered;
        self.spanning += other.spanning;
        self.wrong += other.wrong;
        self.off_mm.extend(other.off_mm);
        self.xy_mm.extend(other.xy_mm);
        self.notes.extend(other.notes);
    }

    /// Reports that a robot must not act on.
    pub fn bad(&self) -> usize {
        self.covered + self.spanning + self.wrong
    }
}

/// Compares reports with the truth.
pub fn judge(scene: &Scene, boxes: &[DetectedBox]) -> Verdict {
    let cartons = &scene.cartons;
    let covered: Vec<bool> = (0..cartons.len()).map(|n| is_covered(cartons, n)).collect();
    let wanted: Vec<bool> = (0..cartons.len())
        .map(|n| !covered[n] && hidden(cartons, n) < 0.02)
        .collect();
    let mut verdict = Verdict {
        wanted: wanted.iter().filter(|w| **w).count(),
        ..Verdict::default()
    };
    let mut taken = vec![false; cartons.len()];
    for found in boxes {
        let pose = at() * found.camera_from_box;
        let p = pose.translation.vector;
        let own = (0..cartons.len()).find(|&n| {
            let c = &cartons[n];
            !taken[n]
                && (c.x - p.x).hypot(c.y - p.y) < 0.02
                && (c.top - p.z).abs() < 0.02
                && (c.size[0] - found.size.length).abs() < 0.02
                && (c.size[1] - found.size.width).abs() < 0.02
        });
        let tell = |what: &str| {
            format!(
                "{what} {:.0} x {:.0} at {:.0} {:.0} {:.0}, confidence {:.2}",
                found.size.length * 1e3,
                found.size.width * 1e3,
                p.x * 1e3,
                p.y * 1e3,
                p.z * 1e3,
                found.confidence
            )
        };
        if let Some(n) = own {
            taken[n] = true;
            if covered[n] {
                verdict.covered += 1;
                verdict.notes.push(tell("covered"));
                continue;
            }
            let off = [
                found.size.length - cartons[n].size[0],
                found.size.width - cartons[n].size[1],
            ];
            if wanted[n] {
                verdict.found += 1;
            }
            if off.iter().any(|o| o.abs() > 0.002) {
                verdict.notes.push(tell("size off"));
            }
            verdict.off_mm.extend(off.map(|o| o * 1e3));
            let c = &cartons[n];
            verdict.xy_mm.push((c.x - p.x).hypot(c.y - p.y) * 1e3);
            continue;
        }
        // Whose tops lie under it.
        let spanned = cartons
            .iter()
            .filter(|c| {
                let points = grid(c, 20, 0.0);
                let under = points.iter().filter(|q| {
                    let q = pose.inverse_transform_point(&Point::from(**q));
                    q.x.abs() < found.size.length / 2.0
                        && q.y.abs() < found.size.width / 2.0
                        && q.z.abs() < 0.02
                });
                under.count() * 2 > points.len()
            })
            .count();
        if spanned >= 2 {
            verdict.spanning += 1;
            verdict.notes.push(tell("spanning"));
        } else {
            verdict.wrong += 1;
            verdict.notes.push(tell("wrong"));
        }
    }
    verdict
}
