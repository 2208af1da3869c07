use std::sync::OnceLock;

use depal_arm::Arm;
use depal_frames::{BoxSize, JointPositions, PlacedShape, Point, Pose, Rotation, Vector};
use depal_gripper::{CupSpec, GripperSpec, SectionSpec, VacuumSpec};
use depal_time::RandomStreams;
use nalgebra::Translation3;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::{
    Motion, PickPlan, PlaceSpec, PlanRequest, PlannerSettings, Refusal, SeenBox, Stage,
    bodies::Robot, contact::Check, plan_pick, world::World,
};

mod choice;
mod executed;
mod given;
mod groups;
mod obstacles;
mod pallet;
mod threads;

const IRB6700: &str = include_str!("../../../../urdf/abb_irb6700_150_320.urdf");
const CARTON: [f64; 3] = [0.4, 0.3, 0.25];
const PALLET_TOP: f64 = 0.144;

fn arm() -> Arm {
    let accelerations = [180.0, 180.0, 180.0, 400.0, 400.0, 500.0].map(f64::to_radians);
    Arm::from_urdf(IRB6700, "irb6700", &accelerations).unwrap()
}

/// Four sections of 140 x 360 mm with 3 x 8 cups of 40 mm each; the plate's underside is 45 mm above the cup plane.
fn gripper() -> GripperSpec {
    let mut cups = Vec::new();
    let mut sections = Vec::new();
    for section in 0..4 {
        let x = -0.225 + 0.15 * section as f64;
        sections.push(SectionSpec {
            digital_output: section as u16,
            area: [x - 0.07, x + 0.07, -0.18, 0.18],
        });
        for i in 0..3 {
            for j in 0..8 {
                cups.push(CupSpec {
                    position: [x + (i as f64 - 1.0) * 0.045, (j as f64 - 3.5) * 0.045],
                    section,
                    diameter: 0.04,
                    stiffness: 10_000.0,
                    damping: 100.0,
                    stroke: 0.01,
                });
            }
        }
    }
    GripperSpec {
        name: "four sections".to_owned(),
        flange_from_tcp: Pose::translation(0.0, 0.0, 0.30),
        mass: 50.0,
        bodies: vec![
            PlacedShape::cuboid(
                Pose::translation(0.0, 0.0, -0.08),
                Vector::new(0.62, 0.40, 0.07),
            ),
            PlacedShape::cuboid(
                Pose::translation(0.0, 0.0, -0.2),
                Vector::new(0.16, 0.16, 0.18),
            ),
        ],
        sections,
        cups,
        vacuum: VacuumSpec {
            supply_vacuum: 30_000.0,
            build_up_time: 0.08,
            blow_off_time: 0.1,
            switch_on_fraction: 0.6,
            switch_off_fraction: 0.5,
            open_cup_loss: 0.1,
            flow: None,
            friction: 0.5,
        },
    }
}

fn cuboid(x: f64, y: f64, z: f64, sx: f64, sy: f64, sz: f64) -> PlacedShape {
    PlacedShape::cuboid(Pose::translation(x, y, z), Vector::new(sx, sy, sz))
}

/// Floor, pallet, conveyor, fence, camera post.
fn known() -> Vec<PlacedShape> {
    vec![
        cuboid(0.0, 0.0, -0.055, 8.0, 8.0, 0.1),
        cuboid(1.7, 0.0, 0.07, 0.8, 1.2, 0.14),
        cuboid(0.4, 1.8, 0.35, 2.0, 0.6, 0.7),
        cuboid(2.6, 0.0, 1.0, 0.06, 3.0, 2.0),
        cuboid(2.6, -1.2, 1.6, 0.15, 0.15, 3.2),
    ]
}

fn place() -> PlaceSpec {
    PlaceSpec {
        base_from_place: Pose::translation(0.4, 1.8, 0.7),
        yaws: vec![0.0, std::f64::consts::PI],
    }
}

