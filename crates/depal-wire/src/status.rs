//! The status codes, as a table.
//!
//! x001 to x099 are errors, x100 to x199 success; 1 vision, 2 Viz, 3 communication, 4 robot,
//! 7 calibration. Codes marked "old" come from versions before 1.6 and are listed so that a
//! client can name them.

macro_rules! status_codes {
    ($($code:literal $name:ident $meaning:literal)*) => {
        /// A status code of the standard interface.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Status {
            $(#[doc = concat!($code, ": ", $meaning, ".")] $name = $code,)*
        }

        impl Status {
            /// All codes, ascending.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// What the code says.
            pub fn meaning(self) -> &'static str {
                match self { $(Self::$name => $meaning,)* }
            }

            /// The status of a number on the wire.
            pub fn from_code(code: i32) -> Option<Self> {
                match code { $($code => Some(Self::$name),)* _ => None }
            }
        }
    };
}

impl Status {
    /// The number on the wire.
    pub fn code(self) -> i32 {
        self as i32
    }

    /// What a Viz run reports when the vision project that it called ended with this code.
    /// Codes without a counterpart become 2008.
    pub fn seen_from_viz(self) -> Self {
        match self {
            Self::NoVisionResult | Self::VisionTimeout => Self::VizNoVisionResult,
            Self::NoPointsInRegion => Self::VizNoPointsInRegion,
            Self::VisionNotRegistered | Self::UnknownJob => Self::VisionServiceMissing,
            Self::BoxSizeCheckFailed => Self::VizBoxSizeCheckFailed,
            Self::VisionUnreachable => Self::VizUnreachable,
            Self::VisionSingularity => Self::VizSingularity,
            Self::VisionBadPickPoint => Self::VizBadPickPoint,
            Self::VisionCollision => Self::VizCollision,
            Self::VisionNoPalletPosition => Self::VizNoPalletPosition,
            Self::VisionMoveWithoutPoint => Self::VizNoVisionPoint,
            Self::VisionBadTool => Self::VizBadTool,
            viz if (2001..3000).contains(&viz.code()) => viz,
            _ => Self::VizRuntimeError,
        }
    }

    /// Whether the command did what it should.
    pub fn is_success(self) -> bool {
        self.code() % 1000 >= 100
    }
}

impl std::fmt::Display for Status {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", self.code(), self.meaning())
    }
}

