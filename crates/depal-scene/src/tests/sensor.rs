//! The keys of the sensor, from the word in a scene to what is in the picture.

use depal_camera::{CameraSpec, Capture, Material, RenderShape, SensorSpec, capture};
use depal_cell::cell::render_shapes;
use depal_frames::{Pose, Shape};
use depal_world::World;

use super::mistakes::told;
use super::{DEMO, load, sets};
use crate::choice::Choice as _;
use crate::*;

/// A picture with the demo's look at the pallet, a quarter of its pixels.
const SMALL: [(&str, &str); 3] = [
    ("camera.width", "640"),
    ("camera.height", "512"),
    ("camera.focal_px", "[800, 800]"),
];

fn real(text: &str, overrides: &[(&str, &str)]) -> Scene {
    let name = "embedded:scenes/demo.toml";
    Scene::load(text, name, &sets(overrides), None, &read_text)
        .unwrap_or_else(|errors| panic!("{errors}"))
}

fn camera(overrides: &[(&str, &str)]) -> CameraSpec {
    real(DEMO, overrides).cell_spec().unwrap().camera
}

fn sensor(overrides: &[(&str, &str)]) -> SensorSpec {
    camera(overrides).sensor
}

fn words() -> Vec<&'static str> {
    SensorTerm::WORDS.iter().map(|(word, _)| *word).collect()
}

/// Every word but these, as in `--set`.
fn all_but(kept: &[&str]) -> String {
    let left_out: Vec<&str> = words().into_iter().filter(|w| !kept.contains(w)).collect();
    left_out.join(",")
}

/// What the demo's camera sees before the run: the stack as laid out, one carton of it nearly black.
fn picture(overrides: &[(&str, &str)]) -> Capture {
    let overrides: Vec<_> = SMALL.iter().chain(overrides).copied().collect();
    let spec = real(DEMO, &overrides).cell_spec().unwrap();
    let mut world = World::new(&spec.world);
    for carton in &spec.cartons {
        world.add_carton(carton);
    }
    let mut shapes = render_shapes(&world, &spec.skins);
    let cartons = shapes.iter_mut().filter(|s| s.material == Material::KRAFT);
    cartons.last().unwrap().material = Material::matt(0.01);
    capture(&spec.camera, &spec.world_from_camera(None), &shapes, 1)
}

