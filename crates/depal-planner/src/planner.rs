use depal_frames::{JointPositions, Pose, Rotation, Vector};

use crate::{
    bodies::{Body, Robot},
    candidate::{Candidates, footprint_overlap, load},
    certificate::certify,
    contact::Check,
    grasp::{Grasp, grasps},
    group::Group,
    path::{Blocked, corner_states, touch_on_states, touch_on_way, vertical_line, ways},
    plan::{Motion, PickPlan, Waypoint},
    refusal::{Refusal, RejectReason, Rejection, Stage, Touch},
    request::PlanRequest,
    suction::{along, loaded_percent, vertical_percent},
    timing::{Trapezoid, chain_time, predicted_time},
    world::World,
};

/// Chooses a box and plans the way there and to the place.
///
/// # Errors
/// [`Refusal`] lists every box with its reason.
pub fn plan_pick(request: &PlanRequest) -> Result<PickPlan, Refusal> {
    let settings = request.settings;
    if request.boxes.is_empty() {
        return Err(Refusal::NoBoxes);
    }
    for (i, (&position, limit)) in request.start.iter().zip(request.arm.limits()).enumerate() {
        if !(position >= limit.lower - 1e-6 && position <= limit.upper + 1e-6) {
            return Err(Refusal::StartOutsideLimits {
                joint: i + 1,
                position,
                lower: limit.lower,
                upper: limit.upper,
            });
        }
    }
    let robot = Robot::new(request.arm, request.gripper);
    let worlds = Worlds {
        far: World::new(request, settings.transfer_padding),
        close: World::new(request, settings.close_padding),
        bare: World::new(request, 0.0),
    };
    let planner = Planner {
        request,
        robot: &robot,
        worlds: &worlds,
        start_far: planner_start(request, &robot, &worlds)?,
    };
    let mut candidates = Candidates::choose(request);
    let rejection = |group: &Group, reason| Rejection {
        box_index: group.members[0],
        with: group.members[1..].to_vec(),
        reason,
    };
    for layer in &candidates.layers {
        // First what can be held as well as it can be: a neighbour that stands in the way may be gone by and by.
        let mut passed = Vec::new();
        for group in layer {
            match planner.pick(group, Grasps::Best) {
                Ok(mut plan) => {
                    candidates.rejected.append(&mut passed);
                    plan.rejected = candidates.rejected;
                    return Ok(plan);
                }
                Err(reason) => passed.push(rejection(group, reason)),
            }
        }
        for group in layer {
            match planner.pick(group, Grasps::All) {
                Ok(mut plan) => {
                    // Those that come later were turned down for their best grasps alone.
                    let done = candidates.rejected.iter().map(|r| r.box_index);
                    let done: Vec<usize> = done.chain([plan.box_index]).collect();
                    passed.retain(|r: &Rejection| !done.contains(&r.box_index));
                    candidates.rejected.append(&mut passed);
                    plan.rejected = candidates.rejected;
                    return Ok(plan);
                }
                Err(reason) => candidates.rejected.push(rejection(group, reason)),
            }
        }
    }
    Err(Refusal::NothingFits(candidates.rejected))
}

/// The same obstacles in three thicknesses.
struct Worlds {
    far: World,
    close: World,
    bare: World,
}

/// Whether the first move can keep the full padding; it cannot when the arm starts closer than that to something.
fn planner_start(request: &PlanRequest, robot: &Robot, worlds: &Worlds) -> Result<bool, Refusal> {
    let check = |world| Check {
        robot,
        world,
        carton: None,
        without: &[],
        stage: Stage::Start,
    };
    if check(&worlds.far).touch(&request.start).is_none() {
        return Ok(true);
    }
    match check(&worlds.close).touch(&request.start) {
        None => Ok(false),
        Some(touch) => Err(Refusal::StartTouches(touch)),
    }
}

struct Planner<'a> {
    request: &'a PlanRequest<'a>,
    robot: &'a Robot<'a>,
    worlds: &'a Worlds,
    start_far: bool,
}

/// Which grasps of a group are tried.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Grasps {
    /// The best one and those equally good.
    Best,
    /// All of them, and where all are blocked the search.
    All,
}

