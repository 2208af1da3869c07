//! What is predicted is what a cabinet does: the same moves, driven tick by tick as a program hands them over.

use std::sync::Arc;
use std::task::Poll;

use depal_arm::Load;
use depal_controller::{Controller, ControllerEvent, ControllerSpec, NoNetwork};
use depal_motion::{
    BlendedPath, Interpolation, MotionError, Segment, SegmentTarget, Speed, Trajectory, Zone,
};
use depal_time::{RandomStream, SimTime, TICK};
use depal_vm::execution::{RobotTask, RuntimeError, Step};
use depal_vm::system::{
    MoveId, MoveKind, MoveRequest, MoveSpeed, MoveTarget, MoveZone, ProgramLocation, System,
};

use super::*;
use crate::timing::{as_driven, loads};
use crate::{RejectReason, TransferGoal, TransferPlan, TransferScene, plan_transfer};

/// A move with what the arm carries meanwhile: kg, and its centre in the flange frame.
#[derive(Clone)]
struct Driven {
    segment: Segment,
    carried: (f64, Point),
}

/// Hands moves over as a program does: ahead of the arm, waiting at stop points.
struct Program {
    moves: Vec<Driven>,
    at: usize,
    accepted: Option<MoveId>,
}

fn request(segment: &Segment) -> MoveRequest {
    MoveRequest {
        kind: match segment.interpolation {
            Interpolation::Joint => MoveKind::Joint,
            Interpolation::Linear => MoveKind::Linear,
        },
        target: match &segment.target {
            SegmentTarget::Joints(joints) => MoveTarget::Joints(*joints),
            SegmentTarget::Tcp(pose) => MoveTarget::Tcp(*pose),
            SegmentTarget::Arc { through, to } => MoveTarget::Arc {
                through: *through,
                to: *to,
            },
        },
        speed: MoveSpeed {
            tcp: segment.speed.tcp,
            orientation: segment.speed.orientation,
            joint_fraction: segment.speed.joint_fraction,
            acceleration_fraction: segment.speed.acceleration_fraction,
        },
        zone: match segment.zone {
            Zone::Fine => MoveZone::Fine,
            Zone::Fly { tcp, orientation } => MoveZone::Fly { tcp, orientation },
            Zone::Blend { joints } => MoveZone::Blend { joints },
        },
        flange_from_tcp: segment.flange_from_tcp,
        configuration: None,
        location: ProgramLocation::default(),
    }
}

impl RobotTask for Program {
    fn step(&mut self, system: &mut dyn System) -> Step {
        let Some(next) = self.moves.get(self.at) else {
            return Step::Finished;
        };
        system.statement(&ProgramLocation::default());
        let request = request(&next.segment);
        if self.accepted.is_none() {
            let (mass, centre) = next.carried;
            system.set_payload(mass, request.flange_from_tcp.inverse() * centre);
            match system.start_move(&request) {
                Poll::Pending => return Step::Blocked,
                Poll::Ready(Ok(id)) => self.accepted = Some(id),
                Poll::Ready(Err(fault)) => {
                    return Step::Failed(RuntimeError {
                        name: String::new(),
                        message: format!("{fault:?}"),
                        call_stack: Vec::new(),
                    });
                }
            }
        }
        let id = self.accepted.expect("just set");
        if request.zone == MoveZone::Fine && system.is_move_done(id) == Ok(false) {
            return Step::Blocked;
        }
        self.accepted = None;
        self.at += 1;
        Step::Ran
    }

    fn location(&self) -> ProgramLocation {
        ProgramLocation::default()
    }
}

/// Seconds from the beginning of the first move to the end of the last.
fn executed(arm: &Arc<Arm>, start: JointPositions, mounted: Load, moves: &[Driven]) -> f64 {
    let mut spec = ControllerSpec::new("rob1", Arc::clone(arm), start);
    spec.mounted = mounted;
    let mut controller = Controller::new(spec).unwrap();
    controller.set_task(Box::new(Program {
        moves: moves.to_vec(),
        at: 0,
        accepted: None,
    }));
    let (mut now, mut begin, mut end) = (SimTime::ZERO, None, None);
    let mut reached = 0;
    for _ in 0..20_000 {
        controller.tick(now, &mut NoNetwork);
        now += TICK;
        while let Some(event) = controller.poll_event() {
            match event {
                ControllerEvent::MoveStarted { at, .. } => begin = begin.or(Some(at)),
                ControllerEvent::MoveReached { at, .. } => {
                    reached += 1;
                    end = Some(at);
                }
                ControllerEvent::CornerFailure { .. } => panic!("a corner became a stop"),
                _ => {}
            }
        }
        if reached == moves.len() {
            break;
        }
    }
    assert_eq!(reached, moves.len(), "{:?}", controller.state());
    end.unwrap().as_secs_f64() - begin.unwrap().as_secs_f64()
}