#[test]
fn what_is_wrong_with_the_sensor_keys() {
    let sensor = |text: &str| told("noise_mm = 0.5", text, &[]);
    let pages = [
        sensor(r#"without = ["shadow", "bowll", "noise"]"#),
        sensor(r#"without = ["quantization"]"#),
        sensor(r#"without = ["bowl", "shadow", "bowl"]"#),
        sensor("without = 3"),
        sensor(r#"without = "shadow, bowl""#),
        sensor(r#"filters = ["mean"]"#),
        sensor("hdr = 1"),
        sensor("device_seed = -1"),
        sensor("noise_at_mm = 2000"),
        told("", "", &[("camera.without", "shadwo,bowl")]),
        told("", "", &[("camera.without", r#"["shadow", "shadow"]"#)]),
        told(
            "sensor = \"laser\"",
            "sensor = \"laser-2m\"",
            &[("camera.noise_mm", "0.2"), ("camera.filter", "median")],
        ),
        told(
            "",
            "",
            &[
                ("camera.sensor", "ideal"),
                ("camera.filters", "median"),
                ("camera.noise_mm", "0.2"),
            ],
        ),
    ];
    insta::assert_snapshot!(pages.join("\n"));
}

#[test]
fn each_word_taken_away_changes_the_picture() {
    let whole = |preset| picture(&[("camera.sensor", preset)]);
    let (laser, flight, stereo) = (
        whole("laser"),
        whole("time-of-flight"),
        whole("active-stereo"),
    );
    for word in words() {
        let (preset, whole) = match word {
            "distance_bias" => ("time-of-flight", &flight),
            "disparity_steps" => ("active-stereo", &stereo),
            _ => ("laser", &laser),
        };
        let less = picture(&[("camera.sensor", preset), ("camera.without", word)]);
        let of_light = ["lens_blur", "intensity_noise"].contains(&word);
        assert_eq!(less.frame.depth == whole.frame.depth, of_light, "{word}");
        assert!(less.frame != whole.frame, "{word}");
    }
}

#[test]
fn all_words_taken_away_leave_the_exact_picture() {
    let ideal = picture(&[("camera.sensor", "ideal")]);
    assert_eq!(ideal.frame.depth, ideal.ideal_depth);
    for (preset, _) in SensorPreset::WORDS {
        let bare = picture(&[
            ("camera.sensor", preset),
            ("camera.without", &all_but(&[])),
            ("camera.device_seed", "77"),
        ]);
        assert!(bare == ideal, "{preset}");
    }
}

/// A term that is added to the model and has no word shows here.
#[test]
fn the_words_are_the_whole_model() {
    for (preset, _) in SensorPreset::WORDS {
        let bare = sensor(&[("camera.sensor", preset), ("camera.without", &all_but(&[]))]);
        let none = SensorSpec {
            // Over-exposure has a key of its own; the others say how much of nothing.
            hdr: bare.hdr,
            correlation_px: bare.correlation_px,
            disparity_base: bare.disparity_base,
            ..SensorSpec::ideal()
        };
        assert_eq!(bare, none, "{preset}");
        assert_eq!(bare.hdr, *preset == "ideal");
    }
}

#[test]
fn without_these_keys_a_sensor_is_its_preset() {
    let preset = |word: &str| sensor(&[("camera.sensor", word)]);
    assert_eq!(preset("laser"), SensorSpec::laser_3m());
    assert_eq!(preset("laser-3m"), SensorSpec::laser_3m());
    assert_eq!(preset("laser-2m"), SensorSpec::laser_2m());
    assert_eq!(preset("active-stereo"), SensorSpec::active_stereo());
    assert_eq!(preset("time-of-flight"), SensorSpec::time_of_flight());
    assert_eq!(sensor(&[("camera.noise_mm", "1.2")]).axial_noise, 0.0012);
}

#[test]
fn lists_are_written_as_a_shell_allows() {
    let without = |value| {
        let scene = load(DEMO, &[("camera.without", value)]).unwrap();
        scene.camera.without
    };
    let both = [SensorTerm::Shadow, SensorTerm::Bowl];
    for value in [
        r#"["shadow", "bowl"]"#,
        "['shadow', 'bowl']",
        "[shadow, bowl]",
        "shadow,bowl",
        "\"shadow, bowl\"",
    ] {
        assert_eq!(without(value), both, "{value}");
    }
    assert_eq!(without("shadow"), both[..1]);
    assert_eq!(without("[]"), []);
    assert_eq!(without(""), []);
    // The list of a scene is replaced, not added to.
    let text = DEMO.replace("noise_mm = 0.5", "without = \"bowl\"");
    let scene = load(&text, &[("camera.without", "shadow")]).unwrap();
    assert_eq!(scene.camera.without, both[..1]);
    assert_eq!(load(&text, &[]).unwrap().camera.without, both[1..]);
}

/// Deviation of depth on a wall of brown board, mm.
fn deviation_mm(distance: f64, overrides: &[(&str, &str)]) -> f64 {
    let quiet = all_but(&["axial_noise", "weak_signal", "falloff"]);
    let mut keys = vec![
        ("camera.without", quiet.as_str()),
        ("camera.near_mm", "100"),
    ];
    keys.extend(SMALL.iter().chain(overrides));
    let spec = camera(&keys);
    let wall = RenderShape {
        world_from_shape: Pose::translation(0.0, 0.0, distance + 0.1),
        shape: Shape::cuboid(20.0, 20.0, 0.2),
        id: 1,
        material: Material::KRAFT,
        edge_radius: 0.0,
    };
    let shot = capture(&spec, &Pose::identity(), &[wall], 3);
    let middle = (200..312).flat_map(|v| (264..376).map(move |u| v * 640 + u));
    let errors: Vec<f64> = middle
        .map(|p| f64::from(shot.frame.depth[p]) - f64::from(shot.ideal_depth[p]))
        .collect();
    let squares: f64 = errors.iter().map(|e| e * e).sum();
    1e3 * (squares / errors.len() as f64).sqrt()
}

#[test]
fn the_noise_of_a_data_sheet_is_found_on_a_wall_at_its_distance() {
    for (preset, noise, at) in [
        ("laser", "0.3", "2000"),
        ("laser-2m", "0.1", "2000"),
        ("laser-2m", "0.7", "4000"),
        ("laser-3m", "0.2", "1000"),
        ("active-stereo", "1", "1000"),
        ("time-of-flight", "2", "1500"),
    ] {
        let keys = [
            ("camera.sensor", preset),
            ("camera.noise_mm", noise),
            ("camera.noise_at_mm", at),
        ];
        let (noise, at): (f64, f64) = (noise.parse().unwrap(), at.parse().unwrap());
        let found = deviation_mm(at * 1e-3, &keys);
        // The projector stands aside and lights the wall a little obliquely: up to 2 % more at 1 m.
        assert!((0.96..1.04).contains(&(found / noise)), "{preset} {found}");
        let halfway = deviation_mm(at * 0.5e-3, &keys);
        assert!(halfway < 0.3 * noise, "{preset} {halfway} at half of {at}");
    }
    // A scene's figure for the plain laser is not another sensor's.
    let found = deviation_mm(2.0, &[("camera.sensor", "laser-2m")]);
    assert!((0.096..0.104).contains(&found), "{found}");
    let none = [
        ("camera.noise_at_mm", "2000"),
        ("camera.without", "axial_noise"),
    ];
    assert_eq!(sensor(&none).axial_noise, 0.0);
}

#[test]
fn a_device_keeps_its_bowl_over_the_seeds_of_runs() {
    let bowl_alone = all_but(&["bowl", "scale_error"]);
    let look = |device, seed| {
        picture(&[
            ("camera.without", &bowl_alone),
            ("camera.device_seed", device),
            ("seed", seed),
            ("randomize.shift_mm", "0"),
            ("randomize.yaw_deg", "0"),
            ("randomize.gap_mm", "3"),
        ])
        .frame
        .depth
    };
    let one = look("1", "1");
    assert!(one == look("1", "2"));
    assert!(one != look("2", "1"));
}

#[test]
fn filters_and_several_exposures_reach_the_sensor() {
    let s = sensor(&[("camera.filters", "median"), ("camera.hdr", "true")]);
    assert!(s.median && s.hdr && !s.outlier_removal);
    let s = sensor(&[("camera.filters", "[\"median\", \"outlier_removal\"]")]);
    assert!(s.median && s.outlier_removal && !s.hdr);
    let plain = picture(&[]);
    for filter in ["median", "outlier_removal"] {
        assert!(picture(&[("camera.filters", filter)]) != plain, "{filter}");
    }
}

#[test]
fn the_ideal_sensor_is_exact_whatever_a_scene_asks_of_another() {
    let text = DEMO.replace(
        "noise_mm = 0.5",
        "noise_mm = 0.2\nnoise_at_mm = 2000\nfilters = \"median\"\nwithout = \"bowl\"\ndevice_seed = 5",
    );
    let ideal = [("camera.sensor", "ideal")];
    let spec = |text: &str| real(text, &ideal).cell_spec().unwrap().camera;
    assert_eq!(spec(&text), spec(DEMO));
    // Leaving out what is not there asks for nothing that is not given.
    let words = [("camera.sensor", "ideal"), ("camera.without", "shadow")];
    assert_eq!(camera(&words), spec(DEMO));
    // A file may keep the keys of the sensor that it had before; on the command line they are meant.
    let edited = text.replace("sensor = \"laser\"", "sensor = \"ideal\"");
    assert_eq!(real(&edited, &[]).cell_spec().unwrap().camera, spec(DEMO));
    let errors = load(&edited, &[("camera.filters", "median")]).unwrap_err();
    assert_eq!(errors.problems[0].key, "camera.filters");
    assert!(
        load(
            &edited,
            &[("camera.filters", "[]"), ("camera.noise_mm", "0")]
        )
        .is_ok()
    );
    assert!(
        load(
            &edited,
            &[("camera.sensor", "laser-2m"), ("camera.filters", "median")]
        )
        .is_ok()
    );
}

#[test]
fn the_lines_that_a_scene_offers_hold_once_their_mark_is_gone() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenes/mixed.toml");
    let text = read_text(path).unwrap();
    let keys = ["without", "noise_at_mm", "device_seed", "filters", "hdr"];
    let offered = keys.map(|key| format!("# {key} = "));
    assert!(offered.iter().all(|line| text.matches(line).count() == 1));
    let taken = offered
        .iter()
        .fold(text.clone(), |text, line| text.replace(line, &line[2..]));
    let camera = |text: &str| {
        let scene = Scene::load(text, path, &[], None, &read_text);
        scene.unwrap_or_else(|errors| panic!("{errors}")).camera
    };
    let camera = (camera(&text), camera(&taken));
    assert_eq!(camera.0.without, []);
    assert_eq!(camera.1.without, [SensorTerm::Shadow, SensorTerm::Bowl]);
    assert_eq!(camera.1.noise_at_mm, Some(2000.0));
    assert_eq!((camera.1.device_seed, camera.1.hdr), (2, true));
    assert_eq!(camera.1.filters.len(), 2);
}
