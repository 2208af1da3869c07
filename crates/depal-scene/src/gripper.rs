//! The sectioned vacuum gripper.

use crate::reader::{Checker, section};
use crate::rules::{
    ANGLE_DEG, COORDINATE_MM, LENGTH_MM, ListOf, Maybe, Numbers, SHARE, Text, Wholes, above,
    number, table, whole,
};

section! {
    /// One separately switched zone: a rectangle with a grid of cups behind one valve.
    pub struct GripperSection {
        /// Digital output that switches it, as it is sent in a DO list.
        digital_output: u16, whole(1, 512), required;
        /// [smallest x, largest x, smallest y, largest y] in the tool frame, mm.
        area_mm: [f64; 4], Numbers::<4>(COORDINATE_MM), required;
        /// Cups along X and along Y, spread evenly over the rectangle.
        cups: [u32; 2], Wholes::<2>(whole(1, 32)), required;
    }
    check check_section;
}

fn check_section(section: &GripperSection, checker: &mut Checker<'_, '_>) {
    let [min_x, max_x, min_y, max_y] = section.area_mm;
    if min_x >= max_x || min_y >= max_y {
        checker.problem(
            "area_mm",
            format!(
                "expected [smallest x, largest x, smallest y, largest y], \
                 found [{min_x}, {max_x}, {min_y}, {max_y}]"
            ),
            None,
        );
    }
}

section! {
    /// The gripper. The tool frame is at the middle of the cup plane, Z out of the gripper towards the
    /// carton, X along its long side.
    pub struct Gripper {
        /// Name of a gripper that travels with the program; keys beside this one win over its own.
        /// Default: none, the gripper is described here or in `file`.
        model: Option<String>, Maybe(Text), default(None);
        /// File of a gripper, its keys as here; keys beside this one win over the file's.
        /// Default: none, the gripper is described here or by `model`.
        file: Option<String>, Maybe(Text), default(None);
        /// Name for messages and the replay.
        /// Default gripper.
        name: String, Text, default("gripper".to_owned());
        /// Origin of the tool frame in the flange frame, mm.
        tcp_xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Roll, pitch and yaw of the tool frame about the axes of the flange frame, degrees.
        /// Default 0: the tool looks where the flange looks.
        tcp_rpy_deg: [f64; 3], Numbers::<3>(ANGLE_DEG), default([0.0; 3]);
        /// Mass of the tool, kg.
        /// Default 45: a plate gripper of this size with its valves.
        mass_kg: f64, above(0.0, 1000.0), default(45.0);
        /// Body behind the cups, along X, Y and Z of the tool frame, mm.
        /// Default [400, 300, 60]: as large as the top face of a common carton.
        plate_mm: [f64; 3], Numbers::<3>(LENGTH_MM), default([400.0, 300.0, 60.0]);
        /// Width of the square post from the flange to the plate, mm.
        /// Default 120: as thick as the arm's flange is wide.
        post_mm: f64, LENGTH_MM, default(120.0);
        /// Height of an unpressed cup below the plate, mm.
        /// Default 40: a bellows cup of 40 mm.
        cup_height_mm: f64, LENGTH_MM, default(40.0);
        /// The zones, in the order of the bits of `sections_signal`.
        section: Vec<GripperSection>, ListOf(table(), 1, 32), required;
        /// Effective diameter of a cup, mm.
        /// Default 40: 32 such cups cover a third of a 400 x 300 mm top face.
        cup_diameter_mm: f64, above(0.0, 500.0), default(40.0);
        /// Axial stiffness of a cup, N/mm.
        /// Default 10: a loaded cup stretches by 1 to 2 mm.
        cup_stiffness_n_mm: f64, above(0.0, 1000.0), default(10.0);
        /// Axial damping of a cup, N s/m.
        /// Default 60: a 20 kg carton on 32 cups stops swinging within a tenth of a second.
        cup_damping_n_s_m: f64, number(0.0, 10_000.0), default(60.0);
        /// Free travel of the lip beyond the cup plane, mm: a cup touches this much early.
        /// Default 10: takes up a tilt of two degrees over the long side.
        cup_stroke_mm: f64, number(0.0, 200.0), default(10.0);
        /// Friction between lip and carton.
        /// Default 0.5: rubber on dry cardboard; a lower one lets cartons slip sideways.
        cup_friction: f64, number(0.0, 2.0), default(0.5);
        /// Vacuum below the air around that the pump reaches on a closed zone, kPa.
        /// Default 30: porous cardboard lets 20 to 40 through; less lifts less.
        vacuum_kpa: f64, number(0.0, 101.3), default(30.0);
        /// Vacuum that the switches are set for, kPa: their shares refer to it, whatever the pump reaches.
        /// Default 30: the default of `vacuum_kpa`.
        rated_vacuum_kpa: f64, number(1.0, 101.3), default(30.0);
        /// Time constant of building up vacuum in a sealed zone, s.
        /// Default 0.08: switch closed after about 0.1 s.
        build_up_s: f64, above(0.0, 10.0), default(0.08);
        /// Time constant of venting with blow-off, s.
        /// Default 0.04: released after about 0.12 s.
        blow_off_s: f64, above(0.0, 10.0), default(0.04);
        /// The vacuum switch closes above this share of `rated_vacuum_kpa` ...
        /// Default 0.6: usual for a part-present switch.
        switch_on: f64, SHARE, default(0.6);
        /// ... and opens below this one.
        /// Default 0.5: the distance keeps the switch from chattering.
        switch_off: f64, SHARE, default(0.5);
        /// Share of the vacuum that a zone loses when all its cups are open; one of n cups costs an n-th of it.
        /// Default 0.9: flow resistors in the cups keep the rest.
        open_cup_loss: f64, SHARE, default(0.9);
        /// Pump curve of one section: pairs of vacuum, kPa, and the flow drawn there, l/min of air as it is around;
        /// from no vacuum upwards, the flow falling to zero at the last pair, which then is `rated_vacuum_kpa`.
        /// Default: none, `open_cup_loss` stands for pump and leaks.
        pump_curve: Vec<[f64; 2]>, ListOf(Numbers::<2>(number(0.0, 100_000.0)), 0, 32), default(Vec::new());
        /// With `pump_curve`: the narrowest hole behind a cup, mm: the cup's own or a flow resistor's.
        /// Default 1.5: a flow resistor; an open bellows cup has 6 mm and more.
        orifice_mm: f64, above(0.0, 100.0), default(1.5);
        /// With `pump_curve`: share of that hole that an open cup's check valve leaves open.
        /// Default 1: no check valves.
        check_valve_leak: f64, SHARE, default(1.0);
        /// With `pump_curve`: air that a sealed cup draws through the carton, l/min at 1 kPa.
        /// Default 0: film or coated board; plain corrugated board lets 0.05 to 0.5 through a cup of 40 mm.
        cup_leak_l_min_kpa: f64, number(0.0, 1000.0), default(0.0);
        /// Name of the robot's group output that switches the zones, one bit each.
        /// Default GO_GRIPPER: one of the robot's default signals.
        sections_signal: String, Text, default("GO_GRIPPER".to_owned());
        /// Name of the robot's digital input that the vacuum switch drives.
        /// Default DI_VACUUM: one of the robot's default signals.
        vacuum_signal: String, Text, default("DI_VACUUM".to_owned());
    }
    check check_gripper;
}

