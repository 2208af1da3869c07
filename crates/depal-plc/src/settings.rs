use depal_frames::{JointPositions, Pose};
use depal_time::SimDuration;

/// Who plans the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Source {
    /// The Viz project: 201, 205 or 210, 206 with project 0.
    Viz,
    /// The vision project: 101, 105 or 210, 206 with its number.
    Vision,
}

/// How the path is fetched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fetch {
    /// 210: with motion types and velocities.
    PlanData,
    /// 205, or 105 of a vision project: joints alone. Moves next to pick and place are straight lines then.
    Path,
}

/// What the sequence is set up with.
#[derive(Debug, Clone, PartialEq)]
pub struct PlcSettings {
    /// Port that vision connects to. Default 102.
    pub port: u16,
    /// Number of the vision project. Default 1.
    pub project: i16,
    /// Sizes for 501, mm; absent: the project's own are used.
    pub box_size_mm: Option<[f32; 3]>,
    /// Who plans.
    pub source: Source,
    /// How the path is fetched.
    pub fetch: Fetch,
    /// Steps and exits, from 1, for 203 after each 201.
    pub branches: Vec<(i16, i16)>,
    /// Sections of the gripper for 206; 0 to leave the register empty.
    pub sections: i16,
    /// Where the arm waits and where planned paths start, radians.
    pub home: JointPositions,
    /// `flange_from_tcp` of the gripper.
    pub flange_from_tcp: Pose,
    /// Group outputs of 16 bits: output d of the DO list is bit d mod 16 of group d / 16.
    pub section_groups: Vec<String>,
    /// Input that is 1 while the switched-on sections hold vacuum.
    pub vacuum_signal: String,
    /// How long the first heartbeat of vision is waited for. Default 30 s.
    pub vision_time: SimDuration,
    /// How long the vacuum may take. Default 1.5 s.
    pub vacuum_time: SimDuration,
    /// Straight up after the release, m. Default 0.15.
    pub retreat: f64,
    /// Speed of the TCP at 100 percent, m/s. Default 5.
    pub tcp_speed: f64,
    /// Velocity of waypoints fetched without one, percent. Default 60.
    pub path_percent: f64,
    /// Failed picks in a row before the program gives up. Default 3.
    pub most_failures: u32,
}

impl Default for PlcSettings {
    /// The Viz project, plan data, no branches; the signals of the built-in demo.
    fn default() -> Self {
        Self {
            port: 102,
            project: 1,
            box_size_mm: None,
            source: Source::Viz,
            fetch: Fetch::PlanData,
            branches: Vec::new(),
            sections: 0,
            home: JointPositions::from_degrees(&[90.0, -20.0, 20.0, 0.0, 90.0, 0.0]),
            flange_from_tcp: Pose::identity(),
            section_groups: vec!["goVacuum".to_owned()],
            vacuum_signal: "diVacuumOk".to_owned(),
            vision_time: SimDuration::from_millis(30_000),
            vacuum_time: SimDuration::from_millis(1_500),
            retreat: 0.15,
            tcp_speed: 5.0,
            path_percent: 60.0,
            most_failures: 3,
        }
    }
}
