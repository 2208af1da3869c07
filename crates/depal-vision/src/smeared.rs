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
    misfit::{Misfit, OVERFIT_BLOCKS, WORSE_BLOCKS},
    neighbours::neighbours,
    patch::pixel_pitch,
    plane::PlaneFrame,
    surface::Surface,
    tile_fit::{Fitted, fit},
    tile_relief::TileRelief,
    tiling::{Tile, readings},
    valleys::Valleys,
    verify::pose_on,
};

/// Tops of fewer pixels across are not looked for: what a smear from both sides leaves of them is too little to tell the
/// right arrangement from others by how plane its tops are.
const LEAST_ACROSS: f64 = 90.0;
/// Surfaces of one height differ by no more than this share of a carton's height.
const ONE_HEIGHT: f64 = 0.15;
/// Beyond outer sides it is at least so much deeper, in heights of a carton.
const LEAST_DROP: f64 = 0.6;
/// Share of the outer sides that must end the surface.
const LEAST_ENDS: f64 = 0.7;
/// Mean square of the errors of the outer sides, and the greatest of them, in deviations.
const MOST_ERROR: f64 = 4.0;
const WORST_ERROR: f64 = 4.5;
/// Share of the surface that no tile explains, at most.
const MOST_OPEN: f64 = 0.04;
/// Width of the outline and of the gaps are so many deviations from what is usual, at most.
const MOST_UNUSUAL: f64 = 2.5;
/// Mean evidence of seams that show, squared deviations.
const SHOWN: f64 = 9.0;
/// Share of a reported top that is seen as surface, at least.
const LEAST_SEEN: f64 = 0.9;
/// By so much, in squared deviations, an arrangement is better than another one that is out of the question.
const LEAD: f64 = 9.0;
/// That sides of cartons just lie where something hides them is chance of one in twenty: twice its logarithm.
const HIDDEN: f64 = 9.0;
/// What the surface costs where it goes on beyond outer sides, for all of their length.
const GOES_ON: f64 = 40.0;
/// A carton's place is known to so much, or it is not reported, metres.
const KNOWN: f64 = 0.010;

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
    let mut surfaces: Vec<Surface> = components(mask, image.width)
        .into_iter()
        .filter_map(|c| Surface::new(c, image, settings, smallest).ok())
        .collect();
    surfaces.retain_mut(|s| s.layout(mask, image, settings).is_ok());
    let mut found = Vec::new();
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
        let (boxes, reason) = layer(smeared, settings, layout, tolerance, height, &known);
        detection
            .boxes
            .retain(|k| !boxes.iter().any(|b| overlap(k, b)));
        found.extend(boxes);
        detection
            .rejected
            .extend(reason.map(|reason| RejectedSurface {
                reason,
                centre_in_camera: surface.frame.origin,
                area: surface.area - covered,
            }));
    }
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

/// The cartons of one height, and why not all of its surface is one.
fn layer(
    image: &DepthImage,
    settings: &VisionSettings,
    (frame, range): Layout,
    tolerance: f64,
    height: f64,
    known: &[&DetectedBox],
) -> (Vec<DetectedBox>, Option<RejectReason>) {
    let cell = pixel_pitch(&frame, &image.intrinsics);
    let shortest = settings
        .sizes
        .iter()
        .map(|s: &BoxSize| s.length.min(s.width))
        .fold(1.0, f64::min);
    let smear = settings.smear_px.clamp(4, 24);
    if shortest < LEAST_ACROSS * cell {
        return (Vec::new(), None);
    }
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
            smear: smear,
            valley: smear + 4,
        },
    );
    let valleys = Valleys::new(&level, smear as f64 * cell, shortest);
    let relief = TileRelief::new(
        &level,
        smear.max(2 * settings.average_px + 1),
        shortest,
        settings.sigma(),
    );
    let (mut fitted, complete) = rated(&level, &valleys, &relief, settings, slack, height);
    if !fitted.iter().any(|r| r.holds) {
        return (Vec::new(), Some(RejectReason::NoKnownSize));
    }
    let noise = fitted
        .iter()
        .filter(|r| r.holds)
        .map(|r| r.misfit.mean())
        .filter(|m| *m > 0.0)
        .fold(f64::MAX, f64::min);
    for r in &mut fitted {
        r.uneven = r.misfit.beyond(noise) / (noise * relief.lump);
    }
    let (mut fitted, odd): (Vec<Rated>, Vec<Rated>) = fitted.into_iter().partition(|r| r.holds);
    fitted.sort_by(|a, b| a.total().total_cmp(&b.total()));
    let Some(best) = fitted.first() else {
        return (Vec::new(), Some(RejectReason::NoKnownSize));
    };
    let Rated { one: first, .. } = best;
    let rivals: Vec<&Fitted> = fitted[1..]
        .iter()
        .filter(|other| !best.rules_out(other) && !same(&first.tiles, &other.one.tiles))
        .map(|other| &other.one)
        .collect();
    // One that explains the inside better although its outline is odd: then the outline was misread.
    let misread = odd
        .iter()
        .any(|o| !same(&first.tiles, &o.one.tiles) && best.inside(o) < 0.0);
    if misread || !complete && !rivals.is_empty() {
        return (Vec::new(), Some(RejectReason::Ambiguous));
    }
    let best = first;
    let all: Vec<DetectedBox> = best
        .tiles
        .iter()
        .enumerate()
        .map(|(n, tile)| report(&level, settings, tile, best.sides[n], best.spread[n]))
        .collect();
    let agrees = |k: &&DetectedBox| all.iter().any(|b| is_same(b, k));
    if !known.iter().all(|k| agrees(k)) {
        return (Vec::new(), Some(RejectReason::Ambiguous));
    }
    let mut open = false;
    let mut boxes = Vec::new();
    for (n, tile) in best.tiles.iter().enumerate() {
        let shared = rivals
            .iter()
            .all(|r| r.tiles.iter().any(|o| o.is_like(tile)));
        let placed = best.spread[n].iter().all(|s| *s <= KNOWN);
        open |= !shared;
        if shared && placed && !tile.hidden && all[n].visible_fraction >= LEAST_SEEN {
            boxes.push(all[n].clone());
        }
    }
    (boxes, open.then_some(RejectReason::Ambiguous))
}

