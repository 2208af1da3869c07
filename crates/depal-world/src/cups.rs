use std::collections::BTreeMap;

use depal_frames::convert::{from_glam, point_to_glam, vector_from_glam, vector_to_glam};
use depal_frames::{Point, Pose, Vector};
use depal_gripper::{CupContact, CupForce, CupSpec, GripperSpec};
use rapier3d::prelude::PhysicsWorld;

use crate::arm::Arm;
use crate::cartons::Carton;

/// How far behind the cup plane a face is still found, m: cups that are pressed in too far.
const BEHIND: f64 = 0.03;
/// How far beyond the relaxed lips cartons are looked for, m.
const REACH: f64 = 0.03;
/// Points on a lip's circle that must all lie on the face.
const LIP_POINTS: usize = 8;

/// A carton near the tool, with its pose and velocity of the same instant.
struct Near {
    id: u32,
    half: Vector,
    tool_from_carton: Pose,
    carton_from_tool: Pose,
    /// In the world frame.
    centre: Point,
    linear: Vector,
    angular: Vector,
}

/// Where a line along the tool's Z enters a carton.
struct Entry {
    /// Height of the face above the cup plane, m.
    z: f64,
    /// Axis (0, 1, 2) of the face's normal in the carton's frame.
    axis: usize,
}

impl Near {
    /// Exact box maths: the line through (x, y) along the tool's Z against three slabs.
    fn enter(&self, x: f64, y: f64) -> Option<Entry> {
        let origin = self.carton_from_tool * Point::new(x, y, -BEHIND);
        let direction = self.carton_from_tool * Vector::z();
        let (mut enter, mut leave, mut axis) = (f64::NEG_INFINITY, f64::INFINITY, 0);
        for i in 0..3 {
            if direction[i].abs() < 1e-12 {
                if origin[i].abs() > self.half[i] {
                    return None;
                }
                continue;
            }
            let near = -self.half[i].copysign(direction[i]);
            let first = (near - origin[i]) / direction[i];
            let last = (-near - origin[i]) / direction[i];
            if first > enter {
                (enter, axis) = (first, i);
            }
            leave = leave.min(last);
        }
        (enter <= leave && enter >= 0.0).then_some(Entry {
            z: enter - BEHIND,
            axis,
        })
    }
}

/// Cup contacts of one instant, and whether any carton is close to the cups.
pub(crate) struct Probe {
    pub contacts: Vec<CupContact>,
    /// A face lies within the lips' stroke and a margin: cup forces need short steps.
    pub close: bool,
}

/// Measures what lies before every cup. `velocity`: the tool's linear and angular velocity.
pub(crate) fn probe(
    physics: &PhysicsWorld,
    cartons: &BTreeMap<u32, Carton>,
    arm: &Arm,
    velocity: (Vector, Vector),
) -> Probe {
    let world_from_tool = arm.tool.pose(physics);
    let near = near_cartons(physics, cartons, &arm.gripper, &world_from_tool);
    let mut close = false;
    let contacts = arm.gripper.cups.iter().map(|cup| {
        let [x, y] = cup.position;
        let entries = near.iter().filter_map(|n| Some((n, n.enter(x, y)?)));
        let first = entries.min_by(|(_, a), (_, b)| a.z.total_cmp(&b.z));
        let Some((carton, entry)) = first.filter(|(_, e)| e.z < cup.stroke + REACH) else {
            return CupContact::OPEN;
        };
        close = true;
        contact(cup, carton, &entry, &world_from_tool, velocity)
    });
    let contacts = contacts.collect();
    Probe { contacts, close }
}

fn contact(
    cup: &CupSpec,
    carton: &Near,
    entry: &Entry,
    world_from_tool: &Pose,
    (linear, angular): (Vector, Vector),
) -> CupContact {
    let [x, y] = cup.position;
    let radius = cup.diameter * 0.5;
    let on_face = (0..LIP_POINTS).filter(|&index| {
        let angle = std::f64::consts::TAU * index as f64 / LIP_POINTS as f64;
        let (sin, cos) = angle.sin_cos();
        let rim = carton.enter(x + radius * cos, y + radius * sin);
        rim.is_some_and(|rim| rim.axis == entry.axis)
    });
    let covered = on_face.count() as f64 / LIP_POINTS as f64;
    let normal_z = (carton.tool_from_carton * Vector::ith(entry.axis, 1.0))
        .z
        .abs();
    let lip = world_from_tool * Point::new(x, y, entry.z);
    let tool_origin = Point::from(world_from_tool.translation.vector);
    let of_tool = linear + angular.cross(&(lip - tool_origin));
    let of_carton = carton.linear + carton.angular.cross(&(lip - carton.centre));
    let slip = world_from_tool.rotation.inverse() * (of_carton - of_tool);
    CupContact {
        carton: Some(carton.id),
        gap: entry.z - cup.stroke,
        tilt: normal_z.min(1.0).acos(),
        closing_speed: -slip.z,
        covered,
        slip_velocity: [slip.x, slip.y],
    }
}

/// Cartons whose bounding sphere meets the sphere around all cups, in the order of ids.
fn near_cartons(
    physics: &PhysicsWorld,
    cartons: &BTreeMap<u32, Carton>,
    gripper: &GripperSpec,
    world_from_tool: &Pose,
) -> Vec<Near> {
    let radius = |cup: &CupSpec| cup.position[0].hypot(cup.position[1]) + cup.diameter;
    let reach = gripper.cups.iter().map(radius).fold(0.0, f64::max) + REACH;
    let tool = world_from_tool.translation.vector;
    let near = cartons.iter().filter_map(|(&id, carton)| {
        let body = &physics.bodies[carton.body];
        let world_from_carton = from_glam(body.position());
        let half = carton.size.half_extents();
        let centre = world_from_carton.translation.vector;
        if (centre - tool).norm() > reach + half.norm() {
            return None;
        }
        let tool_from_carton = world_from_tool.inverse() * world_from_carton;
        Some(Near {
            id,
            half,
            carton_from_tool: tool_from_carton.inverse(),
            tool_from_carton,
            centre: Point::from(centre),
            linear: vector_from_glam(body.linvel()),
            angular: vector_from_glam(body.angvel()),
        })
    });
    near.collect()
}

/// Puts the cup forces on the cartons, in place of those of the step before.
///
/// Forces and torques are both cleared: the engine keeps the torque of a force at a point apart.
pub(crate) fn apply(
    physics: &mut PhysicsWorld,
    cartons: &BTreeMap<u32, Carton>,
    arm: &Arm,
    contacts: &[CupContact],
    forces: &[CupForce],
) {
    clear(physics, cartons);
    let world_from_tool = arm.tool.pose(physics);
    for force in forces {
        let Some(carton) = cartons.get(&force.carton) else {
            continue;
        };
        let cup = &arm.gripper.cups[force.cup];
        let z = contacts[force.cup].gap + cup.stroke;
        let lip = world_from_tool * Point::new(cup.position[0], cup.position[1], z);
        let along = Vector::new(force.shear[0], force.shear[1], -force.pull);
        let body = &mut physics.bodies[carton.body];
        let vector = vector_to_glam(&(world_from_tool.rotation * along));
        body.add_force_at_point(vector, point_to_glam(&lip), true);
    }
}

/// Takes all cup forces off the cartons.
pub(crate) fn clear(physics: &mut PhysicsWorld, cartons: &BTreeMap<u32, Carton>) {
    for carton in cartons.values() {
        let body = &mut physics.bodies[carton.body];
        body.reset_forces(true);
        body.reset_torques(true);
    }
}
