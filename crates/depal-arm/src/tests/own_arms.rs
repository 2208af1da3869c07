use depal_frames::{JointPositions, Pose, Rotation, Vector};
use depal_time::RandomStreams;

use super::{distance, random_joints};
use crate::{Arm, ArmWarning, urdf, verify::oracle_pose};

const IRB460: &str = include_str!("../../../../urdf/abb_irb460.urdf");
const IRB660: &str = include_str!("../../../../urdf/abb_irb660.urdf");
const KR120PA: &str = include_str!("../../../../urdf/kuka_kr120_r3200_pa.urdf");
const KR210: &str = include_str!("../../../../urdf/kuka_kr210_r2700_2.urdf");
const KR16: &str = include_str!("../../../../urdf/kuka_kr16_2.urdf");
const R2000IC: &str = include_str!("../../../../urdf/fanuc_r2000ic_165f.urdf");

fn load(text: &str) -> Arm {
    Arm::from_urdf_uniform(text, "own.urdf", 2.0).unwrap()
}

/// Flange at zero joints by hand, from the published dimensions.
#[test]
fn flanges_at_zero_are_where_the_dimensions_say() {
    let at = |text: &str| {
        let arm = load(text);
        let zero = JointPositions::zeros(arm.joint_count());
        arm.base_from_flange(&zero).translation.vector
    };
    let kr210 = Vector::new(0.330 + 1.150 + 1.220 + 0.215, 0.0, 0.645 + 0.115);
    let kr16 = Vector::new(0.260 + 0.680 + 0.670 + 0.158, 0.0, 0.675 - 0.035);
    let r2000ic = Vector::new(0.312 + 1.280 + 0.215, 0.0, 0.670 + 1.075 + 0.225);
    let irb460 = Vector::new(0.260 + 1.025 + 0.225, 0.0, 0.745 + 0.945 - 0.2515);
    let irb660 = Vector::new(0.300 + 1.350 + 0.260, 0.0, 0.800 + 1.280 - 0.247);
    let kr120_pa = Vector::new(0.350 + 1.350 + 1.220 + 0.280, 0.0, 0.675 - 0.250);
    for (text, expected) in [
        (KR210, kr210),
        (KR16, kr16),
        (R2000IC, r2000ic),
        (IRB460, irb460),
        (IRB660, irb660),
        (KR120PA, kr120_pa),
    ] {
        assert!(
            (at(text) - expected).norm() < 1e-12,
            "{} {expected}",
            at(text)
        );
    }
}

#[test]
fn limits_and_speeds_are_the_published_ones() {
    let degrees = |text: &str| -> Vec<[f64; 3]> {
        let round = |v: f64| (v.to_degrees() * 1e6).round() / 1e6;
        let arm = load(text);
        let limits = arm.limits().iter();
        limits
            .map(|l| [l.lower, l.upper, l.max_speed].map(round))
            .collect()
    };
    assert_eq!(
        degrees(KR210),
        [
            [-185.0, 185.0, 116.8],
            [-140.0, -5.0, 111.4],
            [-120.0, 168.0, 112.0],
            [-350.0, 350.0, 179.0],
            [-125.0, 125.0, 172.0],
            [-350.0, 350.0, 220.0]
        ]
    );
    assert_eq!(
        degrees(R2000IC),
        [
            [-185.0, 185.0, 130.0],
            [-60.0, 76.0, 115.0],
            [-132.0, 180.0, 125.0],
            [-360.0, 360.0, 180.0],
            [-125.0, 125.0, 180.0],
            [-360.0, 360.0, 260.0]
        ]
    );
    assert_eq!(
        degrees(IRB460),
        [
            [-165.0, 165.0, 145.0],
            [-40.0, 85.0, 110.0],
            [-20.0, 120.0, 120.0],
            [-300.0, 300.0, 400.0]
        ]
    );
    assert_eq!(
        degrees(IRB660),
        [
            [-180.0, 180.0, 130.0],
            [-42.0, 82.0, 130.0],
            [-20.0, 120.0, 130.0],
            [-300.0, 300.0, 300.0]
        ]
    );
    assert_eq!(
        degrees(KR120PA),
        [
            [-185.0, 185.0, 136.0],
            [-140.0, -5.0, 130.0],
            [0.0, 155.0, 120.0],
            [-350.0, 350.0, 300.0]
        ]
    );
    assert_eq!(
        degrees(KR16),
        [
            [-185.0, 185.0, 156.0],
            [-155.0, 35.0, 156.0],
            [-130.0, 154.0, 156.0],
            [-350.0, 350.0, 330.0],
            [-130.0, 130.0, 330.0],
            [-350.0, 350.0, 615.0]
        ]
    );
}

