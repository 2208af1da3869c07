//! Box poses from one depth frame.

mod arrange;
mod components;
mod detect;
mod detection;
mod gate;
mod obstacles;
mod orientation;
mod patch;
mod plane;
mod search;
mod settings;
mod sides;
mod steps;
mod surface;
mod verify;

pub use detect::detect;
pub use detection::{DetectedBox, Detection, RejectReason, RejectedSurface};
pub use settings::{RegionOfInterest, VisionSettings};