fn load(mass: f64) -> Load {
    Load::point(mass, Point::new(0.05, 0.0, 0.45))
}

/// The arm with axes that hold such a load in these postures, and give no more than that or this share of what one axis
/// alone would ask for.
fn weak(postures: &[JointPositions], load: &Load, share: f64) -> Arm {
    let arm = arm();
    let zero = JointPositions::zeros(6);
    let mut limits = [1.0_f64; 6];
    for q in postures {
        let held = arm.holding_torques(q, load);
        for (j, limit) in arm.limits().iter().enumerate() {
            let mut rise = zero;
            rise[j] = limit.max_acceleration;
            let asked = arm.joint_torques(q, &zero, &rise, load)[j] - held[j];
            limits[j] = limits[j].max((share * asked).max(1.05 * held[j].abs()));
        }
    }
    arm.with_torque_limits(&limits).unwrap()
}

fn posture(random: &mut RandomStream) -> JointPositions {
    let mut u = |low: f64, high: f64| random.uniform(low, high);
    JointPositions::from_degrees(&[
        u(-100.0, 100.0),
        u(-25.0, 40.0),
        u(-25.0, 35.0),
        u(-60.0, 60.0),
        u(30.0, 100.0),
        u(-120.0, 120.0),
    ])
}

/// Shapes of neighbouring links overlap; here obstacles are what counts.
fn all_pairs(arm: &Arm) -> Vec<(String, String)> {
    let names: Vec<&String> = arm.links().iter().map(|l| &l.name).collect();
    let pairs = names
        .iter()
        .flat_map(|a| names.iter().map(move |b| ((*a).clone(), (*b).clone())));
    pairs.collect()
}

/// A transfer as it was planned: full speed, its own corners.
fn blended(plan: &TransferPlan, carried: (f64, Point)) -> Vec<Driven> {
    let segment = |w: &crate::TransferWaypoint| Driven {
        segment: Segment::blended(w.joints, w.blend),
        carried,
    };
    plan.waypoints[1..].iter().map(segment).collect()
}

