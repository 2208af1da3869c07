mod dynamics;
mod faults;
mod meshes;
mod numeric;
mod own_arms;

use std::fmt::Write;

use depal_frames::{JointPositions, Pose, Vector};
use depal_time::{RandomStream, RandomStreams};
use proptest::prelude::*;

use crate::{Arm, ArmError, opw::Solver, urdf, verify::oracle_pose};

const IRB6700: &str = include_str!("../../../../urdf/abb_irb6700_150_320.urdf");
const FILE: &str = "abb_irb6700_150_320.urdf";
const ACCELERATIONS: [f64; 6] = [3.1, 3.1, 3.1, 7.0, 7.0, 8.7];

fn irb6700() -> Arm {
    Arm::from_urdf(IRB6700, FILE, &ACCELERATIONS).unwrap()
}

fn random_joints(arm: &Arm, random: &mut RandomStream) -> JointPositions {
    let mut joints = JointPositions::zeros(arm.joint_count());
    for (q, limit) in joints.iter_mut().zip(arm.limits()) {
        *q = random.uniform(limit.lower, limit.upper);
    }
    joints
}

fn distance(a: &Pose, b: &Pose) -> (f64, f64) {
    (
        (a.translation.vector - b.translation.vector).norm(),
        a.rotation.angle_to(&b.rotation),
    )
}

/// Published figures by hand: reach and height at zero joints and with the arm turned and bent.
#[test]
fn known_poses() {
    let arm = irb6700();
    let at_zero = arm.base_from_flange(&JointPositions::zeros(6));
    let expected = Vector::new(0.320 + 1.5925 + 0.200, 0.0, 0.780 + 1.280 + 0.200);
    assert!((at_zero.translation.vector - expected).norm() < 1e-12);
    assert!(
        (at_zero * Vector::z() - Vector::x()).norm() < 1e-12,
        "flange looks along +X"
    );
    assert!(
        (at_zero * Vector::x() + Vector::z()).norm() < 1e-12,
        "its X points down"
    );

    // Turned by a right angle and bent: from the triangle of upper arm and forearm.
    let bent = JointPositions::from_degrees(&[90.0, 30.0, 20.0, 0.0, 40.0, 0.0]);
    let (pitch2, pitch3): (f64, f64) = (30f64.to_radians(), 50f64.to_radians());
    let radius = 0.320 + 1.280 * pitch2.sin() + 1.5925 * pitch3.cos() + 0.200 * pitch3.sin();
    let height = 0.780 + 1.280 * pitch2.cos() - 1.5925 * pitch3.sin() + 0.200 * pitch3.cos();
    // 30 + 20 + 40 degrees: the flange looks straight down, 0.2 m below the wrist.
    let pose = arm.base_from_flange(&bent);
    let expected = Vector::new(0.0, radius, height - 0.200);
    assert!(
        (pose.translation.vector - expected).norm() < 1e-12,
        "{pose} {expected}"
    );
    assert!((pose * Vector::z() + Vector::z()).norm() < 1e-12);
}

#[test]
fn limits_speeds_and_masses_are_the_published_ones() {
    let arm = irb6700();
    let degrees: Vec<[i64; 3]> = arm
        .limits()
        .iter()
        .map(|l| [l.lower, l.upper, l.max_speed].map(|v| v.to_degrees().round() as i64))
        .collect();
    assert_eq!(
        degrees,
        [
            [-170, 170, 100],
            [-65, 85, 90],
            [-180, 70, 90],
            [-300, 300, 170],
            [-130, 130, 120],
            [-360, 360, 190]
        ]
    );
    let names: Vec<&str> = arm.links().iter().map(|l| l.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "base_link",
            "link_1",
            "link_2",
            "link_3",
            "link_4",
            "link_5",
            "link_6",
            "tool0"
        ]
    );
    let below: Vec<usize> = (0..8).map(|link| arm.joints_below(link)).collect();
    assert_eq!(below, [0, 1, 2, 3, 4, 5, 6, 6]);
    let mass: f64 = arm.links().iter().map(|l| l.mass).sum();
    assert!((mass - 1280.0).abs() < 1.0, "{mass} kg");
    for link in &arm.links()[..7] {
        assert!(!link.collision.is_empty() && link.visual.len() == link.collision.len());
    }
    assert_eq!(arm.links()[1].visual[0].1, [237, 102, 23]);
}

