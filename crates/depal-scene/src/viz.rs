//! The steps of the path project that plans picks and places.

use depal_interface::PropertyConfig;
use serde_json::{Map, Value as Json, json};

use crate::document::{Node, Place, Table, Value};
use crate::reader::{Checker, Reader, Rule, Section, join, nearest, section};
use crate::rules::{ListOf, Maybe, Text, whole};

pub use actions::{
    BranchByMsg, CustomPalletPattern, ExternalMove, FixedPointMove, MoveByGrid, MoveByList,
    MoveFrame, MoveReference, Notify, PalletPattern, PatternPlace, PickStrategy, PlacePattern,
    PredefinedPalletPattern, RelativeMove, SetDigitalOutput, StepMotion, VisionMove,
    VisualRecognition, VizAction,
};
use actions::{FULL, VELOCITY};

mod actions;

/// One step.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct VizStep {
    /// Number that commands and exits refer to.
    pub id: u16,
    /// Step where the run goes on, 0 for its end; absent: the next of the list.
    pub next: Option<u16>,
    /// What it does.
    #[serde(flatten)]
    pub action: VizAction,
}

/// Keys that every kind of step has.
const STEP_KEYS: &[&str] = &["id", "kind", "next"];

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
    "move_by_grid" => MoveByGrid(MoveByGrid),
    "custom_pallet_pattern" => CustomPalletPattern(CustomPalletPattern),
    "predefined_pallet_pattern" => PredefinedPalletPattern(PredefinedPalletPattern),
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
    properties.insert(
        "next".to_owned(),
        json!({
            "type": "integer",
            "minimum": 0,
            "maximum": 999,
            "description": "Step where the run goes on, 0 for its end. Default: the next of the list.",
        }),
    );
    properties.extend(keys);
    required.extend(["id", "kind"].map(str::to_owned));
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
        let next = match table.get("next") {
            Some(entry) => Some(whole(0, 999).read(&entry.node, &join(key, "next"), reader)?),
            None => None,
        };
        let action = read_action(&kind, table, &node.place, key, reader)?;
        Some(VizStep {
            id: id?,
            next,
            action,
        })
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
        /// Scales the velocity of every move, percent.
        /// Default 100: as planned and taught.
        velocity_percent: f64, VELOCITY, default(FULL);
        /// Which step parameters the robot may read and change by number (commands 207 and 208): lines of
        /// `read, id, step, key` and `write, id, step, key, value`; # begins a comment.
        /// Default: none.
        property_config: Option<String>, Maybe(Text), default(None);
    }
    check check_viz;
}

fn check_viz(viz: &Viz, checker: &mut Checker<'_, '_>) {
    let config = viz.property_config.as_deref().unwrap_or_default();
    if let Err(error) = PropertyConfig::parse(config) {
        checker.problem("property_config", error.to_string(), None);
    }
    for (position, step) in viz.steps.iter().enumerate() {
        let id = step.id;
        if viz.steps[..position].iter().any(|earlier| earlier.id == id) {
            checker.problem(
                "steps",
                format!("expected each id once, found {id} twice"),
                None,
            );
        }
        if let Some(next) = step.next
            && next != 0
            && !viz.steps.iter().any(|other| other.id == next)
        {
            checker.problem(
                "steps",
                format!("expected a step behind step {id}, found {next}"),
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
