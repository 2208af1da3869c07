//! What the world outside does to a depth picture after the camera has taken it: pixels lost one by one or in clusters,
//! pixels with any depth at all, and what a camera's own filters make of it.
#![allow(dead_code)]

use depal_frames::DepthFrame;
use depal_time::{RandomStream, RandomStreams};

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Disturbance {
    None,
    /// Share of the pixels that are lost, each by itself.
    Lost(f64),
    /// Share of the pixels that are lost in clusters of three to ten.
    Clusters(f64),
    /// Share of the pixels that show any depth between 0.5 m and 5 m.
    Outliers(f64),
    /// Median of all that is measured in 3 x 3.
    Median,
    /// What was lost is put in along the rows, straight from one side to the other.
    Interpolated,
    /// What was lost shows the farther one of what was measured beside it in its row.
    FilledFarther,
    /// Depth in steps of so many metres.
    Steps(f64),
}

impl Disturbance {
    pub fn of(self, frame: &DepthFrame, seed: u64) -> DepthFrame {
        let mut frame = frame.clone();
        let mut r = RandomStreams::new(seed).stream("disturbance");
        let width = frame.intrinsics.width;
        match self {
            Self::None => {}
            Self::Lost(share) => {
                for z in &mut frame.depth {
                    if r.uniform(0.0, 1.0) < share {
                        *z = 0.0;
                    }
                }
            }
            Self::Clusters(share) => lose_clusters(&mut frame.depth, width, share, &mut r),
            Self::Outliers(share) => {
                for z in &mut frame.depth {
                    if r.uniform(0.0, 1.0) < share {
                        *z = r.uniform(0.5, 5.0) as f32;
                    }
                }
            }
            Self::Median => frame.depth = median(&frame.depth, width),
            Self::Interpolated => fill_rows(&mut frame.depth, width, |a, b, t| a + (b - a) * t),
            Self::FilledFarther => fill_rows(&mut frame.depth, width, |a, b, _| a.max(b)),
            Self::Steps(step) => {
                for z in &mut frame.depth {
                    *z = ((f64::from(*z) / step).round() * step) as f32;
                }
            }
        }
        frame
    }
}

/// Each cluster grows from a pixel by neighbours drawn by lot.
fn lose_clusters(depth: &mut [f32], width: usize, share: f64, r: &mut RandomStream) {
    let height = depth.len() / width;
    let draw = |r: &mut RandomStream, n: usize| (r.uniform(0.0, n as f64) as usize).min(n - 1);
    let mut open = (share * depth.len() as f64) as usize;
    while open > 0 {
        let mut cluster = vec![(draw(r, width), draw(r, height))];
        let wanted = 3 + draw(r, 8);
        while cluster.len() < wanted {
            let (u, v) = cluster[draw(r, cluster.len())];
            let next = match draw(r, 4) {
                0 => (u.wrapping_add(1), v),
                1 => (u.wrapping_sub(1), v),
                2 => (u, v.wrapping_add(1)),
                _ => (u, v.wrapping_sub(1)),
            };
            if !cluster.contains(&next) {
                cluster.push(next);
            }
        }
        for (u, v) in cluster {
            if u < width && v < height {
                depth[v * width + u] = 0.0;
            }
        }
        open = open.saturating_sub(wanted);
    }
}

fn median(depth: &[f32], width: usize) -> Vec<f32> {
    let height = depth.len() / width;
    let mut out = depth.to_vec();
    for v in 1..height - 1 {
        for u in 1..width - 1 {
            let mut around = [0.0; 9];
            let mut count = 0;
            for w in v - 1..=v + 1 {
                for z in &depth[w * width + u - 1..=w * width + u + 1] {
                    if *z > 0.0 {
                        around[count] = *z;
                        count += 1;
                    }
                }
            }
            // Five of nine make the median of a picture in which what was lost is 0.
            out[v * width + u] = if count < 5 {
                0.0
            } else {
                around[..count].sort_unstable_by(f32::total_cmp);
                around[count / 2]
            };
        }
    }
    out
}

fn fill_rows(depth: &mut [f32], width: usize, value: impl Fn(f32, f32, f32) -> f32) {
    for row in depth.chunks_exact_mut(width) {
        let mut last: Option<usize> = None;
        for u in 0..width {
            if row[u] == 0.0 {
                continue;
            }
            if let Some(from) = last {
                let (a, b) = (row[from], row[u]);
                for (k, z) in row[from..u].iter_mut().enumerate().skip(1) {
                    *z = value(a, b, k as f32 / (u - from) as f32);
                }
            }
            last = Some(u);
        }
    }
}
