use depal_frames::{Point, Shape, Vector};
use depal_time::RandomStreams;
use std::f64::consts::PI;
use std::fmt::Write;

use super::{FILE, IRB6700};
use crate::{Arm, ArmWarning, hull, mesh};

/// Corners of a box with sides 0.4, 0.2 and 0.1 m around (0.1, 0, 0.05).
fn corners() -> Vec<[f64; 3]> {
    (0..8)
        .map(|k| {
            let side = |bit: usize, half: f64| if k & bit == 0 { -half } else { half };
            [0.1 + side(1, 0.2), side(2, 0.1), 0.05 + side(4, 0.05)]
        })
        .collect()
}

const TRIANGLES: [[usize; 3]; 4] = [[0, 1, 2], [3, 4, 5], [6, 7, 0], [1, 3, 6]];

fn binary_stl() -> Vec<u8> {
    // Some writers begin binary files like text ones.
    let mut bytes = b"solid from a drawing".to_vec();
    bytes.resize(80, 0);
    bytes.extend((TRIANGLES.len() as u32).to_le_bytes());
    for triangle in TRIANGLES {
        bytes.extend([0; 12]);
        for value in triangle.iter().flat_map(|&i| corners()[i]) {
            bytes.extend((value as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn text_stl() -> String {
    let mut text = "solid box\n".to_owned();
    for triangle in TRIANGLES {
        text += " facet normal 0 0 1\n  outer loop\n";
        for [x, y, z] in triangle.map(|i| corners()[i]) {
            writeln!(text, "   vertex {x} {y:e} {z}").unwrap();
        }
        text += "  endloop\n endfacet\n";
    }
    text + "endsolid box\n"
}

fn obj() -> String {
    let mut text = "# a box\no box\nvn 0 0 1\nvt 0 0\n".to_owned();
    for [x, y, z] in corners() {
        writeln!(text, "v {x} {y} {z} 1.0").unwrap();
    }
    text + "f 1/1/1 2/1/1 3/1/1\n"
}

/// In centimetres, Y up, half as large in a node that doubles it.
fn collada() -> String {
    let values: Vec<String> = corners()
        .iter()
        .flat_map(|[x, y, z]| [*x, *z, -*y])
        .map(|v| format!("{}", v * 50.0))
        .collect();
    format!(
        r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
        <asset><unit name="centimeter" meter="0.01"/><up_axis>Y_UP</up_axis></asset>
        <library_geometries><geometry id="g"><mesh>
        <source id="p"><float_array id="pa" count="24">{}</float_array><technique_common>
        <accessor source="#pa" count="8" stride="3"/></technique_common></source>
        <vertices id="v"><input semantic="POSITION" source="#p"/></vertices></mesh></geometry></library_geometries>
        <library_visual_scenes><visual_scene id="s"><node><translate>5 0 0</translate><node>
        <matrix>2 0 0 -5 0 2 0 0 0 0 2 0 0 0 0 1</matrix><instance_geometry url="#g"/></node></node></visual_scene>
        </library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"##,
        values.join(" ")
    )
}

#[test]
fn every_format_gives_the_same_corners() {
    let files = [
        ("a.STL", binary_stl()),
        ("b.stl", text_stl().into_bytes()),
        ("package://x/c.obj", obj().into_bytes()),
        ("d.dae", collada().into_bytes()),
    ];
    for (name, bytes) in files {
        let points = mesh::points(name, &bytes).unwrap_or_else(|why| panic!("{name}: {why}"));
        for [x, y, z] in corners() {
            let corner = Point::new(x, y, z);
            assert!(
                points.iter().any(|p| (p - corner).norm() < 1e-6),
                "{name}: {corner} not among {points:?}"
            );
        }
        let (pose, shape) = hull::around(&points);
        let Shape::Hull(hull) = shape else {
            panic!("{name}: {shape:?}")
        };
        assert_eq!((hull.vertices().len(), hull.triangles().len()), (8, 12));
        assert!((pose.translation.vector - Vector::new(0.1, 0.0, 0.05)).norm() < 1e-6);
    }
}

#[test]
fn what_is_no_mesh_says_so() {
    let says = |name: &str, bytes: &[u8], expected: &str| {
        let said = mesh::points(name, bytes).unwrap_err();
        assert!(said.contains(expected), "{said}");
    };
    says("a.glb", b"glTF", "files of kind 'glb' are not read");
    says("a.stl", b"", "neither a binary nor a text STL");
    says("a.stl", &binary_stl()[..200], "4 triangles announced");
    says("a.stl", &[0; 200], "no corner points");
    says("a.obj", b"v 1 2\n", "2 numbers, expected 3");
    says("a.obj", b"v 1 2 nan\n", "not finite");
    says("a.dae", b"<COLLADA><asset>", "no whole <COLLADA>");
    says(
        "a.dae",
        collada().replace("#p", "#q").as_bytes(),
        "'q'".trim_matches('\''),
    );
    let ring = collada().replace(
        "<library_visual_scenes>",
        r##"<library_nodes><node id="n"><instance_node url="#n"/></node></library_nodes><library_visual_scenes>"##,
    );
    let ring = ring.replace(
        "<instance_geometry",
        r##"<instance_node url="#n"/><instance_geometry"##,
    );
    says("a.dae", ring.as_bytes(), "in a ring");
}

#[test]
fn a_hull_holds_all_points_and_hardly_more() {
    let mut random = RandomStreams::new(4).stream("hull");
    for body in 0..20 {
        // A ball pulled long, with random points on it.
        let stretch = [1.0, 0.2 + 0.05 * f64::from(body), 0.6];
        let points: Vec<Point> = (0..3000)
            .map(|_| {
                let (z, turn) = (random.uniform(-1.0, 1.0), random.uniform(0.0, 2.0 * PI));
                let round = (1.0_f64 - z * z).sqrt();
                Point::new(
                    round * turn.cos() * stretch[0] + 0.3,
                    round * turn.sin() * stretch[1],
                    z * stretch[2],
                )
            })
            .collect();
        let (pose, shape) = hull::around(&points);
        let Shape::Hull(hull) = shape else {
            panic!("{shape:?}")
        };
        let at = |i: u32| pose * hull.vertices()[i as usize];
        let mut farthest: f64 = f64::NEG_INFINITY;
        for triangle in hull.triangles() {
            let [a, b, c] = triangle.map(at);
            let normal = (b - a).cross(&(c - a)).normalize();
            let out = points.iter().map(|p| normal.dot(&(p - a)));
            let out = out.fold(f64::NEG_INFINITY, f64::max);
            assert!(out < 1e-9, "a point is {out} m outside");
            farthest = farthest.max(-out);
        }
        assert!(farthest < 0.03, "a face is {farthest} m too far out");
    }
}

#[test]
fn flat_and_tiny_clouds_become_boxes() {
    let sheet: Vec<Point> = (0..20)
        .map(|i| Point::new(f64::from(i % 5), f64::from(i / 5), 0.7))
        .collect();
    let (pose, shape) = hull::around(&sheet);
    assert!(
        matches!(shape, Shape::Cuboid { half_extents } if half_extents.z == 5e-4 && half_extents.x == 2.0)
    );
    assert!((pose.translation.z - 0.7).abs() < 1e-12);
    let (_, shape) = hull::around(&[Point::new(1.0, 1.0, 1.0)]);
    assert!(matches!(shape, Shape::Cuboid { .. }));
}

#[test]
fn collision_meshes_of_a_description_become_hulls() {
    let text = IRB6700.replace(
        r#"<box size="0.86 0.72 0.06"/>"#,
        r#"<mesh filename="package://maker/foot.obj" scale="1 1 -2"/>"#,
    );
    let source = |name: &str| match name {
        "package://maker/foot.obj" => Ok(obj().into_bytes()),
        other => Err(format!("no such file: {other}")),
    };
    let arm = Arm::from_urdf_uniform_with_meshes(&text, FILE, 2.0, &source).unwrap();
    assert!(matches!(
        arm.warnings(),
        [ArmWarning::MeshSkipped {
            element: "visual",
            ..
        }]
    ));
    let Shape::Hull(hull) = &arm.links()[0].collision[0].shape else {
        panic!("{:?}", arm.links()[0].collision[0])
    };
    let half = hull.half_extents();
    assert!((half - Vector::new(0.2, 0.1, 0.1)).norm() < 1e-9, "{half}");
    let lost = |_: &str| Err("not found".to_owned());
    let arm = Arm::from_urdf_uniform_with_meshes(&text, FILE, 2.0, &lost).unwrap();
    assert!(arm.warnings().iter().any(|w| {
        w.to_string().split_once(": ").unwrap().1 == "link 'base_link' <collision>: mesh 'package://maker/foot.obj': not found; the link has no such body there"
    }));
}

/// A mesh drawn in millimetres without a scale would fill the hall: no such arm, but what to write instead.
#[test]
fn a_mesh_in_millimetres_is_refused_with_the_mend() {
    let with = |scale: &str| {
        let text = IRB6700.replace(
            r#"<box size="0.86 0.72 0.06"/>"#,
            &format!(r#"<mesh filename="foot.obj" {scale}/>"#),
        );
        let source = |_: &str| {
            let mut text = String::new();
            for corner in corners() {
                let [x, y, z] = corner.map(|c| c * 1e3);
                writeln!(text, "v {x} {y} {z}").unwrap();
            }
            Ok(text.into_bytes())
        };
        Arm::from_urdf_uniform_with_meshes(&text, FILE, 2.0, &source)
    };
    let error = with("").unwrap_err().to_string();
    assert!(
        error.contains(
            "link 'base_link' <collision> <mesh> 'foot.obj': 458 m long, expected at most 20 m"
        ) && error.contains("scale=\"0.001 0.001 0.001\""),
        "{error}"
    );
    assert!(with(r#"scale="0.001 0.001 0.001""#).is_ok());
}

/// A link of which nothing could be drawn but a visual mesh is drawn as its solids.
#[test]
fn solids_are_drawn_where_the_visual_is_a_mesh_alone() {
    let text = r#"<robot name="r"><link name="a"><visual><geometry><mesh filename="a.dae"/></geometry>
        <material name="red"><color rgba="1 0 0 1"/></material></visual>
        <collision><geometry><box size="1 1 1"/></geometry></collision></link><link name="b"/>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="1" velocity="1"/></joint></robot>"#;
    let arm = Arm::from_urdf_uniform(text, FILE, 2.0).unwrap();
    let drawn = &arm.links()[0].visual;
    assert_eq!(drawn.len(), 1);
    assert_eq!(
        (&drawn[0].0, drawn[0].1),
        (&arm.links()[0].collision[0], [255, 0, 0])
    );
}