/// One combination of grasp, joints at the pick and joints at the place.
struct Attempt {
    grasp: usize,
    pick: JointPositions,
    place: JointPositions,
    time: f64,
}

/// What stood in the way of a box: the touch that came farthest, and how far reach was the trouble.
#[derive(Default)]
struct Notes {
    touch: Option<Touch>,
    poses: usize,
    reached_pick: bool,
    reached_place: bool,
    straight: Option<Stage>,
}

impl Notes {
    fn touched(&mut self, touch: Touch) {
        if self.touch.as_ref().is_none_or(|t| t.stage < touch.stage) {
            self.touch = Some(touch);
        }
    }

    fn reason(self, tried: usize) -> RejectReason {
        let unreachable = |stage, tried| RejectReason::Unreachable { stage, tried };
        if !self.reached_pick {
            return unreachable(Stage::Pick, self.poses);
        }
        match (self.touch, self.straight) {
            (Some(touch), _) if tried > 0 || self.reached_place || touch.stage == Stage::Pick => {
                RejectReason::Collision {
                    touch,
                    tried: tried.max(self.poses),
                }
            }
            (_, Some(stage)) => unreachable(stage, tried),
            _ if !self.reached_place => unreachable(Stage::Place, self.poses),
            _ => unreachable(Stage::TransferToPlace, tried),
        }
    }
}

/// Same number of sections, same offset: only the yaw differs.
fn equally_good(a: &Grasp, b: &Grasp) -> bool {
    a.sections.len() == b.sections.len() && (a.tcp_offset.norm() - b.tcp_offset.norm()).abs() < 1e-3
}

