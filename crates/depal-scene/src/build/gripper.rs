//! The gripper of a scene as a specification.

use depal_arm::Load;
use depal_frames::nalgebra::Translation3;
use depal_frames::{PlacedShape, Point, Pose, Rotation, Vector};
use depal_gripper::{CupSpec, FlowSpec, GripperSpec, SectionSpec, VacuumSpec};

use crate::gripper::Gripper;

/// What the cabinet is told of the gripper at its flange: all of its mass halfway to the tool centre.
pub(super) fn load(gripper: &Gripper) -> Load {
    let halfway = Vector::from(gripper.tcp_xyz_mm) * 0.5e-3;
    Load::point(gripper.mass_kg, Point::from(halfway))
}

/// Millimetres and degrees become metres and radians; the cups are spread over their sections.
pub(super) fn gripper(gripper: &Gripper) -> GripperSpec {
    let [roll, pitch, yaw] = gripper.tcp_rpy_deg.map(f64::to_radians);
    let flange_from_tcp = Pose::from_parts(
        Translation3::from(Vector::from(gripper.tcp_xyz_mm) * 1e-3),
        Rotation::from_euler_angles(roll, pitch, yaw),
    );
    let mut sections = Vec::new();
    let mut cups = Vec::new();
    for (index, section) in gripper.section.iter().enumerate() {
        let [min_x, max_x, min_y, max_y] = section.area_mm.map(|side| side * 1e-3);
        sections.push(SectionSpec {
            digital_output: section.digital_output,
            area: [min_x, max_x, min_y, max_y],
        });
        let [columns, rows] = section.cups;
        let spread = |i: u32, n: u32, from: f64, to: f64| {
            from + (to - from) * (f64::from(i) + 0.5) / f64::from(n)
        };
        for column in 0..columns {
            for row in 0..rows {
                cups.push(CupSpec {
                    position: [
                        spread(column, columns, min_x, max_x),
                        spread(row, rows, min_y, max_y),
                    ],
                    section: index,
                    diameter: gripper.cup_diameter_mm * 1e-3,
                    stiffness: gripper.cup_stiffness_n_mm * 1e3,
                    damping: gripper.cup_damping_n_s_m,
                    stroke: gripper.cup_stroke_mm * 1e-3,
                });
            }
        }
    }
    let cups_per_section = cups.len() as f64 / sections.len().max(1) as f64;
    GripperSpec {
        name: gripper.name.clone(),
        flange_from_tcp,
        mass: gripper.mass_kg,
        bodies: bodies(gripper, &flange_from_tcp),
        sections,
        cups,
        vacuum: VacuumSpec {
            supply_vacuum: gripper.rated_vacuum_kpa * 1e3,
            build_up_time: gripper.build_up_s,
            blow_off_time: gripper.blow_off_s,
            switch_on_fraction: gripper.switch_on,
            switch_off_fraction: gripper.switch_off,
            open_cup_loss: gripper.open_cup_loss / cups_per_section,
            flow: flow(gripper),
            friction: gripper.cup_friction,
        },
    }
}

/// Pump curve and leaks, if the gripper has them.
fn flow(gripper: &Gripper) -> Option<FlowSpec> {
    /// Cubic metres a second in a litre a minute.
    const L_MIN: f64 = 1e-3 / 60.0;
    if gripper.pump_curve.is_empty() {
        return None;
    }
    let radius = gripper.orifice_mm * 0.5e-3;
    Some(FlowSpec {
        pump: gripper
            .pump_curve
            .iter()
            .map(|[kpa, l_min]| [kpa * 1e3, l_min * L_MIN])
            .collect(),
        orifice: std::f64::consts::PI * radius * radius,
        open_share: gripper.check_valve_leak,
        porosity: gripper.cup_leak_l_min_kpa * L_MIN * 1e-3,
    })
}

/// Plate above the cups, and the post from the plate to the flange, in the tool frame.
fn bodies(gripper: &Gripper, flange_from_tcp: &Pose) -> Vec<PlacedShape> {
    let plate = Vector::from(gripper.plate_mm) * 1e-3;
    let plate_bottom = -gripper.cup_height_mm * 1e-3;
    let mut bodies = vec![PlacedShape::cuboid(
        Pose::translation(0.0, 0.0, plate_bottom - 0.5 * plate.z),
        plate,
    )];
    // The flange as the tool frame sees it; a post only where the flange is straight behind the plate.
    let flange = flange_from_tcp.inverse().translation.vector;
    let post_top = plate_bottom - plate.z;
    let length = post_top - flange.z;
    if length > 0.0 && flange.x.hypot(flange.y) < 0.5 * plate.x.min(plate.y) {
        let side = gripper.post_mm * 1e-3;
        bodies.push(PlacedShape::cuboid(
            Pose::translation(flange.x, flange.y, post_top - 0.5 * length),
            Vector::new(side, side, length),
        ));
    }
    bodies
}
