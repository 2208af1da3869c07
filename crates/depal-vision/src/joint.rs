//! Stage 8b: cartons that follow from a covering are placed together, by all that is seen of them.
//!
//! Three kinds of evidence, each with its variance: sides that show an edge; seams, where one carton's plane gives
//! way to its neighbour's; and that touching cartons stand apart by their sides and one common gap. The last holds
//! half way down: a carton that leans has its top beside its middle.

mod seam;

use depal_frames::{Point, Rotation, Vector};
use seam::observe_seam;

use crate::{
    DetectedBox, VisionSettings,
    gate::DepthImage,
    inset::{InsetSums, Insets},
    patch::{BLOCK, Patch, pixel_pitch},
    plane::{Plane, PlaneFrame},
    seams::touches,
    search::{Candidate, extents, sides_with_edges},
    sides::{Fitting, SIDE_PIXELS, fit_rectangle},
    verify::LEAST_SEEN,
};

/// How evenly touching cartons stand, metres.
const PAIR_SIGMA: f64 = 0.000_2;
/// No carton is moved farther than this, pixels.
const FARTHEST: f64 = 1.5;

/// A carton of the covering.
struct Member {
    candidate: Candidate,
    /// Origin in the middle of its top, X close to the patch's.
    frame: PlaneFrame,
    half: [f64; 2],
    /// How far its top lies beside its middle, along the patch's axes.
    lean: [f64; 2],
    /// The middle of its top in the patch's axes.
    top: [f64; 2],
}

/// Where a side of a carton's top was seen.
struct Seen {
    member: usize,
    axis: usize,
    /// -1 or +1: the side with the smaller or the larger coordinate.
    sign: f64,
    /// Where the middle of the top would lie if the side were just there, along the axis.
    place: f64,
    /// 1 over the variance of the place.
    weight: f64,
    what: Edge,
}

enum Edge {
    /// Lit on such a share of its length; pixels there are so large, metres.
    Side { lit: f64, pitch: f64 },
    /// The middle of the gap to the neighbour.
    Seam,
}

impl Seen {
    /// Where it puts the middle of the top.
    fn middle(&self, insets: &Insets, gap: f64) -> f64 {
        self.place
            + self.sign
                * match self.what {
                    Edge::Side { lit, pitch } => insets.of(lit) * pitch,
                    Edge::Seam => -gap / 2.0,
                }
    }
}

impl Member {
    fn new(found: &DetectedBox, candidate: Candidate, patch: &Patch) -> Self {
        let pose = &found.camera_from_box;
        let origin = Point::from(pose.translation.vector);
        let normal = axis_of(&pose.rotation, 2);
        let aligned = [0, 1]
            .map(|k| axis_of(&pose.rotation, k))
            .into_iter()
            .max_by(|a, b| {
                let share = |v: &Vector| v.dot(&patch.frame.x).abs();
                share(a).total_cmp(&share(b))
            })
            .unwrap_or(patch.frame.x);
        let x = aligned * aligned.dot(&patch.frame.x).signum();
        let frame = PlaneFrame {
            plane: Plane {
                coefficient: normal / normal.dot(&origin.coords),
            },
            origin,
            x,
            y: normal.cross(&x),
        };
        let offset = origin - patch.frame.origin;
        let axes = [patch.frame.x, patch.frame.y];
        Self {
            candidate,
            frame,
            half: extents(&found.size, candidate.turned).map(|e| e / 2.0),
            lean: axes.map(|a| normal.dot(&a) * found.size.height / 2.0),
            top: axes.map(|a| offset.dot(&a)),
        }
    }

    fn direction(&self, axis: usize) -> Vector {
        if axis == 0 {
            self.frame.x
        } else {
            self.frame.y
        }
    }
}

fn axis_of(rotation: &Rotation, k: usize) -> Vector {
    rotation * Vector::ith(k, 1.0)
}

/// `high` touches the side of `low` with the larger coordinate.
struct Pair {
    low: usize,
    high: usize,
    axis: usize,
}

