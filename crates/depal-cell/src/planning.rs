//! Between vision, planner and server: what one says in the words of the next.

use std::collections::BTreeSet;
use std::sync::Arc;

use depal_frames::{BoxSize, JointPositions, Point, Pose};
use depal_interface::{CustomPort, Motion, PathPoint, Status, VisionMoveData};
use depal_planner::{
    PickPlan, PlanRequest, PlannerSettings, Refusal, RejectReason, SeenBox, plan_pick,
};
use depal_workflow::{PickRequest, Place};

use crate::event::{EventKind, FailureReason, LoggedPose, LoggedWaypoint, round};
use crate::picture::Picture;
use crate::score::Score;
use crate::spec::CellSpec;
use crate::surroundings::Surroundings;
use crate::vision_side::results::custom_ports;

/// Tool id of the gripper on the wire.
pub(crate) const TOOL: i32 = 1;

/// A planned pick, or all of a picture's, as the engine carries it.
#[derive(Debug, Clone, Default)]
pub(crate) struct PlannedPick {
    /// Waypoints of all rounds.
    pub(crate) points: Vec<PathPoint>,
    /// Numbers of the outputs to switch on, by round.
    pub(crate) rounds: Vec<Vec<u16>>,
    /// The vision project's own data, a row of each port by round.
    pub(crate) custom_ports: Vec<CustomPort>,
    /// The picked reports in the picture, by round.
    pub(crate) detections: Vec<usize>,
    /// How the carton or group of the last round hangs on the gripper.
    pub(crate) carried: Option<Carried>,
    /// By truth: the cartons that are aimed at, by round.
    pub(crate) cartons: Vec<Vec<u32>>,
    /// What stood around when it was planned.
    pub(crate) surroundings: Arc<Surroundings>,
}

/// How a carton hangs on the gripper.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Carried {
    /// From the middle of the top face to the tool.
    box_from_tcp: Pose,
    /// Height of the carton, metres.
    height: f64,
}

impl Carried {
    /// Tool pose that brings the carton's bottom face to a place, `gap` above it.
    pub(crate) fn base_from_tcp(&self, base_from_place: &Pose, gap: f64) -> Pose {
        base_from_place * Pose::translation(0.0, 0.0, self.height + gap) * self.box_from_tcp
    }
}

/// What planning came to: a path, or the status that the robot has to hear.
pub(crate) enum Planned {
    /// A path.
    Path(PlannedPick),
    /// No path.
    Refused {
        /// For the robot.
        status: Status,
        /// For the report.
        reason: FailureReason,
    },
}

/// What a pick starts from.
pub(crate) struct Situation<'a> {
    /// What vision saw.
    pub(crate) picture: &'a Picture,
    /// Reports of the picture that are planned already.
    pub(crate) taken: &'a BTreeSet<usize>,
    /// Where the arm is, radians.
    pub(crate) start: JointPositions,
    /// Cartons planned before.
    pub(crate) picked_before: i32,
}

/// Plans what the project asks for: one pick, or round after round until the picture is used up.
pub(crate) fn plan(
    spec: &CellSpec,
    situation: &Situation,
    pick: &PickRequest,
    place: Option<Place>,
    stopwatch: fn() -> f64,
    score: &mut Score,
    events: &mut Vec<EventKind>,
) -> Planned {
    let picture = situation.picture;
    let mut taken = situation.taken.clone();
    let mut start = situation.start;
    let mut all = PlannedPick::default();
    let own_data = match custom_ports(spec, picture) {
        Ok(ports) => ports,
        Err(status) => {
            let reason = FailureReason::ProtocolError;
            return Planned::Refused { status, reason };
        }
    };
    all.custom_ports = own_data.iter().map(|port| named(&port.name)).collect();
    let mut around = Surroundings::new(picture, &taken);
    around.is_placed = place.is_some();
    loop {
        let left: Vec<usize> = (0..picture.detection.boxes.len())
            .filter(|index| !taken.contains(index))
            .collect();
        if left.is_empty() && !all.detections.is_empty() {
            all.surroundings = Arc::new(around);
            return Planned::Path(all);
        }
        let round = match plan_one(spec, picture, &left, start, pick, stopwatch, score, events) {
            Ok(plan) => plan,
            Err(refusal) => {
                let (status, reason) = refusal_meaning(&refusal);
                events.push(EventKind::PlanRefused {
                    reasons: refusal_reasons(&refusal, &left),
                });
                return Planned::Refused { status, reason };
            }
        };
        let detections: Vec<usize> = round.box_indices.iter().map(|i| left[*i]).collect();
        let all_labels = picture
            .labels
            .as_ref()
            .expect("no path is asked for where vision says nothing");
        let labels: Vec<i32> = detections.iter().map(|i| all_labels[*i]).collect();
        let picked = situation.picked_before + all.detections.len() as i32;
        let mut points = path_points(&round, &labels, picked);
        for point in &mut points {
            point.velocity_percent *= pick.velocity_percent / 100.0;
        }
        if place.is_none() {
            // The project's own moves lead to the pick and away from it.
            let mut point = points.swap_remove(round.pick_index);
            point.velocity_percent = pick.velocity_percent;
            points = vec![point];
        } else if let Some(above) = all.points.len().checked_sub(2) {
            // Off the carton that was placed before, by the way that led down to it.
            let mut back = all.points[above].clone();
            back.motion = Motion::Linear;
            all.points.push(back);
        }
        let at_pick = &round.waypoints[round.pick_index];
        all.carried = Some(Carried {
            box_from_tcp: round.base_from_group.inverse() * at_pick.base_from_tcp,
            height: round.group_size[2],
        });
        let sections = spec.gripper.sections.iter().enumerate();
        all.rounds.push(
            sections
                .filter(|(index, _)| !pick.uses_sections || round.sections.contains(index))
                .map(|(_, section)| section.digital_output)
                .collect(),
        );
        let cartons = detections.iter().filter_map(|i| picture.cartons[*i]);
        all.cartons.push(cartons.collect());
        for (port, rows) in all.custom_ports.iter_mut().zip(&own_data) {
            port.rows.push(rows.rows[detections[0]].clone());
        }
        all.points.extend(points);
        taken.extend(&detections);
        around.take(&detections, &round.carried);
        all.detections.extend(detections);
        if !pick.plans_all {
            all.surroundings = Arc::new(around);
            return Planned::Path(all);
        }
        start = match all.points.len().checked_sub(2) {
            Some(above) => all.points[above].joints,
            None => start,
        };
    }
}

