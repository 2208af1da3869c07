use std::io;

use depal_frames::Vector;
use proptest::prelude::*;

use super::{DEMO, any_file, demo, load, sets};
use crate::*;

#[test]
fn the_demo_says_what_it_promises() {
    let scene = demo(&[]);
    assert_eq!(scene.cartons.total(), 48);
    assert_eq!(
        scene.cartons.mass_kg,
        Span {
            min: 8.0,
            max: 20.0
        }
    );
    assert_eq!(
        scene.robot.urdf.path,
        "scenes/../urdf/abb_irb6700_150_320.urdf"
    );
    assert!(scene.robot.module.is_empty(), "the language's own");
    assert_eq!(scene.gripper.section.len(), 4);
    assert_eq!(scene.accept.delivered_min, Some(48.0));
    assert!(!scene.camera.blackout);
}

#[test]
fn overrides_reach_keys_that_the_file_does_not_have() {
    let scene = demo(&[
        ("camera.blackout", "true"),
        ("camera.noise_mm", "1.2"),
        ("cartons.mass_kg", "150"),
        ("gripper.vacuum_kpa", "9"),
        ("gripper.vacuum_kpa", "2"),
        ("interface.encoding", "hex-be"),
        ("vision.project.0.id", "7"),
        ("viz.steps.0.project", "7"),
        ("robot.signal.1.name", "DI_7"),
        ("gripper.vacuum_signal", "DI_7"),
        ("randomize", "{ yaw_deg = 1 }"),
        ("name", "2026"),
    ]);
    assert!(scene.camera.blackout);
    assert_eq!(scene.camera.noise_mm, 1.2);
    assert_eq!(scene.cartons.mass_kg, Span::of(150.0));
    assert_eq!(scene.gripper.vacuum_kpa, 2.0, "the later one wins");
    assert_eq!(scene.interface.encoding, WireEncoding::HexBe);
    assert_eq!(scene.vision.project[0].id, 7);
    assert_eq!(scene.robot.signal[1].name, "DI_7");
    assert_eq!(scene.randomize.yaw_deg, 1.0);
    assert_eq!(scene.randomize.shift_mm, 1.0, "a table is merged");
    assert_eq!(scene.name, "2026");
}

#[test]
fn files_are_beside_the_scene_or_in_the_working_directory() {
    let paths = |scene: &Scene| -> Vec<String> {
        scene
            .robot
            .program
            .iter()
            .map(|file| file.path.clone())
            .collect()
    };
    assert_eq!(paths(&demo(&[])), ["scenes/demo.mod"]);
    assert_eq!(
        paths(&demo(&[("robot.program", "crash.mod")])),
        ["crash.mod"]
    );
    assert_eq!(
        paths(&demo(&[("robot.program", "['a.mod', '/tmp/b.mod']")])),
        ["a.mod", "/tmp/b.mod"]
    );
    assert_eq!(demo(&[]).robot.program[0].text, "text of scenes/demo.mod");

    let inside = Scene::load(DEMO, "embedded:scenes/demo.toml", &[], None, &any_file).unwrap();
    assert_eq!(paths(&inside), ["embedded:scenes/demo.mod"]);
    assert_eq!(
        inside.robot.urdf.path,
        "embedded:urdf/abb_irb6700_150_320.urdf"
    );
}

#[test]
fn real_files_are_read() {
    let text = read_text(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenes/demo.toml"
    ))
    .unwrap();
    assert_eq!(text, DEMO);
    assert_eq!(read_text("embedded:scenes/demo.toml").unwrap(), DEMO);
    assert!(read_text("embedded:scenes/none.toml").is_err());
}