/// Moves the cartons of a covering, each in its own plane, to where all that is seen places them together.
pub fn place_together(
    image: &DepthImage,
    settings: &VisionSettings,
    patch: &Patch,
    placed: &mut [(Candidate, DetectedBox)],
) {
    let members: Vec<Member> = placed
        .iter()
        .map(|(candidate, found)| Member::new(found, *candidate, patch))
        .collect();
    let mut pairs = Vec::new();
    for (low, a) in members.iter().enumerate() {
        for (high, b) in members.iter().enumerate() {
            for axis in 0..2 {
                if low != high && touches(&a.candidate, &b.candidate, 2 * axis + 1, patch.pitch) {
                    pairs.push(Pair { low, high, axis });
                }
            }
        }
    }
    let sides: Vec<Seen> = (0..members.len())
        .flat_map(|n| observe_sides(image, settings, patch, &members, n))
        .collect();
    let mut seen = join_sides(sides, &members, &pairs);
    // As if it were white: of a mean over many pixels, which is what a seam is taken from.
    let noise = patch.relief().noise(1) * (BLOCK * BLOCK) as f64;
    for pair in &pairs {
        observe_seam(image, settings, &members, pair, noise, &mut seen);
    }
    let (mut middles, insets) = solve(&members, &pairs, &seen, true);
    // Where the image does not tell the two apart, they are the usual ones.
    if !insets.differ() {
        (middles, _) = solve(&members, &pairs, &seen, false);
    }
    let most = FARTHEST * patch.pitch;
    for ((member, middle), (_, found)) in members.iter().zip(middles).zip(placed) {
        let shift = [0, 1].map(|k| middle[k] + member.lean[k] - member.top[k]);
        if shift.iter().all(|s| s.abs() <= most) {
            let moved = member.frame.point(shift[0], shift[1]);
            found.camera_from_box.translation.vector = moved.coords;
        }
    }
}

/// Sides that show a true edge.
fn observe_sides(
    image: &DepthImage,
    settings: &VisionSettings,
    patch: &Patch,
    members: &[Member],
    n: usize,
) -> Vec<Seen> {
    let member = &members[n];
    let sides = member.half.map(|h| 2.0 * h);
    let fit = fit_rectangle(
        image,
        member.frame,
        sides,
        settings.plane_tolerance,
        &Fitting {
            least_seen: LEAST_SEEN,
            turn_seen: 2.0,
            least_turning: 4,
            passes: &[(3.0, 1.0)],
            sides: sides_with_edges(patch, &member.candidate),
        },
    );
    let pitch = pixel_pitch(&member.frame, &image.intrinsics);
    let moved = fit.frame.origin - member.frame.origin;
    let mut seen = Vec::new();
    for (k, side) in fit.sides.iter().enumerate() {
        let (axis, sign) = (k / 2, if k % 2 == 0 { -1.0 } else { 1.0 });
        if side.is_true_edge(LEAST_SEEN) {
            let shift = moved.dot(&member.direction(axis)) + sign * side.offset;
            let sigma = SIDE_PIXELS * pitch / side.seen.min(1.0);
            let what = Edge::Side {
                lit: side.lit,
                pitch,
            };
            seen.push(Seen {
                member: n,
                axis,
                sign,
                place: member.top[axis] + shift,
                weight: 1.0 / (sigma * sigma),
                what,
            });
        }
    }
    seen
}

/// Two sides that face each other tell where the middle of their gap is, whatever is lost at both: a gap of less than
/// a pixel takes a whole pixel where it is seen, and says nothing of insets. The others stay as they are.
fn join_sides(sides: Vec<Seen>, members: &[Member], pairs: &[Pair]) -> Vec<Seen> {
    let of = |member: usize, axis: usize, sign: f64| {
        sides
            .iter()
            .position(|s| s.member == member && s.axis == axis && s.sign * sign > 0.0)
    };
    let mut faces = vec![false; sides.len()];
    let mut seams = Vec::new();
    for pair in pairs {
        let (axis, across) = (pair.axis, 1 - pair.axis);
        let found = [of(pair.low, axis, 1.0), of(pair.high, axis, -1.0)];
        for side in found.into_iter().flatten() {
            faces[side] = true;
        }
        let [Some(low), Some(high)] = found.map(|side| side.map(|n| &sides[n])) else {
            continue;
        };
        let [a, b] = [&members[pair.low], &members[pair.high]];
        let middle = f64::midpoint(low.place + a.half[axis], high.place - b.half[axis]);
        let end = |m: &Member, sign: f64| m.top[across] + sign * m.half[across];
        let common = end(a, 1.0).min(end(b, 1.0)) - end(a, -1.0).max(end(b, -1.0));
        for (side, member) in [(low, a), (high, b)] {
            seams.push(Seen {
                member: side.member,
                axis,
                sign: side.sign,
                place: middle - side.sign * member.half[axis],
                // The same lost pixels make both sides.
                weight: low.weight.min(high.weight)
                    * (common / (2.0 * member.half[across])).clamp(0.0, 1.0),
                what: Edge::Seam,
            });
        }
    }
    let mut faces = faces.iter();
    let mut seen = sides;
    seen.retain(|_| faces.next() == Some(&false));
    seen.extend(seams);
    seen
}

