use depal_motion::MotionError;
use std::fmt;

use depal_frames::Point;

/// A stretch of the way, for messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Standing where the arm is now.
    Start,
    /// Standing at the pick.
    Pick,
    /// Standing at the place.
    Place,
    /// Straight down to the pick.
    Approach,
    /// Straight up with the carton.
    Lift,
    /// Straight down with the carton.
    SetDown,
    /// From the start to above the pick.
    TransferToPick,
    /// With the carton to above the place.
    TransferToPlace,
    /// The last, fine check of the whole path.
    Certificate,
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Start => "at the start",
            Self::Pick => "at the pick",
            Self::Place => "at the place",
            Self::Approach => "on the way down to the pick",
            Self::Lift => "on the way up with the carton",
            Self::SetDown => "on the way down to the place",
            Self::TransferToPick => "on the way to the pick",
            Self::TransferToPlace => "on the way to the place",
            Self::Certificate => "in the fine check of the path",
        })
    }
}

/// What was touched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Obstacle {
    /// A seen box, by its index.
    Box(usize),
    /// The unseen column below a seen box.
    BelowBox(usize),
    /// A known obstacle, by its index.
    Known(usize),
    /// A leftover depth point.
    SeenPoint(Point),
    /// A link of the arm itself, by its index.
    Link(usize),
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Box(i) => write!(f, "box {i}"),
            Self::BelowBox(i) => write!(f, "what lies below box {i}"),
            Self::Known(i) => write!(f, "known obstacle {i}"),
            Self::SeenPoint(p) => write!(
                f,
                "something seen at ({:.3}, {:.3}, {:.3}) m",
                p.x, p.y, p.z
            ),
            Self::Link(i) => write!(f, "link {i} of the arm"),
        }
    }
}

/// Which body came too close to what, and where on the way.
#[derive(Debug, Clone, PartialEq)]
pub struct Touch {
    /// Where on the way.
    pub stage: Stage,
    /// Name of the moving body: a link, `gripper` or `carton`.
    pub body: String,
    /// What it met.
    pub obstacle: Obstacle,
}

impl fmt::Display for Touch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} meets {} {}", self.body, self.obstacle, self.stage)
    }
}

/// Why a box was not taken.
#[derive(Debug, Clone, PartialEq)]
pub enum RejectReason {
    /// Vision is not sure enough.
    LowConfidence {
        /// Found.
        confidence: f64,
        /// Needed.
        minimum: f64,
    },
    /// It leans.
    Tilted {
        /// Found, rad.
        tilt: f64,
        /// Allowed, rad.
        limit: f64,
    },
    /// Another box lies on it.
    Covered {
        /// Index of that box.
        by: usize,
        /// Smaller of the two overlaps, m.
        overlap: f64,
    },
    /// No group of sections fits wholly onto the face.
    NoSectionFits {
        /// Sides of the face, m.
        face: [f64; 2],
    },
    /// Sections fit, but hold too little.
    TooLittleForce {
        /// Largest force of any group, N.
        force: f64,
        /// Needed at rest with the safety factor, N.
        needed: f64,
    },
    /// The gripper could carry it, the arm could not.
    TooHeavy {
        /// Assumed mass of what would hang on the gripper, kg.
        mass: f64,
        /// Allowed, kg.
        limit: f64,
    },
    /// Gripper and load would turn the wrist with more than it is rated for.
    TooMuchMoment {
        /// Least of all grasps, N m.
        moment: f64,
        /// Allowed, N m.
        limit: f64,
    },
    /// No joints inside the limits reach it.
    Unreachable {
        /// Pick or place, or a straight stretch of the way.
        stage: Stage,
        /// Poses tried.
        tried: usize,
    },
    /// Every way tried touches something; this is how far the best one came.
    Collision {
        /// The touch farthest along.
        touch: Touch,
        /// Ways tried.
        tried: usize,
    },
    /// A free way was found, but the arm cannot make its moves: an axis could not hold the load on it, say.
    CannotDrive {
        /// What the law of motion says.
        error: MotionError,
    },
    /// A way was found, but it has too many waypoints.
    TooManyWaypoints {
        /// Found.
        found: usize,
        /// Allowed.
        limit: usize,
    },
}

