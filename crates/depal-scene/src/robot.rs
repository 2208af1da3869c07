//! The arm, its cabinet and the program that it runs.

use std::collections::BTreeMap;

use crate::choice::{choice, one_of};
use crate::language::Language;
use crate::packages::Packages;
use crate::reader::{Checker, section};
use crate::rules::{
    ANGLE_DEG, COORDINATE_MM, ListOf, Maybe, Numbers, OneOrMore, Text, above, number, table, whole,
};
use crate::text_file::{File, TextFile};

choice! {
    /// Kind of a signal, named as in the cabinet.
    pub enum SignalKind {
        /// Digital input, one bit.
        DigitalInput = "di",
        /// Digital output, one bit.
        DigitalOutput = "do",
        /// Group input, a number of several bits.
        GroupInput = "gi",
        /// Group output, a number of several bits.
        GroupOutput = "go",
    }
}

choice! {
    /// Order of the bytes in a cell.
    pub enum HexByteOrder {
        /// Most significant byte first.
        Big = "big",
        /// Least significant byte first.
        Little = "little",
    }
}

section! {
    /// One signal of the cabinet.
    pub struct Signal {
        /// Name in the robot program.
        name: String, Text, required;
        /// Kind.
        kind: SignalKind, one_of(), required;
        /// Width; 1 for digital signals.
        /// Default 1: the width of a digital signal.
        bits: u32, whole(1, 32), default(1);
    }
    check check_signal;
}

fn check_signal(signal: &Signal, checker: &mut Checker<'_, '_>) {
    let digital = matches!(
        signal.kind,
        SignalKind::DigitalInput | SignalKind::DigitalOutput
    );
    if digital && signal.bits != 1 {
        checker.problem(
            "bits",
            format!("expected 1 for a digital signal, found {}", signal.bits),
            Some("a number of several bits is of kind go or gi"),
        );
    }
}

fn default_signals() -> Vec<Signal> {
    vec![
        Signal {
            name: "GO_GRIPPER".to_owned(),
            kind: SignalKind::GroupOutput,
            bits: 4,
        },
        Signal {
            name: "DI_VACUUM".to_owned(),
            kind: SignalKind::DigitalInput,
            bits: 1,
        },
    ]
}

section! {
    /// The arm and its controller.
    pub struct Robot {
        /// URDF file of the arm.
        urdf: TextFile, File, required;
        /// Folders of the packages in mesh names of the URDF, `package://NAME/PATH`: `{ NAME = "FOLDER" }`.
        /// Default none: they are looked for in the folders above the URDF.
        packages: BTreeMap<String, String>, Packages, default(BTreeMap::new());
        /// Program files: one, or a list that is loaded in this order.
        /// Default none: the arm is run by the controller of `[plc]`.
        program: Vec<TextFile>, OneOrMore(File, 32), default(Vec::new());
        /// Files of the interface module that programs call: one, or a list.
        /// Default: the module of the program's language inside depal; TP needs none.
        module: Vec<TextFile>, OneOrMore(File, 8), default(Vec::new());
        /// Byte order of the vision calls that are built into TP; other languages pack their bytes themselves.
        /// Default big: controllers up to version 9.
        hex_byte_order: HexByteOrder, one_of(), default(HexByteOrder::Big);
        /// Foot of the arm in the world, mm.
        /// Default: the origin.
        base_xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), default([0.0; 3]);
        /// Turn of the foot about the world's Z, degrees.
        /// Default 0: facing along the world's X.
        base_yaw_deg: f64, ANGLE_DEG, default(0.0);
        /// Joint angles at the start, degrees, in the order of the URDF.
        /// Default: upright, forearm level, tool looking down.
        start_joints_deg: Vec<f64>, ListOf(number(-720.0, 720.0), 1, 8), default(vec![0.0, 0.0, 0.0, 0.0, 90.0, 0.0]);
        /// Largest acceleration of each joint, degrees/s2, in the order of the URDF; URDF has no place for it.
        /// Default [180, 130, 180, 450, 400, 600]: top speed within about half a second, and faster at
        /// the wrist; the makers of large arms publish no figures. Higher shortens the cycle and shakes cartons off.
        acceleration_deg_s2: Vec<f64>, ListOf(above(0.0, 100_000.0), 1, 8), default(vec![180.0, 130.0, 180.0, 450.0, 400.0, 600.0]);
        /// What the arm is rated to carry at its flange, gripper included, kg.
        /// Default: none, the load is not checked; the description file has no place for it.
        payload_kg: Option<f64>, Maybe(above(0.0, 10_000.0)), default(None);
        /// What its wrist is rated to bear about the flange with the tool level, N m, gripper included.
        /// Default: none, the moment is not checked.
        wrist_moment_n_m: Option<f64>, Maybe(above(0.0, 100_000.0)), default(None);
        /// How much faster the arm moves than its description says, which is all that the planner knows:
        /// speeds by this factor, accelerations by its square, so that the same way takes the time over the factor.
        /// Default 1: as described.
        velocity_scale: f64, number(0.05, 10.0), default(1.0);
        /// Simulated time that one statement of the program takes, microseconds.
        /// Default 50: a cabinet runs some ten thousand simple statements in a second.
        statement_cost_us: f64, number(0.0, 1_000_000.0), default(50.0);
        /// Signals of the cabinet.
        /// Default: a group output of 4 bits for the gripper's zones and a digital input for its vacuum switch.
        signal: Vec<Signal>, ListOf(table(), 0, 512), default(default_signals());
    }
    check check_robot;
}

impl Robot {
    /// The language of the program: that of its first file.
    pub fn language(&self) -> Language {
        let first = self.program.first();
        first
            .and_then(|file| Language::of(&file.path))
            .unwrap_or(Language::Rapid)
    }
}

/// One language for all files of the program and its module.
fn check_languages(robot: &Robot, checker: &mut Checker<'_, '_>) {
    let language = robot.language();
    let files = [("program", &robot.program), ("module", &robot.module)];
    for (key, file) in files
        .iter()
        .flat_map(|(key, files)| files.iter().map(move |file| (*key, file)))
    {
        let message = match Language::of(&file.path) {
            Some(found) if found == language => continue,
            Some(found) => format!(
                "expected files of one language, found {} beside {} in {}",
                found.name(),
                language.name(),
                file.path
            ),
            None => format!(
                "expected a program of a language known here, found {}",
                file.path
            ),
        };
        let hint =
            "RAPID ends in .mod, .sys, .prg, .modx or .sysx, KRL in .src, .dat or .xml, TP in .ls";
        checker.problem(key, message, Some(hint));
    }
}

fn check_robot(robot: &Robot, checker: &mut Checker<'_, '_>) {
    check_languages(robot, checker);
    if robot.start_joints_deg.len() != robot.acceleration_deg_s2.len() {
        checker.problem(
            "acceleration_deg_s2",
            format!(
                "expected as many values as start_joints_deg has ({}), found {}",
                robot.start_joints_deg.len(),
                robot.acceleration_deg_s2.len()
            ),
            None,
        );
    }
    for (position, signal) in robot.signal.iter().enumerate() {
        let name = &signal.name;
        // Names of a robot program do not know upper and lower case.
        if robot.signal[..position]
            .iter()
            .any(|earlier| earlier.name.eq_ignore_ascii_case(name))
        {
            checker.problem(
                "signal",
                format!("expected each name once, found {name:?} twice"),
                None,
            );
        }
    }
}