/// The readings of a level that may be true, and whether there are no others.
fn rated(
    level: &Level,
    valleys: &Valleys,
    relief: &TileRelief,
    settings: &VisionSettings,
    slack: f64,
    height: f64,
) -> (Vec<Rated>, bool) {
    let places = level.inner_places(slack);
    let mut complete = true;
    let mut fitted: Vec<Rated> = Vec::new();
    for fat in [0.0, slack, -0.5 * slack] {
        let found = readings(level, valleys, &settings.sizes, slack, fat);
        complete &= found.complete;
        for tiles in &found.readings {
            let Some(one) = fit(level, tiles, slack) else {
                continue;
            };
            let open = places
                .iter()
                .filter(|p| !one.tiles.iter().any(|t| t.holds(**p, 0.8 * slack)))
                .count();
            let seams: f64 = one
                .seams
                .iter()
                .map(|s| {
                    let [a, b] = s.tiles.map(|k| &one.tiles[k]);
                    let at = f64::midpoint(a.high(s.axis), b.low(s.axis));
                    valleys.evidence(s.axis, at, s.range)
                })
                .sum();
            // Narrow gaps may hide in the noise, wide ones must show.
            let shown = seams >= SHOWN * one.seams.len() as f64;
            let hidden = one.tiles.iter().filter(|t| t.hidden).count();
            // A hidden side proves nothing: the others must prove all the more.
            let most = if hidden > 0 { 1.0 } else { MOST_UNUSUAL };
            let usual =
                one.fat_deviations.abs() <= most && (shown || one.gap_deviations.abs() <= most);
            let holds = usual
                && open as f64 <= MOST_OPEN * places.len() as f64
                && one.outer <= MOST_ERROR * one.outer_sides as f64
                && one.worst <= WORST_ERROR
                && one.ends >= LEAST_ENDS
                && one.drop >= LEAST_DROP * height;
            let cost = one.squares + HIDDEN * hidden as f64 + GOES_ON * (1.0 - one.ends);
            let seen = relief.misfit(&one.tiles);
            let misfit = seen.unwrap_or_default();
            // One carton is one plane, as far as noise lets it be seen.
            let uneven = misfit.beyond(relief.noise) / (relief.noise * relief.lump);
            let most = WORSE_BLOCKS + OVERFIT_BLOCKS * one.tiles.len() as f64;
            fitted.push(Rated {
                cost,
                seams,
                misfit,
                uneven: 0.0,
                holds: holds && seen.is_some() && uneven <= most,
                one,
            });
        }
    }
    (fitted, complete)
}

/// A reading with what speaks against it, and for its seams, in squared deviations.
struct Rated {
    cost: f64,
    seams: f64,
    /// How little plane its tops are, and the same beyond the noise, in its deviations.
    misfit: Misfit,
    uneven: f64,
    /// Nothing about it is out of the ordinary.
    holds: bool,
    one: Fitted,
}

/// What of a difference is more than chance.
fn past(difference: f64, chance: f64) -> f64 {
    difference.signum() * (difference.abs() - chance).max(0.0)
}

impl Rated {
    /// What speaks against it in all.
    fn total(&self) -> f64 {
        self.cost - self.seams + self.uneven
    }

    /// By how much this one explains what lies inside the outline better than another, beyond chance.
    fn inside(&self, other: &Self) -> f64 {
        // Seams where there are none add a half each by chance, with a deviation of 1.1: of two readings four
        // deviations of their sum.
        let by_chance = 4.0 * (2.5 * self.one.seams.len().max(1) as f64).sqrt();
        let cartons = self.one.tiles.len().abs_diff(other.one.tiles.len());
        let uneven = WORSE_BLOCKS + OVERFIT_BLOCKS * cartons as f64;
        past(self.seams - other.seams, by_chance) + past(other.uneven - self.uneven, uneven)
    }

    /// True when the other one is out of the question beside this one.
    fn rules_out(&self, other: &Self) -> bool {
        other.cost - self.cost + self.inside(other) > LEAD
    }
}

/// True when both are the same carton, roughly.
fn is_same(a: &DetectedBox, b: &DetectedBox) -> bool {
    let apart = a.camera_from_box.translation.vector - b.camera_from_box.translation.vector;
    a.label == b.label && apart.norm() < 0.25 * a.size.width
}

fn same(a: &[Tile], b: &[Tile]) -> bool {
    a.len() == b.len() && a.iter().all(|x| b.iter().any(|y| x.is_like(y)))
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
