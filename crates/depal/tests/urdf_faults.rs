//! Every fault of an arm's description: `depal check` and `depal kinematics` say the same, with file, line and element.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const KR16: &str = include_str!("../../../urdf/kuka_kr16_2.urdf");

/// A box of 8 corners.
const BOX: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n";

/// Of the description; two folders above it are ours as well.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_TARGET_TMPDIR")).join("urdf_faults/maker/urdf")
}

/// Exit code and stderr, with the folder left out.
fn told(args: &[&str]) -> (i32, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_depal"))
        .args(args)
        .current_dir(folder())
        .env_remove("ROS_PACKAGE_PATH")
        .output()
        .expect("the binary starts");
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!text.contains("panicked"), "{text}");
    let canonical = folder().canonicalize().expect("it was made");
    let text = text.replace(&*canonical.to_string_lossy(), "HERE");
    let mut text = text;
    for (above, name) in canonical.ancestors().skip(1).zip(["MAKER", "TOP"]) {
        text = text.replace(&*above.to_string_lossy(), name);
    }
    (output.status.code().unwrap_or(-1), text)
}

/// The arm with one passage replaced; the first place counts.
fn with(from: &str, to: &str) -> String {
    assert!(KR16.contains(from), "nothing to replace: {from}");
    KR16.replacen(from, to, 1)
}

