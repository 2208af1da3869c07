//! An arm with mesh files in a scene: planner, physics and camera meet their hulls; without the files nothing is met.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use depal_cell::cell::EndState;
use depal_cell::event::FailureReason;
use depal_scene::Scene;

use crate::runner::{Finished, root, run_scene};

/// A program that passes half a metre above the stack.
const ABOVE_THE_STACK: &str = "MODULE AboveTheStack
  PERS tooldata tGripper:=[TRUE,[[0,0,300],[1,0,0,0]],[50,[0,0,150],[1,0,0,0],0,0,0]];
  CONST robtarget pBefore:=[[900,-900,2200],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  CONST robtarget pBehind:=[[1700,900,2200],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];
  PROC main()
    ConfJ\\Off;
    ConfL\\Off;
    MoveJ pBefore,v1000,fine,tGripper\\WObj:=wobj0;
    MoveL pBehind,v500,fine,tGripper\\WObj:=wobj0;
    TPWrite \"through\";
  ENDPROC
ENDMODULE
";

/// A box between two corners as a Wavefront file, metres.
fn obj(low: [f64; 3], high: [f64; 3]) -> String {
    let mut text = String::new();
    for corner in 0..8 {
        let side = |axis: usize| match corner & (1 << axis) {
            0 => low[axis],
            _ => high[axis],
        };
        writeln!(text, "v {} {} {}", side(0), side(1), side(2)).expect("text");
    }
    text
}

/// The demo's arm with a mesh of the package `maker_support` on one link, in a folder of its own.
struct ArmWithMesh {
    folder: PathBuf,
}

impl ArmWithMesh {
    fn new(name: &str, link: &str, mesh: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        let write = |path: &str, text: &str| {
            let path = folder.join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            fs::write(path, text).expect("written");
        };
        let plain = fs::read_to_string(root().join("urdf/abb_irb6700_150_320.urdf"));
        let plain = plain.expect("the demo's arm");
        let open = format!("<link name=\"{link}\">");
        assert!(plain.contains(&open));
        let body = format!("{open}<collision><geometry>{mesh}</geometry></collision>");
        write("robots/with.urdf", &plain.replacen(&open, &body, 1));
        write("robots/without.urdf", &plain);
        // Wide, 0.6 m below the gripper's cups: the link's X points out of the flange.
        write("stock/plate.obj", &obj([0.9, -0.6, -0.6], [1.0, 0.6, 0.6]));
        // In millimetres, above the pallet and below the camera.
        write(
            "stock/lid.obj",
            &obj([1000.0, -900.0, 3000.0], [2400.0, 900.0, 3050.0]),
        );
        write("above.mod", ABOVE_THE_STACK);
        Self { folder }
    }

    fn run(&self, urdf: &str, more: &[(&str, String)]) -> Finished {
        let path = |name: &str| self.folder.join(name).to_string_lossy().into_owned();
        let mut overrides = vec![
            ("robot.urdf".to_owned(), path(urdf)),
            (
                "robot.packages".to_owned(),
                format!("{{ maker_support = '{}' }}", path("stock")),
            ),
            ("run.max_sim_s".to_owned(), "24".to_owned()),
        ];
        overrides.extend(
            more.iter()
                .map(|(key, value)| ((*key).to_owned(), value.clone())),
        );
        let scene = Scene::demo(&overrides, Some(1)).unwrap_or_else(|error| panic!("{error}"));
        run_scene(&scene)
    }
}

fn reasons(finished: &Finished) -> Vec<FailureReason> {
    let score = &finished.outcome.score;
    score.failures_by_reason().into_keys().collect()
}

#[test]
fn a_mesh_on_a_link_bumps_into_cartons() {
    let mesh = r#"<mesh filename="package://maker_support/plate.obj"/>"#;
    let arm = ArmWithMesh::new("mesh_bumps", "link_6", mesh);
    let program = arm.folder.join("above.mod").to_string_lossy().into_owned();
    let run = |urdf: &str| arm.run(urdf, &[("robot.program", program.clone())]);
    let through = |run: &Finished| run.log.iter().any(|line| line.contains("through\""));
    let with = run("robots/with.urdf");
    assert_eq!(reasons(&with), [FailureReason::Collision]);
    assert_eq!(with.outcome.end, EndState::Failed);
    assert!(!through(&with), "the program went on");

    let without = run("robots/without.urdf");
    assert!(!reasons(&without).contains(&FailureReason::Collision));
    assert!(through(&without), "{:?}", without.outcome.end_detail);
}

#[test]
fn the_planner_keeps_a_mesh_out_of_the_cell() {
    let mesh = r#"<mesh filename="package://maker_support/plate.obj"/>"#;
    let with = ArmWithMesh::new("mesh_planned", "link_6", mesh).run("robots/with.urdf", &[]);
    assert_eq!(with.delivered(), 0);
    assert_eq!(reasons(&with), [FailureReason::PlanCollision]);

    // A twentieth of it is in nobody's way.
    let mesh = r#"<mesh filename="package://maker_support/plate.obj" scale="0.05 0.05 0.05"/>"#;
    let small = ArmWithMesh::new("mesh_small", "link_6", mesh).run("robots/with.urdf", &[]);
    assert!(small.delivered() > 0, "{:?}", reasons(&small));
    assert_eq!(
        reasons(&small),
        [FailureReason::Timeout],
        "until the time is up"
    );
}

#[test]
fn the_camera_sees_a_mesh() {
    let mesh = r#"<mesh filename="package://maker_support/lid.obj" scale="0.001 0.001 0.001"/>"#;
    let arm = ArmWithMesh::new("mesh_seen", "base_link", mesh);
    let with = arm.run("robots/with.urdf", &[]);
    assert_eq!(reasons(&with), [FailureReason::NoDetection]);
    assert_eq!(with.outcome.score.picks.len(), 0);
    let without = arm.run("robots/without.urdf", &[]);
    assert!(without.delivered() > 0, "{:?}", reasons(&without));
    assert_eq!(
        reasons(&without),
        [FailureReason::Timeout],
        "until the time is up"
    );
}

/// An arm that would pass through things for want of a file is refused, with the line and what to write.
#[test]
fn a_mesh_that_is_not_there_stops_the_scene() {
    let mesh = r#"<mesh filename="package://other_support/plate.obj"/>"#;
    let arm = ArmWithMesh::new("mesh_lost", "link_6", mesh);
    let urdf = arm
        .folder
        .join("robots/with.urdf")
        .to_string_lossy()
        .into_owned();
    let overrides = [("robot.urdf".to_owned(), urdf.clone())];
    let scene = Scene::demo(&overrides, Some(1)).unwrap_or_else(|error| panic!("{error}"));
    let error = match scene.build() {
        Ok(_) => panic!("it was built"),
        Err(error) => error.to_string(),
    };
    let text = fs::read_to_string(&urdf).expect("written");
    let before = text.find("<mesh").expect("the mesh");
    let line = text[..before].matches('\n').count() + 1;
    let expected = format!(
        "robot.urdf: {urdf}:{line}: link 'link_6' <collision>: mesh 'package://other_support/plate.obj': package 'other_support'"
    );
    assert!(error.starts_with(&expected), "{error}");
    assert!(error.contains("nor in robot.packages"), "{error}");
}
