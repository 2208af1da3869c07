use depal_frames::Vector;

/// Why a picture is of no use for the calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CaptureProblem {
    /// The frame contradicts itself.
    #[error("expected {expected} pixels of depth and intensity, found {depth} and {intensity}")]
    BadFrame {
        /// Width times height.
        expected: usize,
        /// Depth values.
        depth: usize,
        /// Intensity values.
        intensity: usize,
    },
    /// No grid of discs of this size and pitch is in the picture.
    #[error(
        "expected a grid of discs, found {spots} dark spots of a disc's size and no grid among them"
    )]
    NoBoard {
        /// Dark round spots of about the right size.
        spots: usize,
    },
    /// Some discs are hidden, outside the picture, or in a shadow.
    #[error(
        "expected {expected} discs, found {found}: a part of the board is hidden or outside the picture"
    )]
    Partial {
        /// Discs of the board.
        expected: usize,
        /// Discs of the grid that were seen.
        found: usize,
    },
    /// A grid is there, but of another board.
    #[error("another board: {what}")]
    WrongBoard {
        /// Expected and found.
        what: String,
    },
    /// Two grids fit.
    #[error("expected one board in the picture, found {found}")]
    SeveralBoards {
        /// How many.
        found: usize,
    },
    /// The depth image has too little of the board.
    #[error(
        "expected depth on at least {expected_percent:.0} % of the board, found {found_percent:.0} %"
    )]
    NoDepth {
        /// Least share, percent.
        expected_percent: f64,
        /// Share with valid depth, percent.
        found_percent: f64,
    },
    /// The disc centres are not where the board has them.
    #[error(
        "expected disc centres within {expected_mm:.2} mm of the board's grid, found {found_mm:.2} mm (root mean square)"
    )]
    Distorted {
        /// Largest root mean square distance, mm.
        expected_mm: f64,
        /// What was found, mm.
        found_mm: f64,
    },
    /// The flange pose holds something that is no number.
    #[error("expected a flange pose of finite numbers")]
    BadPose,
}

/// Why captures give no calibration.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CalibrationProblem {
    /// The board's description is out of range.
    #[error("board {field}: expected {expected}, found {found}")]
    Board {
        /// Which figure.
        field: &'static str,
        /// What is accepted, with its unit.
        expected: &'static str,
        /// What was given.
        found: f64,
    },
    /// A capture does not hold one centre for each disc.
    #[error("expected {expected} disc centres in each capture, found {found}")]
    Centres {
        /// Discs of the board.
        expected: usize,
        /// Centres of the first capture that differs.
        found: usize,
    },
    /// Not enough usable captures.
    #[error("expected at least {expected} usable captures, found {found}")]
    TooFewPoses {
        /// The least number.
        expected: usize,
        /// How many there are.
        found: usize,
    },
    /// The flange was never turned.
    #[error(
        "the flange turned by {found_deg:.2} degrees (root mean square between poses), expected at least {expected_deg:.0}: \
         the camera's position is not observable in any direction, a touched point is needed"
    )]
    NoRotation {
        /// Least turn, degrees.
        expected_deg: f64,
        /// What was found, degrees.
        found_deg: f64,
    },
    /// The flange was turned about one direction only, as four-axis arms do.
    #[error(
        "all rotation axes are parallel to ({:.3}, {:.3}, {:.3}) in the robot base \
         (turns about other axes: {found_deg:.2} degrees root mean square, expected at least {expected_deg:.0}): \
         the camera's translation along that axis is not observable, a touched point is needed",
        axis_in_base.x, axis_in_base.y, axis_in_base.z
    )]
    ParallelAxes {
        /// The common axis, unit length.
        axis_in_base: Vector,
        /// Least turn about any other axis, degrees.
        expected_deg: f64,
        /// What was found, degrees.
        found_deg: f64,
    },
    /// Some other combination is open.
    #[error(
        "the poses leave something open: a {what} of {unit} changes the disc centres by {found:.4} mm only (root mean square)"
    )]
    Unobservable {
        /// Which part of which transform dominates what is open.
        what: &'static str,
        /// The step that was tried, with its unit.
        unit: &'static str,
        /// What it changes, mm.
        found: f64,
    },
    /// No pair of transforms explains the captures.
    #[error(
        "expected residuals of at most {expected_mm:.1} mm (root mean square), found {found_mm:.2}: wrong board size, flange poses or mounting"
    )]
    Residual {
        /// Largest acceptable, mm.
        expected_mm: f64,
        /// What was found, mm.
        found_mm: f64,
    },
}

/// Why no calibration poses were found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PoseProblem {
    /// The region, the arm and the camera leave too few.
    #[error(
        "expected {expected} calibration poses, found {found} among {tried} tried \
         ({unseen} outside the picture, {unreachable} out of reach or in the way)"
    )]
    TooFew {
        /// How many are wanted.
        expected: usize,
        /// How many are usable.
        found: usize,
        /// How many were tried.
        tried: usize,
        /// Refused because the board is not seen.
        unseen: usize,
        /// Refused by the caller's test.
        unreachable: usize,
    },
}