/// A file that is not there is answered with what there is.
#[test]
fn a_wrong_path_gets_the_nearest_right_one() {
    let told = |path: &str| {
        let path = format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"));
        let errors = Scene::load_file(&path, &[], None).unwrap_err();
        let root = format!("{}/../../", env!("CARGO_MANIFEST_DIR"));
        errors.to_string().replace(&root, "")
    };
    let cannot = "cannot read the scene: No such file or directory (os error 2)";
    assert_eq!(
        told("scenes/demp.toml"),
        format!("scenes/demp.toml: {cannot}; did you mean \"scenes/demo.toml\"?")
    );
    assert_eq!(
        told("scenes/demo"),
        format!("scenes/demo: {cannot}; did you mean \"scenes/demo.toml\"?")
    );
    assert_eq!(
        told("no/such/scene.toml"),
        format!("no/such/scene.toml: {cannot}; there is no folder no/such")
    );
    let all = told("scenes/zzz.toml");
    assert!(
        all.contains("; there are scenes/calibration.toml, "),
        "{all}"
    );
    assert!(!all.contains("demo.mod"), "{all}");
    let folder = told("urdf");
    assert!(folder.contains("name a file in it: urdf/"), "{folder}");
    assert_eq!(
        told("scenes/demo.mod"),
        "scenes/demo.mod: expected a scene (.toml), found a RAPID program; name it in a scene as robot.program"
    );
    let inside = read_text("embedded:scenes/none.toml").unwrap_err();
    assert_eq!(inside.to_string(), "no such file inside the program");
}

/// A bracket that is left open spoils all that follows: it is not told line by line.
#[test]
fn a_slip_in_the_syntax_is_told_in_a_few_lines() {
    let text = DEMO.replacen("[1700, 0, 0]", "[1700, 0, 0", 1);
    let errors = load(&text, &[]).unwrap_err();
    assert_eq!(errors.problems.len(), 3, "{errors}");
    let slip = text
        .lines()
        .position(|line| line.ends_with("[1700, 0, 0"))
        .unwrap()
        + 1;
    assert_eq!(errors.problems[0].line, slip + 1, "{errors}");
    assert!(
        errors.to_string().contains("more lines cannot be read"),
        "{errors}"
    );
    // Two slips of their own are both told.
    let text =
        DEMO.replacen("name = \"demo\"", "name = demo", 1)
            .replacen("width = 1280", "width =", 1);
    let errors = load(&text, &[]).unwrap_err();
    assert_eq!(errors.problems.len(), 2, "{errors}");
}

#[test]
fn the_seed_of_the_command_line_wins() {
    let seed = |asked| {
        Scene::load(DEMO, "demo.toml", &sets(&[("seed", "5")]), asked, &any_file)
            .unwrap()
            .seed
    };
    assert_eq!((seed(None), seed(Some(9))), (5, 9));
}

fn chain(path: &str) -> io::Result<String> {
    match path {
        "scenes/base.toml" => Ok(DEMO.to_owned()),
        "scenes/broken.toml" => Ok(DEMO.replace("width = 1280", "width = 0")),
        "scenes/loop.toml" => Ok("extends = \"demo.toml\"".to_owned()),
        path => any_file(path),
    }
}

#[test]
fn a_scene_extends_another() {
    let load = |text: &str| Scene::load(text, "scenes/demo.toml", &[], None, &chain);
    let scene =
        load("extends = \"base.toml\"\nname = \"two columns\"\n[camera]\nnoise_mm = 2\n").unwrap();
    assert_eq!(
        (scene.name.as_str(), scene.camera.noise_mm),
        ("two columns", 2.0)
    );
    assert_eq!(scene.camera.width, 1280);

    let replaced =
        load("extends = \"base.toml\"\n[viz]\nsteps = [{ id = 9, kind = \"external_move\" }]\n")
            .unwrap();
    assert_eq!(replaced.viz.steps.len(), 1, "lists are replaced whole");

    let problem = |text: &str| load(text).unwrap_err().problems[0].clone();
    let broken = problem("extends = \"broken.toml\"");
    assert_eq!(
        (broken.source.as_str(), broken.key.as_str()),
        ("scenes/broken.toml", "camera.width")
    );
    assert!(
        problem("extends = \"loop.toml\"")
            .message
            .contains("does not extend itself")
    );
    assert!(
        problem("extends = \"missing.toml\"")
            .message
            .contains("cannot read scenes/missing.toml")
    );
}

