use std::fmt::Write;

use depal_frames::{JointPositions, Point, Vector};
use depal_time::{RandomStream, RandomStreams};
use nalgebra::Matrix3;
use proptest::prelude::*;

use super::{FILE, IRB6700, irb6700};
use crate::{Arm, Load};

const G: f64 = 9.806_65;

/// Two links in a vertical plane: along X at zero, lowered by positive angles about Y.
const TWO_LINKS: &str = r#"<robot name="two">
  <link name="l0"/>
  <link name="l1"><inertial><origin xyz="0.4 0 0"/><mass value="20"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="l2"><inertial><origin xyz="0.25 0 0"/><mass value="8"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="flange"/>
  <joint name="a1" type="revolute"><parent link="l0"/><child link="l1"/><origin xyz="0 0 1"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="2" effort="500"/></joint>
  <joint name="a2" type="revolute"><parent link="l1"/><child link="l2"/><origin xyz="0.9 0 0"/><axis xyz="0 1 0"/><limit lower="-3" upper="3" velocity="2" effort="0"/></joint>
  <joint name="f" type="fixed"><parent link="l2"/><child link="flange"/><origin xyz="0.6 0 0"/></joint>
</robot>"#;

#[test]
fn holding_torque_of_two_links_by_hand() {
    let arm = Arm::from_urdf_uniform(TWO_LINKS, "two.urdf", 1.0).unwrap();
    let load = Load::point(5.0, Point::new(0.1, 0.0, 0.0));
    for (q1, q2) in [(0.0_f64, 0.0_f64), (0.3, -1.1), (-1.2, 2.0), (1.5, 0.2)] {
        let (near, far) = (q1.cos(), (q1 + q2).cos());
        let second = -G * (8.0 * 0.25 * far + 5.0 * 0.7 * far);
        let first = -G * (20.0 * 0.4 * near + (8.0 + 5.0) * 0.9 * near) + second;
        let found = arm.holding_torques(&JointPositions::from_slice(&[q1, q2]), &load);
        assert!((found[0] - first).abs() < 1e-9, "{found:?} {first}");
        assert!((found[1] - second).abs() < 1e-9, "{found:?} {second}");
    }
}

#[test]
fn limits_come_from_the_file_where_it_has_both_effort_and_mass() {
    let arm = Arm::from_urdf_uniform(TWO_LINKS, "two.urdf", 1.0).unwrap();
    let limits = arm.torque_limits().unwrap();
    assert_eq!(limits[0], 500.0);
    assert!(limits[1].is_infinite(), "effort 0 is no limit");
    let massless = TWO_LINKS.replace("value=\"20\"", "value=\"0\"");
    let massless = massless.replace("value=\"8\"", "value=\"0\"");
    let massless = massless
        .replace("=\"1\" i", "=\"0\" i")
        .replace("izz=\"1\"", "izz=\"0\"");
    let arm = Arm::from_urdf_uniform(&massless, "two.urdf", 1.0).unwrap();
    assert!(arm.torque_limits().is_none(), "nothing is known of masses");
    assert!(irb6700().torque_limits().is_none());
    assert!(irb6700().with_torque_limits(&[1.0; 5]).is_err());
    let limited = irb6700().with_torque_limits(&[0.0, 9e3, 0.0, 0.0, 0.0, 0.0]);
    assert_eq!(limited.unwrap().torque_limits().unwrap()[1], 9e3);
    let text = IRB6700.replace("effort=\"0\"", "effort=\"4000\"");
    let arm = Arm::from_urdf_uniform(&text, FILE, 1.0).unwrap();
    assert_eq!(arm.torque_limits().unwrap()[5], 4000.0);
}

/// A body about its own centre, drawn a quarter turn off: the moment about its X is what the file calls Y.
#[test]
fn inertia_is_turned_into_the_links_frame() {
    let text = r#"<robot name="wheel"><link name="l0"/>
      <link name="l1"><inertial><origin rpy="0 0 1.5707963267948966"/><mass value="1"/><inertia ixx="2" iyy="3" izz="4" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="a1" type="revolute"><parent link="l0"/><child link="l1"/><axis xyz="1 0 0"/><limit lower="-3" upper="3" velocity="2" effort="0"/></joint></robot>"#;
    let arm = Arm::from_urdf_uniform(text, "wheel.urdf", 1.0).unwrap();
    let one = JointPositions::from_slice(&[1.0]);
    let torques = arm.joint_torques(&one, &one, &one, &Load::NONE);
    assert!((torques[0] - 3.0).abs() < 1e-12, "{torques:?}");
}

