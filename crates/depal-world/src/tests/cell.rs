//! A test cell: floor, pallet, belt, cartons, and a tool without an arm that moves straight.

use depal_frames::nalgebra::{Translation3, UnitQuaternion};
use depal_frames::{BoxSize, PlacedShape, Pose, Vector};
use depal_gripper::GripperSpec;
use depal_time::{RandomStreams, SimDuration};

use crate::{CartonId, CartonSpec, ConveyorSpec, FixedBody, World, WorldEvent, WorldSpec};

pub const PALLET_HEIGHT: f64 = 0.144;
pub const SIZE: BoxSize = BoxSize {
    length: 0.4,
    width: 0.3,
    height: 0.25,
};
/// The two middle sections.
pub const MIDDLE: [bool; 4] = [false, true, true, false];
pub const CLOSED: [bool; 4] = [false; 4];

pub fn at(x: f64, y: f64, z: f64) -> Pose {
    Pose::translation(x, y, z)
}

/// Tool looking down, its X along the world's X.
pub fn down(x: f64, y: f64, z: f64) -> Pose {
    Pose::from_parts(
        Translation3::new(x, y, z),
        UnitQuaternion::from_axis_angle(&Vector::x_axis(), std::f64::consts::PI),
    )
}

pub fn spec() -> WorldSpec {
    let cuboid = |pose, x, y, z| PlacedShape::cuboid(pose, Vector::new(x, y, z));
    WorldSpec {
        fixed: vec![
            FixedBody::floor(vec![cuboid(at(0.0, 0.0, -0.5), 12.0, 12.0, 1.0)]),
            FixedBody::standing(
                "pallet",
                vec![cuboid(at(0.0, 0.0, 0.072), 1.2, 0.8, PALLET_HEIGHT)],
            ),
        ],
        conveyors: vec![ConveyorSpec {
            name: "outfeed".to_owned(),
            belt: cuboid(at(0.0, 3.0, 0.35), 3.0, 0.6, 0.7),
            direction: Vector::x(),
            speed: 0.4,
            delivered_at: 1.2,
            friction: 0.8,
        }],
        ..WorldSpec::default()
    }
}

/// A carton whose bottom centre is at (x, y, z), its length along the world's Y.
pub fn carton(x: f64, y: f64, z: f64, mass: f64) -> CartonSpec {
    let turn = UnitQuaternion::from_axis_angle(&Vector::z_axis(), std::f64::consts::FRAC_PI_2);
    CartonSpec {
        size: SIZE,
        mass,
        world_from_centre: Pose::from_parts(Translation3::new(x, y, z + SIZE.height * 0.5), turn),
        friction: 0.5,
    }
}

/// 48 cartons of 8 to 20 kg in six layers of 4 x 2, 2 to 6 mm apart.
pub fn full_pallet(world: &mut World) -> Vec<(CartonId, Pose)> {
    let mut random = RandomStreams::new(11).stream("pallet");
    let mut placed = Vec::new();
    for layer in 0..6 {
        for column in 0..4 {
            for row in 0..2 {
                let gap = random.uniform(0.002, 0.006);
                let x = (column as f64 - 1.5) * (SIZE.width + gap);
                let y = (row as f64 - 0.5) * (SIZE.length + gap);
                let z = PALLET_HEIGHT + layer as f64 * SIZE.height;
                let spec = carton(x, y, z, random.uniform(8.0, 20.0));
                placed.push((world.add_carton(&spec), spec.world_from_centre));
            }
        }
    }
    placed
}

/// A world with a tool at rest somewhere, and everything that it reported.
pub struct Cell {
    pub world: World,
    pub tool: [f64; 3],
    pub velocity: [f64; 3],
    pub events: Vec<WorldEvent>,
}

impl Cell {
    pub fn new(world: World, tool: [f64; 3]) -> Self {
        let mut cell = Self {
            world,
            tool,
            velocity: [0.0; 3],
            events: Vec::new(),
        };
        cell.world.add_arm(&[], &GripperSpec::four_sections());
        cell.world.set_arm(&[], &down(tool[0], tool[1], tool[2]));
        cell
    }

    /// One carton of `mass` on the pallet's middle, tool 50 mm above its top.
    pub fn one_carton(mass: f64) -> (Self, CartonId) {
        let mut world = World::new(&spec());
        let id = world.add_carton(&carton(0.0, 0.0, PALLET_HEIGHT, mass));
        world.settle(SimDuration::from_millis(500));
        (
            Self::new(world, [0.0, 0.0, PALLET_HEIGHT + SIZE.height + 0.05]),
            id,
        )
    }

    /// Moves for `span` seconds with a constant acceleration up to `top` m/s per axis.
    pub fn push(&mut self, span: f64, acceleration: [f64; 3], top: f64, valves: &[bool]) {
        let dt = self.world.spec().timestep.as_secs_f64();
        for _ in 0..(span / dt).round() as usize {
            for (axis, a) in acceleration.iter().enumerate() {
                let v = &mut self.velocity[axis];
                *v = (*v + a * dt).clamp(-top, top);
                self.tool[axis] += *v * dt;
            }
            self.world
                .set_arm(&[], &down(self.tool[0], self.tool[1], self.tool[2]));
            self.events.extend(self.world.step(valves));
        }
    }

    /// Goes straight to a place, starting and ending at rest.
    pub fn go(&mut self, to: [f64; 3], speed: f64, acceleration: f64, valves: &[bool]) {
        let from = self.tool;
        let delta: Vec<f64> = (0..3).map(|i| to[i] - from[i]).collect();
        let length = delta.iter().map(|d| d * d).sum::<f64>().sqrt();
        let top = speed.min((length * acceleration).sqrt());
        let ramp = top / acceleration;
        let total = length / top + ramp;
        let dt = self.world.spec().timestep.as_secs_f64();
        let steps = (total / dt).ceil() as usize;
        for step in 1..=steps {
            let t = (step as f64 * dt).min(total);
            let left = total - t;
            let way = if t < ramp {
                0.5 * acceleration * t * t
            } else if left < ramp {
                length - 0.5 * acceleration * left * left
            } else {
                top * (t - 0.5 * ramp)
            };
            for axis in 0..3 {
                self.tool[axis] = from[axis] + delta[axis] * way / length;
            }
            self.world
                .set_arm(&[], &down(self.tool[0], self.tool[1], self.tool[2]));
            self.events.extend(self.world.step(valves));
        }
        self.velocity = [0.0; 3];
    }

    /// Stands for `span` seconds.
    pub fn stay(&mut self, span: f64, valves: &[bool]) {
        self.velocity = [0.0; 3];
        self.push(span, [0.0; 3], 0.0, valves);
    }

    /// Lowers the tool onto the face below it and builds up vacuum.
    pub fn grip(&mut self, valves: &[bool]) {
        let [x, y, z] = self.tool;
        self.go([x, y, z - 0.05], 0.1, 1.0, valves);
        self.stay(0.6, valves);
    }

    pub fn height(&self, id: CartonId) -> f64 {
        let state = self.world.carton(id).expect("the carton is in the world");
        state.world_from_centre.translation.z
    }

    pub fn place(&self, id: CartonId) -> Vector {
        let state = self.world.carton(id).expect("the carton is in the world");
        state.world_from_centre.translation.vector
    }
}