#[test]
fn three_computations_of_the_flange_agree() {
    let arm = irb6700();
    let loaded = urdf::load(
        IRB6700,
        FILE,
        &urdf::Accelerations::PerJoint(&ACCELERATIONS),
        None,
    )
    .unwrap();
    let solver = Solver::recognise(&loaded.chain, &loaded.joint_names).unwrap();
    let oracle = k::Chain::<f64>::from(&loaded.robot);
    let mut random = RandomStreams::new(1).stream("forward");
    let mut worst: f64 = 0.0;
    for _ in 0..10_000 {
        let joints = random_joints(&arm, &mut random);
        let flat = arm.base_from_flange(&joints);
        for other in [
            solver.base_from_flange(&joints),
            oracle_pose(&oracle, &loaded, &joints),
        ] {
            let (metres, radians) = distance(&flat, &other);
            worst = worst.max(metres);
            assert!(
                metres < 1e-9 && radians < 1e-7,
                "{metres} m {radians} rad at {joints:?}"
            );
        }
        let links = arm.base_from_links(&joints);
        assert_eq!(links[7], flat);
    }
    assert!(worst < 1e-12, "worst {worst} m");
}

#[test]
fn inverse_finds_the_generating_joints_and_only_true_solutions() {
    let arm = irb6700();
    let mut random = RandomStreams::new(2).stream("inverse");
    let (mut solutions, mut branches) = (0, 0);
    for _ in 0..10_000 {
        let joints = random_joints(&arm, &mut random);
        let pose = arm.base_from_flange(&joints);
        let found = arm.inverse(&pose);
        for solution in &found {
            assert!(arm.within_limits(solution), "{solution:?}");
            let (metres, radians) = distance(&pose, &arm.base_from_flange(solution));
            assert!(metres < 1e-6 && radians < 1e-6, "{metres} m {radians} rad");
        }
        assert!(
            found.iter().any(|s| s.max_distance(&joints) < 1e-5),
            "{joints:?} not among {found:?}"
        );
        assert!(found.is_sorted_by(|a, b| a[..] <= b[..]));
        let nearest = arm.inverse_nearest(&pose, &joints).unwrap();
        assert!(nearest.max_distance(&joints) < 1e-5);
        solutions += found.len();
        branches += found
            .iter()
            .filter(|s| s[3].abs() <= std::f64::consts::PI && s[5].abs() <= std::f64::consts::PI)
            .count();
    }
    // Turns: joint 6 has two for every angle, joint 4 two for many.
    assert!(solutions > 2 * branches, "{solutions} {branches}");
}

#[test]
fn nearest_keeps_a_straight_wrist_still() {
    let arm = irb6700();
    let near = JointPositions::from_degrees(&[10.0, 20.0, 10.0, 70.0, 0.0, -40.0]);
    let found = arm
        .inverse_nearest(&arm.base_from_flange(&near), &near)
        .unwrap();
    assert!(found.max_distance(&near) < 1e-4, "{found:?}");
}

#[test]
fn out_of_reach_is_empty() {
    let arm = irb6700();
    let far = Pose::translation(4.0, 0.0, 1.0);
    assert!(arm.inverse(&far).is_empty());
    assert_eq!(arm.inverse_nearest(&far, &JointPositions::zeros(6)), None);
    let nan = Pose::translation(f64::NAN, 0.0, 1.0);
    assert!(arm.inverse(&nan).is_empty());
}

/// The file with one passage replaced, and what the reader says of it.
fn check(from: &str, to: &str, expected: &str) {
    assert!(IRB6700.contains(from), "nothing to replace: {from}");
    let text = IRB6700.replacen(from, to, 1);
    let error = Arm::from_urdf(&text, FILE, &ACCELERATIONS).unwrap_err();
    assert!(error.to_string().contains(expected), "{error}");
    assert!(error.to_string().starts_with(FILE), "{error}");
}

