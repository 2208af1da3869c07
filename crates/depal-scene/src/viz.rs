//! The steps of the path project that plans picks and places.

use serde_json::{Map, Value as Json, json};

use crate::choice::{choice, one_of};
use crate::document::{Node, Place, Table, Value};
use crate::reader::{Checker, Reader, Rule, Section, join, nearest, section};
use crate::rules::{ANGLE_DEG, COORDINATE_MM, Flag, ListOf, Numbers, Text, number, whole};

choice! {
    /// How picks are chosen.
    pub enum PickStrategy {
        /// Uppermost cartons first, lifted out of the stack.
        BoxDepalletizing = "box_depalletizing",
    }
}

choice! {
    /// Where picked cartons go.
    pub enum PlacePattern {
        /// The conveyor's place.
        Conveyor = "conveyor",
    }
}

choice! {
    /// The frame of a relative move.
    pub enum MoveFrame {
        /// The tool's.
        Tool = "tool",
        /// The robot base's.
        Base = "base",
    }
}

section! {
    /// Take a picture and find cartons.
    pub struct VisualRecognition {
        /// Vision project.
        project: u16, whole(1, 999), required;
        /// Use what the last picture showed while something is left of it.
        /// Default false: every pick moves its neighbours a little.
        reuse_vision_result: bool, Flag, default(false);
    }
}

section! {
    /// Go to a carton and pick it.
    pub struct VisionMove {
        /// How picks are chosen.
        /// Default box_depalletizing: the only one.
        pick: PickStrategy, one_of(), default(PickStrategy::BoxDepalletizing);
        /// Switch only the gripper's sections that lie on the carton.
        /// Default true: an open cup weakens its whole zone.
        sections: bool, Flag, default(true);
        /// Plan every carton that was found instead of the first one that can be reached.
        /// Default false: the picture is old after one pick.
        plan_all_vision_results: bool, Flag, default(false);
    }
}

section! {
    /// Place what is held by a pattern.
    pub struct PalletPattern {
        /// Where it goes.
        /// Default conveyor: the only one.
        pattern: PlacePattern, one_of(), default(PlacePattern::Conveyor);
    }
}

section! {
    /// Go to fixed joint angles.
    pub struct FixedPointMove {
        /// Joint angles, degrees, in the order of the URDF.
        joints_deg: Vec<f64>, ListOf(number(-720.0, 720.0), 1, 8), required;
    }
}

section! {
    /// Move by an offset.
    pub struct RelativeMove {
        /// Offset, mm.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Turn: roll, pitch and yaw, degrees.
        /// Default 0: no turn.
        rpy_deg: [f64; 3], Numbers::<3>(ANGLE_DEG), default([0.0; 3]);
        /// Frame of the offset.
        /// Default base: up stays up whatever the tool does.
        frame: MoveFrame, one_of(), default(MoveFrame::Base);
    }
}

section! {
    /// Go to one of several fixed joint angles, chosen by an index that the robot sends.
    pub struct MoveByList {
        /// The list, each in degrees in the order of the URDF.
        joints_deg: Vec<Vec<f64>>, ListOf(ListOf(number(-720.0, 720.0), 1, 8), 1, 500), required;
    }
}

section! {
    /// Go on at the step that a message of the robot chooses.
    pub struct BranchByMsg {
        /// Steps of the exits, in the order of their numbers from 1.
        exits: Vec<u16>, ListOf(whole(1, 999), 1, 99), required;
    }
}

section! {
    /// Go to a pose that the robot sends.
    pub struct ExternalMove {}
}

section! {
    /// Switch an output on the way.
    pub struct SetDigitalOutput {
        /// Number of the output.
        output: u16, whole(1, 512), required;
        /// Its value.
        value: bool, Flag, required;
    }
}

section! {
    /// Send a message to the robot.
    pub struct Notify {
        /// The message.
        message: String, Text, required;
    }
}

/// What a step does.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum VizAction {
    /// Take a picture and find cartons.
    VisualRecognition(VisualRecognition),
    /// Go to a carton and pick it.
    VisionMove(VisionMove),
    /// Place what is held by a pattern.
    PalletPattern(PalletPattern),
    /// Go to fixed joint angles.
    FixedPointMove(FixedPointMove),
    /// Move by an offset.
    RelativeMove(RelativeMove),
    /// Go to one of several fixed joint angles.
    MoveByList(MoveByList),
    /// Go on at the step that a message chooses.
    BranchByMsg(BranchByMsg),
    /// Go to a pose that the robot sends.
    ExternalMove(ExternalMove),
    /// Switch an output.
    SetDo(SetDigitalOutput),
    /// Send a message to the robot.
    Notify(Notify),
}