fn check_pump(gripper: &Gripper, checker: &mut Checker<'_, '_>) {
    let curve = &gripper.pump_curve;
    let (Some(first), Some(last)) = (curve.first(), curve.last()) else {
        return;
    };
    let falls = |pair: &[[f64; 2]]| pair[0][0] < pair[1][0] && pair[0][1] >= pair[1][1];
    let is_curve =
        curve.len() >= 2 && first[0] == 0.0 && last[1] == 0.0 && curve.windows(2).all(falls);
    if !is_curve {
        checker.problem(
            "pump_curve",
            "expected two pairs or more, the vacuum rising from 0 and the flow falling to 0"
                .to_owned(),
            None,
        );
    } else if (last[0] - gripper.rated_vacuum_kpa).abs() > 1e-9 {
        checker.problem(
            "pump_curve",
            format!(
                "expected the last pair at rated_vacuum_kpa = {}, found {}",
                gripper.rated_vacuum_kpa, last[0]
            ),
            None,
        );
    }
}

fn check_gripper(gripper: &Gripper, checker: &mut Checker<'_, '_>) {
    if gripper.switch_off >= gripper.switch_on {
        checker.problem(
            "switch_off",
            format!(
                "expected less than switch_on = {}, found {}",
                gripper.switch_on, gripper.switch_off
            ),
            None,
        );
    }
    check_pump(gripper, checker);
    for (position, section) in gripper.section.iter().enumerate() {
        let output = section.digital_output;
        if gripper.section[..position]
            .iter()
            .any(|earlier| earlier.digital_output == output)
        {
            checker.problem(
                "section",
                format!(
                    "expected a digital_output of its own for each section, found {output} twice"
                ),
                None,
            );
        }
    }
}