fn seen(x: f64, y: f64, top: f64, yaw: f64) -> SeenBox {
    SeenBox {
        base_from_box: Pose::from_parts(
            Translation3::new(x, y, top),
            Rotation::from_axis_angle(&Vector::z_axis(), yaw),
        ),
        size: BoxSize {
            length: CARTON[0],
            width: CARTON[1],
            height: CARTON[2],
        },
        confidence: 0.9,
    }
}

/// `layers` of eight, as vision would see them if it could see all: gaps of 2 to 6 mm, turned by up to 0.3 degrees.
fn pallet(layers: usize) -> Vec<SeenBox> {
    let mut random = RandomStreams::new(7).stream("pallet");
    let mut boxes = Vec::new();
    for layer in 0..layers {
        for i in 0..2 {
            for j in 0..4 {
                let mut jitter = || random.uniform(-0.001, 0.001);
                let x = 1.7 + (i as f64 - 0.5) * 0.404 + jitter();
                let y = (j as f64 - 1.5) * 0.304 + jitter();
                let top = PALLET_TOP + 0.25 * (layer + 1) as f64;
                let yaw = jitter() * 3.0
                    + if (i + j) % 2 == 0 {
                        0.0
                    } else {
                        std::f64::consts::PI
                    };
                boxes.push(seen(x, y, top, yaw));
            }
        }
    }
    boxes
}

/// Those with no box on top.
fn visible(boxes: &[SeenBox]) -> Vec<SeenBox> {
    let covers = |a: &SeenBox, b: &SeenBox| {
        let d = a.base_from_box.translation.vector - b.base_from_box.translation.vector;
        d.z > 0.1 && d.xy().norm() < 0.1
    };
    boxes
        .iter()
        .filter(|b| !boxes.iter().any(|a| covers(a, b)))
        .copied()
        .collect()
}

const THREADS: [usize; 3] = [1, 2, 4];

/// What `work` comes to in a pool of so many threads.
fn with_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    static POOLS: OnceLock<[ThreadPool; 3]> = OnceLock::new();
    let pool = |count| ThreadPoolBuilder::new().num_threads(count).build().unwrap();
    let pools = POOLS.get_or_init(|| THREADS.map(pool));
    let index = THREADS.iter().position(|&count| count == threads);
    pools[index.unwrap()].install(work)
}

fn home() -> JointPositions {
    JointPositions::from_degrees(&[45.0, -15.0, 10.0, 0.0, 95.0, 45.0])
}

struct Cell {
    arm: Arm,
    gripper: GripperSpec,
    known: Vec<PlacedShape>,
    points: Vec<Point>,
    place: PlaceSpec,
    settings: PlannerSettings,
    start: JointPositions,
}

impl Cell {
    fn new() -> Self {
        Self {
            arm: arm(),
            gripper: gripper(),
            known: known(),
            points: Vec::new(),
            place: place(),
            settings: PlannerSettings::default(),
            start: home(),
        }
    }

    fn request<'a>(&'a self, boxes: &'a [SeenBox]) -> PlanRequest<'a> {
        PlanRequest {
            arm: &self.arm,
            gripper: &self.gripper,
            boxes,
            known_obstacles: &self.known,
            obstacle_points: &self.points,
            start: self.start,
            place: &self.place,
            settings: &self.settings,
        }
    }

    /// Plan and plan history, which must be the same with any number of threads: every plan of these tests is made by
    /// pools of 1, 2 and 4. Figures are compared by their digits, so that not even -0 passes for 0.
    fn plan(&self, boxes: &[SeenBox]) -> Result<PickPlan, Refusal> {
        let request = self.request(boxes);
        let [one, more @ ..] = THREADS.map(|count| with_threads(count, || plan_pick(&request)));
        for (other, threads) in more.iter().zip(&THREADS[1..]) {
            assert_eq!(&one, other, "{threads} threads");
            let [one, other] = [&one, other].map(|plan| format!("{plan:?}"));
            assert_eq!(one, other, "{threads} threads");
        }
        one
    }
}

