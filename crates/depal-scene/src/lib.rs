//! Scene files: strict TOML, overrides, randomisation, program and arm loading.
//!
//! A scene says what stands where, what the vision server has been given, which program the robot
//! runs and which figures count as done. This crate turns its text into plain data ([`Scene`]) and
//! the seed into a stack of cartons ([`carton_layout`]); it must never know how anything moves.
//!
//! Every problem of a file is reported at once ([`SceneErrors`]), each with file, line, column, key,
//! what was expected and what was found. Unknown keys are errors with the nearest known name.
//!
//! ```
//! use depal_scene::Scene;
//! let text = "schema = 1\nname = \"lab\"\n[camera]\nnois_mm = 0.2\n";
//! let no_files = |_: &str| Err(std::io::ErrorKind::NotFound.into());
//! let errors = Scene::load(text, "lab.toml", &[], None, &no_files).unwrap_err();
//! let camera = &errors.problems.iter().find(|problem| problem.key == "camera.nois_mm").unwrap();
//! assert_eq!((camera.line, camera.column), (4, 1));
//! assert_eq!(camera.hint.as_deref(), Some("did you mean \"noise_mm\"?"));
//! ```
//!
//! Units stand in the keys (`_mm`, `_deg`, `_kg`, `_s`, `_kpa`) and in the fields of the same names;
//! poses and placements that are computed here are SI. The world has Z up and its origin on the floor.
//!
//! Limitations: one pallet or platform, one carton size, one camera, one arm, one gripper.

mod build;
mod calibration;
mod camera;
mod choice;
mod document;
mod embedded;
mod equip;
mod error;
mod files;
mod gripper;
mod interface;
mod language;
mod layout;
mod load;
mod mesh_files;
mod missing;
mod packages;
mod plc;
mod reader;
mod robot;
mod rules;
mod run;
mod scene;
mod sensor;
mod skin;
mod solid;
mod stack;
mod text_file;
mod vision;
mod viz;

pub use build::{BuildError, Built};
pub use calibration::{Board, BoardMounting, Calibration};
pub use camera::{Camera, CameraMount};
pub use error::{SceneErrors, SceneProblem};
pub use files::{Resolver, read_text};
pub use gripper::{Gripper, GripperSection};
pub use interface::{Interface, InterfaceProfile, Latency, RobotBrand, WireEncoding};
pub use language::Language;
pub use layout::{CartonPlacement, carton_layout};
pub use mesh_files::MeshFiles;
pub use missing::with_advice;
pub use plc::{BranchChoice, PathFetch, PathSource, Plc};
pub use robot::{HexByteOrder, Robot, Signal, SignalKind};
pub use rules::Span;
pub use run::{Accept, Planner, Run};
pub use scene::{Scene, json_schema};
pub use sensor::{DepthFilter, SensorPreset, SensorTerm};
pub use skin::{CartonSurface, CartonTape};
pub use solid::Solid;
pub use stack::{
    CartonBlock, CartonPlace, Cartons, Conveyor, Pallet, PalletAxis, Pattern, Randomize,
    SupportForm,
};
pub use text_file::TextFile;
pub use vision::{CustomPort, ProjectOutput, Recipe, Vision, VisionProject};
pub use viz::{
    BranchByMsg, CustomPalletPattern, ExternalMove, FixedPointMove, MoveByGrid, MoveByList,
    MoveFrame, MoveReference, Notify, PalletPattern, PatternPlace, PickStrategy, PlacePattern,
    PredefinedPalletPattern, RelativeMove, SetDigitalOutput, StepMotion, VisionMove,
    VisualRecognition, Viz, VizAction, VizStep,
};

#[cfg(test)]
mod tests;