/// Least squares over the middles of all cartons, their common gap, and the insets of their sides: seams and rows of
/// known lengths tell those, too. The insets stay the usual ones unless they are `open`.
fn solve(members: &[Member], pairs: &[Pair], seen: &[Seen], open: bool) -> (Vec<[f64; 2]>, Insets) {
    const ROUNDS: usize = 200;
    /// Rounds after which pairs are weighed anew.
    const AGAIN: usize = 40;
    /// Pairs that stand farther from the common gap than so many deviations count less and less.
    const LOOSE: f64 = 3.0;
    /// At first each carton stands where it is seen, and pairs count little: as if by this, metres.
    const SOFT: f64 = 1.0 / (0.001 * 0.001);
    let mut middles: Vec<[f64; 2]> = members
        .iter()
        .map(|m| [0, 1].map(|k| m.top[k] - m.lean[k]))
        .collect();
    let mut gap = 0.0;
    let mut insets = Insets::USUAL;
    let apart =
        |pair: &Pair| members[pair.low].half[pair.axis] + members[pair.high].half[pair.axis];
    let mut weights = vec![SOFT; pairs.len()];
    for round in 0..ROUNDS {
        let mut sums = vec![[[0.0; 2]; 2]; members.len()];
        for one in seen {
            let sum = &mut sums[one.member][one.axis];
            let middle = one.middle(&insets, gap) - members[one.member].lean[one.axis];
            sum[0] += one.weight;
            sum[1] += one.weight * middle;
        }
        for (pair, between) in pairs.iter().zip(&weights) {
            let distance = apart(pair) + gap;
            let axis = pair.axis;
            let low = &mut sums[pair.low][axis];
            low[0] += between;
            low[1] += between * (middles[pair.high][axis] - distance);
            let high = &mut sums[pair.high][axis];
            high[0] += between;
            high[1] += between * (middles[pair.low][axis] + distance);
        }
        for (middle, sums) in middles.iter_mut().zip(&sums) {
            for axis in 0..2 {
                let [weight, sum] = sums[axis];
                if weight > 0.0 {
                    // Not all the way: all move at once.
                    middle[axis] += 0.7 * (sum / weight - middle[axis]);
                }
            }
        }
        let beyond = |p: &Pair| middles[p.high][p.axis] - middles[p.low][p.axis] - apart(p);
        let (total, weight) = pairs
            .iter()
            .zip(&weights)
            .fold((0.0, 1e-12), |s, (p, w)| (s.0 + w * beyond(p), s.1 + w));
        gap = (total / weight).max(0.0);
        let mut torn = InsetSums::new();
        for one in seen {
            if let Edge::Side { lit, pitch } = one.what {
                let top = middles[one.member][one.axis] + members[one.member].lean[one.axis];
                let pixels = (top - one.place) * one.sign / pitch;
                torn.add(lit, 1.0 - lit, pixels, one.weight * pitch * pitch);
            }
        }
        if open {
            insets = torn.solve();
        }
        if (round + 1) % AGAIN == 0 {
            for (pair, weight) in pairs.iter().zip(&mut weights) {
                let off = (beyond(pair) - gap) / (LOOSE * PAIR_SIGMA);
                *weight = 1.0 / (PAIR_SIGMA * (1.0 + off * off)).powi(2);
            }
        }
    }
    (middles, insets)
}
