use std::f64::consts::PI;

use depal_frames::nalgebra::Translation3;
use depal_frames::{PlacedShape, Pose, Rotation, Shape, Vector};

use crate::{CupSpec, GripperSpec, SectionSpec, VacuumSpec};

/// Middles of the four sections along the `tcp` X axis, m.
const SECTION_CENTRES: [f64; 4] = [-0.225, -0.075, 0.075, 0.225];
/// Digital outputs of the four sections.
const DIGITAL_OUTPUTS: [u16; 4] = [1, 3, 5, 6];
/// Sides of one section, m.
const SECTION_SIZE: [f64; 2] = [0.140, 0.360];
/// Distance between cups along X and Y, m.
const CUP_PITCH: [f64; 2] = [0.070, 0.062];
/// Cups of a section along X and Y.
const CUPS_PER_SECTION: [usize; 2] = [2, 6];

impl GripperSpec {
    /// An area gripper of 620 x 400 mm with four sections in a row, each of 2 x 6 bellows cups
    /// of 40 mm, behind the digital outputs 1, 3, 5 and 6.
    ///
    /// Figures: 35 kPa as for cardboard (20 to 40 kPa), friction 0.5, build-up 80 ms,
    /// 95 % vented 120 ms after the valve closes, switch at 60 % / 45 % of the supply.
    /// One cup holds 44 N; each open cup takes 5 % from its section.
    pub fn four_sections() -> Self {
        let at_z = |z: f64| Pose::from_parts(Translation3::new(0.0, 0.0, z), Rotation::identity());
        let mut sections = Vec::new();
        let mut cups = Vec::new();
        for (section, (centre, digital_output)) in
            SECTION_CENTRES.into_iter().zip(DIGITAL_OUTPUTS).enumerate()
        {
            let half = [SECTION_SIZE[0] * 0.5, SECTION_SIZE[1] * 0.5];
            sections.push(SectionSpec {
                digital_output,
                area: [centre - half[0], centre + half[0], -half[1], half[1]],
            });
            for column in 0..CUPS_PER_SECTION[0] {
                for row in 0..CUPS_PER_SECTION[1] {
                    let offset = |index: usize, count: usize, pitch: f64| {
                        (index as f64 - (count - 1) as f64 * 0.5) * pitch
                    };
                    cups.push(CupSpec {
                        position: [
                            centre + offset(column, CUPS_PER_SECTION[0], CUP_PITCH[0]),
                            offset(row, CUPS_PER_SECTION[1], CUP_PITCH[1]),
                        ],
                        section,
                        diameter: 0.040,
                        stiffness: 10_000.0,
                        damping: 30.0,
                        stroke: 0.012,
                    });
                }
            }
        }
        Self {
            name: "four-section area gripper".to_owned(),
            flange_from_tcp: at_z(0.30),
            mass: 50.0,
            bodies: vec![
                PlacedShape::cuboid(at_z(-0.050), Vector::new(0.62, 0.40, 0.06)),
                PlacedShape {
                    pose: at_z(-0.190),
                    shape: Shape::Cylinder {
                        half_length: 0.110,
                        radius: 0.060,
                    },
                },
            ],
            sections,
            cups,
            vacuum: VacuumSpec {
                supply_vacuum: 35_000.0,
                build_up_time: 0.080,
                blow_off_time: 0.040,
                switch_on_fraction: 0.60,
                switch_off_fraction: 0.45,
                open_cup_loss: 0.05,
                flow: None,
                friction: 0.5,
            },
        }
    }
}

impl GripperSpec {
    /// The valve commands for [`GripperState::update`](crate::GripperState::update) from the
    /// digital outputs of the controller, in the order of the sections.
    pub fn valves(&self, is_output_on: impl Fn(u16) -> bool) -> Vec<bool> {
        let sections = self.sections.iter();
        sections
            .map(|section| is_output_on(section.digital_output))
            .collect()
    }
}

impl CupSpec {
    /// Effective area, m2.
    pub fn area(&self) -> f64 {
        PI * 0.25 * self.diameter * self.diameter
    }
}