/// Random transfers past a post and a table, with strong axes and with weak ones, light and heavy.
#[test]
fn a_transfer_takes_the_time_that_is_said() {
    let mut random = RandomStreams::new(31).stream("executed");
    let mut postures = Vec::new();
    postures.resize_with(300, || posture(&mut random));
    let weak = weak(&postures, &load(90.0), 0.45);
    let mut scene = TransferScene {
        arm: arm(),
        attached: Vec::new(),
        load: Load::NONE,
        obstacles: vec![
            cuboid(0.0, 0.0, -0.055, 8.0, 8.0, 0.1),
            cuboid(1.6, 0.5, 1.2, 0.15, 0.15, 2.4),
            cuboid(1.8, -0.9, 0.4, 0.8, 0.8, 0.8),
        ],
        allowed_pairs: all_pairs(&arm()),
        tcp_link: None,
    };
    let (mut driven, mut blends, mut wrong_without, mut slower) = (0, 0, 0, 0);
    for ends in postures.chunks(2).take(14) {
        let (start, goal) = (ends[0], TransferGoal::Joints(ends[1]));
        scene.arm = arm();
        scene.load = load(90.0);
        let Ok(free) = plan_transfer(&scene, &start, &goal) else {
            continue;
        };
        driven += 1;
        blends += usize::from(free.waypoints.iter().any(|w| w.blend > 0.0));
        let carried = |load: &Load| (load.mass, load.centre);
        let drive = |arm: &Arm, plan: &TransferPlan, load: &Load| {
            let moves = blended(plan, carried(load));
            executed(&Arc::new(arm.clone()), start, Load::NONE, &moves)
        };
        // Axes without torque limits carry everything alike.
        let time = drive(&scene.arm, &free, &load(90.0));
        assert!(
            (free.motion_time - time).abs() < 0.01 * time,
            "said {} s, took {time} s",
            free.motion_time
        );
        assert!((drive(&scene.arm, &free, &load(5.0)) - time).abs() < 1e-9);
        scene.arm = weak.clone();
        let heavy = plan_transfer(&scene, &start, &goal).unwrap();
        let time = drive(&weak, &heavy, &load(90.0));
        assert!(
            (heavy.motion_time - time).abs() < 0.01 * time,
            "said {} s, took {time} s with torque limits",
            heavy.motion_time
        );
        // The same way as without torques, for the search looks at speeds and accelerations.
        assert_eq!(heavy.waypoints, free.waypoints);
        assert_eq!(heavy.lower_bound, free.lower_bound);
        // Counterfactuals: the law without torques, and the load that was not told.
        wrong_without += usize::from((free.motion_time - time).abs() > 0.01 * time);
        scene.load = load(5.0);
        let light = plan_transfer(&scene, &start, &goal).unwrap();
        assert!(light.motion_time < heavy.motion_time * 1.001);
        slower += usize::from(light.motion_time < 0.99 * heavy.motion_time);
        // Blends and times belong together: the path alone says the same.
        let points: Vec<JointPositions> = heavy.waypoints.iter().map(|w| w.joints).collect();
        let corners: Vec<f64> = heavy.waypoints.iter().map(|w| w.blend).collect();
        let path = BlendedPath::new(&points, &corners);
        let again = path.loaded_time(&weak, &Load::NONE, &load(90.0)).unwrap();
        assert_eq!(again, heavy.motion_time);
    }
    assert!(driven >= 8 && blends >= 3, "{driven} {blends}");
    assert!(2 * wrong_without > driven, "{wrong_without} of {driven}");
    assert!(2 * slower > driven, "{slower} of {driven}");
}

/// A load that the axes cannot hold is no way, and the reason names the axis.
#[test]
fn a_transfer_that_cannot_be_held_is_refused() {
    let mut random = RandomStreams::new(32).stream("executed");
    let (start, goal) = (home(), posture(&mut random));
    let mut scene = TransferScene {
        arm: weak(&[start, goal, start.lerp(&goal, 0.5)], &load(50.0), 0.6),
        attached: Vec::new(),
        load: load(50.0),
        obstacles: Vec::new(),
        allowed_pairs: all_pairs(&arm()),
        tcp_link: None,
    };
    let goal = TransferGoal::Joints(goal);
    plan_transfer(&scene, &start, &goal).unwrap();
    scene.load = load(2000.0);
    let refusal = plan_transfer(&scene, &start, &goal).unwrap_err();
    assert!(
        refusal
            .reason
            .contains("N m to hold the arm with a load of 2000.0 kg"),
        "{}",
        refusal.reason
    );
}

