//! Forward and inverse kinematics of our own arms, and of one without a closed form, over random postures.
#![allow(missing_docs)]

use std::{f64::consts::FRAC_PI_2, fmt::Write};

use criterion::{Criterion, criterion_group, criterion_main};
use depal_arm::Arm;
use depal_frames::{JointPositions, Pose};
use depal_time::RandomStreams;

const ARMS: [(&str, &str); 3] = [
    (
        "six axes",
        include_str!("../../../urdf/abb_irb6700_150_320.urdf"),
    ),
    ("palletizer", include_str!("../../../urdf/abb_irb660.urdf")),
    (
        "palletizer, elbow angle",
        include_str!("../../../urdf/kuka_kr120_r3200_pa.urdf"),
    ),
];

/// Universal Robots UR10e, whose wrist is no ball: figures of the maker's table of Denavit and Hartenberg parameters.
fn ur10e() -> String {
    let rows = [
        ("0 0 0", 0.0),
        ("0 0 0.1807", FRAC_PI_2),
        ("-0.6127 0 0", 0.0),
        ("-0.57155 0 0", 0.0),
        ("0 0 0.17415", FRAC_PI_2),
        ("0 0 0.11985", -FRAC_PI_2),
    ];
    let mut text = r#"<robot name="ur10e"><link name="link_0"/>"#.to_owned();
    for (i, (xyz, roll)) in rows.iter().enumerate() {
        let n = i + 1;
        write!(
            text,
            r#"<link name="link_{n}"/><joint name="joint_{n}" type="revolute"><parent link="link_{i}"/>
            <child link="link_{n}"/><origin xyz="{xyz}" rpy="{roll} 0 0"/><axis xyz="0 0 1"/>
            <limit lower="-3.1" upper="3.1" velocity="2"/></joint>"#
        )
        .expect("text");
    }
    text + r#"<link name="tool0"/><joint name="flange" type="fixed"><parent link="link_6"/><child link="tool0"/>
        <origin xyz="0 0 0.11655"/></joint></robot>"#
}

fn bench_kinematics(criterion: &mut Criterion) {
    let ur10e = ur10e();
    let numeric = [("offset wrist", ur10e.as_str())];
    for (name, urdf) in ARMS.into_iter().chain(numeric) {
        let arm = Arm::from_urdf_uniform(urdf, name, 2.0).expect("a good URDF");
        let mut random = RandomStreams::new(1).stream("bench");
        let mut states: Vec<(JointPositions, Pose)> = Vec::new();
        for _ in 0..500 {
            let mut joints = JointPositions::zeros(arm.joint_count());
            for (q, limit) in joints.iter_mut().zip(arm.limits()) {
                *q = random.uniform(limit.lower, limit.upper);
            }
            states.push((joints, arm.base_from_flange(&joints)));
        }
        let mut next = 0;
        let mut turn = || {
            next = (next + 1) % states.len();
            &states[next]
        };
        criterion.bench_function(&format!("{name}: flange"), |bencher| {
            bencher.iter(|| arm.base_from_flange(&turn().0));
        });
        criterion.bench_function(&format!("{name}: all links"), |bencher| {
            bencher.iter(|| arm.base_from_links(&turn().0));
        });
        criterion.bench_function(
            &format!("{name}: every branch and turn of the inverse"),
            |bencher| bencher.iter(|| arm.inverse(&turn().1)),
        );
        criterion.bench_function(&format!("{name}: nearest of the inverse"), |bencher| {
            bencher.iter(|| {
                let (joints, pose) = turn();
                arm.inverse_nearest(pose, joints)
            });
        });
    }
}

criterion_group!(benches, bench_kinematics);
criterion_main!(benches);
