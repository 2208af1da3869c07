//! One flat surface: its plane, its direction, and the cartons on it.

use crate::{
    DetectedBox, RejectReason, RejectedSurface, VisionSettings,
    blank::Blank,
    components::Component,
    cover::uncovered,
    doubles::is_doubtful,
    even::is_even,
    gate::{DepthImage, LARGEST_DEPTH},
    measure::measure_whole,
    orientation::{main_direction, outline},
    outlined::outlined,
    patch::{Grid, Patch, SHARP_RIM, pixel_pitch},
    plane::{PlaneFrame, fit_plane},
    search::{Candidate, extents},
    support::Measured,
    verify::{Proof, verify},
};

mod covered;

/// How far a patch reaches beyond its surface, metres.
const MARGIN: f64 = 0.030;

/// What shows less of the smallest carton than this is none.
const LEAST_PART: f64 = 0.25;
/// Fewer pixels make no plane.
const LEAST_SAMPLES: usize = 50;

/// A piece of fewer pixels is too small for [`Surface::new`], however far away it lies.
pub fn least_pixels(image: &DepthImage, settings: &VisionSettings, smallest: f64) -> usize {
    /// Rounding is less than that.
    const SLACK: f64 = 0.999;
    let far = settings.max_depth.min(f64::from(LARGEST_DEPTH));
    let seen = LEAST_PART * smallest * image.intrinsics.fx * image.intrinsics.fy / (far * far);
    LEAST_SAMPLES.max((SLACK * seen) as usize)
}

/// A piece of the step mask that lies on a plane roughly facing the camera.
pub struct Surface {
    pub component: Component,
    /// Origin near its middle, X along the camera's X.
    pub frame: PlaneFrame,
    /// Square metres of its mask, which ends two pixels inside the real border.
    pub area: f64,
    /// All of it belongs to found boxes.
    pub solved: bool,
    /// How far its carton may go on beyond it, metres.
    pub reach: f64,
    bounds: Option<Bounds>,
    searched: Option<Searched>,
}

/// Main direction of an outline (radians) and its ranges along that and across it, metres.
#[derive(Debug, Clone, Copy)]
pub struct Bounds {
    pub yaw: f64,
    pub x: [f64; 2],
    pub y: [f64; 2],
}

/// A patch and the boxes whose outline was found on it.
struct Searched {
    patch: Patch,
    fixed: Vec<Candidate>,
    boxes: Vec<DetectedBox>,
}

impl Surface {
    /// `Err(None)`: too small to be the visible rest of a carton.
    pub fn new(
        component: Component,
        image: &DepthImage,
        settings: &VisionSettings,
        smallest: f64,
    ) -> Result<Self, Option<RejectedSurface>> {
        let k = &image.intrinsics;
        let wanted = 500 + component.pixels / 200;
        let stride = (component.pixels / wanted.min(4000)).max(1);
        let mut samples = Vec::with_capacity(2 * wanted.min(4000));
        let mut skip = stride / 2;
        for run in &component.runs {
            let length = run.last - run.first + 1;
            while skip < length {
                let u = run.first + skip;
                let z = image.depth[run.row * image.width + u];
                // Lone holes count as surface but measure nothing.
                if z > 0.0 {
                    samples.push((u as f64, run.row as f64, f64::from(z)));
                }
                skip += stride;
            }
            skip -= length;
        }
        let n = samples.len().max(1) as f64;
        let (u, v, z) = samples.iter().fold((0.0, 0.0, 0.0), |s, p| {
            (s.0 + p.0 / n, s.1 + p.1 / n, s.2 + p.2 / n)
        });
        let area = component.pixels as f64 * (z / k.fx) * (z / k.fy);
        if area < LEAST_PART * smallest || samples.len() < LEAST_SAMPLES {
            return Err(None);
        }
        let centre_in_camera = k.deproject(u, v, z);
        let reject = |reason| {
            Some(RejectedSurface {
                reason,
                centre_in_camera,
                area,
            })
        };
        // Loose at first: several cartons of slightly different heights may hang together.
        let (plane, rms) = fit_plane(&samples, k, 3.0 * settings.plane_tolerance)
            .ok_or_else(|| reject(RejectReason::NotFlat))?;
        if rms > settings.plane_tolerance {
            return Err(reject(RejectReason::NotFlat));
        }
        if (-plane.normal().z).clamp(-1.0, 1.0).acos() > settings.max_tilt {
            return Err(reject(RejectReason::Tilted));
        }
        let frame = PlaneFrame::new(plane, &k.ray(u, v));
        Ok(Self {
            component,
            frame,
            area,
            solved: false,
            reach: 0.0,
            bounds: None,
            searched: None,
        })
    }

