use depal_arm::Arm;
use depal_frames::{BoxSize, JointPositions, PlacedShape, Point, Pose};
use depal_gripper::GripperSpec;

/// A box as vision reports it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenBox {
    /// Middle of the top face, Z up, X along the long side.
    pub base_from_box: Pose,
    /// Outer size, metres.
    pub size: BoxSize,
    /// 0 to 1.
    pub confidence: f64,
}

/// Where the carton shall stand.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaceSpec {
    /// Middle of the carton's bottom face on the support, Z up, X along the carton's long side at yaw 0.
    pub base_from_place: Pose,
    /// Allowed turns about that Z, radians. A carton looks alike at 0 and pi; name both to let the planner choose.
    pub yaws: Vec<f64>,
}

/// One question to the planner. Everything in the base frame.
#[derive(Debug, Clone, Copy)]
pub struct PlanRequest<'a> {
    /// The arm.
    pub arm: &'a Arm,
    /// The tool on its flange.
    pub gripper: &'a GripperSpec,
    /// What vision saw.
    pub boxes: &'a [SeenBox],
    /// Floor, conveyor, pallet, fence, posts.
    pub known_obstacles: &'a [PlacedShape],
    /// Leftover depth points that no box explains, thinned to about [`PlannerSettings::point_size`].
    /// Points within [`PlannerSettings::stack_tolerance`] of a box or below its top are taken to be part of it.
    pub obstacle_points: &'a [Point],
    /// Where the arm is now, rad.
    pub start: JointPositions,
    /// Where the carton goes.
    pub place: &'a PlaceSpec,
    /// Tunables.
    pub settings: &'a PlannerSettings,
}

/// Tunables of the planner.
#[derive(Debug, Clone, PartialEq)]
pub struct PlannerSettings {
    /// Most waypoints of a plan; the interface sends 20 in one reply.
    pub max_waypoints: usize,
    /// Boxes below this confidence are left alone.
    pub min_confidence: f64,
    /// Largest lean of a box against the vertical, rad. Lifting is straight up, so a leaning box would rub its neighbours.
    pub max_tilt: f64,
    /// Assumed mass of a carton, kg: what the suction limit is computed for.
    pub max_carton_mass: f64,
    /// Most cartons of one pick. They must be alike, side by side in a rectangle, and each held by cups of its own.
    pub max_group: usize,
    /// Widest gap between neighbours of a group, m.
    pub group_gap: f64,
    /// Most mass that may hang on the gripper, kg: the arm's payload without the gripper.
    pub max_load: f64,
    /// Largest moment of gripper and load about the flange, tool level, N m: what the arm's wrist is rated for.
    pub max_moment: f64,
    /// Safety factor of the suction limit. 2 is usual for porous cardboard; raising it slows loaded moves.
    pub suction_safety: f64,
    /// A cup must lie this far inside the face, m. Raising it guards against wrong sizes and costs sections.
    pub cup_margin: f64,
    /// Two tops belong to one layer when they differ by less than this share of the smallest height.
    pub layer_share: f64,
    /// A box counts as covered when a higher one overlaps its footprint by more than this in both directions, m.
    pub cover_tolerance: f64,
    /// Bodies are this much thicker in free moves, m.
    pub transfer_padding: f64,
    /// ... and this much in the straight moves at pick and place, m.
    pub close_padding: f64,
    /// Cartons in the stack touch: while a carton is lifted straight out or set down, it counts as this much smaller
    /// on every side, m. It must exceed `close_padding` plus what vision may be wrong by.
    pub stack_tolerance: f64,
    /// Straight way down to the pick, m.
    pub approach_height: f64,
    /// The carton's bottom rises at least this far above its neighbours before it moves sideways, m.
    pub lift_clearance: f64,
    /// Largest lean of the tool against the vertical in loaded moves, rad. A hanging carton that swings aside may shear off.
    pub max_carry_tilt: f64,
    /// Straight way down to the place, m.
    pub place_height: f64,
    /// The carton is let go this far above the support, m.
    pub place_gap: f64,
    /// How far a controller may cut a corner at the tool centre, m. The chord of that corner is checked too.
    pub corner_zone: f64,
    /// Side of the cube that stands for one obstacle point, m.
    pub point_size: f64,
    /// Acceleration of straight moves, m/s2.
    pub linear_acceleration: f64,
    /// Step of the padded path check, rad (Euclidean over all joints).
    pub check_step: f64,
    /// Combinations of branch, turn and yaw tried for one grasp (and those equally good) before the next worse one.
    pub attempts_per_grasp: usize,
    /// Of all attempts, the first so many may use the random search when every template is blocked; 0 turns it off.
    pub search_attempts: usize,
    /// Growth steps of one search. Raising it finds narrower ways and delays refusals.
    pub search_rounds: usize,
    /// Seed of the search.
    pub search_seed: u64,
}

impl Default for PlannerSettings {
    fn default() -> Self {
        Self {
            max_waypoints: 20,
            min_confidence: 0.3,
            max_tilt: 5f64.to_radians(),
            max_carton_mass: 20.0,
            max_group: 1,
            group_gap: 0.015,
            max_load: f64::INFINITY,
            max_moment: f64::INFINITY,
            suction_safety: 2.0,
            cup_margin: 0.002,
            layer_share: 0.5,
            cover_tolerance: 0.02,
            transfer_padding: 0.020,
            close_padding: 0.005,
            stack_tolerance: 0.015,
            approach_height: 0.12,
            lift_clearance: 0.05,
            max_carry_tilt: 15f64.to_radians(),
            place_height: 0.12,
            place_gap: 0.006,
            corner_zone: 0.05,
            point_size: 0.025,
            linear_acceleration: 3.0,
            check_step: 0.05,
            attempts_per_grasp: 8,
            search_attempts: 3,
            search_rounds: 800,
            search_seed: 1,
        }
    }
}
