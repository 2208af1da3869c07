//! Stages 5 to 8 for pictures whose steps are smeared: each height of the stack is covered by whole cartons as one, so
//! that its outline as a whole decides where each of them lies.
//!
//! Single sides are known to centimetres there and seams may not show at all. But a known size leaves few
//! arrangements that fill an outline with next to no play, and where a dozen outer sides agree, they agree to
//! millimetres. An arrangement counts when all its outer sides lie where the surface ends, and when every other
//! arrangement explains the picture clearly worse; of several that explain it as well, what they have in common counts.

use depal_frames::BoxSize;

use crate::{
    DetectedBox, Detection, RejectReason, RejectedSurface, VisionSettings,
    components::{Component, components},
    detect::overlap,
    gate::DepthImage,
    level::{Cut, Level},
    neighbours::neighbours,
    patch::pixel_pitch,
    plane::PlaneFrame,
    rated::{Rated, rated, weigh},
    surface::{Surface, least_pixels},
    tile_fit::Fitted,
    tile_relief::TileRelief,
    tiling::Tile,
    valleys::Valleys,
    verify::pose_on,
};

/// Tolerances are so many deviations of a depth by noise.
const SIGMAS: f64 = 6.0;
/// Of a top so much must be left between the smears of its sides, pixels, or nothing is reported: fifteen blocks of
/// those by which it is judged how plane it is. Of less, another arrangement was taken for the right one now and then.
const LEAST_PLANE: f64 = 75.0;
/// Tops are no less plane than the picture is noisy, deviations of a depth: else they are no tops.
const MOST_RELIEF: f64 = 0.9;
/// Surfaces of one height differ by no more than this share of a carton's height.
const ONE_HEIGHT: f64 = 0.15;
/// Share of a reported top that is seen as surface, at least.
const LEAST_SEEN: f64 = 0.9;
/// A carton's place is known to so much, or it is not reported, metres.
const KNOWN: f64 = 0.010;
/// A box found before lies where it does by itself when so many of its sides are seen.
const OUTLINED: u32 = 2;

/// Finds cartons on every height that those found so far leave open. What was found by outlines of its own must be
/// among them, or nothing is said about that height.
pub fn find_smeared(
    mask: &[u8],
    image: &DepthImage,
    smeared: &DepthImage,
    settings: &VisionSettings,
    smallest: f64,
    detection: &mut Detection,
) -> Vec<DetectedBox> {
    let height = settings.sizes.iter().map(|s| s.height).fold(1.0, f64::min);
    let tolerance = settings.plane_tolerance.max(ONE_HEIGHT * height);
    let loose = VisionSettings {
        plane_tolerance: tolerance,
        ..settings.clone()
    };
    let mut surfaces: Vec<Surface> =
        components(mask, image.width, least_pixels(image, settings, smallest))
            .into_iter()
            .filter_map(|c| Surface::new(c, image, settings, smallest).ok())
            .collect();
    surfaces.retain_mut(|s| s.layout(mask, image, settings).is_ok());
    let mut found = Vec::new();
    // One height all around, at least, must show that the size is right.
    let mut proven = false;
    for group in neighbours(&surfaces, &image.intrinsics, &loose) {
        let mut whole = Component::default();
        for &s in &group {
            whole.pixels += surfaces[s].component.pixels;
            whole.runs.extend(&surfaces[s].component.runs);
        }
        whole.runs.sort_by_key(|r| (r.row, r.first));
        let Ok(mut surface) = Surface::new(whole, image, &loose, smallest) else {
            continue;
        };
        let Ok(layout) = surface.layout(mask, image, settings) else {
            continue;
        };
        let known: Vec<&DetectedBox> = detection
            .boxes
            .iter()
            .filter(|b| surface.is_level_with(b, &loose) && is_within(b, &layout))
            .collect();
        let covered: f64 = known.iter().map(|b| b.size.length * b.size.width).sum();
        let Layer {
            boxes,
            reason,
            closed,
            denied,
        } = layer(smeared, settings, layout, tolerance, height, &known);
        detection.boxes.retain(|k| !denied.contains(k));
        proven |= closed && !boxes.is_empty();
        found.extend(boxes);
        detection
            .rejected
            .extend(reason.map(|reason| RejectedSurface {
                reason,
                centre_in_camera: surface.frame.origin,
                area: surface.area - covered,
            }));
    }
    if !proven {
        return Vec::new();
    }
    detection
        .boxes
        .retain(|k| !found.iter().any(|b| overlap(k, b)));
    found
}

/// True when the middle of a box lies in the range of a layout.
fn is_within(found: &DetectedBox, (frame, range): &Layout) -> bool {
    let from_origin = found.camera_from_box.translation.vector - frame.origin.coords;
    [frame.x, frame.y]
        .iter()
        .zip(range)
        .all(|(axis, [low, high])| (*low..*high).contains(&from_origin.dot(axis)))
}

/// Axes of a height and its ranges along them, metres.
type Layout = (PlaneFrame, [[f64; 2]; 2]);

/// What is said about one height.
#[derive(Default)]
struct Layer {
    boxes: Vec<DetectedBox>,
    /// Why not all of its surface is cartons.
    reason: Option<RejectReason>,
    /// All its outer sides are seen: its extents prove the size.
    closed: bool,
    /// Found before, but not what covers this height.
    denied: Vec<DetectedBox>,
}