/// One step.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct VizStep {
    /// Number that commands and exits refer to.
    pub id: u16,
    /// What it does.
    #[serde(flatten)]
    pub action: VizAction,
}

/// Keys that every kind of step has.
const STEP_KEYS: &[&str] = &["id", "kind"];

/// The table of kinds: word, reader, schema.
macro_rules! step_kinds {
    ($($word:literal => $Variant:ident($Section:ident),)*) => {
        const KINDS: &[&str] = &[$($word),*];

        fn read_action(
            kind: &str,
            table: &Table,
            place: &Place,
            key: &str,
            reader: &mut Reader<'_>,
        ) -> Option<VizAction> {
            match kind {
                $($word => $Section::read(table, place, key, STEP_KEYS, reader).map(VizAction::$Variant),)*
                _ => None,
            }
        }

        fn kind_schemas() -> Vec<Json> {
            vec![$(kind_schema::<$Section>($word)),*]
        }
    };
}

step_kinds! {
    "visual_recognition" => VisualRecognition(VisualRecognition),
    "vision_move" => VisionMove(VisionMove),
    "pallet_pattern" => PalletPattern(PalletPattern),
    "fixed_point_move" => FixedPointMove(FixedPointMove),
    "relative_move" => RelativeMove(RelativeMove),
    "move_by_list" => MoveByList(MoveByList),
    "branch_by_msg" => BranchByMsg(BranchByMsg),
    "external_move" => ExternalMove(ExternalMove),
    "set_do" => SetDo(SetDigitalOutput),
    "notify" => Notify(Notify),
}

fn kind_schema<S: Section>(word: &str) -> Json {
    let (keys, mut required) = S::key_schemas();
    let mut properties = Map::new();
    properties.insert(
        "id".to_owned(),
        json!({
            "type": "integer",
            "minimum": 1,
            "maximum": 999,
            "description": "Number that commands and exits refer to.",
        }),
    );
    properties.insert(
        "kind".to_owned(),
        json!({"const": word, "description": S::DOC}),
    );
    properties.extend(keys);
    required.extend(STEP_KEYS.iter().map(|key| (*key).to_owned()));
    json!({
        "type": "object",
        "description": S::DOC,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

struct Step;

impl Rule for Step {
    type Output = VizStep;

    fn read(&self, node: &Node, key: &str, reader: &mut Reader<'_>) -> Option<VizStep> {
        let Value::Table(table) = &node.value else {
            reader.unexpected(node, key, "a table with id and kind");
            return None;
        };
        let id_key = join(key, "id");
        let id = if let Some(entry) = table.get("id") {
            whole(1, 999).read(&entry.node, &id_key, reader)
        } else {
            reader.problem(&node.place, &id_key, "missing key".to_owned(), None);
            None
        };
        let kind_key = join(key, "kind");
        let Some(entry) = table.get("kind") else {
            let hint = format!("known kinds: {}", KINDS.join(", "));
            reader.problem(&node.place, &kind_key, "missing key".to_owned(), Some(hint));
            return None;
        };
        let kind = Text.read(&entry.node, &kind_key, reader)?;
        if !KINDS.contains(&kind.as_str()) {
            let message = format!("unknown kind of step {kind:?}");
            let hint = nearest(&kind, KINDS);
            reader.problem(&entry.node.place, &kind_key, message, Some(hint));
            return None;
        }
        let action = read_action(&kind, table, &node.place, key, reader)?;
        Some(VizStep { id: id?, action })
    }

    fn schema(&self) -> Json {
        json!({"oneOf": kind_schemas()})
    }
}

section! {
    /// The path project.
    pub struct Viz {
        /// Its steps, in order.
        steps: Vec<VizStep>, ListOf(Step, 1, 500), required;
    }
    check check_viz;
}

fn check_viz(viz: &Viz, checker: &mut Checker<'_, '_>) {
    for (position, step) in viz.steps.iter().enumerate() {
        let id = step.id;
        if viz.steps[..position].iter().any(|earlier| earlier.id == id) {
            checker.problem(
                "steps",
                format!("expected each id once, found {id} twice"),
                None,
            );
        }
        if let VizAction::BranchByMsg(branch) = &step.action {
            for exit in &branch.exits {
                if !viz.steps.iter().any(|other| other.id == *exit) {
                    checker.problem(
                        "steps",
                        format!("expected exits that are steps, found {exit} in step {id}"),
                        None,
                    );
                }
            }
        }
    }
}
