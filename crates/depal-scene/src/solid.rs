//! Solids that stand in the cell beside the pallet and the belt.

use crate::reader::{Checker, section};
use crate::rules::{ANGLE_DEG, COORDINATE_MM, Flag, LENGTH_MM, Numbers, Text};

section! {
    /// A block that stands still: a pedestal, a fence, a rail of a roll cage.
    pub struct Solid {
        /// Name for messages: several solids may share one.
        name: String, Text, required;
        /// Middle of its bottom face in the world, mm.
        xyz_mm: [f64; 3], Numbers::<3>(COORDINATE_MM), required;
        /// Turn about the world's Z, degrees.
        /// Default 0: along the world's axes.
        yaw_deg: f64, ANGLE_DEG, default(0.0);
        /// Size along its own X, Y and Z, mm.
        size_mm: [f64; 3], Numbers::<3>(LENGTH_MM), required;
        /// It is there: things bump into it and the camera sees it. If not, it is a space that the planner keeps out of.
        /// Default true: a real thing.
        body: bool, Flag, default(true);
        /// The planner is told of it.
        /// Default true: what stands in a cell is measured once.
        known: bool, Flag, default(true);
    }
    check check_solid;
}

fn check_solid(solid: &Solid, checker: &mut Checker<'_, '_>) {
    if !solid.body && !solid.known {
        checker.problem(
            "known",
            "expected a body, or a space that the planner knows, found neither".to_owned(),
            None,
        );
    }
}