#[test]
fn two_loads_weigh_as_one() {
    let arm = irb6700();
    let tool = Load {
        inertia: Matrix3::new(2.0, 0.1, 0.0, 0.1, 3.0, 0.2, 0.0, 0.2, 4.0),
        ..Load::point(45.0, Point::new(0.02, 0.0, 0.15))
    };
    let carton = Load::point(20.0, Point::new(0.1, -0.2, 0.5));
    let q = JointPositions::from_slice(&[0.3, 0.2, 0.4, -0.5, 0.9, 1.1]);
    let v = JointPositions::from_slice(&[1.0, -0.7, 0.5, 2.0, -1.0, 3.0]);
    let torques = |load: &Load| arm.joint_torques(&q, &v, &v, load);
    let (both, bare) = (torques(&tool.and(&carton)), torques(&Load::NONE));
    let (one, other) = (torques(&tool), torques(&carton));
    for j in 0..6 {
        let sum = one[j] + other[j] - bare[j];
        assert!((both[j] - sum).abs() < 1e-8 * (1.0 + sum.abs()), "{j}");
    }
    assert_eq!(Load::NONE.and(&Load::NONE), Load::NONE);
}

fn three(random: &mut RandomStream, size: f64) -> String {
    let mut one = || random.uniform(-size, size);
    format!("{} {} {}", one(), one(), one())
}

/// A chain with any axes and offsets, a joint in its middle that follows the first, and a heavy side branch.
fn random_chain(random: &mut RandomStream, joints: usize) -> Arm {
    let mut text = r#"<robot name="any"><link name="l0"/>"#.to_owned();
    for i in 0..=joints {
        let side = |random: &mut RandomStream| random.uniform(0.05, 0.6);
        let (mass, a, b, c) = (
            random.uniform(0.5, 30.0),
            side(random),
            side(random),
            side(random),
        );
        let moment = |x: f64, y: f64| mass / 12.0 * (x * x + y * y);
        write!(
            text,
            r#"<link name="l{}"><inertial><origin xyz="{}" rpy="{}"/><mass value="{mass}"/><inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>"#,
            i + 1,
            three(random, 0.4),
            three(random, 3.0),
            moment(b, c),
            moment(a, c),
            moment(a, b),
        )
        .unwrap();
        let mimic = if i == 1 {
            r#"<mimic joint="a0" multiplier="-0.7" offset="0.2"/>"#
        } else {
            ""
        };
        write!(
            text,
            r#"<joint name="a{i}" type="revolute"><parent link="l{i}"/><child link="l{}"/><origin xyz="{}" rpy="{}"/><axis xyz="{}"/>{mimic}<limit lower="-3" upper="3" velocity="2" effort="0"/></joint>"#,
            i + 1,
            three(random, 0.8),
            three(random, 3.0),
            three(random, 1.0),
        )
        .unwrap();
    }
    text += r#"<link name="side"><inertial><origin xyz="0.1 0.2 0.3"/><mass value="12"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="s" type="fixed"><parent link="l2"/><child link="side"/><origin xyz="0.3 -0.2 0.1"/></joint></robot>"#;
    Arm::from_urdf_uniform(&text, "any.urdf", 1.0).unwrap()
}

fn moved(q: &JointPositions, by: &JointPositions, times: f64) -> JointPositions {
    let mut out = *q;
    for (o, b) in out.iter_mut().zip(by.iter()) {
        *o += times * b;
    }
    out
}

/// All bodies with their place: links by the file, and the load at the flange.
fn bodies(arm: &Arm, q: &JointPositions, load: &Load) -> Vec<(f64, Vector, Matrix3<f64>)> {
    let poses = arm.base_from_links(q);
    let tip = arm.base_from_flange(q);
    let place = |pose: &depal_frames::Pose, mass, centre: Vector, inertia: Matrix3<f64>| {
        let turn = pose.rotation.to_rotation_matrix();
        let inertia = turn.matrix() * inertia * turn.matrix().transpose();
        (mass, (pose * Point::from(centre)).coords, inertia)
    };
    let links = poses.iter().zip(&arm.dynamics.inertials);
    let mut all: Vec<_> = links
        .map(|(pose, i)| place(pose, i.mass, i.centre, i.inertia))
        .collect();
    all.push(place(&tip, load.mass, load.centre.coords, load.inertia));
    all
}

