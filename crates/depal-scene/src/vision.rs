//! The projects that a vision server has been given.

use crate::choice::{choice, one_of};
use crate::reader::{Checker, section};
use crate::rules::{
    COORDINATE_MM, Flag, LENGTH_MM, ListOf, Maybe, Number, Numbers, OneOrMore, Text, above, number,
    table, whole,
};

/// A number of a project's own; the wire carries single precision.
const DATUM: Number = number(-1e9, 1e9);

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
        /// What goes out as label with a carton of each size, in the order of the sizes: whole numbers as text.
        /// A found size without a label is answered with 1010, a label that is no whole number with 1017.
        /// Default: the size's place in the list, from 0.
        labels: Vec<String>, ListOf(Text, 0, 32), default(Vec::new());
    }
}

section! {
    /// Data of a project's own under a name.
    pub struct CustomPort {
        /// Name: ports go out in alphabetical order.
        name: String, Text, required;
        /// The same numbers with every point. Either this or `rows`.
        /// Default: none.
        row: Vec<f64>, ListOf(DATUM, 0, 50), default(Vec::new());
        /// A row of numbers for each point.
        /// Default: none.
        rows: Vec<Vec<f64>>, ListOf(ListOf(DATUM, 1, 50), 0, 500), default(Vec::new());
    }
    check check_port;
}

fn check_port(port: &CustomPort, checker: &mut Checker<'_, '_>) {
    if port.row.is_empty() == port.rows.is_empty() {
        checker.problem("row", "expected either row or rows".to_owned(), None);
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
        /// What goes out as label with a carton of each size, in the order of the sizes: whole numbers as text.
        /// A found size without a label is answered with 1010, a label that is no whole number with 1017.
        /// Default: the size's place in the list, from 0.
        labels: Vec<String>, ListOf(Text, 0, 32), default(Vec::new());
        /// What it answers with.
        /// Default poses: the plain case.
        output: ProjectOutput, one_of(), default(ProjectOutput::Poses);
        /// Middle of the box in the world in which cartons are looked for, mm; with `region_size_mm`.
        /// Default: the air above the pallet, 150 mm over its edges, 30 mm below its deck.
        region_xyz_mm: Option<[f64; 3]>, Maybe(Numbers::<3>(COORDINATE_MM)), default(None);
        /// Size of that box along the world's axes, mm.
        /// Default: see `region_xyz_mm`.
        region_size_mm: Option<[f64; 3]>, Maybe(Numbers::<3>(LENGTH_MM)), default(None);
        /// Names of its steps that take a pose by command 503; a pose is noted and changes nothing else.
        /// Default: none.
        input_steps: Vec<String>, ListOf(Text, 0, 20), default(Vec::new());
        /// With output custom or path: the data that go out with each point or pick.
        /// Default: none.
        port: Vec<CustomPort>, ListOf(table(), 0, 20), default(Vec::new());
        /// With output path: velocity of its moves, percent.
        /// Default 100: the planner's own limits hold.
        velocity_percent: f64, above(0.0, 100.0), default(100.0);
        /// With output path: pick and place every carton that was found, one after another.
        /// Default false: one pick.
        plan_all_vision_results: bool, Flag, default(false);
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
        let has_ports = !project.port.is_empty();
        let fits = match project.output {
            ProjectOutput::Poses => !has_ports,
            ProjectOutput::Custom => has_ports,
            ProjectOutput::Path => true,
        };
        if !fits {
            checker.problem(
                "project",
                format!("expected ports with output custom and none with output poses, found otherwise in project {id}"),
                None,
            );
        }
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
