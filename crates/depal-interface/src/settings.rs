use depal_frames::{EulerConvention, JointPositions, Pose};
use depal_time::SimDuration;
use depal_wire::{Encoding, Profile, Status};
use thiserror::Error;

use crate::fault_script::FaultScript;
use crate::property_config::{PropertyConfig, PropertyConfigError};

/// A port of the server: its place in [`ServerSettings::ports`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PortId(pub u16);

/// What the server is set up with. Fixed while it runs.
#[derive(Debug, Clone, PartialEq)]
pub struct ServerSettings {
    /// One session each.
    pub ports: Vec<PortSettings>,
    /// The vision projects (commands 101 to 103, 501).
    pub projects: Vec<VisionProject>,
    /// The Viz project that is loaded by itself (commands 201 to 210), if any.
    pub viz: Option<VizProject>,
    /// Numbers of the solutions that 104 may switch to.
    pub solutions: Vec<i32>,
    /// Global variables that 504 to 507 may set.
    pub variables: Vec<Variable>,
    /// The text of the property configuration (207 and 208), see [`PropertyConfig`].
    pub property_config: String,
    /// Where 701 sends the robot, in order: 3 to 100 poses, or none if no calibration is set up.
    pub calibration: Vec<CalibrationPose>,
    /// The camera is on the flange: a run must be told where the robot is. 100 and 101 without the robot's
    /// joints or flange are refused with 1006, 200 and 201 with 2013.
    pub needs_robot_pose: bool,
    /// What shall go wrong on every port; each counts for itself.
    pub faults: FaultScript,
}

/// One place of a calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct CalibrationPose {
    /// Flange in the robot base.
    pub base_from_flange: Pose,
    /// Joints, radians, that bring the flange there.
    pub joints: JointPositions,
}

/// A global variable of the solution.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variable {
    /// Its name, without commas.
    pub name: String,
    /// What it holds.
    pub kind: VariableKind,
}

/// What a global variable holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum VariableKind {
    /// A number, set by 504.
    Number,
    /// A list of numbers, set by 505.
    Numbers,
    /// A text, set by 506.
    Text,
    /// A list of texts, set by 507.
    Texts,
}

impl Default for ServerSettings {
    /// One ASCII port, one vision project with number 1, a Viz project without branches.
    fn default() -> Self {
        Self {
            ports: vec![PortSettings::default()],
            projects: vec![VisionProject::default()],
            viz: Some(VizProject::default()),
            solutions: Vec::new(),
            variables: Vec::new(),
            property_config: String::new(),
            calibration: Vec::new(),
            needs_robot_pose: false,
            faults: FaultScript::default(),
        }
    }
}

/// How one port speaks.
#[derive(Debug, Clone, PartialEq)]
pub struct PortSettings {
    /// Text or packed cells.
    pub encoding: Encoding,
    /// Each connection's encoding is found out from its first bytes instead.
    pub detects_encoding: bool,
    /// The product version's output rules, with the most points of a reply.
    pub profile: Profile,
    /// The brand's rule for the three angles of a pose.
    pub euler: EulerConvention,
    /// How long 102, 105, 110, 111, 205 and 210 wait for a running project before they answer 1019 or 2025,
    /// and 601 for a message before it answers 0.
    /// The product's default is 10 s. Shorter than planning takes makes programs give up.
    pub timeout: SimDuration,
    /// What 102 answers when everything has been fetched. Newer versions say 1002; up to 1.5 it was 1008.
    pub all_fetched: Status,
    /// How long a message waits for 601: 1 s, from version 2.2 3 s.
    pub notify_hold: SimDuration,
}

impl PortSettings {
    /// The settings that go with a profile, text, and ABB angles.
    pub fn of_profile(profile: Profile) -> Self {
        let is_oldest = profile.name == "v1_5";
        let holds_longer = profile.name == "v2_2";
        Self {
            profile,
            all_fetched: if is_oldest {
                Status::VisionDoListMissing
            } else {
                Status::NoVisionResult
            },
            notify_hold: SimDuration::from_millis(if holds_longer { 3_000 } else { 1_000 }),
            ..Self::default()
        }
    }
}

impl Default for PortSettings {
    fn default() -> Self {
        Self {
            encoding: Encoding::Ascii,
            detects_encoding: false,
            profile: Profile::v1_8(),
            euler: EulerConvention::AbbZyx,
            timeout: SimDuration::from_millis(10_000),
            all_fetched: Status::NoVisionResult,
            notify_hold: SimDuration::from_millis(1_000),
        }
    }
}

/// What the server has to know of a vision project.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VisionProject {
    /// The number that commands name, from 1.
    pub id: i32,
    /// Numbers of its recipes, 1 to 99; empty if it has none.
    pub recipes: Vec<i32>,
    /// What it puts out.
    pub output: OutputPort,
    /// Names of its steps that take a pose by 503.
    pub input_steps: Vec<String>,
}

