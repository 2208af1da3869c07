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
//! 1. `gate`: valid pixels, depth range, region of interest.
//! 2. `steps`: the step mask; surface is what has nothing much nearer within two pixels.
//! 3. `components`: connected pieces. `plane`: a plane is affine in inverse depth.
//! 4. `orientation`, `patch`: each piece resampled in its own axes, with running sums.
//! 5. `search`: rectangles of the known sizes whose sides show edges.
//! 6. `cover`: surfaces without visible gaps are covered exactly by the known sizes; `relief`, `arrange`: of
//!    several such readings the one whose every carton is one plane; `breaks`: where two planes do not meet, two
//!    cartons do; `unknown`: what is hidden or not measured may be part of one.
//!    `measure`: tops of unknown size, where all four sides fall away.
//! 7. `sides`: lines fitted to where scan lines leave the surface; four sides share one turn.
//!    `ends`: where a surface ends, whatever is lost of its outermost pixels; `between_ends`: cartons lie in the
//!    middle. `fold`: rounded edges, by where the tops begin to fall. `inset`: how far inside the real edges this camera shows them.
//!    `joint`: the cartons of a covering are placed together, by sides, by seams and by each other.
//! 8. `verify`: size, wholeness, cover, tilt. `turn_together`: what stands too close to be turned much.
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
//!   reported that three sides prove each, by an edge or by a break in height towards the next one; on cartons that
//!   lie quite level, none.
//! - Two cartons side by side that make one plane to a few hundredths of a millimetre, without a visible gap, among
//!   cartons that do not, are taken for one where a known size is as large as both.
//! - Depth steps smeared over many pixels are put back to where they are half way (`smear`); tops of a
//!   lower layer beside a higher one are then often refused, and beyond fifteen pixels a side may be
//!   20 mm off.
//! - Measured sides along the pixel grid are uncertain by one to two pixels, others by less than one.
//! - The known sizes must differ by more than the size tolerance plus two pixels.

// The loops over pixels are compiled once for each instruction set: all that they call must be inlined
// into them, and what they decide must be decided without a jump.
#![allow(
    clippy::inline_always,
    clippy::manual_range_contains,
    clippy::needless_bitwise_bool
)]

mod arrange;
mod average;
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
mod ends;
mod even;
mod fall;
mod fold;
mod gate;
mod ink;
mod inset;
mod joint;
mod lean;
mod level;
mod measure;
mod misfit;
mod neighbours;
mod noise;
mod obstacles;
mod orientation;
mod outlined;
mod overhang;
mod patch;
mod plane;
mod rated;
mod relief;
mod resample;
mod seams;
mod search;
mod settings;
mod settle;
mod sides;
mod smear;
mod smeared;
mod spaced_points;
mod stands;
mod steps;
mod surface;
mod tile_fit;
mod tile_relief;
mod tiling;
mod turn_together;
mod unknown;
mod valleys;
mod verify;

pub use detect::{Stage, detect, detect_any_size, detect_staged};
pub use detection::{DetectedBox, Detection, RejectReason, RejectedSurface};
pub use settings::{RegionOfInterest, VisionSettings};
