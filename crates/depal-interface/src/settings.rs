use depal_frames::EulerConvention;
use depal_time::SimDuration;
use depal_wire::{Encoding, Profile, Status};
use thiserror::Error;

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
}

impl Default for ServerSettings {
    /// One ASCII port, one vision project with number 1, a Viz project without branches.
    fn default() -> Self {
        Self {
            ports: vec![PortSettings::default()],
            projects: vec![VisionProject {
                id: 1,
                recipes: Vec::new(),
                output: OutputPort::Poses,
            }],
            viz: Some(VizProject {
                branches: Vec::new(),
            }),
        }
    }
}

/// How one port speaks.
#[derive(Debug, Clone, PartialEq)]
pub struct PortSettings {
    /// Text or packed cells.
    pub encoding: Encoding,
    /// The product version's output rules, with the most points of a reply.
    pub profile: Profile,
    /// The brand's rule for the three angles of a pose.
    pub euler: EulerConvention,
    /// How long 102, 205 and 210 wait for a running project before they answer 1019 or 2025.
    /// The product's default is 10 s. Shorter than planning takes makes programs give up.
    pub timeout: SimDuration,
    /// What 102 answers when everything has been fetched. Newer versions say 1002; up to 1.5 it was 1008.
    pub all_fetched: Status,
}

impl Default for PortSettings {
    fn default() -> Self {
        Self {
            encoding: Encoding::Ascii,
            profile: Profile::v1_8(),
            euler: EulerConvention::AbbZyx,
            timeout: SimDuration::from_millis(10_000),
            all_fetched: Status::NoVisionResult,
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
}

/// The kind of a vision project's output.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OutputPort {
    /// Vision points, for 102.
    Poses,
    /// A planned path, for 105: 102 is answered with 1016.
    Path,
}

/// What the server has to know of the Viz project.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct VizProject {
    /// Its "branch by message" steps.
    pub branches: Vec<BranchStep>,
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