/// Kinetic energy from how bodies are displaced, J.
fn kinetic(arm: &Arm, q: &JointPositions, speeds: &JointPositions, load: &Load) -> f64 {
    const H: f64 = 1e-5;
    let (before, after) = (moved(q, speeds, -H), moved(q, speeds, H));
    let turns = |q: &JointPositions| {
        let mut turns: Vec<_> = arm.base_from_links(q).iter().map(|p| p.rotation).collect();
        turns.push(arm.base_from_flange(q).rotation);
        turns
    };
    let ways = bodies(arm, &before, load)
        .into_iter()
        .zip(bodies(arm, &after, load));
    let turns = turns(&before).into_iter().zip(turns(&after));
    bodies(arm, q, load)
        .iter()
        .zip(ways.zip(turns))
        .map(|(body, ((a, b), (r, s)))| {
            let v = (b.1 - a.1) / (2.0 * H);
            let w = (s * r.inverse()).scaled_axis() / (2.0 * H);
            0.5 * body.0 * v.norm_squared() + 0.5 * w.dot(&(body.2 * w))
        })
        .sum()
}

fn potential(arm: &Arm, q: &JointPositions, load: &Load) -> f64 {
    bodies(arm, q, load).iter().map(|b| b.0 * G * b.1.z).sum()
}

fn unit(count: usize, joint: usize) -> JointPositions {
    let mut unit = JointPositions::zeros(count);
    unit[joint] = 1.0;
    unit
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Lagrange's equations from energies that know nothing of the recursion.
    #[test]
    fn torques_are_those_of_the_lagrangian(seed: u64, joints in 2usize..6) {
        const H: f64 = 1e-3;
        let mut random = RandomStreams::new(seed).stream("chain");
        let arm = random_chain(&mut random, joints);
        prop_assert_eq!(arm.joint_count(), joints);
        let mut any = |size: f64| {
            let mut out = JointPositions::zeros(joints);
            out.iter_mut().for_each(|v| *v = random.uniform(-size, size));
            out
        };
        let (q, v, a) = (any(2.0), any(2.0), any(5.0));
        let load = Load {
            inertia: Matrix3::from_diagonal(&Vector::new(0.5, 0.7, 0.9)),
            ..Load::point(15.0, Point::new(0.1, -0.05, 0.3))
        };
        let momentum = |j: usize, time: f64| {
            let (q, v) = (moved(&moved(&q, &v, time), &a, 0.5 * time * time), moved(&v, &a, time));
            let e = unit(joints, j);
            0.5 * (kinetic(&arm, &q, &moved(&v, &e, 1.0), &load) - kinetic(&arm, &q, &moved(&v, &e, -1.0), &load))
        };
        let lagrangian = |q: &JointPositions| kinetic(&arm, q, &v, &load) - potential(&arm, q, &load);
        let found = arm.joint_torques(&q, &v, &a, &load);
        let size = found.iter().fold(1.0_f64, |s, t| s.max(t.abs()));
        for j in 0..joints {
            let e = unit(joints, j);
            let slope = (lagrangian(&moved(&q, &e, H)) - lagrangian(&moved(&q, &e, -H))) / (2.0 * H);
            let expected = (momentum(j, H) - momentum(j, -H)) / (2.0 * H) - slope;
            prop_assert!((found[j] - expected).abs() < 2e-4 * size, "{} {} {}", j, found[j], expected);
        }
    }

    /// What the joints put in is what the bodies gain.
    #[test]
    fn power_is_the_gain_of_energy(seed: u64, joints in 2usize..6) {
        const H: f64 = 1e-3;
        let mut random = RandomStreams::new(seed).stream("power");
        let arm = random_chain(&mut random, joints);
        let mut any = |size: f64| {
            let mut out = JointPositions::zeros(joints);
            out.iter_mut().for_each(|v| *v = random.uniform(-size, size));
            out
        };
        let (q, v, a) = (any(2.0), any(2.0), any(5.0));
        let load = Load::point(15.0, Point::new(0.1, -0.05, 0.3));
        let energy = |time: f64| {
            let (q, v) = (moved(&moved(&q, &v, time), &a, 0.5 * time * time), moved(&v, &a, time));
            kinetic(&arm, &q, &v, &load) + potential(&arm, &q, &load)
        };
        let torques = arm.joint_torques(&q, &v, &a, &load);
        let power: f64 = torques.iter().zip(v.iter()).map(|(t, v)| t * v).sum();
        let size: f64 = 1.0 + torques.iter().zip(v.iter()).map(|(t, v)| (t * v).abs()).sum::<f64>();
        let gain = (energy(H) - energy(-H)) / (2.0 * H);
        prop_assert!((power - gain).abs() < 2e-4 * size, "{} {}", power, gain);
    }
}