/// Joint and linear moves, zones, speeds and loads at random: all at once against one after the other.
#[test]
fn a_program_with_zones_takes_the_time_of_its_trajectory() {
    let mut random = RandomStreams::new(33).stream("executed");
    let flange_from_tcp = Pose::translation(0.0, 0.0, 0.3);
    let mut postures = vec![home()];
    postures.resize_with(200, || posture(&mut random));
    let mounted = Load::point(50.0, Point::new(0.0, 0.0, 0.15));
    let full = mounted.and(&load(40.0));
    let strong = Arc::new(arm());
    let weak = Arc::new(weak(&postures, &full, 0.25));
    let (mut limited, mut heavier) = (0, 0);
    for round in 0..24 {
        let arm = if round % 2 == 0 { &strong } else { &weak };
        let mut moves = Vec::new();
        let mut here = home();
        while moves.len() < 8 {
            let linear = random.uniform(0.0, 1.0) < 0.5;
            let target = if linear {
                let mut to = arm.base_from_flange(&here) * flange_from_tcp;
                for axis in 0..3 {
                    to.translation.vector[axis] += random.uniform(-0.3, 0.3);
                }
                SegmentTarget::Tcp(to)
            } else {
                SegmentTarget::Joints(here.lerp(&posture(&mut random), 0.4))
            };
            let last = moves.len() == 7;
            let zone = match random.uniform(0.0, 3.0) as usize {
                _ if last => Zone::Fine,
                0 => NEAR,
                _ => Zone::Fly {
                    tcp: random.uniform(0.01, 0.2),
                    orientation: random.uniform(0.02, 0.3),
                },
            };
            let segment = Segment {
                interpolation: if linear {
                    Interpolation::Linear
                } else {
                    Interpolation::Joint
                },
                target,
                flange_from_tcp,
                speed: Speed {
                    tcp: random.uniform(0.5, 5.0),
                    orientation: 8.0,
                    joint_fraction: random.uniform(0.5, 1.0),
                    acceleration_fraction: random.uniform(0.8, 1.0),
                },
                zone,
                quarters: None,
            };
            // What cannot be reached or held is drawn again.
            let mut probe = Trajectory::new(Arc::clone(&weak), here);
            probe.set_tool_and_load(&mounted, &load(40.0));
            if probe.append(0.0, &segment).is_ok() {
                here = probe.end_joints();
                let mass = if moves.len() < 3 { 0.0 } else { 40.0 };
                moves.push(Driven {
                    segment,
                    carried: (mass, load(40.0).centre),
                });
            }
        }
        let predicted = |arm: &Arc<Arm>, factor: f64| {
            let mut t = Trajectory::new(Arc::clone(arm), home());
            for driven in &moves {
                let (mass, centre) = driven.carried;
                t.set_tool_and_load(&mounted, &Load::point(mass * factor, centre));
                t.append(0.0, &driven.segment).unwrap();
            }
            assert!(t.corner_failures().is_empty());
            t.duration()
        };
        let said = predicted(arm, 1.0);
        let time = executed(arm, home(), mounted, &moves);
        assert!(
            (said - time).abs() < 0.01 * time,
            "round {round}: said {said} s, took {time} s"
        );
        if round % 2 == 1 {
            limited += usize::from(predicted(&strong, 1.0) < 0.99 * time);
            heavier += usize::from(predicted(&weak, 0.05) < 0.995 * time);
        }
    }
    assert!(limited >= 6, "torques count in {limited} of 12");
    assert!(heavier >= 4, "the load counts in {heavier} of 12");
}

const NEAR: Zone = Zone::Fly {
    tcp: 0.01,
    orientation: 0.026,
};

/// Picks driven in the manner of the shipped programs, with and without torque limits.
#[test]
fn a_pick_takes_the_time_that_is_said() {
    let mut cell = Cell::new();
    let boxes = pallet(2);
    let mut times = Vec::new();
    for limited in [false, true] {
        if limited {
            let states: Vec<JointPositions> = dense(&cell, &cell.plan(&boxes).unwrap(), 0.05)
                .into_iter()
                .map(|(_, q)| q)
                .collect();
            cell.arm = weak(&states, &load(90.0), 0.5);
        }
        let plan = cell.plan(&boxes).unwrap();
        let request = cell.request(&boxes);
        let middle = plan.carried.pose.translation.vector;
        let (tool, carton) = loads(&request, cell.settings.max_carton_mass, &middle);
        let moves: Vec<Driven> = as_driven(&request, &plan.waypoints)
            .into_iter()
            .enumerate()
            .map(|(i, segment)| Driven {
                segment,
                carried: if i > plan.pick_index {
                    (carton.mass, carton.centre)
                } else {
                    (0.0, Point::origin())
                },
            })
            .collect();
        let time = executed(&Arc::new(cell.arm.clone()), cell.start, tool, &moves);
        assert!(
            (plan.estimated_time - time).abs() < 0.01 * time,
            "said {} s, took {time} s",
            plan.estimated_time
        );
        times.push(time);
    }
    assert!(times[1] > 1.02 * times[0], "{times:?}");
}

/// The way is free, but an axis could not hold gripper and carton on it: no plan, and the axis is named.
#[test]
fn a_pick_that_cannot_be_held_is_refused() {
    let mut cell = Cell::new();
    let boxes = pallet(1);
    let states: Vec<JointPositions> = dense(&cell, &cell.plan(&boxes).unwrap(), 0.05)
        .into_iter()
        .map(|(_, q)| q)
        .collect();
    cell.arm = weak(&states, &Load::NONE, 0.0);
    let Err(Refusal::NothingFits(rejections)) = cell.plan(&boxes) else {
        panic!("planned");
    };
    let reason = &rejections[0].reason;
    assert!(
        matches!(
            reason,
            RejectReason::CannotDrive {
                error: MotionError::Overload { .. }
            }
        ),
        "{reason}"
    );
}