#[test]
fn faults_are_named_with_file_and_element() {
    let joint3 = &IRB6700[IRB6700.find(r#"<joint name="joint_3""#).unwrap()..];
    let limit3 = &joint3[joint3.find("<limit").unwrap()..];
    let limit3 = &limit3[..=limit3.find('>').unwrap()];
    check(limit3, "", "joint 'joint_3': <limit> is missing");
    check(
        limit3,
        r#"<limit lower="1" upper="-1" velocity="1"/>"#,
        "joint 'joint_3' <limit>: lower 1 rad is not below upper -1 rad",
    );
    check(
        limit3,
        r#"<limit lower="-1" upper="1" velocity="0"/>"#,
        "joint 'joint_3' <limit> velocity: 0 found, expected a positive value",
    );
    check(
        limit3,
        r#"<limit lower="nan" upper="1" velocity="1"/>"#,
        "NaN is not a finite",
    );
    check(
        r#"<origin xyz="0 0 1.28"/>"#,
        r#"<origin xyz="inf 0 1.28"/>"#,
        "joint 'joint_3' <origin> xyz: inf",
    );
    check(
        r#"<axis xyz="1 0 0"/>"#,
        r#"<axis xyz="0 0 0"/>"#,
        "joint 'joint_4' <axis>: the zero",
    );
    check(
        r#"<parent link="link_2"/>"#,
        r#"<parent link="link_9"/>"#,
        "'joint_3': parent link 'link_9'",
    );
    check(
        r#"<parent link="base_link"/>"#,
        r#"<parent link="link_6"/>"#,
        "cycle through link 'link_1'",
    );
    check(
        r#"<link name="tool0"/>"#,
        r#"<link name="tool0"/><link name="lost"/>"#,
        "2 root links (base_link, lost)",
    );
    check(
        r#"<link name="tool0"/>"#,
        r#"<link name="tool0"/><link name="link_3"/>"#,
        "link 'link_3' is defined twice",
    );
    check(
        r#"name="joint_5" type="revolute""#,
        r#"name="joint_5" type="prismatic""#,
        "joint 'joint_5': type prismatic is not supported",
    );
    check(
        r#"<box size="0.86 0.72 0.06"/>"#,
        r#"<box size="0.86 -0.72 0.06"/>"#,
        "link 'base_link' <visual> <box> size: -0.72 found",
    );
    check("</robot>", "", "not a readable URDF");
}

#[test]
fn two_parents_and_wrong_accelerations() {
    let second = r#"<joint name="again" type="fixed"><parent link="base_link"/><child link="link_4"/></joint></robot>"#;
    let text = IRB6700.replace("</robot>", second);
    let error = Arm::from_urdf(&text, FILE, &ACCELERATIONS).unwrap_err();
    assert!(
        matches!(error, ArmError::TwoParents { ref link, .. } if link == "link_4"),
        "{error}"
    );
    let error = Arm::from_urdf(IRB6700, FILE, &[1.0; 5]).unwrap_err();
    assert!(
        matches!(
            error,
            ArmError::AccelerationCount {
                found: 5,
                expected: 6,
                ..
            }
        ),
        "{error}"
    );
    let error = Arm::from_urdf(IRB6700, FILE, &[1.0, 1.0, 0.0, 1.0, 1.0, 1.0]).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("acceleration of joint 'joint_3'"),
        "{error}"
    );
}

/// Another brand's layout: reversed axes and another zero. Limits wide, so that every branch must come back.
#[test]
fn reversed_axes_and_another_zero_are_recognised() {
    let mut text = r#"<robot name="other">"#.to_owned();
    for link in 0..8 {
        write!(text, r#"<link name="l{link}"/>"#).unwrap();
    }
    let joints = [
        ("0 0 0.645", "3.141592653589793 0 0", "0 0 1"),
        ("0.33 0 0", "1.5707963267948966 0 0", "0 0 1"),
        ("1.15 0 0", "0 0 -1.5707963267948966", "0 0 1"),
        ("0.115 0 0", "1.5707963267948966 0 0", "0 0 -1"),
        (
            "0 0 -1.22",
            "1.5707963267948966 0 3.141592653589793",
            "0 0 1",
        ),
        ("0 0 0", "-1.5707963267948966 0 0", "0 0 -1"),
    ];
    for (i, (xyz, rpy, axis)) in joints.iter().enumerate() {
        write!(
            text,
            r#"<joint name="a{i}" type="revolute"><parent link="l{i}"/><child link="l{}"/><origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/><limit lower="-3" upper="3" velocity="2" effort="0"/></joint>"#,
            i + 1
        )
        .unwrap();
    }
    text += r#"<joint name="f" type="fixed"><parent link="l6"/><child link="l7"/><origin xyz="0 0 0.215" rpy="0 0 0.3"/></joint></robot>"#;
    let arm = Arm::from_urdf(&text, "other.urdf", &[1.0; 6]).unwrap();
    let mut random = RandomStreams::new(3).stream("other");
    for _ in 0..1000 {
        let joints = random_joints(&arm, &mut random);
        let pose = arm.base_from_flange(&joints);
        let found = arm.inverse(&pose);
        assert!(
            found.iter().any(|s| s.max_distance(&joints) < 1e-5),
            "{joints:?} {found:?}"
        );
    }
}

proptest! {
    #[test]
    fn any_text_is_refused_without_panic(text in ".{0,200}") {
        prop_assert!(Arm::from_urdf(&text, "x", &ACCELERATIONS).is_err());
    }

    /// Cutting or doubling any passage of a true file gives an arm or an error, never a panic.
    #[test]
    fn damaged_file_never_panics(start in 0usize..12_000, length in 1usize..400, twice: bool) {
        let start = start.min(IRB6700.len());
        let end = (start + length).min(IRB6700.len());
        let middle = if twice { IRB6700[start..end].repeat(2) } else { String::new() };
        let text = format!("{}{middle}{}", &IRB6700[..start], &IRB6700[end..]);
        let _ = Arm::from_urdf(&text, "x", &ACCELERATIONS);
    }
}
