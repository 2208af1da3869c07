//! Grippers out of files of their own.

use std::io;

use super::{DEMO, sets};
use crate::files::read_text;
use crate::*;

/// The demo with another `[gripper]` section.
fn with_gripper(section: &str) -> String {
    let from = DEMO.find("[gripper]").unwrap();
    let to = DEMO.find("[robot]").unwrap();
    let wiring = "sections_signal = \"goVacuum\"\nvacuum_signal = \"diVacuumOk\"\n";
    format!(
        "{}[gripper]\n{section}\n{wiring}\n{}",
        &DEMO[..from],
        &DEMO[to..]
    )
}

fn load(section: &str, overrides: &[(&str, &str)]) -> Result<Scene, SceneErrors> {
    let files = |path: &str| match path {
        "scenes/own.toml" => Ok(
            "name = \"own\"\ntcp_xyz_mm = [0, 0, 200]\ncup_diametr_mm = 30\n\
             section = [{ digital_output = 2, area_mm = [-50, 50, -50, 50], cups = [1, 1] }]\n"
                .to_owned(),
        ),
        "scenes/loop.toml" => Ok("model = \"single_cup\"\n".to_owned()),
        path if path.starts_with("embedded:") => read_text(path),
        path if path.contains("missing") => {
            Err(io::Error::new(io::ErrorKind::NotFound, "no such file"))
        }
        path => Ok(format!("text of {path}")),
    };
    Scene::load(
        &with_gripper(section),
        "scenes/demo.toml",
        &sets(overrides),
        None,
        &files,
    )
}

fn refusal(section: &str, overrides: &[(&str, &str)]) -> String {
    load(section, overrides).expect_err("refused").to_string()
}

#[test]
fn grippers_are_known_by_name() {
    for (name, sections, cups) in [
        ("foam_4_sections", 4, 84),
        ("bellows_2x6", 12, 12),
        ("single_cup", 1, 1),
    ] {
        let scene = load(&format!("model = {name:?}"), &[]).unwrap_or_else(|e| panic!("{e}"));
        let gripper = &scene.gripper;
        assert_eq!(gripper.section.len(), sections, "{name}");
        let total: u32 = gripper.section.iter().map(|s| s.cups[0] * s.cups[1]).sum();
        assert_eq!(total, cups, "{name}");
        assert!(!gripper.pump_curve.is_empty() && gripper.mass_kg > 5.0);
        // Cups lie inside their sections, and sections in the plate.
        for section in &gripper.section {
            let [x0, x1, y0, y1] = section.area_mm;
            let pitch = [
                (x1 - x0) / f64::from(section.cups[0]),
                (y1 - y0) / f64::from(section.cups[1]),
            ];
            assert!(
                pitch.iter().all(|p| *p >= gripper.cup_diameter_mm),
                "{name}: {pitch:?}"
            );
            assert!(
                x1.abs().max(x0.abs()) <= gripper.plate_mm[0] * 0.5 + 1e-9,
                "{name}"
            );
            assert!(
                y1.abs().max(y0.abs()) <= gripper.plate_mm[1] * 0.5 + 1e-9,
                "{name}"
            );
        }
    }
}

#[test]
fn own_keys_and_overrides_win() {
    let scene = load(
        "model = \"foam_4_sections\"\nvacuum_kpa = 21\nmass_kg = 40",
        &[("gripper.mass_kg", "41")],
    )
    .unwrap();
    assert_eq!(
        (scene.gripper.vacuum_kpa, scene.gripper.mass_kg),
        (21.0, 41.0)
    );
    assert_eq!(scene.gripper.cup_diameter_mm, 36.0);
    assert_eq!(scene.gripper.sections_signal, "goVacuum");
    let scene = load(
        "model = \"foam_4_sections\"",
        &[("gripper.model", "single_cup")],
    )
    .unwrap();
    assert_eq!(scene.gripper.section.len(), 1);
}

#[test]
fn mistakes_are_told_where_they_are() {
    let text = refusal("model = \"foam_4_section\"", &[]);
    assert!(
        text.contains("did you mean \"foam_4_sections\"?") && text.contains("gripper.model"),
        "{text}"
    );
    let text = refusal("model = \"zzz\"", &[]);
    assert!(
        text.contains("bellows_2x6, foam_4_sections, single_cup"),
        "{text}"
    );
    let text = refusal("file = \"missing.toml\"", &[]);
    assert!(text.contains("cannot read scenes/missing.toml"), "{text}");
    let text = refusal("file = \"own.toml\"", &[]);
    assert!(
        text.contains("scenes/own.toml:3") && text.contains("cup_diameter_mm"),
        "{text}"
    );
    let text = refusal("file = \"own.toml\"\nmodel = \"single_cup\"", &[]);
    assert!(text.contains("found both"), "{text}");
    let text = refusal("file = \"loop.toml\"", &[]);
    assert!(text.contains("names no other"), "{text}");
    let text = refusal(
        "model = \"single_cup\"\npump_curve = [[0, 50], [40, 60]]",
        &[],
    );
    assert!(text.contains("flow falling to 0"), "{text}");
    let text = refusal("model = \"single_cup\"\nrated_vacuum_kpa = 60", &[]);
    assert!(text.contains("rated_vacuum_kpa = 60, found 50"), "{text}");
}
