use depal_frames::{BoxSize, Point, Pose};

/// One carton whose top face was found.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectedBox {
    /// Centre of the top face: Z out of the face towards the camera, X along the long side
    /// (of its two directions the one with positive X in the camera frame; where it is within five
    /// degrees of square to the camera's X, the one with positive Y: noise must not turn a carton round).
    pub camera_from_box: Pose,
    /// The known size that fits, metres; from [`detect_any_size`](crate::detect_any_size) the
    /// measured sides, with height 0 for unknown.
    pub size: BoxSize,
    /// Index of that size in the settings.
    pub label: u32,
    /// 0..1: how much of the outline was proven, and how close the measured sides are; of measured ones also how often
    /// the picture shows their size.
    pub confidence: f64,
    /// 0..1: share of the top face seen as surface.
    pub visible_fraction: f64,
    /// How many of the four sides were seen; the others follow from the known size.
    pub proven_sides: u32,
}

/// Why a flat surface or a candidate on it was not reported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RejectReason {
    /// Larger than any layer: floor, wall.
    Background,
    /// Tilted more than allowed.
    Tilted,
    /// Points do not lie on one plane.
    NotFlat,
    /// No whole carton of a known size fits its outline; where no size is given, it is no rectangle that ends on all
    /// sides, or nothing certain has the same sides.
    NoKnownSize,
    /// A carton fits the seen part, but something lies over it.
    Covered,
    /// Several arrangements of cartons fit equally well; where no size is given, it may be one carton or several.
    Ambiguous,
}

/// A flat surface (or a candidate on it) that was looked at and refused.
#[derive(Debug, Clone, PartialEq)]
pub struct RejectedSurface {
    /// Why.
    pub reason: RejectReason,
    /// Its middle, camera frame, metres.
    pub centre_in_camera: Point,
    /// Its seen area, square metres.
    pub area: f64,
}

/// What one frame gave.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Detection {
    /// Cartons, nearest to the camera first.
    pub boxes: Vec<DetectedBox>,
    /// Valid depth points inside the region and the depth range; 0 means there is nothing to see.
    pub points_in_region: usize,
    /// Middles (camera frame, metres) of the cubes that hold points which no reported carton
    /// explains, ordered by cube index; a planner keeps clear of them.
    pub obstacle_points: Vec<Point>,
    /// What was looked at and refused.
    pub rejected: Vec<RejectedSurface>,
}
