//! The whole scene: its sections, and what must fit together between them.

use depal_time::RandomStreams;
use serde_json::{Value as Json, json};

use crate::calibration::{BoardMounting, Calibration};
use crate::camera::{Camera, CameraMount};
use crate::gripper::Gripper;
use crate::interface::{Interface, Latency, WireEncoding};
use crate::layout::footprint_mm;
use crate::plc::Plc;
use crate::reader::{Checker, Section as _, section};
use crate::robot::{Robot, SignalKind};
use crate::rules::{ListOf, Maybe, Text, table, whole};
use crate::run::{Accept, Planner, Run};
use crate::solid::Solid;
use crate::stack::{Cartons, Conveyor, Pallet, Randomize};
use crate::vision::Vision;
use crate::viz::{Viz, VizAction};

/// The version of the scene format.
pub(crate) const SCHEMA: i64 = 1;

section! {
    /// A scene: the cell, the work, and what counts as done.
    pub struct Scene {
        /// Version of the format: 1.
        schema: u32, whole(SCHEMA, SCHEMA), required;
        /// Another scene file, beside this one, whose keys hold where this one has none.
        extends: Option<String>, Maybe(Text), default(None);
        /// Name for reports and folders.
        name: String, Text, required;
        /// Seed of everything random, unless the command line gives one.
        /// Default 1: any other serves as well.
        seed: u64, whole(0, i64::MAX), default(1);
        /// The pallet.
        pallet: Pallet, table(), section;
        /// The cartons on it.
        cartons: Cartons, table(), section;
        /// How untidy the stack is.
        randomize: Randomize, table(), section;
        /// The belt that takes the cartons away.
        conveyor: Conveyor, table(), section;
        /// What else stands in the cell.
        /// Default: nothing.
        solid: Vec<Solid>, ListOf(table(), 0, 200), default(Vec::new());
        /// The depth camera.
        camera: Camera, table(), section;
        /// Hand-eye calibration with command 701.
        /// Default: none is set up, and the command is refused.
        calibration: Option<Calibration>, Maybe(table()), default(None);
        /// The gripper.
        gripper: Gripper, table(), section;
        /// The arm, its cabinet and its program.
        robot: Robot, table(), section;
        /// A controller with an S7 data block that runs the arm, in place of a robot program.
        /// Default: none, the arm runs the program of `[robot]`.
        plc: Option<Plc>, Maybe(table()), default(None);
        /// The robot-facing interface of the vision server.
        interface: Interface, table(), section;
        /// The vision projects.
        vision: Vision, table(), section;
        /// The path project.
        viz: Viz, table(), section;
        /// How long computing takes.
        latency: Latency, table(), section;
        /// The path planner.
        planner: Planner, table(), section;
        /// Limits of the run.
        run: Run, table(), section;
        /// What makes a run accepted.
        accept: Accept, table(), section;
    }
    check check_scene;
}

impl Scene {
    /// The random streams of this scene's seed.
    pub fn streams(&self) -> RandomStreams {
        RandomStreams::new(self.seed)
    }
}

/// The JSON Schema of scene files, for editors.
pub fn json_schema() -> Json {
    let mut schema = Scene::schema();
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("depal scene");
    schema
}

fn check_scene(scene: &Scene, checker: &mut Checker<'_, '_>) {
    let signal = |name: &str| {
        let signals = scene.robot.signal.iter();
        signals
            .filter(|signal| signal.name.eq_ignore_ascii_case(name))
            .map(|signal| (signal.kind, signal.bits))
            .next()
    };
    check_section_signals(scene, checker);
    let name = &scene.gripper.vacuum_signal;
    match signal(name) {
        Some((SignalKind::DigitalInput, _)) => {}
        Some((kind, _)) => checker.problem(
            "gripper.vacuum_signal",
            format!(
                "expected a signal of kind di, found {name:?} of kind {}",
                kind.word()
            ),
            None,
        ),
        None => checker.problem(
            "gripper.vacuum_signal",
            format!("expected one of the robot's signals, found {name:?}"),
            Some("add it as a [[robot.signal]]"),
        ),
    }
    for project in &scene.vision.project {
        if project.camera != scene.camera.name {
            checker.problem(
                "vision.project",
                format!(
                    "expected the camera {:?} in project {}, found {:?}",
                    scene.camera.name, project.id, project.camera
                ),
                None,
            );
        }
    }
    for step in &scene.viz.steps {
        if let VizAction::VisualRecognition(recognition) = &step.action
            && !scene
                .vision
                .project
                .iter()
                .any(|project| project.id == recognition.project)
        {
            checker.problem(
                "viz.steps",
                format!(
                    "expected a vision project in step {}, found {}",
                    step.id, recognition.project
                ),
                None,
            );
        }
    }
    check_who_runs_the_arm(scene, checker);
    check_board_before_camera(scene, checker);
    let footprint = scene
        .cartons
        .stack()
        .map(|(_, pattern)| footprint_mm(scene.cartons.size_mm, pattern));
    for (axis, name) in ["X", "Y"].into_iter().enumerate() {
        let room = scene.pallet.size_mm[axis] + 200.0;
        if let Some(footprint) = footprint
            && footprint[axis] > room
        {
            checker.problem(
                "cartons.pattern",
                format!(
                    "expected a layer of at most {room} mm along the pallet's {name} \
                     (100 mm over either edge), found {} mm",
                    footprint[axis]
                ),
                None,
            );
        }
    }
    if let Some(payload) = scene.robot.payload_kg
        && scene.gripper.mass_kg >= payload
    {
        checker.problem(
            "robot.payload_kg",
            format!(
                "expected more than the gripper's {} kg, found {payload}",
                scene.gripper.mass_kg
            ),
            None,
        );
    }
    check_support(scene, checker);
    let most = f64::from(scene.cartons.total());
    if let Some(least) = scene.accept.delivered_min
        && least > most
    {
        checker.problem(
            "accept.delivered_min",
            format!("expected at most the {most} cartons of the pallet, found {least}"),
            None,
        );
    }
}

