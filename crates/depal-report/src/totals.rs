use std::collections::BTreeMap;

/// What a run counted and measured, filled by whoever ran it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunTotals {
    /// Name of the scene.
    pub scene: String,
    /// Seed of the run.
    pub seed: u64,
    /// Version of the program.
    pub version: String,
    /// Simulated time at the end, s.
    pub sim_time_s: f64,
    /// Time on the wall, s. Nothing else in the report depends on it but the real-time factor.
    pub wall_time_s: f64,
    /// Hash of the state at the end, as text.
    pub state_hash: String,
    /// Why the run ended, in a sentence; for people only.
    pub ended_because: String,
    /// Scripted faults that struck; for people only.
    pub faults: Vec<String>,

    /// Cartons at the start.
    pub boxes_total: u64,
    /// Cartons that the conveyor carried away.
    pub boxes_delivered: u64,
    /// Cartons that fell or were lost.
    pub boxes_dropped: u64,
    /// Simulated time of the last delivery, s; `None` before the first. Rates are counted up to here,
    /// or up to the end when some carton was not delivered.
    pub last_delivery_s: Option<f64>,

    /// Picks begun: the arm went for a carton.
    pub picks_attempted: u64,
    /// Picks whose carton was held until the place.
    pub picks_succeeded: u64,
    /// Reason of every other pick, in the words of the reason list (`no_seal`, `dropped`, ...).
    pub pick_failures: BTreeMap<String, u64>,
    /// From one pick's start to the next one's, s each.
    pub cycle_s: Vec<f64>,

    /// Pictures taken.
    pub frames: u64,
    /// Cartons that could be seen whole, summed over the pictures.
    pub visible_boxes: u64,
    /// Those of them that were found.
    pub found_boxes: u64,
    /// Estimates where no carton was.
    pub false_picks: u64,
    /// Distance of each matched estimate from the truth, mm.
    pub pose_err_mm: Vec<f64>,
    /// Angle of each matched estimate to the truth, degrees.
    pub pose_err_deg: Vec<f64>,
    /// Computing time of each detection, ms.
    pub vision_ms: Vec<f64>,

    /// Computing time of each planning call, ms.
    pub planning_ms: Vec<f64>,
    /// Smallest clear distance of any planned path, mm; `None` before the first path.
    pub min_clearance_mm: Option<f64>,

    /// Commands that arrived, by number.
    pub commands: BTreeMap<u32, u64>,
    /// Statuses that were answered, by number.
    pub statuses: BTreeMap<u32, u64>,
}