impl Default for VisionProject {
    /// Number 1, vision points, no recipes.
    fn default() -> Self {
        Self {
            id: 1,
            recipes: Vec::new(),
            output: OutputPort::Poses,
            input_steps: Vec::new(),
        }
    }
}

/// The kind of a vision project's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputPort {
    /// Vision points, for 102.
    Poses,
    /// A planned path, for 105, 106 and 111: 102 is answered with 1016.
    Path,
    /// Vision points with custom ports, for 102 or 110.
    Custom,
}

/// What the server has to know of the Viz project.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct VizProject {
    /// Its "branch by message" steps.
    pub branches: Vec<BranchStep>,
    /// Its steps that count, for 204.
    pub index_steps: Vec<IndexStep>,
    /// The numeric parameters of its steps that 207 and 208 may name.
    pub parameters: Vec<StepParameter>,
}

/// A step with an index: move by list, by grid, pallet patterns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IndexStep {
    /// Step id.
    pub step: i32,
    /// Places that it counts through; 204 takes 1 to this.
    pub places: i32,
}

/// A parameter of a step, with the value that it has when the server starts.
#[derive(Debug, Clone, PartialEq)]
pub struct StepParameter {
    /// Step id.
    pub step: i32,
    /// Name of the parameter.
    pub key: String,
    /// Value, in the unit of the step's own settings.
    pub value: f64,
    /// What 208 may write; absent: the parameter can only be read.
    pub writable: Option<ParameterRange>,
}

/// Values that a parameter takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterRange {
    /// The smallest value.
    pub low: f64,
    /// Whether the smallest value itself is out of range.
    pub excludes_low: bool,
    /// The largest value.
    pub high: f64,
    /// Only whole numbers.
    pub is_whole: bool,
}

impl ParameterRange {
    /// Every finite number.
    pub const ANY: Self = Self {
        low: f64::MIN,
        excludes_low: false,
        high: f64::MAX,
        is_whole: false,
    };

    /// Whether a value is in range; NaN never is.
    pub fn holds(&self, value: f64) -> bool {
        let is_high_enough = if self.excludes_low {
            value > self.low
        } else {
            value >= self.low
        };
        is_high_enough && value <= self.high && (!self.is_whole || value.fract() == 0.0)
    }
}

/// A step that waits for command 203.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BranchStep {
    /// Step id.
    pub step: i32,
    /// Number of exits; 203 takes ports 1 to this.
    pub exits: i32,
}

/// What is wrong with the settings.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum InterfaceError {
    /// No port to listen on.
    #[error("the server has no port; give it at least one")]
    NoPort,
    /// The number of points in a reply.
    #[error("port {port}: pose cap {found}, expected 1 to 30")]
    PoseCap {
        /// Place of the port.
        port: usize,
        /// The cap.
        found: usize,
    },
    /// Two vision projects of one number.
    #[error("vision project {id} is there twice; numbers must differ")]
    DuplicateProject {
        /// The number.
        id: i32,
    },
    /// A number that commands cannot name.
    #[error("vision project {id}: expected a number from 1")]
    ProjectNumber {
        /// The number.
        id: i32,
    },
    /// A recipe number out of range.
    #[error("vision project {id}: recipe {recipe}, expected 1 to 99")]
    RecipeNumber {
        /// The project.
        id: i32,
        /// The recipe.
        recipe: i32,
    },
    /// The number of calibration poses.
    #[error("calibration with {found} poses, expected 3 to 100, or none")]
    CalibrationPoses {
        /// Poses found.
        found: usize,
    },
    /// The property configuration cannot be read.
    #[error(transparent)]
    PropertyConfig(#[from] PropertyConfigError),
}

impl ServerSettings {
    /// Refuses what the server could not serve.
    pub fn check(&self) -> Result<(), InterfaceError> {
        if self.ports.is_empty() {
            return Err(InterfaceError::NoPort);
        }
        for (port, settings) in self.ports.iter().enumerate() {
            let found = settings.profile.pose_cap;
            if !(1..=30).contains(&found) {
                return Err(InterfaceError::PoseCap { port, found });
            }
        }
        let found = self.calibration.len();
        if found != 0 && !(3..=100).contains(&found) {
            return Err(InterfaceError::CalibrationPoses { found });
        }
        PropertyConfig::parse(&self.property_config)?;
        for (place, project) in self.projects.iter().enumerate() {
            let id = project.id;
            if id < 1 {
                return Err(InterfaceError::ProjectNumber { id });
            }
            if self.projects[..place].iter().any(|other| other.id == id) {
                return Err(InterfaceError::DuplicateProject { id });
            }
            if let Some(recipe) = project.recipes.iter().find(|r| !(1..=99).contains(*r)) {
                return Err(InterfaceError::RecipeNumber {
                    id,
                    recipe: *recipe,
                });
            }
        }
        Ok(())
    }
}
