//! The vision computer: the server's brain, the planning project's engine, and the work they ask for,
//! each result handed over when its simulated time has come.

use depal_interface::{
    ConnectionId, Direction, Job, JobId, Motion, PathPoint, PortId, Server, Status, VisionMoveData,
    VisionPoint, VizOutcome, VizPath,
};
use depal_planner::{PickPlan, PlanRequest, RejectReason, Refusal, SeenBox, plan_pick};
use depal_time::SimTime;
use depal_frames::{JointPositions, Point};

use crate::error::CellError;
use crate::event::{EventKind, FailureReason, LoggedPose, LoggedWaypoint, round};
use crate::link::{Link, ToServer};
use crate::observer::Observer;
use crate::picture::{Picture, Seen, take_picture};
use crate::score::Score;
use crate::spec::CellSpec;
