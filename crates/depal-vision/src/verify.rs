//! Stage 9: from a candidate rectangle to a reported carton, or the reason why not.

use depal_frames::{BoxSize, Pose, Rotation};
use nalgebra::{Matrix3, Rotation3, Translation3};

use crate::{
    DetectedBox, RejectReason, VisionSettings,
    class::Class,
    gate::DepthImage,
    look::look,
    overhang::is_overhung,
    patch::pixel_pitch,
    plane::{PlaneFrame, fit_plane},
    runs_on::runs_on,
    sides::{
        FROM_AFAR, FROM_CLOSE, Fitting, INSET_PIXELS, RectangleFit, SideFit, anchored, edge_inside,
        fit_rectangle,
    },
    walls::{between, is_between},
};

/// Least share of scan lines with an edge for a side to count as seen.
pub const LEAST_SEEN: f64 = 0.15;
/// Least share for a side to turn an arranged box.
pub const TURN_SEEN: f64 = 0.5;

/// Share of scan lines with an edge that noise never gives.
const PLAIN: f64 = 0.5;

/// So many seen sides must not be mere shadows of something taller: the floor of a cage ends in those.
const LEAST_TRUE_EDGES: usize = 2;

/// Share of a side across which a surface may be seen to run on, where only two sides show that it ends: noise.
const MOST_RUNNING_ON: f64 = 0.05;

/// Share of a side's extent that a shadow may hide and still be slid under.
const MOST_HIDDEN: f64 = 0.2;

/// A point lies on a side's plane within so many root mean squares of the plane's own residuals,
pub const SHARP: f64 = 4.0;
/// and at least within this, metres.
pub const LEAST_SHARP: f64 = 0.001;

/// What is demanded of the outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Proof {
    /// Three or four seen sides.
    Outline,
    /// Unseen sides follow from a unique arrangement of the whole surface; `sides` may show edges.
    Arrangement { sides: [bool; 4] },
}

/// Fits and checks a rectangle that starts as `start` (origin in the middle, X along
/// `extents[0]`) on a surface.
pub fn verify(
    image: &DepthImage,
    settings: &VisionSettings,
    start: PlaneFrame,
    label: u32,
    turned: bool,
    proof: Proof,
) -> Result<DetectedBox, RejectReason> {
    let size = settings.sizes[label as usize];
    let extents = crate::search::extents(&size, turned);
    let (found, measured, _) = check(image, settings, start, extents, proof)?;
    // Of a nearly square carton the sides that were measured tell which way round it lies; if it is the other one, its
    // neighbours in the arrangement lie where it ends. A lone one was put the way round that fits best.
    let off = |sides: [f64; 2]| {
        let seen = (0..2).filter(|&k| measured[k] != extents[k]);
        seen.map(|k| (measured[k] - sides[k]).abs()).sum::<f64>()
    };
    let [length, width] = extents;
    if proof != Proof::Outline && off([width, length]) < off(extents) {
        return Err(RejectReason::Ambiguous);
    }
    Ok(DetectedBox {
        size,
        label,
        ..found
    })
}

/// The same for a rectangle of unknown size that is about `extents` large; also the sides as
/// measured, along X and Y of `start`, and how far from its plane a point of it lies at most, metres. The height
/// stays 0: one picture from above does not show it.
pub fn verify_measured(
    image: &DepthImage,
    settings: &VisionSettings,
    start: PlaneFrame,
    extents: [f64; 2],
    proof: Proof,
) -> Result<(DetectedBox, [f64; 2], f64), RejectReason> {
    check(image, settings, start, extents, proof)
}

