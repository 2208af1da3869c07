//! Between vision, planner and server: what one says in the words of the next.

use depal_frames::{BoxSize, JointPositions};
use depal_interface::{Motion, PathPoint, Status, VisionMoveData, VizPath};
use depal_planner::{PickPlan, PlanRequest, Refusal, RejectReason, SeenBox, plan_pick};

use crate::event::{EventKind, FailureReason, LoggedPose, LoggedWaypoint, round};
use crate::picture::Picture;
use crate::score::Score;
use crate::spec::CellSpec;

/// Tool id of the gripper on the wire.
pub(crate) const TOOL: i32 = 1;

/// What planning came to: a path for the server, or the status that the robot has to hear.
pub(crate) enum Planned {
    /// A path.
    Path {
        /// For the server.
        path: VizPath,
        /// Index of the picked report in the picture.
        detection: usize,
    },
    /// No path.
    Refused {
        /// For the robot.
        status: Status,
        /// For the report.
        reason: FailureReason,
    },
}

/// Plans a pick from what vision saw.
pub(crate) fn plan(
    spec: &CellSpec,
    picture: &Picture,
    start: JointPositions,
    picked_before: i32,
    stopwatch: fn() -> f64,
    score: &mut Score,
    events: &mut Vec<EventKind>,
) -> Planned {
    let boxes: Vec<SeenBox> = picture
        .detection
        .boxes
        .iter()
        .zip(&picture.base_from_boxes)
        .map(|(found, base_from_box)| SeenBox {
            base_from_box: *base_from_box,
            size: found.size,
            confidence: found.confidence,
        })
        .collect();
    let obstacle_points: Vec<_> = picture
        .detection
        .obstacle_points
        .iter()
        .map(|point| spec.base_from_camera * point)
        .collect();
    let request = PlanRequest {
        arm: &spec.arm,
        gripper: &spec.gripper,
        boxes: &boxes,
        known_obstacles: &spec.known_obstacles,
        obstacle_points: &obstacle_points,
        start,
        place: &spec.place,
        settings: &spec.planner,
    };
    let started = stopwatch();
    let planned = plan_pick(&request);
    score.planning_ms.push((stopwatch() - started) * 1e3);
    match planned {
        Ok(plan) => {
            let clearance = plan.min_clearance * 1e3;
            score.min_clearance_mm = Some(
                score
                    .min_clearance_mm
                    .map_or(clearance, |least| least.min(clearance)),
            );
            events.push(plan_event(spec, &plan));
            let label = picture.detection.boxes[plan.box_index].label as i32;
            Planned::Path {
                path: viz_path(spec, &plan, label, picked_before),
                detection: plan.box_index,
            }
        }
        Err(refusal) => {
            let (status, reason) = refusal_meaning(&refusal);
            events.push(EventKind::PlanRefused {
                reasons: refusal_reasons(&refusal),
            });
            Planned::Refused { status, reason }
        }
    }
}

/// The plan as the server sends it.
fn viz_path(spec: &CellSpec, plan: &PickPlan, label: i32, picked_before: i32) -> VizPath {
    let mut labels = [0; 10];
    labels[0] = label;
    let points = plan.waypoints.iter().enumerate().map(|(index, waypoint)| {
        let is_pick = index == plan.pick_index;
        PathPoint {
            joints: waypoint.joints,
            base_from_tcp: waypoint.base_from_tcp,
            motion: match waypoint.motion {
                depal_planner::Motion::Joint => Motion::Joint,
                depal_planner::Motion::Linear => Motion::Linear,
            },
            tool: TOOL,
            velocity_percent: waypoint.velocity_percent,
            label: if is_pick { label } else { 0 },
            vision_move: is_pick.then(|| VisionMoveData {
                labels,
                picked_total: picked_before + 1,
                picked_now: 1,
                edge_or_corner: i32::from(plan.edge_corner_id),
                group_from_tcp_offset: plan.tcp_offset,
                is_group_square: plan.group_orientation == 1,
                is_box_square: plan.box_orientation == 1,
                group_size: BoxSize {
                    length: plan.group_size[0],
                    width: plan.group_size[1],
                    height: plan.group_size[2],
                },
            }),
        }
    });
    let outputs = plan
        .sections
        .iter()
        .map(|section| spec.gripper.sections[*section].digital_output);
    VizPath {
        points: points.collect(),
        digital_outputs: outputs.collect(),
    }
}

fn plan_event(spec: &CellSpec, plan: &PickPlan) -> EventKind {
    EventKind::Plan {
        detection: plan.box_index,
        waypoints: plan
            .waypoints
            .iter()
            .map(|waypoint| LoggedWaypoint {
                joints_deg: waypoint
                    .joints
                    .iter()
                    .map(|joint| round(joint.to_degrees(), 1e6))
                    .collect(),
                world_from_tcp: LoggedPose::from(&(spec.world_from_base * waypoint.base_from_tcp)),
                motion: match waypoint.motion {
                    depal_planner::Motion::Joint => "joint",
                    depal_planner::Motion::Linear => "linear",
                },
                velocity_percent: round(waypoint.velocity_percent, 1e3),
            })
            .collect(),
        pick_index: plan.pick_index,
        sections: plan.sections.clone(),
        min_clearance_mm: round(plan.min_clearance * 1e3, 1e3),
        estimated_s: round(plan.estimated_time, 1e6),
        rejected: plan
            .rejected
            .iter()
            .map(|rejection| format!("box {}: {}", rejection.box_index, rejection.reason))
            .collect(),
    }
}

/// The reason of each candidate in words.
fn refusal_reasons(refusal: &Refusal) -> Vec<String> {
    match refusal {
        Refusal::NothingFits(rejections) => rejections
            .iter()
            .map(|rejection| format!("box {}: {}", rejection.box_index, rejection.reason))
            .collect(),
        other => vec![other.to_string()],
    }
}

/// Status and reason of a refusal: those of the candidate that was considered first.
fn refusal_meaning(refusal: &Refusal) -> (Status, FailureReason) {
    match refusal {
        Refusal::NoBoxes => (Status::VizNoVisionResult, FailureReason::NoDetection),
        Refusal::NothingFits(rejections) => match rejections.first().map(|r| &r.reason) {
            Some(RejectReason::Unreachable { .. }) => {
                (Status::VizUnreachable, FailureReason::IkUnreachable)
            }
            Some(RejectReason::NoSectionFits { .. } | RejectReason::TooLittleForce { .. }) => {
                (Status::VizBadPickPoint, FailureReason::PlanCollision)
            }
            Some(RejectReason::LowConfidence { .. } | RejectReason::Tilted { .. }) => {
                (Status::VizBadPickPoint, FailureReason::PoseError)
            }
            _ => (Status::VizCollision, FailureReason::PlanCollision),
        },
        _ => (Status::VizCollision, FailureReason::PlanCollision),
    }
}