/// Sums of the link masses, kg. Of the KR 210 the makers' own link masses (kroshu kuka_quantec_support); of the others
/// the mass of the machine from its data sheet (ABB IRB 460, 660, 6700-150/3.20; KUKA KR 16-2, KR 120 R3200 PA;
/// FANUC R-2000iC/165F).
#[test]
fn link_masses_add_up_to_the_machine() {
    for (text, kilograms) in [
        (IRB460, 925.0),
        (IRB660, 1650.0),
        (super::IRB6700, 1280.0),
        (KR120PA, 1075.0),
        (KR210, 1077.0),
        (KR16, 235.0),
        (R2000IC, 1090.0),
    ] {
        let arm = load(text);
        let sum: f64 = arm.links().iter().map(|l| l.mass).sum();
        assert!((sum - kilograms).abs() < 0.5, "{}: {sum} kg", arm.name());
    }
}

#[test]
fn forward_agrees_with_the_chain_library_and_inverse_with_forward() {
    for text in [KR210, KR16, R2000IC, IRB460, IRB660, KR120PA] {
        let arm = load(text);
        assert_eq!(arm.warnings(), [], "{}", arm.name());
        let loaded =
            urdf::load(text, "own.urdf", &urdf::Accelerations::Uniform(2.0), None).unwrap();
        let oracle = k::Chain::<f64>::from(&loaded.robot);
        let mut random = RandomStreams::new(5).stream("own arms");
        for _ in 0..1000 {
            let joints = random_joints(&arm, &mut random);
            let pose = arm.base_from_flange(&joints);
            let (metres, radians) = distance(&pose, &oracle_pose(&oracle, &loaded, &joints));
            assert!(
                metres < 1e-9 && radians < 1e-7,
                "{} {metres} {radians}",
                arm.name()
            );
            let found = arm.inverse(&pose);
            assert!(
                found.iter().any(|s| s.max_distance(&joints) < 1e-5),
                "{}: {joints:?} not among {found:?}",
                arm.name()
            );
            for solution in &found {
                let (metres, radians) = distance(&pose, &arm.base_from_flange(solution));
                assert!(arm.within_limits(solution) && metres < 1e-6 && radians < 1e-6);
            }
        }
    }
}

#[test]
fn palletizers_keep_their_flange_level_and_refuse_to_tilt() {
    for text in [IRB460, IRB660, KR120PA] {
        let arm = load(text);
        assert_eq!(
            arm.joint_names(),
            ["joint_1", "joint_2", "joint_3", "joint_4"]
        );
        let mut random = RandomStreams::new(6).stream("level");
        for _ in 0..200 {
            let joints = random_joints(&arm, &mut random);
            let pose = arm.base_from_flange(&joints);
            assert!((pose * Vector::z() + Vector::z()).norm() < 1e-12);
            let tilted = pose
                * Pose::from_parts(
                    Vector::zeros().into(),
                    Rotation::from_euler_angles(0.1, 0.0, 0.0),
                );
            assert!(arm.inverse(&tilted).is_empty());
        }
    }
}

/// Published reach: with the upper arm and the forearm in one line, to the flange's axis.
#[test]
fn palletizers_reach_as_far_as_their_links_add_up() {
    for (text, stretched, expected) in [
        (IRB660, [0.0, 82.0, -8.0, 0.0], 3.19),
        (KR120PA, [0.0, -5.0, 0.0, 0.0], 3.20),
    ] {
        let arm = load(text);
        let at = arm.base_from_flange(&JointPositions::from_degrees(&stretched));
        let reach = at.translation.vector.xy().norm();
        assert!((reach - expected).abs() < 0.03, "{} {reach}", arm.name());
    }
}