fn check(
    image: &DepthImage,
    settings: &VisionSettings,
    start: PlaneFrame,
    extents: [f64; 2],
    proof: Proof,
) -> Result<(DetectedBox, [f64; 2], f64), RejectReason> {
    let turned = extents[1] > extents[0];
    let tolerance = settings.plane_tolerance;
    let pitch = pixel_pitch(&start, &image.intrinsics);

    let mut surface = Vec::new();
    look(image, &start, extents, tolerance, 0.010, |pixel| {
        surface.push(pixel);
    });
    let (plane, rms) =
        fit_plane(&surface, &image.intrinsics, tolerance).ok_or(RejectReason::NotFlat)?;
    if rms > 0.6 * tolerance {
        return Err(RejectReason::NotFlat);
    }
    let frame = start.on_plane(plane);
    let fitting = match proof {
        Proof::Outline => Fitting {
            least_seen: LEAST_SEEN,
            turn_seen: LEAST_SEEN,
            least_turning: 1,
            passes: FROM_AFAR,
            sides: [true; 4],
        },
        // What hangs together shares its direction; a carton with three sides of its own has its own.
        Proof::Arrangement { sides } => Fitting {
            least_seen: LEAST_SEEN,
            turn_seen: TURN_SEEN,
            least_turning: 3,
            passes: FROM_CLOSE,
            sides,
        },
    };
    // The wall of a neighbour that is seen inside a gap lies on the plane as deep as the tolerance. Where steps are
    // smeared, the face itself sags towards its sides.
    let sharp = if proof == Proof::Outline && !settings.is_smeared() {
        tolerance.min((SHARP * rms).max(LEAST_SHARP))
    } else {
        tolerance
    };
    let allowed = settings.size_tolerance + pitch;
    let mut fit = fit_rectangle(image, frame, extents, sharp, &fitting);
    for axis in 0..2 {
        let blind =
            |fit: &RectangleFit| !(0..2).any(|k| fit.sides[2 * axis + k].is_true_edge(LEAST_SEEN));
        if proof != Proof::Outline || !blind(&fit) {
            continue;
        }
        let reach = extents[axis] * (1.0 - settings.min_visible).min(MOST_HIDDEN);
        if let Some(frame) = anchored(image, &fit.frame, extents, tolerance, axis, reach) {
            let again = fit_rectangle(image, frame, extents, sharp, &fitting);
            if !blind(&again) {
                fit = again;
            }
        } else if let Some(frame) = between(image, &fit, extents, axis, allowed) {
            fit = fit_rectangle(image, frame, extents, sharp, &fitting);
        }
    }

    let mut proven = 0;
    let true_edges = fit
        .sides
        .iter()
        .filter(|s| s.is_true_edge(LEAST_SEEN))
        .count();
    let mut misfit = 0.0f64;
    let mut measured = extents;
    for (axis, measured) in measured.iter_mut().enumerate() {
        let (low, high) = (fit.sides[2 * axis], fit.sides[2 * axis + 1]);
        // A shadow alone pins nothing.
        let alone = |one: &SideFit, other: &SideFit| {
            one.seen >= LEAST_SEEN && (!one.shadowed || other.seen >= LEAST_SEEN)
        };
        proven += usize::from(alone(&low, &high)) + usize::from(alone(&high, &low));
        proven += usize::from(is_between(image, &fit, extents, axis, allowed));
        if low.seen >= LEAST_SEEN && high.seen >= LEAST_SEEN {
            let error = low.offset + high.offset + 2.0 * INSET_PIXELS * pitch;
            if low.shadowed != high.shadowed && error < 0.0 {
                // A shadow hides the rest; the size and the other side say where it ends.
                proven -= usize::from(-error > allowed);
                continue;
            }
            misfit = misfit.max(error.abs());
            *measured += error;
        }
    }
    let (needed, needed_edges) = match proof {
        Proof::Outline => (3, LEAST_TRUE_EDGES),
        Proof::Arrangement { .. } => (0, 0),
    };
    // Lumps of noise left over by averaging make pieces of sides, never two plain ones.
    let plain = fit.sides.iter().filter(|s| s.seen >= PLAIN).count();
    let made_of_noise = settings.average_px > 0 && plain < needed_edges;
    if misfit > allowed || proven < needed || true_edges < needed_edges || made_of_noise {
        return Err(RejectReason::NoKnownSize);
    }

    if proof == Proof::Outline {
        for (k, side) in fit.sides.iter().enumerate() {
            let at = (k / 2, if k % 2 == 0 { -1.0 } else { 1.0 });
            // Two edges are those of any corner, and a shadow beside it may lie at a carton's length by chance.
            let corner = true_edges <= LEAST_TRUE_EDGES && !side.is_true_edge(LEAST_SEEN);
            if corner && runs_on(image, &fit.frame, extents, at, tolerance) > MOST_RUNNING_ON {
                return Err(RejectReason::NoKnownSize);
            }
            // A side that is not seen must be hidden; a surface that ends before it is a smaller one.
            if side.seen >= LEAST_SEEN {
                continue;
            }
            let reach = extents[at.0] * MOST_HIDDEN;
            let ends = edge_inside(image, &fit.frame, extents, tolerance, at, reach);
            if ends.is_some_and(|beyond| beyond < -allowed) {
                return Err(RejectReason::NoKnownSize);
            }
        }
    }

    // Where steps were smeared, the outermost pixels are guesses.
    let rim = 0.4 * settings.smear_px as f64 * pitch;
    let seen = look(image, &fit.frame, extents, tolerance, 0.006 + rim, |_| ());
    if seen.share(Class::Deep) > 0.01 || seen.share(Class::On) < settings.min_visible {
        return Err(RejectReason::NoKnownSize);
    }
    let covered = seen.is_covered(image, &fit.frame, extents, settings.average_px)
        || is_overhung(image, &fit.frame, extents, tolerance, rim);
    if covered {
        return Err(RejectReason::Covered);
    }
    let tilt = (-fit
        .frame
        .plane
        .normal()
        .dot(&fit.frame.origin.coords.normalize()))
    .clamp(-1.0, 1.0)
    .acos();
    // Against the camera's axis, not the viewing ray: a level carton at the rim is not tilted.
    let axis_tilt = (-fit.frame.plane.normal().z).clamp(-1.0, 1.0).acos();
    if axis_tilt.min(tilt) > settings.max_tilt {
        return Err(RejectReason::Tilted);
    }
    let mean_seen = fit.sides.iter().map(|s| s.seen.min(1.0)).sum::<f64>() / 4.0;
    let visible_fraction = seen.share(Class::On);
    let confidence =
        (0.4 + 0.6 * mean_seen) * (1.0 - 0.5 * misfit / allowed) * visible_fraction.sqrt();
    let found = DetectedBox {
        camera_from_box: pose(&fit, turned),
        size: BoxSize {
            length: measured[0].max(measured[1]),
            width: measured[0].min(measured[1]),
            height: 0.0,
        },
        label: 0,
        confidence: confidence.clamp(0.0, 1.0),
        visible_fraction,
        proven_sides: proven as u32,
    };
    Ok((found, measured, sharp))
}

/// Pose with X along the long side, of its two directions the one towards positive camera X; within
/// five degrees of square to it, the one towards positive camera Y.
fn pose(fit: &RectangleFit, turned: bool) -> Pose {
    pose_on(&fit.frame, turned)
}

/// The same of a rectangle in a frame.
pub fn pose_on(frame: &PlaneFrame, turned: bool) -> Pose {
    let z = frame.plane.normal();
    let along = if turned { frame.y } else { frame.x };
    // Square to the camera's X the sign of X is chance: there Y decides, within five degrees.
    let square = along.x.abs() < 5f64.to_radians().sin();
    let forward = if square { along.y > 0.0 } else { along.x > 0.0 };
    let along = if forward { along } else { -along };
    let x = (along - z * z.dot(&along)).normalize();
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, z.cross(&x), z]));
    Pose::from_parts(
        Translation3::from(frame.origin.coords),
        Rotation::from_rotation_matrix(&rotation),
    )
}
