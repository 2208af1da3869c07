//! Rules that the manuals leave open or that differ between versions, in one place.
//!
//! - A FOR without STEP whose start is above its end counts down (in the machine's `ForBegin`).
//! - NumToStr rounds the exact value of the 32-bit number, ties to even (as the standard formatter does).
//! - The end of an ERROR clause hands the error on to the caller (in `routine` of the lowering).

/// Whether AND and OR leave out their right side when the left one decides.
pub(crate) const SHORT_CIRCUIT: bool = true;