/// A port without rows.
fn named(name: &str) -> CustomPort {
    CustomPort {
        name: name.to_owned(),
        rows: Vec::new(),
    }
}

/// One pick with its way to the conveyor, out of the reports that are left.
fn plan_one(
    spec: &CellSpec,
    picture: &Picture,
    left: &[usize],
    start: JointPositions,
    pick: &PickRequest,
    stopwatch: fn() -> f64,
    score: &mut Score,
    events: &mut Vec<EventKind>,
) -> Result<PickPlan, Refusal> {
    let boxes = seen_boxes(picture, left);
    let obstacle_points = seen_points(picture);
    let settings = PlannerSettings {
        max_group: pick.max_group as usize,
        ..spec.planner.clone()
    };
    let request = PlanRequest {
        arm: &spec.arm,
        gripper: &spec.gripper,
        boxes: &boxes,
        known_obstacles: &spec.known_obstacles,
        obstacle_points: &obstacle_points,
        start,
        place: &spec.place,
        settings: &settings,
    };
    let started = stopwatch();
    let planned = plan_pick(&request);
    score.planning_ms.push((stopwatch() - started) * 1e3);
    let plan = planned?;
    let clearance = plan.min_clearance * 1e3;
    score.min_clearance_mm = Some(
        score
            .min_clearance_mm
            .map_or(clearance, |least| least.min(clearance)),
    );
    events.push(plan_event(spec, &plan, left));
    Ok(plan)
}

/// Some reports of a picture, for the planner.
pub(crate) fn seen_boxes(picture: &Picture, numbers: &[usize]) -> Vec<SeenBox> {
    let seen = numbers.iter().map(|index| {
        let found = &picture.detection.boxes[*index];
        SeenBox {
            base_from_box: picture.base_from_boxes[*index],
            size: found.size,
            confidence: found.confidence,
        }
    });
    seen.collect()
}

/// What a picture shows besides boxes, base frame.
pub(crate) fn seen_points(picture: &Picture) -> Vec<Point> {
    let points = picture.detection.obstacle_points.iter();
    points
        .map(|point| picture.base_from_camera * point)
        .collect()
}

/// The plan's waypoints as the server sends them.
fn path_points(plan: &PickPlan, of_cartons: &[i32], picked_before: i32) -> Vec<PathPoint> {
    let mut labels = [0; 10];
    for (label, of_carton) in labels.iter_mut().zip(of_cartons) {
        *label = *of_carton;
    }
    let picked_now = of_cartons.len() as i32;
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
            label: if is_pick { labels[0] } else { 0 },
            vision_move: is_pick.then(|| VisionMoveData {
                labels,
                picked_total: picked_before + picked_now,
                picked_now,
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
    points.collect()
}

fn plan_event(spec: &CellSpec, plan: &PickPlan, left: &[usize]) -> EventKind {
    EventKind::Plan {
        detection: left[plan.box_index],
        detections: plan.box_indices.iter().map(|i| left[*i]).collect(),
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
            .map(|rejection| rejection.clone().renumbered(left).to_string())
            .collect(),
    }
}

/// The reason of each candidate in words.
fn refusal_reasons(refusal: &Refusal, left: &[usize]) -> Vec<String> {
    match refusal {
        Refusal::NothingFits(rejections) => rejections
            .iter()
            .map(|rejection| rejection.clone().renumbered(left).to_string())
            .collect(),
        other => vec![other.to_string()],
    }
}

/// Status and reason of a refusal: those of the candidate that was considered first.
fn refusal_meaning(refusal: &Refusal) -> (Status, FailureReason) {
    match refusal {
        Refusal::NoBoxes => (Status::VizNoVisionResult, FailureReason::NoDetection),
        Refusal::NothingFits(rejections) => match rejections.first().map(|r| &r.reason) {
            Some(RejectReason::Unreachable { .. } | RejectReason::CannotDrive { .. }) => {
                (Status::VizUnreachable, FailureReason::IkUnreachable)
            }
            Some(
                RejectReason::NoSectionFits { .. }
                | RejectReason::TooLittleForce { .. }
                | RejectReason::TooHeavy { .. }
                | RejectReason::TooMuchMoment { .. },
            ) => (Status::VizBadPickPoint, FailureReason::PlanCollision),
            Some(RejectReason::LowConfidence { .. } | RejectReason::Tilted { .. }) => {
                (Status::VizBadPickPoint, FailureReason::PoseError)
            }
            _ => (Status::VizCollision, FailureReason::PlanCollision),
        },
        _ => (Status::VizCollision, FailureReason::PlanCollision),
    }
}
