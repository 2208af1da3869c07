use proptest::prelude::*;

use crate::{EulerConvention, Intrinsics, Pose, Rotation, convert};

fn any_pose() -> impl Strategy<Value = Pose> {
    (
        prop::array::uniform3(-4.0..4.0f64),
        prop::array::uniform3(-3.1..3.1f64),
    )
        .prop_map(|(t, r)| {
            Pose::from_parts(
                nalgebra::Translation3::new(t[0], t[1], t[2]),
                Rotation::from_euler_angles(r[0], r[1] * 0.5, r[2]),
            )
        })
}

proptest! {
    #[test]
    fn euler_round_trip(pose in any_pose()) {
        for convention in [
            EulerConvention::AbbZyx,
            EulerConvention::AbbXyz,
            EulerConvention::KukaAbc,
            EulerConvention::FanucWpr,
        ] {
            let back = convention.pose_from_mm_deg(convention.mm_deg_from_pose(&pose));
            prop_assert!((back.translation.vector - pose.translation.vector).norm() < 1e-12);
            prop_assert!(back.rotation.angle_to(&pose.rotation) < 1e-6);
        }
    }

    #[test]
    fn library_round_trips(pose in any_pose()) {
        let older = convert::from_nalgebra_030(&convert::to_nalgebra_030(&pose));
        prop_assert!((older.translation.vector - pose.translation.vector).norm() == 0.0);
        prop_assert!(older.rotation.angle_to(&pose.rotation) < 1e-7);
        let single = convert::from_glam(&convert::to_glam(&pose));
        prop_assert!((single.translation.vector - pose.translation.vector).norm() < 1e-6);
        prop_assert!(single.rotation.angle_to(&pose.rotation) < 1e-3);
    }
}

/// A level box turned by 30 degrees, tool looking down: the figures of the protocol's own example.
#[test]
fn half_turn_about_own_x() {
    let turned = Rotation::from_euler_angles(0.0, 0.0, 30f64.to_radians())
        * Rotation::from_euler_angles(std::f64::consts::PI, 0.0, 0.0);
    let abb = EulerConvention::AbbZyx.angles(&turned).map(f64::to_degrees);
    let fanuc = EulerConvention::FanucWpr
        .angles(&turned)
        .map(f64::to_degrees);
    assert!(
        (abb[0] - 30.0).abs() < 1e-9 && abb[1].abs() < 1e-9 && (abb[2].abs() - 180.0).abs() < 1e-9
    );
    assert!((fanuc[2] - 30.0).abs() < 1e-9 && (fanuc[0].abs() - 180.0).abs() < 1e-9);
}

#[test]
fn projection_inverts_deprojection() {
    let intrinsics = Intrinsics {
        width: 1280,
        height: 1024,
        fx: 1600.0,
        fy: 1590.0,
        cx: 639.5,
        cy: 511.5,
    };
    let (u, v) = intrinsics.project(&intrinsics.deproject(17.25, 900.5, 2.7));
    assert!((u - 17.25).abs() < 1e-9 && (v - 900.5).abs() < 1e-9);
}