impl Layer {
    fn refused(reason: RejectReason) -> Self {
        Self {
            reason: Some(reason),
            ..Self::default()
        }
    }
}

/// The cartons of one height.
fn layer(
    image: &DepthImage,
    settings: &VisionSettings,
    (frame, range): Layout,
    tolerance: f64,
    height: f64,
    known: &[&DetectedBox],
) -> Layer {
    let cell = pixel_pitch(&frame, &image.intrinsics);
    let shortest = settings
        .sizes
        .iter()
        .map(|s: &BoxSize| s.length.min(s.width))
        .fold(1.0, f64::min);
    let smear = settings.smear_px.clamp(4, 24);
    let slack = ((smear as f64 / 3.0 + 2.0) * cell)
        .max(0.012)
        .min(0.15 * shortest);
    let margin = 4.0 * slack + 0.03;
    let level = Level::new(
        image,
        &Cut {
            frame,
            range: range.map(|[a, b]| [a - margin, b + margin]),
            cell,
            tolerance,
            height,
            smear,
            valley: smear + 4,
        },
    );
    let valleys = Valleys::new(&level, smear as f64 * cell, shortest);
    let relief = TileRelief::new(
        &level,
        smear.max(2 * settings.average_px + 1),
        shortest,
        settings.plane_tolerance / SIGMAS,
    );
    let (mut fitted, complete) = rated(&level, &valleys, &relief, settings, slack, height);
    if !fitted.iter().any(|r| r.holds) {
        return Layer::refused(RejectReason::NoKnownSize);
    }
    let Some(noise) = weigh(&mut fitted, &relief) else {
        return Layer::refused(RejectReason::Ambiguous);
    };
    let (mut fitted, odd): (Vec<Rated>, Vec<Rated>) = fitted.into_iter().partition(|r| r.holds);
    fitted.sort_by(|a, b| a.total().total_cmp(&b.total()));
    let Some(best) = fitted.first() else {
        return Layer::refused(RejectReason::NoKnownSize);
    };
    let Rated { one: first, .. } = best;
    // Outlines are misread more easily than tops: an odd one counts as well.
    let rivals: Vec<&Fitted> = fitted[1..]
        .iter()
        .chain(odd.iter().filter(|o| o.nearly))
        .filter(|o| best.leaves_open(o))
        .map(|other| &other.one)
        .collect();
    let rough = noise.left.sqrt() > MOST_RELIEF * settings.plane_tolerance / SIGMAS;
    let hidden = first.tiles.iter().any(|t| t.hidden);
    let all: Vec<DetectedBox> = first
        .tiles
        .iter()
        .enumerate()
        .map(|(n, tile)| report(&level, settings, tile, first.sides[n], first.spread[n]))
        .collect();
    let shared: Vec<bool> = first
        .tiles
        .iter()
        .map(|tile| {
            rivals
                .iter()
                .all(|r| r.tiles.iter().any(|o| o.is_like(tile)))
        })
        .collect();
    // Where several readings may be true, those found before must all lie where they do by themselves: others are but
    // one covering of a part.
    let outlined = known.iter().all(|k| k.proven_sides >= OUTLINED);
    let may_be = |k: &DetectedBox| {
        first.is_one_of(k, &level.frame)
            || outlined && rivals.iter().any(|r| r.is_one_of(k, &level.frame))
    };
    let denied: Vec<DetectedBox> = known
        .iter()
        .filter(|k| !may_be(k))
        .map(|k| (*k).clone())
        .collect();
    let otherwise = !known.iter().all(|k| first.is_one_of(k, &level.frame));
    if rough || hidden || otherwise || !complete && !rivals.is_empty() {
        return Layer {
            denied,
            ..Layer::refused(RejectReason::Ambiguous)
        };
    }
    if shortest < (smear as f64 + LEAST_PLANE) * cell {
        return Layer::default();
    }
    let placed = |n: usize| first.spread[n].iter().all(|s| *s <= KNOWN);
    Layer {
        boxes: (0..all.len())
            .filter(|&n| shared[n] && placed(n) && all[n].visible_fraction >= LEAST_SEEN)
            .map(|n| all[n].clone())
            .collect(),
        reason: shared.contains(&false).then_some(RejectReason::Ambiguous),
        closed: first.hidden_sides == 0,
        denied: Vec::new(),
    }
}

fn report(
    level: &Level,
    settings: &VisionSettings,
    tile: &Tile,
    sides: u32,
    spread: [f64; 2],
) -> DetectedBox {
    let inner = |sign: f64| [0, 1].map(|k| tile.centre[k] + sign * 0.7 * tile.half[k]);
    let height = level.mean_height(inner(-1.0), inner(1.0)).unwrap_or(0.0);
    let mut frame = level.frame;
    frame.origin = frame.point(tile.centre[0], tile.centre[1]);
    let frame = frame.on_plane(level.plane_at(height));
    let [on, _] = level.shares(
        [0, 1].map(|k| tile.centre[k] - 0.93 * tile.half[k]),
        [0, 1].map(|k| tile.centre[k] + 0.93 * tile.half[k]),
    );
    DetectedBox {
        camera_from_box: pose_on(&frame, tile.turned),
        size: settings.sizes[tile.label as usize],
        label: tile.label,
        confidence: (0.9 - spread[0].max(spread[1]) / KNOWN * 0.4).clamp(0.0, 1.0),
        visible_fraction: on.min(1.0),
        proven_sides: sides,
    }
}