#[test]
fn the_demo_camera_looks_straight_down_with_its_long_side_along_y() {
    let world_from_camera = demo(&[]).camera.carrier_from_camera();
    let axis = |axis: Vector| world_from_camera.rotation * axis;
    assert!((axis(Vector::x()) - Vector::y()).norm() < 1e-12);
    assert!((axis(Vector::y()) - Vector::x()).norm() < 1e-12);
    assert!((axis(Vector::z()) + Vector::z()).norm() < 1e-12);
    assert!((world_from_camera.translation.vector - Vector::new(1.7, 0.0, 3.7)).norm() < 1e-12);
    let by_angles = DEMO.replace("look_at_mm = [1700, 0, 0]", "rpy_deg = [180, 0, 90]");
    let turned = load(&by_angles, &[]).unwrap().camera.carrier_from_camera();
    assert!(turned.rotation.angle_to(&world_from_camera.rotation) < 1e-9);
}

#[test]
fn deep_nesting_is_refused_without_harm() {
    let deep = format!("a = {}1{}", "[".repeat(60), "]".repeat(60));
    assert!(load(&deep, &[]).is_err());
    assert!(load(DEMO, &[(&"a.".repeat(500), "1")]).is_err());
    assert!(load(&"[a.b]\n".repeat(200), &[]).is_err());
    assert!(load(&format!("{}a = 1", "a.".repeat(50_000)), &[]).is_err());
    assert!(load(&format!("[{}a]", "a.".repeat(50_000)), &[]).is_err());
}

/// Lines of the demo with one piece cut out, doubled or replaced.
fn damaged() -> impl Strategy<Value = String> {
    let letters = DEMO.chars().count();
    (
        0..letters,
        0_usize..40,
        "[-\\[\\]{}=.,\"a-z0-9_ \n\u{e4}]{0,8}",
    )
        .prop_map(|(start, length, put)| {
            let head = DEMO.chars().take(start);
            let tail = DEMO.chars().skip(start + length);
            head.chain(put.chars()).chain(tail).collect()
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_text_makes_it_panic(text in "\\PC{0,300}") {
        let _ = load(&text, &[]);
    }

    #[test]
    fn no_damage_makes_it_panic(text in damaged()) {
        if let Err(errors) = load(&text, &[]) {
            prop_assert!(!errors.problems.is_empty());
            for problem in &errors.problems {
                prop_assert!(problem.line <= text.lines().count() + 1);
            }
        }
    }

    #[test]
    fn no_override_makes_it_panic(key in "[a-z_.0-9]{0,30}", value in "\\PC{0,30}") {
        let _ = load(DEMO, &[(&key, &value)]);
        let _ = load(DEMO, &[(&format!("camera.{key}"), &value)]);
        let _ = load(DEMO, &[("cartons.mass_kg", &value)]);
    }

    #[test]
    fn whatever_loads_can_be_laid_out(
        layers in 1..4_u32, columns in 1..4_u32, rows in 1..5_u32,
        gap in 0.0..20.0_f64, yaw in 0.0..5.0_f64, shift in 0.0..10.0_f64, seed in any::<u64>(),
    ) {
        let text = DEMO.replace("count = 48\n", "").replace("delivered_min = 48\n", "");
        let scene = load(&text, &[
            ("cartons.layers", &layers.to_string()),
            ("cartons.size_mm", "[200, 150, 100]"),
            ("cartons.pattern", &format!("{{ columns = {columns}, rows = {rows} }}")),
            ("randomize.gap_mm", &gap.to_string()),
            ("randomize.yaw_deg", &yaw.to_string()),
            ("randomize.shift_mm", &shift.to_string()),
        ]).unwrap();
        let cartons = carton_layout(&scene, depal_time::RandomStreams::new(seed));
        prop_assert_eq!(cartons.len() as u32, layers * columns * rows);
        prop_assert!(super::layout::closest_mm(&cartons) >= gap - 1e-6);
    }
}
