//! The axes as the controller shows them, against the arm of the scene.

use depal_arm::Arm;
use depal_frames::{JointPositions, Pose};

use crate::fake_system::*;

const URDF: &str = include_str!("../../../../urdf/fanuc_r2000ic_165f.urdf");

/// `base_from_flange` where `J P[1]` goes.
fn flange(shown: [f64; 6]) -> Pose {
    let [a, b, c, d, e, f] = shown;
    let positions = format!(
        "P[1]{{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1={a} deg,\tJ2={b} deg,\tJ3={c} deg,\n\tJ4={d} deg,\tJ5={e} deg,\tJ6={f} deg\n}};\n"
    );
    let trace = run_text(&listing(&["J P[1] 100% FINE"], &positions)).trace;
    let list = trace[0].split(['[', ']']).nth(1).expect("joints");
    let degrees: Vec<f64> = list
        .split(", ")
        .map(|v| v.parse().expect("a number"))
        .collect();
    let arm = Arm::from_urdf_uniform(URDF, "tool0", 3.0).expect("a good description");
    arm.base_from_flange(&JointPositions::from_degrees(&degrees))
}

#[test]
fn axis_3_is_shown_against_the_horizontal() {
    // At zero the upper arm stands and the forearm is level: L1 .67 + L2 1.075 + .225 high, .312 + 1.28 + .215 out.
    let zero = flange([0.0; 6]).translation.vector;
    assert!(
        (zero.x - 1.807).abs() < 1e-9 && (zero.z - 1.97).abs() < 1e-9,
        "{zero}"
    );
    // Axis 2 alone leans the upper arm forward; the forearm stays level, the flange keeps its direction.
    let leaned = flange([0.0, 30.0, 0.0, 0.0, 0.0, 0.0]);
    assert!(leaned.rotation.angle_to(&flange([0.0; 6]).rotation) < 1e-9);
    let moved = leaned.translation.vector - zero;
    assert!((moved.x - 1.075 * 0.5).abs() < 1e-9, "{moved}");
    assert!(
        (moved.z - 1.075 * (3f64.sqrt() / 2.0 - 1.0)).abs() < 1e-9,
        "{moved}"
    );
    // Axis 3 upwards is positive: the flange rises and looks up.
    let raised = flange([0.0, 0.0, 20.0, 0.0, 0.0, 0.0]);
    let out = raised.rotation * depal_frames::Vector::z();
    assert!((out.z - 20f64.to_radians().sin()).abs() < 1e-9, "{out}");
    assert!(raised.translation.z > zero.z);
}

#[test]
fn the_capture_pose_looks_down() {
    let pose = flange([90.0, -20.0, 0.0, 0.0, -90.0, 0.0]);
    let out = pose.rotation * depal_frames::Vector::z();
    assert!((out.z + 1.0).abs() < 1e-9, "{out}");
}