    /// True when the middle of a found box lies on this plane.
    pub fn is_level_with(&self, found: &DetectedBox, settings: &VisionSettings) -> bool {
        let middle = found.camera_from_box.translation.vector;
        (self.frame.plane.depth(&(middle / middle.z)) - middle.z).abs() < settings.plane_tolerance
    }

    fn rejected(&self, reason: RejectReason) -> RejectedSurface {
        RejectedSurface {
            reason,
            centre_in_camera: self.frame.origin,
            area: self.area,
        }
    }

    /// True when its first and last row, or its outermost columns, lie farther apart than that, metres.
    fn spans_more_than(&self, image: &DepthImage, distance: f64) -> bool {
        let runs = &self.component.runs;
        let (Some(top), Some(bottom)) = (runs.first(), runs.last()) else {
            return false;
        };
        let (mut left, mut right) = (*top, *top);
        for run in runs {
            if run.first < left.first {
                left = *run;
            }
            if run.last > right.last {
                right = *run;
            }
        }
        let at =
            |u: usize, row: usize| self.frame.of_pixel(&image.intrinsics, u as f64, row as f64);
        let apart = |a: (f64, f64), b: (f64, f64)| (a.0 - b.0).hypot(a.1 - b.1) > distance;
        apart(at(top.first, top.row), at(bottom.last, bottom.row))
            || apart(at(left.first, left.row), at(right.last, right.row))
    }

    /// Direction and size; `Err` when this is background.
    pub fn bounds(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
    ) -> Result<Bounds, RejectedSurface> {
        if let Some(bounds) = self.bounds {
            return Ok(bounds);
        }
        if self.spans_more_than(image, settings.max_surface_side * std::f64::consts::SQRT_2) {
            return Err(self.rejected(RejectReason::Background));
        }
        let pitch = pixel_pitch(&self.frame, &image.intrinsics);
        let border = outline(&self.component, mask, image, &self.frame);
        let yaw = main_direction(&border, 2.0 * pitch);
        let (s, c) = yaw.sin_cos();
        let (mut x, mut y) = ([f64::MAX, f64::MIN], [f64::MAX, f64::MIN]);
        for &(px, py) in &border {
            let (along, across) = (px * c + py * s, py * c - px * s);
            x = [x[0].min(along), x[1].max(along)];
            y = [y[0].min(across), y[1].max(across)];
        }
        if (x[1] - x[0]).max(y[1] - y[0]) > settings.max_surface_side {
            return Err(self.rejected(RejectReason::Background));
        }
        let bounds = Bounds { yaw, x, y };
        self.bounds = Some(bounds);
        Ok(bounds)
    }

    /// Axes along its main direction, and its ranges along them, metres; `Err` when this is background.
    pub fn layout(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
    ) -> Result<(PlaneFrame, [[f64; 2]; 2]), RejectedSurface> {
        let bounds = self.bounds(mask, image, settings)?;
        Ok((self.frame.turned(bounds.yaw), [bounds.x, bounds.y]))
    }

    /// Its plane in the middle of its bounds, X along its main direction.
    pub fn middle(&self, bounds: &Bounds) -> PlaneFrame {
        let frame = self.frame.turned(bounds.yaw);
        let [x, y] = [bounds.x, bounds.y].map(|[low, high]| f64::midpoint(low, high));
        PlaneFrame {
            origin: frame.point(x, y),
            ..frame
        }
    }

