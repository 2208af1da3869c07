//! What the steps of a path project do, each with its parameters.

use crate::choice::{choice, one_of};
use crate::reader::section;
use crate::rules::{
    ANGLE_DEG, COORDINATE_MM, Flag, LENGTH_MM, ListOf, Number, Numbers, Wholes, above, number,
    table, whole,
};

choice! {
    /// How a move goes.
    pub enum StepMotion {
        /// All joints together.
        Joint = "joint",
        /// Straight line of the tool.
        Linear = "linear",
    }
}

choice! {
    /// The waypoint that a relative move counts from.
    pub enum MoveReference {
        /// The one before.
        Previous = "previous",
        /// The one after.
        Next = "next",
    }
}

/// Velocity of a move before the project's own, percent.
pub(super) const VELOCITY: Number = above(0.0, 100.0);
/// The speed that the planner's or taught move has by itself.
pub(super) const FULL: f64 = 100.0;

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
        /// Most cartons of one pick: like cartons side by side in a rectangle, each on cups of its own.
        /// Default 1: one at a time.
        group_max: u32, whole(1, 16), default(1);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
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
        /// How it goes there.
        /// Default joint: no line to keep.
        motion: StepMotion, one_of(), default(StepMotion::Joint);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
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
        /// The waypoint that it counts from.
        /// Default previous: next is for an approach.
        relative_to: MoveReference, one_of(), default(MoveReference::Previous);
        /// How it goes there.
        /// Default linear: along the offset.
        motion: StepMotion, one_of(), default(StepMotion::Linear);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
    }
}

section! {
    /// Go to one of several fixed joint angles, chosen by an index that the robot sends.
    pub struct MoveByList {
        /// The list, each in degrees in the order of the URDF.
        joints_deg: Vec<Vec<f64>>, ListOf(ListOf(number(-720.0, 720.0), 1, 8), 1, 500), required;
        /// How it goes there.
        /// Default joint: no line to keep.
        motion: StepMotion, one_of(), default(StepMotion::Joint);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
    }
}

section! {
    /// Go to one pose of a grid, chosen by an index that the robot sends; it rises with every use.
    pub struct MoveByGrid {
        /// Tool position at index 0 in the robot base, mm.
        base_xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Roll, pitch and yaw of the tool in the robot base, degrees.
        /// Default [180, 0, 0]: the tool looks down.
        base_rpy_deg: [f64; 3], Numbers::<3>(ANGLE_DEG), default([180.0, 0.0, 0.0]);
        /// Poses along the base's X, Y and Z, X counting fastest.
        counts: [u32; 3], Wholes::<3>(whole(1, 1000)), required;
        /// Distances along the base's X, Y and Z, mm.
        offsets_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// How it goes there.
        /// Default joint: no line to keep.
        motion: StepMotion, one_of(), default(StepMotion::Joint);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
    }
}

section! {
    /// A place of a pattern: where the middle of a carton's bottom goes.
    pub struct PatternPlace {
        /// In the robot base, mm.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Where the long side points, degrees from the base's X.
        /// Default 0: along the base's X.
        yaw_deg: f64, ANGLE_DEG, default(0.0);
    }
}

section! {
    /// Place what is held at the next of a list of places.
    pub struct CustomPalletPattern {
        /// The places, in order.
        places: Vec<PatternPlace>, ListOf(table(), 1, 500), required;
        /// How it goes there.
        /// Default linear: straight down from the move before.
        motion: StepMotion, one_of(), default(StepMotion::Linear);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
    }
}

section! {
    /// Place what is held at the next place of equal layers.
    pub struct PredefinedPalletPattern {
        /// Where the middle of the first carton's bottom goes, in the robot base, mm.
        base_xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Direction of the columns, degrees from the base's X.
        /// Default 0: along the base's X.
        base_yaw_deg: f64, ANGLE_DEG, default(0.0);
        /// Rows of a layer.
        rows: u32, whole(1, 100), required;
        /// Columns of a layer.
        columns: u32, whole(1, 100), required;
        /// Layers.
        layers: u32, whole(1, 100), required;
        /// Distances from column to column, row to row and layer to layer, mm.
        pitch_mm: [f64; 3], Numbers::<3>(LENGTH_MM), required;
        /// Whether every second layer is turned by 90 degrees about its middle.
        /// Default false: all layers alike.
        alternating: bool, Flag, default(false);
        /// How it goes there.
        /// Default linear: straight down from the move before.
        motion: StepMotion, one_of(), default(StepMotion::Linear);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
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
    /// Go to a tool pose that the robot sends (502).
    pub struct ExternalMove {
        /// How it goes there.
        /// Default joint: no line to keep.
        motion: StepMotion, one_of(), default(StepMotion::Joint);
        /// Velocity, percent, before the project's own.
        /// Default 100: the project's own alone.
        velocity_percent: f64, VELOCITY, default(FULL);
    }
}

section! {
    /// Send the gripper's outputs of the pick before to the robot.
    pub struct SetDigitalOutput {}
}

section! {
    /// Send a message to the robot.
    pub struct Notify {
        /// The message, a number.
        message: u32, whole(1, 2_147_483_647), required;
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
    /// Go to one pose of a grid.
    MoveByGrid(MoveByGrid),
    /// Place at the next of a list of places.
    CustomPalletPattern(CustomPalletPattern),
    /// Place at the next place of equal layers.
    PredefinedPalletPattern(PredefinedPalletPattern),
    /// Go on at the step that a message chooses.
    BranchByMsg(BranchByMsg),
    /// Go to a pose that the robot sends.
    ExternalMove(ExternalMove),
    /// Switch an output.
    SetDo(SetDigitalOutput),
    /// Send a message to the robot.
    Notify(Notify),
}
