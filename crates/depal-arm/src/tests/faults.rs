use super::{FILE, IRB6700, check};
use crate::{Arm, ArmWarning};

fn load(text: &str) -> Arm {
    Arm::from_urdf_uniform(text, FILE, 2.0).unwrap()
}

#[test]
fn masses_inertias_and_mimics_that_cannot_be_are_named() {
    check(
        r#"<mass value="269"/>"#,
        r#"<mass value="-1"/>"#,
        "link 'base_link' <mass>: -1 found",
    );
    check(
        r#"<inertia ixx="12.7416""#,
        r#"<inertia ixx="-12.7416""#,
        "link 'base_link' <inertia>: smallest principal moment",
    );
    check(
        r#"<inertia ixx="12.7416""#,
        r#"<inertia ixx="nan""#,
        "link 'base_link' <inertia>: NaN is not a finite",
    );
    let axis4 = r#"<axis xyz="1 0 0"/>"#;
    let with = |master: &str| format!(r#"{axis4}<mimic joint="{master}"/>"#);
    check(
        axis4,
        &with("joint_4"),
        "joint 'joint_4' <mimic>: it follows itself",
    );
    check(
        axis4,
        &with("joint_9"),
        "joint 'joint_4' <mimic>: joint 'joint_9' does not exist",
    );
}

/// A body without mass has no inertia; a massless link between two joints has neither, and is no fault.
#[test]
fn zero_masses_without_inertia_are_massless_links() {
    let mass = r#"<mass value="269"/>"#;
    check(
        mass,
        r#"<mass value="0"/>"#,
        "link 'base_link' <mass>: 0 found, expected a positive value",
    );
    let start = IRB6700.find(mass).unwrap();
    let end = start + IRB6700[start..].find("</inertial>").unwrap();
    let nothing = r#"<mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>"#;
    let arm = load(&format!(
        "{}{nothing}{}",
        &IRB6700[..start],
        &IRB6700[end..]
    ));
    assert_eq!((arm.warnings(), arm.links()[0].mass), (&[][..], 0.0));
}

/// The line of the very element, not of the first of its kind.
#[test]
fn the_line_is_that_of_the_fault() {
    let from = IRB6700.find(r#"<link name="link_3">"#).unwrap();
    let second = IRB6700[from..].find("<collision").unwrap();
    let second = from + second + 1 + IRB6700[from + second + 1..].find("<collision").unwrap();
    let size = second + IRB6700[second..].find("<geometry>").unwrap();
    let end = size + IRB6700[size..].find("</geometry>").unwrap();
    let text = format!(
        "{}<geometry><sphere radius=\"-2\"/>{}",
        &IRB6700[..size],
        &IRB6700[end..]
    );
    let error = Arm::from_urdf_uniform(&text, FILE, 2.0).unwrap_err();
    let line = IRB6700[..size].matches('\n').count() + 1;
    assert_eq!(error.place().line, Some(line), "{error}");
    assert_eq!(
        error.to_string(),
        format!(
            "{FILE}:{line}: link 'link_3' <collision> 2 <sphere>: -2 found, expected a positive value"
        )
    );
}

#[test]
fn a_joint_that_cannot_move_may_not_follow_one_that_is_not_there() {
    let text = IRB6700.replace(
        "</robot>",
        r#"<link name="plate"/><joint name="held" type="fixed"><parent link="tool0"/><child link="plate"/>
        <mimic joint="joint_9"/></joint></robot>"#,
    );
    let error = Arm::from_urdf_uniform(&text, FILE, 2.0).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("'held' <mimic>: joint 'joint_9' does not exist")
    );
}

#[test]
fn meshes_are_left_out_with_a_warning_wherever_they_point() {
    for mesh in ["package://x/foot.stl", "../../secret.dae", "/etc/foot.obj"] {
        let text = IRB6700.replace(
            r#"<box size="0.86 0.72 0.06"/>"#,
            &format!(r#"<mesh filename="{mesh}"/>"#),
        );
        let arm = load(&text);
        assert_eq!(arm.warnings().len(), 2, "one visual, one collision");
        assert!(arm.warnings().iter().all(|w| matches!(
            w,
            ArmWarning::MeshSkipped { link, mesh: m, .. } if link == "base_link" && m == mesh
        )));
        assert_eq!(
            arm.links()[0].collision.len(),
            load(IRB6700).links()[0].collision.len() - 1
        );
    }
}

#[test]
fn tags_of_other_tools_do_no_harm() {
    let extra = r#"<gazebo reference="link_1"><mu1>0.2</mu1></gazebo>
        <transmission name="t1"><type>simple</type><joint name="joint_1"/><actuator name="m1"/></transmission>
        <ros2_control name="sys" type="system"><hardware><plugin>x/y</plugin></hardware>
        <joint name="joint_1"><command_interface name="position"/></joint></ros2_control></robot>"#;
    let arm = load(&IRB6700.replace("</robot>", extra));
    assert_eq!(arm.warnings(), []);
    assert_eq!(arm.links(), load(IRB6700).links());
}

#[test]
fn an_endless_joint_turns_once_either_way_and_a_finger_stays() {
    let text = IRB6700
        .replace(r#"name="joint_6" type="revolute""#, r#"name="joint_6" type="continuous""#)
        .replace(
            r#"<limit lower="-6.283185307179586" upper="6.283185307179586" velocity="3.3161255787892263" effort="0"/>"#,
            r#"<limit velocity="3" effort="0"/>"#,
        )
        .replace(
            "</robot>",
            r#"<link name="finger"/><joint name="grip" type="prismatic"><parent link="tool0"/><child link="finger"/>
               <axis xyz="1 0 0"/><limit lower="0" upper="0.1" velocity="1" effort="1"/></joint></robot>"#,
        );
    let arm = load(&text);
    assert_eq!((arm.joint_count(), arm.tip()), (6, "tool0"));
    assert_eq!(arm.limits()[5].upper, std::f64::consts::TAU);
    assert!(matches!(arm.warnings(), [ArmWarning::JointFrozen { joint, .. }] if joint == "grip"));
}

/// Fixed links by the thousand are read in one go.
#[test]
fn ten_thousand_links_are_no_trouble() {
    use std::fmt::Write;
    let mut extra = String::new();
    for i in 0..10_000 {
        let parent = if i == 0 {
            "tool0".to_owned()
        } else {
            format!("x{}", i - 1)
        };
        write!(extra, r#"<link name="x{i}"/><joint name="f{i}" type="fixed"><parent link="{parent}"/><child link="x{i}"/></joint>"#).unwrap();
    }
    let arm = load(&IRB6700.replace("</robot>", &format!("{extra}</robot>")));
    assert_eq!(arm.links().len(), 10_008);
}