/// Joint states of a plan at `step` rad, straight moves by the inverse at 2 mm; each with whether the carton hangs on it.
fn dense(cell: &Cell, plan: &PickPlan, step: f64) -> Vec<(usize, JointPositions)> {
    let mut states = vec![(0, cell.start)];
    let mut before = cell.start;
    for (i, w) in plan.waypoints.iter().enumerate() {
        match w.motion {
            Motion::Joint => {
                let count = (before.max_distance(&w.joints) / step).ceil().max(1.0) as usize;
                states.extend(
                    (1..=count).map(|k| (i, before.lerp(&w.joints, k as f64 / count as f64))),
                );
            }
            Motion::Linear => {
                let from = cell.arm.base_from_flange(&before);
                let to = cell.arm.base_from_flange(&w.joints);
                let count = ((to.translation.vector - from.translation.vector).norm() / 0.002)
                    .ceil() as usize;
                let mut near = before;
                for k in 1..=count {
                    let pose = from.lerp_slerp(&to, k as f64 / count as f64);
                    near = cell
                        .arm
                        .inverse_nearest(&pose, &near)
                        .expect("the straight line is in reach");
                    states.push((i, near));
                }
                assert!(
                    near.max_distance(&w.joints) < 1e-5,
                    "the straight line ends on the same branch"
                );
            }
        }
        before = w.joints;
    }
    states
}

/// Independent of the planner's own certificate: intersection tests, unpadded, on a dense sampling.
fn assert_free(cell: &Cell, boxes: &[SeenBox], plan: &PickPlan) {
    let request = cell.request(boxes);
    let world = World::new(&request, 0.0);
    let robot = Robot::new(&cell.arm, &cell.gripper);
    let carton = robot.carton(&plan.carried, 0.0);
    let rubbing = robot.carton(&plan.carried, cell.settings.stack_tolerance);
    let last = plan.waypoints.len() - 1;
    for (i, q) in dense(cell, plan, 0.005) {
        assert!(cell.arm.within_limits(&q), "{q:?}");
        let loaded = i > plan.pick_index;
        let straight_lift = i == plan.pick_index + 1;
        let check = Check {
            robot: &robot,
            world: &world,
            carton: loaded.then_some(if straight_lift { &rubbing } else { &carton }),
            without: if i >= plan.pick_index {
                &plan.box_indices
            } else {
                &[]
            },
            stage: Stage::Certificate,
        };
        assert_eq!(check.touch(&q), None, "waypoint {i} of {last}");
    }
}

/// The plan says what it does: the tool is on the box, only the named sections have cups on it, the carton ends at the place.
fn assert_consistent(cell: &Cell, boxes: &[SeenBox], plan: &PickPlan) {
    let pick = &plan.waypoints[plan.pick_index];
    assert_eq!(plan.waypoints.iter().filter(|w| w.is_pick).count(), 1);
    assert!(pick.is_pick && pick.motion == Motion::Linear);
    assert!(plan.waypoints.len() <= cell.settings.max_waypoints);
    let target = &boxes[plan.box_index];
    let tcp = cell.arm.base_from_flange(&pick.joints) * cell.gripper.flange_from_tcp;
    assert!((tcp.translation.vector - pick.base_from_tcp.translation.vector).norm() < 1e-9);
    let middle = tcp * Point::from(plan.tcp_offset);
    assert!((middle.coords - target.base_from_box.translation.vector).norm() < 1e-6);
    for cup in cell
        .gripper
        .cups
        .iter()
        .filter(|c| plan.sections.contains(&c.section))
    {
        let on_box = target.base_from_box.inverse()
            * tcp
            * Point::new(cup.position[0], cup.position[1], 0.0);
        assert!(
            on_box.x.abs() + 0.02 <= 0.2 && on_box.y.abs() + 0.02 <= 0.15 && on_box.z.abs() < 1e-6
        );
    }
    let end = plan.waypoints.last().unwrap();
    let carton = end.base_from_tcp * plan.carried.pose;
    let at = carton.translation.vector;
    let expected = cell.place.base_from_place.translation.vector;
    assert!((at.xy() - expected.xy()).norm() < 1e-6);
    assert!((at.z - expected.z - 0.125 - cell.settings.place_gap).abs() < 1e-6);
}
