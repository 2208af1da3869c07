//! Forward and inverse kinematics of our own arms over random postures.
#![allow(missing_docs)]

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

fn bench_kinematics(criterion: &mut Criterion) {
    for (name, urdf) in ARMS {
        let arm = Arm::from_urdf_uniform(urdf, name, 2.0).expect("our own URDF");
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