/// On a pedestal, on a wall, under a ceiling, turned: the closed form is found there, too.
#[test]
fn mounted_any_way_the_closed_form_is_still_found() {
    for text in [KR210, R2000IC, IRB660, KR120PA] {
        for mount in [
            r#"<origin xyz="0.4 -0.7 0.5"/>"#,
            r#"<origin xyz="0 0 3" rpy="3.141592653589793 0 0"/>"#,
            r#"<origin xyz="0 0 0" rpy="0 0 1.5707963267948966"/>"#,
            r#"<origin xyz="0.1 0.2 1.3" rpy="1.2 -0.4 2.2"/>"#,
        ] {
            let mounted = text.replacen(
                r#"<link name="base_link">"#,
                &format!(
                    r#"<link name="world"/><joint name="mount" type="fixed"><parent link="world"/><child link="base_link"/>{mount}</joint><link name="base_link">"#
                ),
                1,
            );
            let arm = load(&mounted);
            assert_eq!(arm.warnings(), [], "{} {mount}", arm.name());
            let mut random = RandomStreams::new(8).stream("mounted");
            for _ in 0..200 {
                let joints = random_joints(&arm, &mut random);
                let pose = arm.base_from_flange(&joints);
                let found = arm.inverse(&pose);
                assert!(
                    found.iter().any(|s| s.max_distance(&joints) < 1e-5),
                    "{} {mount}: {joints:?} not among {found:?}",
                    arm.name()
                );
                for solution in &found {
                    let (metres, radians) = distance(&pose, &arm.base_from_flange(solution));
                    assert!(arm.within_limits(solution) && metres < 1e-6 && radians < 1e-6);
                }
            }
        }
    }
}

/// A wrist that is no ball: the closed form does not fit, and says so; the descent still finds true postures.
#[test]
fn an_offset_wrist_is_solved_numerically() {
    let offset = KR16.replacen(
        r#"<origin xyz="0 0 0"/>
    <axis xyz="-1 0 0"/>"#,
        r#"<origin xyz="0 0.09 0"/>
    <axis xyz="-1 0 0"/>"#,
        1,
    );
    assert_ne!(offset, KR16, "nothing was replaced");
    let arm = load(&offset);
    let warned = arm.warnings().iter();
    assert!(warned.clone().any(
        |w| matches!(w, ArmWarning::NumericInverse { reason, .. } if reason.contains("joint_6"))
    ));
    let mut random = RandomStreams::new(7).stream("offset");
    let (mut solved, mut near) = (0, 0);
    for _ in 0..60 {
        let joints = random_joints(&arm, &mut random);
        let pose = arm.base_from_flange(&joints);
        let found = arm.inverse(&pose);
        for solution in &found {
            let (metres, radians) = distance(&pose, &arm.base_from_flange(solution));
            assert!(arm.within_limits(solution) && metres < 1e-6 && radians < 1e-6);
        }
        solved += usize::from(!found.is_empty());
        let mut aside = joints;
        for (q, limit) in aside.iter_mut().zip(arm.limits()) {
            *q = (*q + 0.05).min(limit.upper);
        }
        let nearest = arm.inverse_nearest(&pose, &aside);
        near += usize::from(nearest.is_some_and(|s| s.max_distance(&aside) < 0.5));
    }
    assert!(solved >= 58 && near >= 50, "{solved} solved, {near} near");
}

/// How many of the closed form's postures the descent meets when it knows nothing of the arm's build.
#[test]
fn descents_from_spread_beginnings_meet_the_branches_of_the_closed_form() {
    use std::f64::consts::PI;
    let arm = load(KR16);
    let mut random = RandomStreams::new(12).stream("unknown");
    let (mut there, mut met, mut complete) = (0, 0, 0);
    const POSES: usize = 25;
    for _ in 0..POSES {
        let pose = arm.base_from_flange(&random_joints(&arm, &mut random));
        let found = crate::numeric::solutions(&arm.chain, arm.limits(), &pose);
        // Whole turns of a joint are one branch.
        let alike = |a: &JointPositions, b: &JointPositions| {
            a.iter()
                .zip(b.iter())
                .all(|(a, b)| ((a - b + PI).rem_euclid(2.0 * PI) - PI).abs() < 1e-4)
        };
        let mut branches: Vec<JointPositions> = Vec::new();
        for exact in arm.inverse(&pose) {
            if branches.iter().all(|b| !alike(b, &exact)) {
                branches.push(exact);
            }
        }
        let hits = branches
            .iter()
            .filter(|b| found.iter().any(|f| alike(f, b)))
            .count();
        for solution in &found {
            assert!(
                branches.iter().any(|b| alike(b, solution)),
                "{solution:?} is no solution"
            );
        }
        there += branches.len();
        met += hits;
        complete += usize::from(hits == branches.len());
    }
    assert!(
        met * 100 >= there * 90,
        "{met} of {there}, {complete} complete"
    );
}
