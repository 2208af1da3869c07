//! Arms without a closed form, written from published dimensions.

use std::fmt::Write;

use depal_frames::{Pose, Rotation};
use depal_time::RandomStreams;

use super::{distance, random_joints};
use crate::{
    Arm, ArmWarning,
    numeric::{self, same_posture},
};

/// One row of a table in the convention of Denavit and Hartenberg (distal): d, a (m) and alpha (degrees).
type Row = [f64; 3];

/// A description from such a table: after each joint about Z, shift d along Z, a along the new X, turn alpha about X.
fn from_table(name: &str, table: &[Row], limits_deg: &[f64]) -> Arm {
    let mut text = format!(r#"<robot name="{name}"><link name="base_link"/>"#);
    let mut origin = [0.0; 4];
    let last = table.len();
    for (i, ([d, a, alpha], limit)) in table.iter().zip(limits_deg).enumerate() {
        let parent = if i == 0 {
            "base_link".to_owned()
        } else {
            format!("link_{i}")
        };
        let [x, z, roll, limit] = [origin[0], origin[1], origin[2], limit.to_radians()];
        // In the turned frame: the shift along the joint's own axis belongs to the next origin.
        write!(
            text,
            r#"<link name="link_{n}"/><joint name="joint_{n}" type="revolute"><parent link="{parent}"/><child link="link_{n}"/>
            <origin xyz="{x} 0 {z}" rpy="{roll} 0 0"/><axis xyz="0 0 1"/><limit lower="-{limit}" upper="{limit}" velocity="2" effort="0"/></joint>"#,
            n = i + 1
        )
        .unwrap();
        origin = [*a, *d, alpha.to_radians(), 0.0];
    }
    let [x, z, roll, _] = origin;
    write!(
        text,
        r#"<link name="tool0"/><joint name="flange" type="fixed"><parent link="link_{last}"/><child link="tool0"/><origin xyz="{x} 0 {z}" rpy="{roll} 0 0"/></joint></robot>"#
    )
    .unwrap();
    Arm::from_urdf_uniform(&text, name, 2.0).unwrap()
}

/// Universal Robots UR10e: the maker's page "DH parameters for calculations of kinematics and dynamics".
/// Limits: a turn either way (the maker's data sheet).
fn ur10e() -> Arm {
    let table = [
        [0.1807, 0.0, 90.0],
        [0.0, -0.6127, 0.0],
        [0.0, -0.57155, 0.0],
        [0.17415, 0.0, 90.0],
        [0.11985, 0.0, -90.0],
        [0.11655, 0.0, 0.0],
    ];
    from_table("ur10e", &table, &[360.0; 6])
}

/// FANUC CRX-10iA: 540, 540, 150 and 160 mm (M. Abbes, G. Poisson, "Geometric approach for inverse kinematics of the
/// FANUC CRX collaborative robot", Robotics 13(6), 2024; figures only). Limits are ours: half a turn, a little more at
/// the ends of the arm.
fn crx() -> Arm {
    let table = [
        [0.0, 0.0, -90.0],
        [0.0, 0.540, 180.0],
        [0.0, 0.0, -90.0],
        [-0.540, 0.0, 90.0],
        [0.150, 0.0, -90.0],
        [-0.160, 0.0, 180.0],
    ];
    from_table(
        "crx_10ia",
        &table,
        &[190.0, 180.0, 180.0, 190.0, 180.0, 225.0],
    )
}

/// KUKA LBR iiwa 7 R800: 340, 400, 400 and 126 mm, limits of its data sheet.
fn iiwa() -> Arm {
    let table = [
        [0.340, 0.0, -90.0],
        [0.0, 0.0, 90.0],
        [0.400, 0.0, 90.0],
        [0.0, 0.0, -90.0],
        [0.400, 0.0, -90.0],
        [0.0, 0.0, 90.0],
        [0.126, 0.0, 0.0],
    ];
    let limits = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0];
    from_table("iiwa_7", &table, &limits)
}

/// Five axes: two parallel ones for the arm, pitch and roll of the hand. A made-up machine.
fn five_axes() -> Arm {
    let table = [
        [0.4, 0.1, 90.0],
        [0.0, 0.5, 0.0],
        [0.0, 0.45, 0.0],
        [0.0, 0.0, 90.0],
        [0.12, 0.0, 0.0],
    ];
    from_table("five", &table, &[160.0, 100.0, 140.0, 120.0, 180.0])
}

/// What `inverse` gives for `poses` random poses: how many were solved, in how many the joints that made the pose were
/// among the solutions (but for whole turns), and postures in all. Every solution is checked on the way.
fn judge(arm: &Arm, poses: usize) -> (usize, usize, usize) {
    let mut random = RandomStreams::new(21).stream("judge");
    let (mut solved, mut met, mut postures) = (0, 0, 0);
    for _ in 0..poses {
        let joints = random_joints(arm, &mut random);
        let pose = arm.base_from_flange(&joints);
        let found = numeric::solutions(&arm.chain, arm.limits(), &pose);
        for (i, solution) in found.iter().enumerate() {
            let (metres, radians) = distance(&pose, &arm.base_from_flange(solution));
            assert!(arm.within_limits(solution), "{solution:?}");
            assert!(metres < 1e-6 && radians < 1e-6, "{metres} m {radians} rad");
            assert!(found[..i].iter().all(|f| !same_posture(f, solution)));
        }
        solved += usize::from(!found.is_empty());
        met += usize::from(found.iter().any(|f| same_posture(f, &joints)));
        postures += found.len();
    }
    (solved, met, postures)
}