/// The arm with a body of `link_2` replaced by a mesh.
fn with_mesh(attributes: &str) -> String {
    let link = KR16.find(r#"<link name="link_2">"#).expect("link 2");
    let body = link + KR16[link..].find("<collision").expect("a body");
    let start = body + KR16[body..].find("<geometry>").expect("a shape");
    let end = start + KR16[start..].find("</geometry>").expect("its end");
    let mesh = format!("<geometry><mesh {attributes}/>");
    format!("{}{mesh}{}", &KR16[..start], &KR16[end..])
}

const LIMIT_3: &str = r#"<limit lower="-2.2689280275926285" upper="2.6878070480712677" velocity="2.722713633111154" effort="0"/>"#;
const AXIS_1: &str = r#"<axis xyz="0 0 -1"/>"#;
const MASS: &str = r#"<mass value="49.3"/>"#;
const INERTIA: &str =
    r#"<inertia ixx="0.8988" ixy="0" ixz="0" iyy="1.1936" iyz="0" izz="1.6769"/>"#;
const TOOL: &str = r#"<link name="tool0"/>"#;

/// What is wrong, and a description with it.
fn rows() -> Vec<(&'static str, String)> {
    let mimic = |joint: &str| with(AXIS_1, &format!("{AXIS_1}<mimic joint=\"{joint}\"/>"));
    let again = r#"<joint name="again" type="fixed"><parent link="base_link"/><child link="link_4"/></joint></robot>"#;
    let mut deep = String::new();
    for _ in 0..100 {
        deep += "<a>";
    }
    vec![
        ("a tag that is not closed", with("</robot>", "")),
        ("a tag closed as another", with("</joint>", "</link>")),
        ("not XML", "solid foot\nfacet normal 0 0 1\n".to_owned()),
        ("an empty file", String::new()),
        (
            "another format",
            "<sdf version=\"1.9\">\n</sdf>\n".to_owned(),
        ),
        (
            "macros not expanded",
            with("<robot ", "<robot xmlns:xacro=\"x\" ").replace(TOOL, "<xacro:tool name=\"t\"/>"),
        ),
        (
            "a number of a macro",
            with(
                r#"<origin xyz="0.68 0 0"/>"#,
                r#"<origin xyz="${a2} 0 0"/>"#,
            ),
        ),
        (
            "elements without end inside each other",
            with("</robot>", &format!("{deep}</robot>")),
        ),
        (
            "no joint",
            "<robot name=\"r\">\n<link name=\"a\"/>\n</robot>".to_owned(),
        ),
        ("no link", "<robot name=\"r\">\n</robot>".to_owned()),
        (
            "a joint without parent",
            with(r#"<parent link="link_2"/>"#, ""),
        ),
        (
            "a parent that is not there",
            with(r#"<parent link="link_2"/>"#, r#"<parent link="link_22"/>"#),
        ),
        (
            "a child that is not there",
            with(r#"<child link="link_3"/>"#, r#"<child link="link_33"/>"#),
        ),
        (
            "a cycle",
            with(
                r#"<parent link="base_link"/>"#,
                r#"<parent link="link_6"/>"#,
            ),
        ),
        (
            "two roots",
            with(TOOL, "<link name=\"tool0\"/>\n  <link name=\"lost\"/>"),
        ),
        ("two parents", KR16.replace("</robot>", again)),
        (
            "a link name twice",
            with(TOOL, "<link name=\"tool0\"/>\n  <link name=\"link_3\"/>"),
        ),
        (
            "a joint name twice",
            with(r#"<joint name="joint_3""#, r#"<joint name="joint_2""#),
        ),
        (
            "an unknown joint type",
            with(
                r#"name="joint_3" type="revolute""#,
                r#"name="joint_3" type="hinge""#,
            ),
        ),
        (
            "a joint that arms here do not have",
            with(
                r#"name="joint_3" type="revolute""#,
                r#"name="joint_3" type="prismatic""#,
            ),
        ),
        (
            "no joint type",
            with(r#"name="joint_3" type="revolute""#, r#"name="joint_3""#),
        ),
        ("no limit", with(LIMIT_3, "")),
        (
            "limits the wrong way round",
            with(LIMIT_3, r#"<limit lower="1" upper="-1" velocity="1"/>"#),
        ),
        (
            "limits in degrees",
            with(
                LIMIT_3,
                r#"<limit lower="-130" upper="154" velocity="156"/>"#,
            ),
        ),
        (
            "a limit that is no number",
            with(LIMIT_3, r#"<limit lower="-1,5" upper="2" velocity="1"/>"#),
        ),
        (
            "no speed",
            with(LIMIT_3, r#"<limit lower="-1" upper="2" velocity="0"/>"#),
        ),
        ("two limits", with(LIMIT_3, &format!("{LIMIT_3}{LIMIT_3}"))),
        ("a zero axis", with(AXIS_1, r#"<axis xyz="0 0 0"/>"#)),
        (
            "an axis of two numbers",
            with(AXIS_1, r#"<axis xyz="0 1"/>"#),
        ),
        (
            "NaN in an origin",
            with(
                r#"<origin xyz="0.68 0 0"/>"#,
                r#"<origin xyz="0.68 nan 0"/>"#,
            ),
        ),
        (
            "infinity in an origin",
            with(r#"<origin xyz="0.68 0 0"/>"#, r#"<origin xyz="inf 0 0"/>"#),
        ),
        (
            "millimetres",
            with(r#"<origin xyz="0.68 0 0"/>"#, r#"<origin xyz="680 0 0"/>"#),
        ),
        ("a mass of zero", with(MASS, r#"<mass value="0"/>"#)),
        ("a negative mass", with(MASS, r#"<mass value="-3"/>"#)),
        ("no mass", with(MASS, "")),
        (
            "an inertia of no body",
            with(
                INERTIA,
                r#"<inertia ixx="1" ixy="2" ixz="0" iyy="1" iyz="0" izz="1"/>"#,
            ),
        ),
        (
            "an inertia without a moment",
            with(
                INERTIA,
                r#"<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0"/>"#,
            ),
        ),
        ("a mimic of a joint that is not there", mimic("joint_9")),
        ("a mimic of itself", mimic("joint_1")),
        (
            "mimics in a ring",
            mimic("joint_2").replacen(
                r#"<axis xyz="0 1 0"/>"#,
                r#"<axis xyz="0 1 0"/><mimic joint="joint_1"/>"#,
                1,
            ),
        ),
        (
            "a body without shape",
            with_mesh("filename=\"x\"").replace("<mesh filename=\"x\"/>", ""),
        ),
        (
            "a body of negative size",
            with(
                r#"<collision name="axis 2 hub">"#,
                r#"<collision><geometry><sphere radius="-1"/></geometry></collision><collision name="axis 2 hub">"#,
            ),
        ),
        (
            "a scale of zero",
            with_mesh("filename=\"box.obj\" scale=\"1 0 1\""),
        ),
        (
            "a mesh in millimetres",
            with_mesh("filename=\"box_mm.obj\""),
        ),
        (
            "a mesh that is not there",
            with_mesh("filename=\"meshes/lost.stl\""),
        ),
        (
            "a package that is nowhere",
            with_mesh("filename=\"package://maker_support/arm.stl\""),
        ),
        ("a mesh outside", with_mesh("filename=\"../../secret.stl\"")),
        (
            "a mesh by an absolute path",
            with_mesh("filename=\"/etc/hostname\""),
        ),
        (
            "a mesh from the network",
            with_mesh("filename=\"https://x/y.stl\""),
        ),
        ("a mesh of 2 GB", with_mesh("filename=\"huge.stl\"")),
        ("a mesh that is cut off", with_mesh("filename=\"cut.stl\"")),
        (
            "a mesh of an unknown kind",
            with_mesh("filename=\"arm.glb\""),
        ),
    ]
}

#[test]
fn every_fault_names_file_line_and_element() {
    let folder = folder();
    fs::create_dir_all(&folder).expect("a writable folder");
    let write = |name: &str, bytes: &[u8]| fs::write(folder.join(name), bytes).expect("writable");
    write("box.obj", BOX.as_bytes());
    write("box_mm.obj", BOX.replace('1', "1000").as_bytes());
    write(
        "cut.stl",
        &[[0; 80].as_slice(), &[200, 0, 0, 0, 1, 2, 3]].concat(),
    );
    write("arm.glb", b"glTF");
    write("../../secret.stl", b"solid secret");
    // 2 GB that take no room on the disk.
    let huge = fs::File::create(folder.join("huge.stl")).expect("writable");
    huge.set_len(2 << 30).expect("long");

    let mut page = String::new();
    for (name, text) in rows() {
        write("arm.urdf", text.as_bytes());
        let (code, check) = told(&["check", "arm.urdf"]);
        assert_eq!(code, 2, "{name}: {check}");
        let first = check
            .lines()
            .find(|l| l.starts_with("error: "))
            .unwrap_or("");
        assert!(first.starts_with("error: arm.urdf:"), "{name}: {check}");
        let (code, kinematics) = told(&["kinematics", "arm.urdf", "--samples", "1"]);
        writeln!(page, "{name}\n  {first}").expect("text");
        if code == 2 {
            assert_eq!(kinematics.trim_end(), first, "{name}");
        } else {
            // Meshes do not move a link.
            assert_eq!(code, 0, "{name}: {kinematics}");
            assert!(name.contains("mesh") || name.contains("package"), "{name}");
            writeln!(page, "  kinematics: good").expect("text");
        }
    }
    fs::remove_file(folder.join("huge.stl")).expect("it was made");
    insta::assert_snapshot!(page);

    // The line reaches other programs, too.
    write(
        "arm.urdf",
        with(AXIS_1, r#"<axis xyz="0 0 0"/>"#).as_bytes(),
    );
    let output = Command::new(env!("CARGO_BIN_EXE_depal"))
        .args(["check", "--json", "arm.urdf"])
        .current_dir(&folder)
        .output()
        .expect("the binary starts");
    let document: serde_json::Value = serde_json::from_slice(&output.stdout).expect("one document");
    let finding = &document["files"][0]["diagnostics"][0];
    assert_eq!(
        (&finding["code"], &finding["line"]),
        (&"URDF".into(), &197.into())
    );
}

/// What other programs put into the file, and meshes only to look at, do no harm.
#[test]
fn a_description_full_of_other_things_is_good() {
    let folder = folder();
    fs::create_dir_all(&folder).expect("a writable folder");
    let extra = r#"
  <gazebo reference="link_1"><mu1>0.2</mu1><material>Gazebo/Orange</material><selfCollide>true</selfCollide></gazebo>
  <gazebo><plugin name="control" filename="libgazebo_ros2_control.so"><parameters>$(find x)/a.yaml ${y}</parameters></plugin></gazebo>
  <transmission name="t1"><type>transmission_interface/SimpleTransmission</type><joint name="joint_1">
    <hardwareInterface>PositionJointInterface</hardwareInterface></joint>
    <actuator name="m1"><mechanicalReduction>1</mechanicalReduction></actuator></transmission>
  <ros2_control name="sys" type="system"><hardware><plugin>mock_components/GenericSystem</plugin></hardware>
    <joint name="joint_1"><command_interface name="position"><param name="min">-1</param></command_interface>
    <state_interface name="position"/></joint></ros2_control>
</robot>"#;
    let visual = r#"<visual name="axis 2 hub"><geometry><mesh filename="package://nowhere/visual/link_1.dae" scale="1 1 1"/></geometry>
      <material name=""/></visual><visual name="axis 2 hub">"#;
    let text = KR16
        .replace("</robot>", extra)
        .replacen(r#"<visual name="axis 2 hub">"#, visual, 1)
        .replacen(
            "<robot ",
            "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" ",
            1,
        );
    fs::write(folder.join("user.urdf"), &text).expect("writable");
    fs::write(folder.join("plain.urdf"), KR16).expect("writable");
    let (code, check) = told(&["check", "user.urdf"]);
    assert_eq!(code, 0, "{check}");
    let run = |name: &str| {
        let output = Command::new(env!("CARGO_BIN_EXE_depal"))
            .args([
                "kinematics",
                name,
                "--samples",
                "5",
                "--seed",
                "3",
                "--json",
            ])
            .current_dir(&folder)
            .output()
            .expect("the binary starts");
        assert!(output.status.success());
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
        output.stdout
    };
    assert_eq!(run("user.urdf"), run("plain.urdf"));
}