    /// Resampled along its main direction.
    fn patch(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
        found: &[DetectedBox],
    ) -> Result<Patch, RejectedSurface> {
        let bounds = self.bounds(mask, image, settings)?;
        let frame = self.frame.turned(bounds.yaw);
        let pitch = pixel_pitch(&self.frame, &image.intrinsics);
        let margin = margin(settings, pitch) + self.reach;
        let grid = Grid {
            frame,
            x: [bounds.x[0] - margin, bounds.x[1] + margin],
            y: [bounds.y[0] - margin, bounds.y[1] + margin],
            pitch,
            rim: SHARP_RIM + settings.smear_px.min(20) / 3,
            soft_px: settings.smear_px.max(2 * settings.average_px),
            averaged: settings.average_px > 0,
        };
        let blanks: Vec<Blank> = found.iter().map(|b| Blank::of(b, &frame)).collect();
        Ok(Patch::new(image, &grid, &blanks, settings.plane_tolerance))
    }

    /// The one carton of a known size that this piece plainly is: its outline fills a rectangle of that
    /// size, and nothing runs through it. `None` says nothing: then [`Surface::search`] must look closely.
    pub fn single(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
    ) -> Option<DetectedBox> {
        /// Share of the rectangle that must be mask.
        const FILLED: f64 = 0.93;
        /// The mask ends two pixels inside the border, and counts whole pixels.
        const BORDER: f64 = 5.0;
        const SLACK_PIXELS: f64 = 2.5;
        let bounds = self.bounds(mask, image, settings).ok()?;
        let pitch = pixel_pitch(&self.frame, &image.intrinsics);
        let range = [bounds.x[1] - bounds.x[0], bounds.y[1] - bounds.y[0]];
        let allowed = settings.size_tolerance + SLACK_PIXELS * pitch;
        let misfit = |label: usize, turned: bool| {
            let sides = extents(&settings.sizes[label], turned);
            (0..2).fold(0.0f64, |worst, k| {
                worst.max((range[k] + BORDER * pitch - sides[k]).abs())
            })
        };
        let (label, turned) = (0..settings.sizes.len())
            .flat_map(|label| [(label, false), (label, true)])
            .filter(|&(label, turned)| misfit(label, turned) <= allowed)
            .min_by(|a, b| misfit(a.0, a.1).total_cmp(&misfit(b.0, b.1)))?;
        if self.area < FILLED * (range[0] + pitch) * (range[1] + pitch) {
            return None;
        }
        let start = self.middle(&bounds);
        if !is_even(mask, image, &start, range, pitch) {
            return None;
        }
        let found = verify(image, settings, start, label as u32, turned, Proof::Outline).ok()?;
        (found.proven_sides == 4 && !is_doubtful(image, settings, &found)).then_some(found)
    }

    /// Boxes whose outline can be seen; `Err` when this is background.
    pub fn search(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
        smallest: f64,
    ) -> Result<Vec<DetectedBox>, RejectedSurface> {
        /// Less than this share of the smallest carton is no further one.
        const LEAST_REST: f64 = 0.3;
        let patch = self.patch(mask, image, settings, &[])?;
        let (fixed, boxes) = outlined(&patch, image, settings, &mut Vec::new());
        self.solved = uncovered(&patch, &fixed) < LEAST_REST * smallest;
        if !self.solved {
            self.searched = Some(Searched {
                patch,
                fixed,
                boxes: boxes.clone(),
            });
        }
        Ok(boxes)
    }

    /// The carton of unknown size that this surface is.
    pub fn measure(
        &mut self,
        mask: &[u8],
        image: &DepthImage,
        settings: &VisionSettings,
    ) -> Result<Measured, RejectedSurface> {
        let patch = self.patch(mask, image, settings, &[])?;
        let margin = margin(settings, patch.pitch);
        measure_whole(&patch, image, settings, self.area, margin)
    }
}

/// How far a patch reaches beyond its surface, which ends early where steps are smeared, metres.
fn margin(settings: &VisionSettings, pitch: f64) -> f64 {
    MARGIN + settings.smear_px.min(30) as f64 * pitch
}
