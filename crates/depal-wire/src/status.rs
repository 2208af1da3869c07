//! The status codes, as a table.
//!
//! x001 to x099 are errors, x100 to x199 success; 1 vision, 2 Viz, 3 communication, 4 robot,
//! 7 calibration. Codes marked "old" come from versions before 1.6 and are listed so that a
//! client can name them.
//! Columns: number, name, meaning, and when this server sends it; nothing in the last column means never.

macro_rules! status_codes {
    ($($code:literal $name:ident $meaning:literal $situation:literal)*) => {
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

            /// When this server sends the code, in a few words; empty if never.
            pub fn situation(self) -> &'static str {
                match self { $(Self::$name => $situation,)* }
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
    1001 VisionNotRegistered      "vision project not registered"                      "901 or a command that names a project, when no project is there"
    1002 NoVisionResult           "no vision result"                                   "the run found nothing; or everything has been fetched"
    1003 NoPointsInRegion         "no point cloud in the region of interest"           "the run saw no point in its region"
    1004 SetPropertyFailed        "setting a property failed (old)"                    ""
    1005 InvalidVisionPoseType    "invalid robot pose type for vision"                 "101 with a pose type outside 0 to 3"
    1006 InvalidVisionPose        "invalid robot pose data for vision"                 "100 or 101 with a pose that is no number or out of any reach, or with none where the camera is on the flange"
    1007 VisionRunning            "vision project is running"                          "100, 101, 103, 501, 503 during a run of that project"
    1008 VisionDoListMissing      "vision provides no DO list"                         "106 when the project plans no path, or it switches nothing; re-fetch up to version 1.5"
    1009 PosesNotMotions          "poses and motion parameters differ in number (old)" ""
    1010 PosesNotLabels           "poses and labels differ in number"                  "the run found a carton whose size has no label"
    1011 UnknownJob               "vision project does not exist"                      "a project number that is not registered"
    1012 UnknownRecipe            "recipe does not exist"                              "100 or 103 with a recipe that the project does not have"
    1013 RecipesNotConfigured     "project has no recipes"                             "100 or 103 on a project without recipes"
    1014 RecipeSwitchFailed       "switching the recipe failed"                        "the run reports it"
    1015 VisionExecutionError     "vision project failed"                              "the run reports it"
    1016 WrongOutputPort          "data does not fit the project's output port type"   "102, 105, 110, 111 on a project with another output, or mixed on one result"
    1017 LabelNotInteger          "label cannot be mapped to an integer"               "the run found a carton whose label is no whole number"
    1018 InvalidPointCount        "invalid number of points"                           "101 with a negative count"
    1019 VisionTimeout            "vision timed out"                                   "100, 102, 105, 110, 111 waited longer than the time-out"
    1020 VisionNotStarted         "vision project not started"                         "102, 105, 106, 110, 111 before 101"
    1021 BoxSizeFailed            "setting the box size failed"                        "the run reports it"
    1022 InvalidBoxSize           "invalid box size"                                   "501 with a side that is not positive, longer than 10 m, or no number"
    1023 CameraNotConnected       "camera not connected"                               "the run reports it"
    1024 PosesNotCustomData       "poses and custom data differ in number"             "the run's custom rows and points differ in number"
    1025 ImageInUse               "image data in use"                                  "the run reports it"
    1026 InvalidPathType          "invalid pose type for a path"                       "100 with a format outside 1 to 4; 105, 111 with a type outside 1 to 2"
    1027 PathPlanningError        "path planning step failed"                          "the run reports it"
    1030 VisionUnreachable        "waypoint unreachable"                               "the run reports it"
    1033 VisionSingularity        "path runs through a singularity"                    "the run reports it"
    1035 VisionBadPickPoint       "pick point cannot be used"                          "the run reports it"
    1036 VisionCollision          "path collides"                                      "the run reports it"
    1037 VisionNoPalletPosition   "no position left on the pallet"                     "the run reports it"
    1044 VisionMoveWithoutPoint   "no vision point for the Vision Move"                "the run reports it"
    1046 VisionBadTool            "tool cannot be used"                                "the run reports it"
    1047 CaptureTimeout           "waiting for the capture timed out"                  "the run reports it"
    1048 BoxMaskError             "box mask failed"                                    "the run found tops that it could not tell apart into cartons"
    1049 BoxSizeCheckFailed       "box size check failed"                              "the run found cartons, none of them of a known size"
    1051 PoseNotSet               "setting the pose failed"                            "503 for an unknown step, or with an impossible pose"
    1052 VariableNotSet           "setting the global variable failed"                 "504 to 507 for an unknown variable, one of another kind, or no number"
    1053 SolutionNotSwitched      "switching the solution failed"                      "104 with an unknown solution, or during a run"
    1100 VisionResult             "vision result sent"                                 "100, 102, 110"
    1101 VisionReady              "vision ready"                                       "901 up to version 2.1"
    1102 VisionTriggered          "vision project triggered"                           "101"
    1103 VisionPathSent           "vision path sent"                                   "100, 105, 111"
    1104 SolutionSwitched         "solution switched"                                  "104"
    1106 VisionDoListSent         "vision DO list sent"                                "106"
    1107 RecipeSwitched           "recipe switched"                                    "103"
    1108 BoxSizeSet               "box size set"                                       "501"
    1110 PoseSet                  "pose set"                                           "503"
    1111 VariableSet              "global variable set"                                "504 to 507"
    2001 VizNotRegistered         "Viz project not registered"                         ""
    2002 VizRunning               "Viz project is running"                             "200 or 201 during a run"
    2003 VizNoPose                "no pose from vision (old)"                          ""
    2004 VizUnreachable           "waypoint unreachable"                               "the run reports it"
    2005 VizJointChoice           "no choice of joints (old)"                          ""
    2006 InvalidVizPoseType       "invalid robot pose type for Viz"                    "201 with a pose type outside 0 to 2"
    2007 VizPlanningFailed        "planning failed"                                    "the run reports it"
    2008 VizRuntimeError          "Viz project failed"                                 "the run reports it"
    2009 VizNoTcp                 "no TCP (old)"                                       ""
    2011 VizDoListMissing         "Viz provides no DO list"                            "206 when no path is there, or it switches nothing"
    2012 InvalidVizPathType       "invalid pose type for a path"                       "200, 205 with a type outside 1 to 2, 210 outside 1 to 4"
    2013 InvalidVizPose           "invalid robot pose data for Viz"                    "200, 201, 502 with a pose that is no number; 502 also out of any reach; 200, 201 with none where the camera is on the flange"
    2014 VizNoAutoload            "no Viz project is set to load automatically"        "200 or 201 without a Viz project"
    2015 VizNotOpened             "Viz project not opened"                             ""
    2016 StepParameterNotSet      "setting a step parameter failed"                    "208 when a step or key does not exist, or the value is no number"
    2017 VizStopFailed            "stopping the Viz project failed"                    ""
    2018 BadExitPort              "exit port does not exist"                           "200, 203 with a port outside 1 to the number of exits"
    2019 BranchFailed             "setting the branch failed"                          ""
    2020 VizSingularity           "path runs through a singularity"                    "the run reports it"
    2022 VizNoResult              "Viz project not run, or no result left"             "203, 204, 205, 210 before 201, after 202, or when everything has been fetched"
    2023 VizProjectBroken         "Viz project broken (old)"                           ""
    2024 BadBranchStep            "branch step does not exist"                         "200, 203 for a step that is no branch"
    2025 VizTimeout               "Viz timed out"                                      "200, 205, 210 waited longer than the time-out, also at a branch"
    2026 BadIndexStep             "index step does not exist"                          "204 for a step that does not count"
    2027 BadIndex                 "index out of range"                                 "204 with an index outside 1 to the number of places"
    2028 IndexFailed              "setting the index failed"                           "204 after 203, or after the run"
    2030 VizBadPickPoint          "pick point cannot be used"                          "the run reports it"
    2031 VizCollision             "path collides"                                      "the run reports it"
    2032 VizNoPalletPosition      "no position left on the pallet"                     "the run reports it"
    2036 RecognitionNotCalled     "visual recognition was not run"                     "the run reports it"
    2037 VizNoVisionResult        "no result from vision"                              "the run reports it"
    2038 VizNoPointsInRegion      "no point cloud in the region of interest"           "the run reports it"
    2039 VizNoVisionPoint         "no vision point for the Vision Move"                "the run reports it"
    2041 StepParameterNotRead     "reading a step parameter failed"                    "207 when the step or key does not exist"
    2042 NoPlanData               "no plan data"                                       "205 and 210 mixed on one path"
    2043 NoCustomData             "no custom data"                                     "the run reports it"
    2044 VisionServiceMissing     "vision service not found"                           "the run reports it"
    2045 VizBadTool               "tool cannot be used"                                "the run reports it"
    2047 VizBoxSizeCheckFailed    "box size check failed"                              "the run reports it"
    2100 VizFinished              "path sent"                                          "200, 205, 210"
    2101 VizStoppedByCommand      "stopped by command (old)"                           ""
    2102 VizDoListSent            "DO list sent"                                       "206"
    2103 VizStarted               "Viz project started"                                "201"
    2104 VizStopped               "Viz project stopped"                                "202, also when nothing runs"
    2105 BranchSet                "branch exit set"                                    "203"
    2106 IndexSet                 "index set"                                          "204"
    2107 OuterPoseSet             "external pose set"                                  "502"
    2108 StepParameterSet         "step parameter set"                                 "208"
    2109 StepParameterRead        "step parameter read"                                "207"
    3001 InvalidCommand           "invalid command"                                    "a command number that is unknown or no number"
    3002 WrongFormat              "wrong number or form of parameters"                 "too few or too many fields, or a field that is no number"
    3003 ClientGone               "client disconnected (old)"                          ""
    3004 ServerGone               "server disconnected (old)"                          ""
    3005 VisionCallTimeout        "call to vision timed out"                           ""
    3006 CommunicationUnknown     "unknown communication error"                        ""
    3007 AcknowledgeTimeout       "data acknowledge timed out"                         ""
    3008 UnknownConfigId          "configuration id does not exist"                    "207 or 208 with an id that is not in the property configuration"
    3099 SocketNotOpen            "robot side: socket could not be opened"             ""
    3100 ClientConnected          "client connected (old)"                             ""
    3101 ServerConnected          "server connected (old)"                             ""
    3102 WaitingForClient         "waiting for a client (old)"                         ""
    3103 ModbusCleared            "Modbus data cleared"                                ""
    4001 RobotServiceMissing      "robot service not registered (old)"                 ""
    4002 EulerTypeUnsupported     "Euler angle type not supported"                     ""
    7001 CalibrationParameter     "invalid calibration parameter"                      "701 with a state outside 0 to 2, before state 0, or where no calibration is set up"
    7002 CalibrationNoFlange      "calibration without flange pose"                    "701 with a flange pose of zeros"
    7003 CalibrationNoJoints      "calibration without joint data"                     "701 without joints (text only)"
    7004 CalibrationNotReached    "calibration point not reached"                      "701 with state 2"
    7100 CalibrationMoved         "calibration point reached"                          ""
    7101 CalibrationPointSent     "calibration point sent"                             "701"
    9100 StateSent                "state sent"                                         "901 from version 2.2"
}
