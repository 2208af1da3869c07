use std::fmt::Write as _;

use super::{DEMO, load};

/// The demo with one line replaced (or put at the end), and what loading it says.
pub(super) fn told(found: &str, replacement: &str, overrides: &[(&str, &str)]) -> String {
    let text = if found.is_empty() {
        format!("{DEMO}{replacement}\n")
    } else {
        assert_eq!(
            DEMO.matches(found).count(),
            1,
            "{found:?} stands once in the demo"
        );
        DEMO.replace(found, replacement)
    };
    let mut page = String::new();
    if !replacement.is_empty() || overrides.is_empty() {
        writeln!(page, "input:  {replacement}").unwrap();
    }
    for (key, value) in overrides {
        writeln!(page, "input:  --set {key}={value}").unwrap();
    }
    let errors = load(&text, overrides).expect_err("a mistake is refused");
    for problem in &errors.problems {
        writeln!(page, "{problem}").unwrap();
        if problem.line > 0 {
            writeln!(page, "    | {}", problem.source_line).unwrap();
            writeln!(page, "    | {}^", " ".repeat(problem.column - 1)).unwrap();
        }
    }
    page
}

#[test]
fn typical_mistakes() {
    let pages = [
        told("noise_mm = 0.5", "nois_mm = 0.5", &[]),
        told("width = 1280", "width = 1280.5", &[]),
        told("size_mm = [400, 300, 250]", "size_mm = [400, -300, 0]", &[]),
        told("size_mm = [400, 300, 250]\n", "", &[]),
        told("mass_kg = [8, 20]", "mass_kg = [20, 8]", &[]),
        told("mass_kg = [8, 20]", "mass_kg = nan", &[]),
        told("encoding = \"hex-le\"", "encoding = \"hex-el\"", &[]),
        told("schema = 1\n", "schema = 2\n", &[]),
        told("name = \"demo\"", "name = demo", &[]),
        told(
            "program = \"demo.mod\"",
            "program = [\"demo.mod\", \"missing.mod\"]",
            &[],
        ),
        told(
            "kind = \"vision_move\", pick",
            "kind = \"vision_mov\", pick",
            &[],
        ),
        told(
            "kind = \"pallet_pattern\", pattern",
            "kind = \"pallet_pattern\", patern",
            &[],
        ),
        told("kind = \"go\", bits = 16", "kind = \"go\", bits = 3", &[]),
        told(
            "look_at_mm = [1700, 0, 0]",
            "rpy_deg = [180, 0, 90]\nlook_at_mm = [1700, 0, 0]",
            &[],
        ),
        told(
            "place_xyz_mm = [500, 1800, 650]",
            "place_xyz_mm = [500, 2200, 650]",
            &[],
        ),
        told("", "[grippers]\nvacuum_kpa = 3", &[]),
        told("", "[pallet]\nyaw_deg = 3", &[]),
        told("count = 48", "count = 40", &[]),
        told("", "", &[("camera.nois_mm", "1.2")]),
        told(
            "",
            "",
            &[("camera.noise_mm", "loud"), ("pallet..xyz_mm", "1")],
        ),
        told(
            "",
            "",
            &[("robot.signal.7.name", "DI_OTHER"), ("seed.x", "1")],
        ),
        told(
            "",
            "",
            &[("gripper.vacuum_kpa", "-2"), ("interface.pose_cap", "31")],
        ),
        told(
            "",
            "",
            &[(
                "interface.inject",
                r#"["no_points@pick=4", "no_point", "delay=2@command=102"]"#,
            )],
        ),
    ];
    insta::assert_snapshot!(pages.join("\n"));
}

#[test]
fn all_problems_of_a_file_come_at_once_in_the_order_of_the_text() {
    let text = DEMO
        .replace("layers = 6", "layers = 0")
        .replace("exposure_s = 0.5", "exposure = 0.5")
        .replace("pose_cap = 20", "pose_cap = \"many\"");
    let errors = load(&text, &[("run.max_sim_s", "0")]).unwrap_err();
    let keys: Vec<&str> = errors
        .problems
        .iter()
        .map(|problem| problem.key.as_str())
        .collect();
    assert_eq!(
        keys,
        [
            "cartons.layers",
            "camera.exposure",
            "interface.pose_cap",
            "run.max_sim_s"
        ]
    );
    assert!(
        errors.problems[..3]
            .windows(2)
            .all(|pair| pair[0].line < pair[1].line)
    );
}

#[test]
fn several_syntax_errors_are_all_told() {
    let errors = load("schema = \n[camera\nwidth = = 3\n", &[]).unwrap_err();
    let lines: Vec<usize> = errors.problems.iter().map(|problem| problem.line).collect();
    assert!(lines.contains(&1) && lines.contains(&3), "{errors}");
}

#[test]
fn edges_are_no_rounder_than_the_shortest_side_allows() {
    let message = |overrides: &[(&str, &str)]| {
        let errors = load(DEMO, overrides).unwrap_err();
        assert_eq!(errors.problems.len(), 1, "{errors}");
        assert_eq!(errors.problems[0].key, "cartons.edge_radius_mm");
        errors.problems[0].message.clone()
    };
    for (radius, found) in [("-1", "-1"), ("51", "51")] {
        let told = message(&[("cartons.edge_radius_mm", radius)]);
        assert!(told.contains("0 to 50") && told.contains(found), "{told}");
    }
    let flat = ("cartons.size_mm", "[400, 300, 30]");
    assert_eq!(
        message(&[flat, ("cartons.edge_radius_mm", "16")]),
        "expected at most 15 (half of the shortest side of a carton), found 16"
    );
    assert!(load(DEMO, &[flat, ("cartons.edge_radius_mm", "15")]).is_ok());
}