impl Planner<'_> {
    fn tool(&self, joints: &JointPositions) -> Pose {
        self.request.arm.base_from_flange(joints) * self.request.gripper.flange_from_tcp
    }

    /// Where a group is taken to be: an arm with fewer than six axes cannot lean, so it comes down level.
    fn base_from_group(&self, group: &Group) -> Pose {
        let pose = group.whole.base_from_box;
        if self.request.arm.joint_count() >= 6 {
            return pose;
        }
        let long = pose.rotation * Vector::x();
        let level = Rotation::from_axis_angle(&Vector::z_axis(), long.y.atan2(long.x));
        Pose::from_parts(pose.translation, level)
    }

    fn pick(&self, group: &Group, which: Grasps) -> Result<PickPlan, RejectReason> {
        let settings = self.request.settings;
        let (mass, limit) = (load(group, settings), settings.max_load);
        if mass > limit {
            return Err(RejectReason::TooHeavy { mass, limit });
        }
        let grasps = grasps(self.request.gripper, group, settings)?;
        let (low, high) = (self.lift_height(group), self.height_out(group));
        let mut notes = Notes::default();
        let mut tried = 0;
        let mut first: Vec<(&Grasp, Attempt)> = Vec::new();
        // Equally good grasps are mixed and sorted by time; worse ones come only when these lead nowhere.
        let most = match which {
            Grasps::Best => 1,
            Grasps::All => usize::MAX,
        };
        for tier in grasps.chunk_by(equally_good).take(most) {
            for attempt in self.attempts(group, tier, &mut notes) {
                tried += 1;
                let grasp = &tier[attempt.grasp];
                for lift in [low, high] {
                    if let Some(plan) = self.way(group, grasp, &attempt, lift, false, &mut notes) {
                        return self.sized(plan);
                    }
                    if high <= low {
                        break;
                    }
                }
                if first.len() < settings.search_attempts {
                    first.push((grasp, attempt));
                }
            }
        }
        if which == Grasps::Best && grasps.chunk_by(equally_good).count() > 1 {
            return Err(notes.reason(tried));
        }
        // No template is free: search for the first few.
        for (grasp, attempt) in &first {
            for lift in [low, high] {
                if let Some(plan) = self.way(group, grasp, attempt, lift, true, &mut notes) {
                    return self.sized(plan);
                }
                if high <= low {
                    break;
                }
            }
        }
        Err(notes.reason(tried))
    }

    fn sized(&self, plan: PickPlan) -> Result<PickPlan, RejectReason> {
        let (found, limit) = (plan.waypoints.len(), self.request.settings.max_waypoints);
        if found > limit {
            return Err(RejectReason::TooManyWaypoints { found, limit });
        }
        Ok(plan)
    }

    /// The fastest combinations whose pick and place are reachable and free, in order of obstacle-free time.
    fn attempts(&self, group: &Group, grasps: &[Grasp], notes: &mut Notes) -> Vec<Attempt> {
        let request = self.request;
        let (arm, settings) = (request.arm, request.settings);
        let seen = &group.whole;
        let tcp_from_flange = request.gripper.flange_from_tcp.inverse();
        let mut attempts: Vec<Attempt> = Vec::new();
        for (g, grasp) in grasps.iter().enumerate() {
            let at_pick = self.base_from_group(group) * grasp.box_from_tcp * tcp_from_flange;
            let bare_tool = Check {
                robot: self.robot,
                world: &self.worlds.close,
                carton: None,
                without: &group.members,
                stage: Stage::Pick,
            };
            let picks = arm.inverse(&at_pick);
            notes.poses += 1;
            notes.reached_pick |= !picks.is_empty();
            let picks = free_states(&bare_tool, picks, notes);
            if picks.is_empty() {
                continue;
            }
            let shrunk = self.robot.carton(&grasp.carried, settings.stack_tolerance);
            let loaded = Check {
                carton: Some(&shrunk),
                stage: Stage::Place,
                ..bare_tool
            };
            for &yaw in &request.place.yaws {
                let turn = Rotation::from_axis_angle(&Vector::z_axis(), yaw);
                let up = Pose::translation(0.0, 0.0, seen.size.height + settings.place_gap);
                let base_from_placed = request.place.base_from_place * turn * up;
                let at_place = base_from_placed * grasp.box_from_tcp * tcp_from_flange;
                let places = arm.inverse(&at_place);
                notes.poses += 1;
                notes.reached_place |= !places.is_empty();
                for place in free_states(&loaded, places, notes) {
                    for pick in &picks {
                        let there = Trapezoid::joints(&request.start, pick, arm.limits());
                        let back = Trapezoid::joints(pick, &place, arm.limits());
                        attempts.push(Attempt {
                            grasp: g,
                            pick: *pick,
                            place,
                            time: there.duration + back.duration,
                        });
                    }
                }
            }
        }
        attempts.sort_by(|a, b| a.time.total_cmp(&b.time));
        attempts.truncate(settings.attempts_per_grasp);
        attempts
    }

    /// How far the carton is lifted straight up: its bottom clears whatever stands beside it, corner cutting included.
    fn lift_height(&self, group: &Group) -> f64 {
        let settings = self.request.settings;
        let target = &group.whole;
        let bottom = target.base_from_box.translation.z - target.size.height;
        let neighbours = self
            .request
            .boxes
            .iter()
            .enumerate()
            .filter(|&(i, other)| {
                !group.members.contains(&i) && footprint_overlap(target, other) > -0.1
            })
            .map(|(_, other)| other.base_from_box.translation.z)
            .fold(bottom, f64::max);
        let above = settings
            .lift_clearance
            .max(settings.corner_zone + settings.transfer_padding + 0.005);
        neighbours + above - bottom
    }

    /// The lift that brings the carton out of what it stands in: its bottom above all that is known within a hand's breadth
    /// of its sides, the walls of a cage or container.
    fn height_out(&self, group: &Group) -> f64 {
        let settings = self.request.settings;
        let target = &group.whole;
        let pose = target.base_from_box;
        let bottom = pose.translation.z - target.size.height;
        let reach = 0.5 * target.size.length.hypot(target.size.width) + 0.15;
        let rim = self
            .worlds
            .bare
            .rim(&pose.translation.vector, reach)
            .map_or(bottom, |rim| rim.max(bottom));
        let above = settings
            .lift_clearance
            .max(settings.corner_zone + settings.transfer_padding + 0.005);
        rim + above - bottom
    }

    /// The whole way of one attempt; what hinders it is noted.
    fn way(
        &self,
        group: &Group,
        grasp: &Grasp,
        attempt: &Attempt,
        lift: f64,
        search: bool,
        notes: &mut Notes,
    ) -> Option<PickPlan> {
        let request = self.request;
        let (arm, settings) = (request.arm, request.settings);
        let carton = self.robot.carton(&grasp.carried, 0.0);
        let shrunk = self.robot.carton(&grasp.carried, settings.stack_tolerance);
        let check = |stage, world, carton, without| Check {
            robot: self.robot,
            world,
            carton,
            without,
            stage,
        };
        let Worlds { far, close, bare } = self.worlds;
        let target = &group.members[..];

        // The straight moves.
        let mut line = |start: &JointPositions, rise: f64, stage: Stage| {
            let states = vertical_line(arm, start, rise);
            if states.is_none() {
                notes.straight = Some(stage);
            }
            states
        };
        let rise = settings.approach_height.max(lift - self.lift_height(group));
        let mut approach = line(&attempt.pick, rise, Stage::Approach)?;
        approach.reverse();
        let lift = line(&attempt.pick, lift, Stage::Lift)?;
        let mut set_down = line(&attempt.place, settings.place_height, Stage::SetDown)?;
        set_down.reverse();
        let down = check(Stage::Approach, close, None, target);
        let up = check(Stage::Lift, close, Some(&shrunk), target);
        let lower = check(Stage::SetDown, close, Some(&shrunk), target);
        let lower_bare = check(Stage::SetDown, bare, Some(&carton), target);
        for (check, states) in [
            (&down, &approach),
            (&up, &lift),
            (&lower, &set_down),
            (&lower_bare, &set_down),
        ] {
            if let Some(touch) = touch_on_states(check, states) {
                notes.touched(touch);
                return None;
            }
        }

        // The free moves.
        let first_world = if self.start_far { far } else { close };
        let to_pick = check(Stage::TransferToPick, first_world, None, &[]);
        let to_place = check(Stage::TransferToPlace, far, Some(&carton), target);
        let there = self.free_way(
            &to_pick,
            &request.start,
            None,
            &approach,
            None,
            search,
            notes,
        )?;
        let back = self.free_way(
            &to_place,
            &lift[lift.len() - 1],
            Some(&lift),
            &set_down,
            Some(settings.max_carry_tilt),
            search,
            notes,
        )?;

        // The certificate: true bodies, all of the way.
        let mut clearance = f64::INFINITY;
        let stretches: [(Option<&Body>, &[usize], &[JointPositions]); 5] = [
            (None, &[], &there),
            (None, target, &approach),
            (None, target, &lift),
            (Some(&carton), target, &back),
            (None, target, &set_down),
        ];
        for (carton, without, states) in stretches {
            let fine = check(Stage::Certificate, bare, carton, without);
            if let Err(touch) = certify(&fine, states, &mut clearance) {
                notes.touched(touch);
                return None;
            }
        }
        Some(self.finish(
            group, grasp, &there, &approach, &lift, &back, &set_down, clearance,
        ))
    }

    /// The fastest free joint way between two straight moves, their corners included.
    fn free_way(
        &self,
        check: &Check,
        from: &JointPositions,
        before: Option<&[JointPositions]>,
        after: &[JointPositions],
        upright: Option<f64>,
        search: bool,
        notes: &mut Notes,
    ) -> Option<Vec<JointPositions>> {
        let settings = self.request.settings;
        let tool = |q: &JointPositions| self.tool(q);
        let to = after[0];
        let corner =
            |a: &JointPositions, at: &JointPositions, b: &JointPositions, check: &Check| {
                touch_on_states(check, &corner_states(tool, a, at, b, settings.corner_zone))
            };
        // Beside the straight moves the target box and the close padding count.
        let beside = Check {
            world: &self.worlds.close,
            ..*check
        };
        // The corners between this way and the straight moves beside it.
        let ends = |points: &[JointPositions]| {
            let last = points.len() - 1;
            let into = corner(&points[last - 1], &to, &after[after.len() / 2], &beside);
            into.or_else(|| {
                let half = before.map(|line| &line[line.len() / 2])?;
                corner(half, from, &points[1], &beside)
            })
        };
        for way in ways(self.request.arm, from, &to) {
            match touch_on_way(check, &way.points, upright, settings) {
                Err(Blocked::Touches(touch)) => {
                    notes.touched(touch);
                    continue;
                }
                Err(Blocked::Leans) => continue,
                Ok(()) => {}
            }
            match ends(&way.points) {
                Some(touch) => notes.touched(touch),
                None => return Some(way.points),
            }
        }
        if !search {
            return None;
        }
        let way = crate::search::search(check, from, &to, upright, settings)?;
        match ends(&way) {
            Some(touch) => {
                notes.touched(touch);
                None
            }
            None => Some(way),
        }
    }

    fn finish(
        &self,
        group: &Group,
        grasp: &Grasp,
        there: &[JointPositions],
        approach: &[JointPositions],
        lift: &[JointPositions],
        back: &[JointPositions],
        set_down: &[JointPositions],
        min_clearance: f64,
    ) -> PickPlan {
        let request = self.request;
        let (arm, settings) = (request.arm, request.settings);
        let mut waypoints: Vec<Waypoint> = Vec::new();
        let mut moves: Vec<(Trapezoid, bool)> = Vec::new();
        let mut add =
            |joints: &JointPositions, profile: Trapezoid, motion, percent: f64, is_pick| {
                waypoints.push(Waypoint {
                    joints: *joints,
                    base_from_tcp: self.tool(joints),
                    motion,
                    velocity_percent: percent,
                    is_pick,
                });
                moves.push((profile.slowed(percent), is_pick));
            };
        let line = |states: &[JointPositions]| {
            let [from, to] =
                [0, states.len() - 1].map(|i| self.tool(&states[i]).translation.vector);
            Trapezoid::line(
                (to - from).norm(),
                settings.linear_speed,
                settings.linear_acceleration,
            )
        };
        let end = |states: &[JointPositions]| states[states.len() - 1];
        for w in there.windows(2) {
            let profile = Trapezoid::joints(&w[0], &w[1], arm.limits());
            add(&w[1], profile, Motion::Joint, 100.0, false);
        }
        add(&end(approach), line(approach), Motion::Linear, 100.0, true);
        let straight = vertical_percent(&grasp.hold, settings);
        add(&end(lift), line(lift), Motion::Linear, straight, false);
        let carton_in_tcp = grasp.carried.pose.translation.vector;
        for w in back.windows(2) {
            let profile = Trapezoid::joints(&w[0], &w[1], arm.limits());
            let percent = loaded_percent(
                &profile,
                along(|q| self.tool(q), &w[0], &w[1]),
                &carton_in_tcp,
                &grasp.hold,
                settings,
            );
            add(&w[1], profile, Motion::Joint, percent, false);
        }
        add(
            &end(set_down),
            line(set_down),
            Motion::Linear,
            straight,
            false,
        );
        let size = group.whole.size;
        // The law that moves the arm; where it cannot make a move, the sum of the moves alone.
        let mass = load(group, settings);
        let estimated_time = predicted_time(request, &waypoints, mass, &carton_in_tcp)
            .unwrap_or_else(|_| chain_time(&moves));
        PickPlan {
            pick_index: there.len() - 1,
            estimated_time,
            waypoints,
            box_index: group.members[0],
            box_indices: group.members.clone(),
            base_from_group: self.base_from_group(group),
            sections: grasp.sections.clone(),
            tcp_offset: grasp.tcp_offset,
            edge_corner_id: grasp.edge_corner_id,
            group_orientation: u8::from(grasp.across),
            box_orientation: u8::from(group.is_across),
            group_size: [size.length, size.width, size.height],
            carried: grasp.carried.clone(),
            min_clearance,
            rejected: Vec::new(),
        }
    }
}

/// The states that touch nothing; what the others touch is noted.
fn free_states(
    check: &Check,
    states: Vec<JointPositions>,
    notes: &mut Notes,
) -> Vec<JointPositions> {
    states
        .into_iter()
        .filter(|q| match check.touch(q) {
            None => true,
            Some(touch) => {
                notes.touched(touch);
                false
            }
        })
        .collect()
}