/// The outputs that switch the sections: bits of a group, or one for each.
fn check_section_signals(scene: &Scene, checker: &mut Checker<'_, '_>) {
    let key = "gripper.sections_signal";
    let gripper = &scene.gripper;
    let zones = gripper.section.len();
    let names = gripper.single_outputs();
    let is_single = names.is_some();
    for name in names.unwrap_or_else(|| vec![gripper.sections_signal.clone()]) {
        let mut signals = scene.robot.signal.iter();
        let found = signals.find(|signal| signal.name.eq_ignore_ascii_case(&name));
        match found.map(|signal| (signal.kind, signal.bits)) {
            Some((SignalKind::DigitalOutput, _)) if is_single => {}
            Some((SignalKind::GroupOutput, bits)) if !is_single && bits as usize >= zones => {}
            Some((SignalKind::GroupOutput, bits)) if !is_single => checker.problem(
                key,
                format!("expected {zones} bits, one for each section, found {bits} in {name:?}"),
                None,
            ),
            Some((kind, _)) => checker.problem(
                key,
                format!(
                    "expected a signal of kind {}, found {name:?} of kind {}",
                    if is_single { "do" } else { "go" },
                    kind.word()
                ),
                None,
            ),
            None => checker.problem(
                key,
                format!("expected one of the robot's signals, found {name:?}"),
                Some("add it as a [[robot.signal]]"),
            ),
        }
    }
}

/// The arm obeys a robot program or a controller, and never both.
fn check_who_runs_the_arm(scene: &Scene, checker: &mut Checker<'_, '_>) {
    match (&scene.plc, scene.robot.program.is_empty()) {
        (None, true) => checker.problem(
            "robot.program",
            "expected a program for the arm, found none".to_owned(),
            Some("name its files in robot.program, or let a controller run the arm with [plc]"),
        ),
        (Some(_), false) => checker.problem(
            "robot.program",
            "expected no robot program beside [plc], which runs the arm itself".to_owned(),
            Some("leave one of the two out"),
        ),
        (None, false) if scene.interface.encoding == WireEncoding::S7 => checker.problem(
            "interface.encoding",
            "expected a controller with a data block for s7, found a robot program".to_owned(),
            Some("set up the controller in [plc], or take hex-le, hex-be, ascii or auto"),
        ),
        _ => {}
    }
}

/// Of board and camera one is on the flange, and the other is not.
fn check_board_before_camera(scene: &Scene, checker: &mut Checker<'_, '_>) {
    let mounted = scene.calibration.as_ref().and_then(|c| c.mounted);
    let wanted = BoardMounting::before(scene.camera.mount);
    if let Some(mounted) = mounted
        && mounted != wanted
    {
        let (moves, hint) = match scene.camera.mount {
            CameraMount::Flange => (
                "moves with the flange",
                "a board on the flange would move with the camera; leave the key out, or mount the camera in \
                 the world",
            ),
            CameraMount::World => (
                "stands still",
                "no motion of the arm would show such a camera anything; leave the key out, or mount the \
                 camera on the flange",
            ),
        };
        checker.problem(
            "calibration.mounted",
            format!(
                "expected {} for a camera that {moves}, found {}",
                wanted.word(),
                mounted.word()
            ),
            Some(hint),
        );
    }
}

/// The middle of every carton that lies alone must be on the pallet.
fn check_support(scene: &Scene, checker: &mut Checker<'_, '_>) {
    let pallet = &scene.pallet;
    let (sin, cos) = pallet.yaw_deg.to_radians().sin_cos();
    for place in &scene.cartons.at {
        let [x, y] = [0, 1].map(|axis| place.xy_mm[axis] - pallet.xyz_mm[axis]);
        let on_pallet = [cos * x + sin * y, cos * y - sin * x];
        if (0..2).any(|axis| on_pallet[axis].abs() > 0.5 * pallet.size_mm[axis]) {
            checker.problem(
                "cartons.at",
                format!(
                    "expected cartons on the pallet, found {:?} beside it",
                    place.xy_mm
                ),
                None,
            );
        }
    }
}
