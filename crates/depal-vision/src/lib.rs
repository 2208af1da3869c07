//! Box poses from one depth frame.
//!
//! [`detect`] takes what a depth camera delivers and the known carton sizes, and reports every
//! whole uncovered top face of such a size, at every height, and nothing else.
//! It is a pure function: no clock, no randomness, the same frame gives the same bits.
//!
//! [`calibration`] finds out where the camera is, from pictures of a board of discs and the arm's poses.
//!
//! It must never know the scene, the simulator, carton identities or where anything really is.
//!
//! ```
//! use depal_frames::{BoxSize, DepthFrame, Intrinsics};
//! use depal_vision::{VisionSettings, detect};
//! let intrinsics = Intrinsics { width: 64, height: 48, fx: 80.0, fy: 80.0, cx: 31.5, cy: 23.5 };
//! let covered_lens = DepthFrame::blank(intrinsics);
//! let settings = VisionSettings::new(vec![BoxSize::from_mm([400.0, 300.0, 250.0])]);
//! let detection = detect(&covered_lens, &settings);
//! assert_eq!((detection.boxes.len(), detection.points_in_region), (0, 0));
//! ```
//!
//! # Stages
//!
//! 1. `gate`: valid pixels, depth range, region of interest. `lost`: what is lost by chance is put in, `strips` says
//!    what is lost along lines; `outliers`: single wrong depths.
//! 2. `steps`: the step mask; surface is what has nothing much nearer within two pixels.
//! 3. `components`: connected pieces. `plane`: a plane is affine in inverse depth.
//! 4. `orientation`, `patch`: each piece resampled in its own axes, with running sums.
//! 5. `search`: rectangles of the known sizes whose sides show edges.
//! 6. `cover`: surfaces without visible gaps are covered exactly by the known sizes; `relief`, `arrange`: of
//!    several such readings the one whose every carton is one plane; `parts`: what is one plane is no two smaller
//!    cartons; `breaks`: where two planes do not meet, two cartons do; `proven`, `shown`: where no covering is exact,
//!    cartons that their sides prove one by one; `unknown`: what is hidden or not measured may be part of one;
//!    `leaning`: one that stands tilted among others. `measure`: tops of unknown size, where all four sides fall away;
//!    `parted`, `support`: which of them are one carton; `again`: their sizes looked for where cartons hang together.
//! 7. `sides`: lines fitted to where scan lines leave the surface; four sides share one turn.
//!    `ends`: where a surface ends, whatever is lost of its outermost pixels; `between_ends`: cartons lie in the
//!    middle. `fold`: rounded edges, by where the tops begin to fall. `inset`: how far inside the real edges this camera shows them.
//!    `joint`: the cartons of a covering are placed together, by sides, by seams and by each other.
//! 8. `verify`: size, wholeness, cover, tilt; `sharp`: which pixels lie on a plane. `walls`: what fills the room between
//!    taller ones. `runs_on`: a top ends at its sides; a corner of a slab does not.
//!    `bearers`: boards of the pallet are none. `turn_together`: what stands too close to be turned much.
//!    `doubles`: two that look like one of another size; `gaps`: whether the gap between them could hide.
//!    `obstacles`: what nothing reported explains.
//!
//! # Units and frames
//!
//! Metres and radians. Camera frame: X right, Y down, Z forward. Box frame: middle of the top
//! face, Z out of it towards the camera, X along the long side.
//!
//! # Limitations
//!
//! - Gaps of 0 mm are resolved by the known sizes and by the differences in height and tilt of a few
//!   tenths of a millimetre that cartons have; the intensity image only tells coverings apart that
//!   these leave open (`ink`), it never finds a carton by itself. A
//!   surface that two or more known cartons cover exactly may be one larger, unknown carton; such
//!   a reading is refused unless cartons of that size stand proven beside it, or at least three
//!   cover it and no gap in sight is wide enough that all gaps should be seen.
//! - A sheet thinner than the plane tolerance that lies over a part of a layer is not seen; one that just
//!   one arrangement of a known size covers, over a stack as high as its cartons, is taken for them.
//! - Cartons of one merged surface share its direction.
//! - Where something hides part of a surface without visible gaps, or tape runs over it, only those cartons are
//!   reported that three sides prove each, by an edge, by a break in height towards the next one or by a proven
//!   neighbour, or two that make a corner if all beyond the others is hidden; on cartons that lie quite level, none.
//! - Two cartons side by side that make one plane to a few hundredths of a millimetre, without a visible gap, are taken
//!   for one where a known size is as large as both and the layer's other gaps and heights make that unlikely; where
//!   they do not, such a size is not reported.
//! - Depth steps smeared over many pixels are put back to where they are half way (`smear`); tops of a
//!   lower layer beside a higher one are then often refused, and beyond fifteen pixels a side may be
//!   20 mm off.
//! - Of cartons whose size is not given, those that touch on one level and end flush are measured as one where
//!   nothing in the picture parts them or shows one alone; the confidence of a size seen once is at most 0.75. Layers
//!   without any carton that gaps of 2 mm or more set apart are refused. A carton as large as some smaller ones in the
//!   same picture is refused unless another of its size is there; one whose halves differ in height by more than
//!   0.13 mm along a straight line, as some flaps do, is refused.
//! - Measured sides along the pixel grid are uncertain by one to two pixels, others by less than one.
//! - The known sizes must differ by more than the size tolerance plus two pixels.
//! - Of cartons nearly as wide as long those of a layer without visible gaps are often refused: either way round fits,
//!   and the sides that are seen say which one is right.
//! - Boards are known by bearers that come out 10 to 30 mm beneath them. A part of a closed deck that shows the outline
//!   of a known size is taken for a carton, and so is a board where known cartons are lower than 60 mm.
//! - A carton of which a shadow hides a side, and two edges are all that shows, is refused where the next one touches
//!   it as level as if the surface ran on.

// The loops over pixels are compiled once for each instruction set: all that they call must be inlined
// into them, and what they decide must be decided without a jump.
#![allow(
    clippy::inline_always,
    clippy::manual_range_contains,
    clippy::needless_bitwise_bool
)]

mod again;
mod arrange;
mod average;
mod bearers;
mod between_ends;
mod beyond;
mod blank;
mod breaks;
pub mod calibration;
mod class;
mod components;
mod cover;
mod detect;
mod detection;
mod doubles;
mod edge_sums;
mod ends;
mod even;
mod fall;
mod fold;
mod gaps;
mod gate;
mod ink;
mod inset;
mod joint;
mod lean;
mod leaning;
mod level;
mod look;
mod lost;
mod measure;
mod misfit;
mod neighbours;
mod noise;
mod obstacles;
mod orientation;
mod outliers;
mod outlined;
mod overhang;
mod parted;
mod parts;
mod patch;
mod plane;
mod proven;
mod rated;
mod relief;
mod resample;
mod runs_on;
mod scan;
mod scratch;
mod seams;
mod search;
mod settings;
mod settle;
mod sharp;
mod shown;
mod sides;
mod smear;
mod smeared;
mod spaced_points;
mod stands;
mod steps;
mod strips;
mod support;
mod surface;
mod tile_fit;
mod tile_relief;
mod tiling;
mod turn_together;
mod unknown;
mod valleys;
mod verify;
mod walls;
mod widest;

pub use detect::{Stage, detect, detect_any_size, detect_staged};
pub use detection::{DetectedBox, Detection, RejectReason, RejectedSurface};
pub use settings::{RegionOfInterest, VisionSettings};