status_codes! {
    1001 VisionNotRegistered      "vision project not registered"
    1002 NoVisionResult           "no vision result"
    1003 NoPointsInRegion         "no point cloud in the region of interest"
    1004 SetPropertyFailed        "setting a property failed (old)"
    1005 InvalidVisionPoseType    "invalid robot pose type for vision"
    1006 InvalidVisionPose        "invalid robot pose data for vision"
    1007 VisionRunning            "vision project is running"
    1008 VisionDoListMissing      "vision provides no DO list"
    1009 PosesNotMotions          "poses and motion parameters differ in number (old)"
    1010 PosesNotLabels           "poses and labels differ in number"
    1011 UnknownJob               "vision project does not exist"
    1012 UnknownRecipe            "recipe does not exist"
    1013 RecipesNotConfigured     "project has no recipes"
    1014 RecipeSwitchFailed       "switching the recipe failed"
    1015 VisionExecutionError     "vision project failed"
    1016 WrongOutputPort          "data does not fit the project's output port type"
    1017 LabelNotInteger          "label cannot be mapped to an integer"
    1018 InvalidPointCount        "invalid number of points"
    1019 VisionTimeout            "vision timed out"
    1020 VisionNotStarted         "vision project not started"
    1021 BoxSizeFailed            "setting the box size failed"
    1022 InvalidBoxSize           "invalid box size"
    1023 CameraNotConnected       "camera not connected"
    1024 PosesNotCustomData       "poses and custom data differ in number"
    1025 ImageInUse               "image data in use"
    1026 InvalidPathType          "invalid pose type for a path"
    1027 PathPlanningError        "path planning step failed"
    1030 VisionUnreachable        "waypoint unreachable"
    1033 VisionSingularity        "path runs through a singularity"
    1035 VisionBadPickPoint       "pick point cannot be used"
    1036 VisionCollision          "path collides"
    1037 VisionNoPalletPosition   "no position left on the pallet"
    1044 VisionMoveWithoutPoint   "no vision point for the Vision Move"
    1046 VisionBadTool            "tool cannot be used"
    1047 CaptureTimeout           "waiting for the capture timed out"
    1048 BoxMaskError             "box mask failed"
    1049 BoxSizeCheckFailed       "box size check failed"
    1051 PoseNotSet               "setting the pose failed"
    1052 VariableNotSet           "setting the global variable failed"
    1053 SolutionNotSwitched      "switching the solution failed"
    1100 VisionResult             "vision result sent"
    1101 VisionReady              "vision ready"
    1102 VisionTriggered          "vision project triggered"
    1103 VisionPathSent           "vision path sent"
    1104 SolutionSwitched         "solution switched"
    1106 VisionDoListSent         "vision DO list sent"
    1107 RecipeSwitched           "recipe switched"
    1108 BoxSizeSet               "box size set"
    1110 PoseSet                  "pose set"
    1111 VariableSet              "global variable set"
    2001 VizNotRegistered         "Viz project not registered"
    2002 VizRunning               "Viz project is running"
    2003 VizNoPose                "no pose from vision (old)"
    2004 VizUnreachable           "waypoint unreachable"
    2005 VizJointChoice           "no choice of joints (old)"
    2006 InvalidVizPoseType       "invalid robot pose type for Viz"
    2007 VizPlanningFailed        "planning failed"
    2008 VizRuntimeError          "Viz project failed"
    2009 VizNoTcp                 "no TCP (old)"
    2011 VizDoListMissing         "Viz provides no DO list"
    2012 InvalidVizPathType       "invalid pose type for a path"
    2013 InvalidVizPose           "invalid robot pose data for Viz"
    2014 VizNoAutoload            "no Viz project is set to load automatically"
    2015 VizNotOpened             "Viz project not opened"
    2016 StepParameterNotSet      "setting a step parameter failed"
    2017 VizStopFailed            "stopping the Viz project failed"
    2018 BadExitPort              "exit port does not exist"
    2019 BranchFailed             "setting the branch failed"
    2020 VizSingularity           "path runs through a singularity"
    2022 VizNoResult              "Viz project not run, or no result left"
    2023 VizProjectBroken         "Viz project broken (old)"
    2024 BadBranchStep            "branch step does not exist"
    2025 VizTimeout               "Viz timed out"
    2026 BadIndexStep             "index step does not exist"
    2027 BadIndex                 "index out of range"
    2028 IndexFailed              "setting the index failed"
    2030 VizBadPickPoint          "pick point cannot be used"
    2031 VizCollision             "path collides"
    2032 VizNoPalletPosition      "no position left on the pallet"
    2036 RecognitionNotCalled     "visual recognition was not run"
    2037 VizNoVisionResult        "no result from vision"
    2038 VizNoPointsInRegion      "no point cloud in the region of interest"
    2039 VizNoVisionPoint         "no vision point for the Vision Move"
    2041 StepParameterNotRead     "reading a step parameter failed"
    2042 NoPlanData               "no plan data"
    2043 NoCustomData             "no custom data"
    2044 VisionServiceMissing     "vision service not found"
    2045 VizBadTool               "tool cannot be used"
    2047 VizBoxSizeCheckFailed    "box size check failed"
    2100 VizFinished              "path sent"
    2101 VizStoppedByCommand      "stopped by command (old)"
    2102 VizDoListSent            "DO list sent"
    2103 VizStarted               "Viz project started"
    2104 VizStopped               "Viz project stopped"
    2105 BranchSet                "branch exit set"
    2106 IndexSet                 "index set"
    2107 OuterPoseSet             "external pose set"
    2108 StepParameterSet         "step parameter set"
    2109 StepParameterRead        "step parameter read"
    3001 InvalidCommand           "invalid command"
    3002 WrongFormat              "wrong number or form of parameters"
    3003 ClientGone               "client disconnected (old)"
    3004 ServerGone               "server disconnected (old)"
    3005 VisionCallTimeout        "call to vision timed out"
    3006 CommunicationUnknown     "unknown communication error"
    3007 AcknowledgeTimeout       "data acknowledge timed out"
    3008 UnknownConfigId          "configuration id does not exist"
    3099 SocketNotOpen            "robot side: socket could not be opened"
    3100 ClientConnected          "client connected (old)"
    3101 ServerConnected          "server connected (old)"
    3102 WaitingForClient         "waiting for a client (old)"
    3103 ModbusCleared            "Modbus data cleared"
    4001 RobotServiceMissing      "robot service not registered (old)"
    4002 EulerTypeUnsupported     "Euler angle type not supported"
    7001 CalibrationParameter     "invalid calibration parameter"
    7002 CalibrationNoFlange      "calibration without flange pose"
    7003 CalibrationNoJoints      "calibration without joint data"
    7004 CalibrationNotReached    "calibration point not reached"
    7100 CalibrationMoved         "calibration point reached"
    7101 CalibrationPointSent     "calibration point sent"
    9100 StateSent                "state sent"
}