impl fmt::Display for RejectReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LowConfidence {
                confidence,
                minimum,
            } => write!(f, "confidence {confidence:.2} is below {minimum:.2}"),
            Self::Tilted { tilt, limit } => write!(
                f,
                "it leans by {:.1} degrees, allowed are {:.1}",
                tilt.to_degrees(),
                limit.to_degrees()
            ),
            Self::Covered { by, overlap } => {
                write!(f, "box {by} lies on it by {:.0} mm", overlap * 1e3)
            }
            Self::NoSectionFits { face } => write!(
                f,
                "no section fits wholly onto its face of {:.0} x {:.0} mm",
                face[0] * 1e3,
                face[1] * 1e3
            ),
            Self::TooLittleForce { force, needed } => write!(
                f,
                "the sections that fit hold {force:.0} N, needed are {needed:.0} N"
            ),
            Self::TooHeavy { mass, limit } => write!(
                f,
                "it is taken to weigh {mass:.0} kg, the arm carries {limit:.0} kg below the gripper"
            ),
            Self::TooMuchMoment { moment, limit } => write!(
                f,
                "gripper and load turn the wrist with {moment:.0} N m, allowed are {limit:.0} N m"
            ),
            Self::Unreachable { stage, tried } => write!(
                f,
                "the arm cannot reach it {stage} (ik_unreachable, {tried} poses tried)"
            ),
            Self::Collision { touch, tried } => write!(f, "{touch} ({tried} ways tried)"),
            Self::CannotDrive { error } => {
                write!(f, "the way is free, but the arm cannot drive it: {error}")
            }
            Self::TooManyWaypoints { found, limit } => {
                write!(f, "the way has {found} waypoints, allowed are {limit}")
            }
        }
    }
}

/// A box that was looked at and not taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Rejection {
    /// Index in the request's boxes; of a group its first.
    pub box_index: usize,
    /// Indices of the boxes that were to be picked together with it.
    pub with: Vec<usize>,
    /// Why.
    pub reason: RejectReason,
}

impl Rejection {
    /// The same with box `i` called `numbers[i]`: the request's boxes were taken out of a longer list.
    /// Boxes beyond the list keep their index.
    #[must_use]
    pub fn renumbered(mut self, numbers: &[usize]) -> Self {
        let number = |i: usize| numbers.get(i).copied().unwrap_or(i);
        self.box_index = number(self.box_index);
        for other in &mut self.with {
            *other = number(*other);
        }
        match &mut self.reason {
            RejectReason::Covered { by, .. } => *by = number(*by),
            RejectReason::Collision { touch, .. } => match &mut touch.obstacle {
                Obstacle::Box(i) | Obstacle::BelowBox(i) => *i = number(*i),
                _ => {}
            },
            _ => {}
        }
        self
    }
}

impl fmt::Display for Rejection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "box {}", self.box_index)?;
        for other in &self.with {
            write!(f, "+{other}")?;
        }
        write!(f, ": {}", self.reason)
    }
}

/// No plan, and why.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Refusal {
    /// Vision found nothing.
    NoBoxes,
    /// The arm stands outside its limits.
    StartOutsideLimits {
        /// Joint, counted from 1.
        joint: usize,
        /// Found, rad.
        position: f64,
        /// Allowed, rad.
        lower: f64,
        /// Allowed, rad.
        upper: f64,
    },
    /// The arm already touches something.
    StartTouches(Touch),
    /// Every box has its own reason, in the order in which they were considered.
    NothingFits(Vec<Rejection>),
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoBoxes => f.write_str("no boxes were seen"),
            Self::StartOutsideLimits {
                joint,
                position,
                lower,
                upper,
            } => write!(
                f,
                "joint {joint} starts at {:.1} degrees, allowed are {:.1} to {:.1}",
                position.to_degrees(),
                lower.to_degrees(),
                upper.to_degrees()
            ),
            Self::StartTouches(touch) => write!(f, "{touch}"),
            Self::NothingFits(rejections) => {
                write!(f, "none of {} boxes can be picked", rejections.len())?;
                for r in rejections {
                    write!(f, "; {r}")?;
                }
                Ok(())
            }
        }
    }
}

impl std::error::Error for Refusal {}