/// Two arms whose wrist is no ball, 1000 poses each: every one is solved, hardly a posture is missed.
#[test]
fn arms_with_an_offset_wrist_are_solved_by_restarts() {
    for (arm, branches) in [(ur10e(), 6.8), (crx(), 8.0)] {
        let named = arm.warnings();
        assert!(
            matches!(named, [ArmWarning::NumericInverse { at, .. }] if at.line.is_some()),
            "{named:?}"
        );
        let (solved, met, postures) = judge(&arm, 1000);
        println!(
            "{}: {solved} solved, {met} met, {postures} postures",
            arm.name()
        );
        assert_eq!(solved, 1000, "{}", arm.name());
        assert!(met >= 990, "{}: {met} of 1000", arm.name());
        assert!(
            postures as f64 > branches * 1000.0,
            "{}: {postures}",
            arm.name()
        );
    }
}

/// All that `inverse` promises besides: sorted, whole turns listed, the same every time.
#[test]
fn numeric_solutions_are_sorted_and_always_the_same() {
    let arm = ur10e();
    let mut random = RandomStreams::new(22).stream("sorted");
    for _ in 0..20 {
        let joints = random_joints(&arm, &mut random);
        let pose = arm.base_from_flange(&joints);
        let found = arm.inverse(&pose);
        assert_eq!(found, arm.clone().inverse(&pose));
        assert!(found.is_sorted_by(|a, b| a[..] <= b[..]));
        assert!(
            found.iter().any(|f| f.max_distance(&joints) < 1e-4),
            "{joints:?}"
        );
        assert!(found.windows(2).all(|w| w[0].max_distance(&w[1]) > 1e-4));
        let nearest = arm.inverse_nearest(&pose, &joints).unwrap();
        assert!(nearest.max_distance(&joints) < 1e-4);
    }
    let far = Pose::translation(3.0, 0.0, 0.0);
    assert!(arm.inverse(&far).is_empty());
}

/// Joints that turn many times do not make the list endless.
#[test]
fn whole_turns_are_listed_up_to_a_bound() {
    let table = [
        [0.3, 0.0, -90.0],
        [0.0, 0.4, 0.0],
        [0.0, 0.1, -90.0],
        [0.4, 0.0, 90.0],
        [0.0, 0.0, -90.0],
        [0.1, 0.0, 0.0],
    ];
    let arm = from_table("turning", &table, &[3600.0; 6]);
    assert_eq!(arm.warnings(), []);
    let joints = depal_frames::JointPositions::from_degrees(&[10.0, 20.0, 30.0, 40.0, 50.0, 60.0]);
    let found = arm.inverse(&arm.base_from_flange(&joints));
    assert!(
        found.len() > 1000 && found.len() <= 8 * 1024,
        "{}",
        found.len()
    );
    assert!(found.iter().any(|f| f.max_distance(&joints) < 1e-6));
}

#[test]
fn seven_and_five_axes_say_what_they_give() {
    let seven = iiwa();
    let said = seven.warnings()[0].to_string();
    assert!(
        said.contains("endlessly many solutions, of which up to 24"),
        "{said}"
    );
    let (solved, _, postures) = judge(&seven, 100);
    assert_eq!(solved, 100);
    assert!(postures > 1000, "{postures}");

    let five = five_axes();
    let said = five.warnings()[0].to_string();
    assert!(
        said.contains("only the poses that it can reach exactly"),
        "{said}"
    );
    let (solved, met, _) = judge(&five, 200);
    assert!(solved >= 199 && met >= 196, "{solved} {met}");
    // Turned out of the plane in which the arm stands.
    let mut random = RandomStreams::new(23).stream("five");
    let pose = five.base_from_flange(&random_joints(&five, &mut random));
    let turn = Rotation::from_euler_angles(0.0, 0.0, 0.3);
    let turned = Pose::from_parts(pose.translation, turn * pose.rotation);
    assert!(five.inverse(&turned).is_empty());
}

/// Mimics that no closed form knows: the joint after next follows joint 2 by half.
#[test]
fn chains_with_mimics_are_solved_as_well() {
    let joint = |n: usize, xyz: &str, axis: &str, extra: &str| {
        format!(
            r#"<link name="l{n}"/><joint name="j{n}" type="revolute"><parent link="l{}"/><child link="l{n}"/><origin xyz="{xyz}"/>
            <axis xyz="{axis}"/><limit lower="-2.5" upper="2.5" velocity="1"/>{extra}</joint>"#,
            n - 1
        )
    };
    let mut text = r#"<robot name="m"><link name="l0"/>"#.to_owned();
    text += &joint(1, "0 0 0.4", "0 0 1", "");
    text += &joint(2, "0.1 0 0", "0 1 0", "");
    text += &joint(
        3,
        "0 0 0.3",
        "0 1 0",
        r#"<mimic joint="j2" multiplier="0.5" offset="0.2"/>"#,
    );
    text += &joint(4, "0 0 0.3", "0 1 0", "");
    text += &joint(5, "0.3 0.05 0", "1 0 0", "");
    text += &joint(6, "0.05 0 0", "0 1 0", "");
    text += &joint(7, "0.05 0.04 0", "1 0 0", "");
    let arm = Arm::from_urdf_uniform(&(text + "</robot>"), "m.urdf", 2.0).unwrap();
    assert_eq!(arm.joint_count(), 6);
    let (solved, met, _) = judge(&arm, 100);
    assert!(solved == 100 && met >= 97, "{solved} {met}");
}
