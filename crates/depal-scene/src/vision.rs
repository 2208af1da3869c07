//! The projects that a vision server has been given.

use crate::choice::{choice, one_of};
use crate::reader::{Checker, section};
use crate::rules::{LENGTH_MM, ListOf, Numbers, OneOrMore, Text, table, whole};

choice! {
    /// What a vision project answers with.
    pub enum ProjectOutput {
        /// Poses, labels and speeds.
        Poses = "poses",
        /// Poses with data of the project's own.
        Custom = "custom",
        /// A planned path.
        Path = "path",
    }
}

section! {
    /// A stored set of values that a command can switch a project to.
    pub struct Recipe {
        /// Number that the robot sends.
        id: u16, whole(1, 999), required;
        /// Carton size or a list of sizes, each [length, width, height] in mm.
        box_mm: Vec<[f64; 3]>, OneOrMore(Numbers::<3>(LENGTH_MM), 32), required;
    }
}

section! {
    /// One vision project.
    pub struct VisionProject {
        /// Number that the robot sends.
        id: u16, whole(1, 999), required;
        /// Name of the camera that it looks through.
        /// Default overhead: the camera's own default name.
        camera: String, Text, default("overhead".to_owned());
        /// Carton size or a list of sizes, each [length, width, height] in mm.
        box_mm: Vec<[f64; 3]>, OneOrMore(Numbers::<3>(LENGTH_MM), 32), required;
        /// What it answers with.
        /// Default poses: the plain case.
        output: ProjectOutput, one_of(), default(ProjectOutput::Poses);
        /// What a command can switch it to.
        /// Default: nothing to switch to.
        recipes: Vec<Recipe>, ListOf(table(), 0, 99), default(Vec::new());
    }
}

section! {
    /// What the vision server has been set up with.
    pub struct Vision {
        /// The projects.
        project: Vec<VisionProject>, ListOf(table(), 1, 99), required;
    }
    check check_vision;
}

fn check_vision(vision: &Vision, checker: &mut Checker<'_, '_>) {
    for (position, project) in vision.project.iter().enumerate() {
        let id = project.id;
        if vision.project[..position]
            .iter()
            .any(|earlier| earlier.id == id)
        {
            checker.problem(
                "project",
                format!("expected each id once, found {id} twice"),
                None,
            );
        }
    }
}
