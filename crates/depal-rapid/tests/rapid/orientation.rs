//! Orientation and pose functions against nalgebra, on random angles.

use depal_frames::nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion, Vector3};
use depal_vm::Value;
use depal_vm::execution::Step;
use proptest::prelude::*;

use crate::fake_system::*;

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Record(items) | Value::Array(items) => items.iter().flat_map(numbers).collect(),
        other => other.as_number().into_iter().collect(),
    }
}

fn rapid(q: &UnitQuaternion<f64>) -> String {
    format!("[{:.9},{:.9},{:.9},{:.9}]", q.w, q.i, q.j, q.k)
}

fn pose(p: &Isometry3<f64>) -> String {
    let t = p.translation.vector;
    format!(
        "[[{:.4},{:.4},{:.4}],{}]",
        t.x,
        t.y,
        t.z,
        rapid(&p.rotation)
    )
}

fn rotation(q: &[f64]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_quaternion(Quaternion::new(q[0], q[1], q[2], q[3]))
}

fn angles() -> impl Strategy<Value = [f64; 3]> {
    [-180.0..180.0, -89.0..89.0, -180.0..180.0]
}

fn position() -> impl Strategy<Value = [f64; 3]> {
    [-500.0..500.0, -500.0..500.0, -500.0..500.0]
}

fn zyx([z, y, x]: [f64; 3]) -> UnitQuaternion<f64> {
    UnitQuaternion::from_euler_angles(x.to_radians(), y.to_radians(), z.to_radians())
}

fn isometry(at: [f64; 3], turned: [f64; 3]) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::from(Vector3::from(at)), zyx(turned))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn orientations_and_poses_are_those_of_nalgebra(
        (a, b) in ((position(), angles()), (position(), angles())),
        point in position(),
        tool_angles in angles(),
    ) {
        let (pa, pb) = (isometry(a.0, a.1), isometry(b.0, b.1));
        let [z, y, x] = a.1;
        let [px, py, pz] = point;
        let [rz, ry, rx] = tool_angles;
        let text = format!(
            "MODULE m
VAR orient o; VAR num e{{3}}; VAR pose product; VAR pose inverse; VAR pos v; VAR orient n;
VAR robtarget t; VAR robtarget u; VAR orient oo; VAR num d; VAR num dot; VAR num length; VAR pos sum; VAR pos cross; VAR pos a1; VAR pos a2;
PROC main()
 o := OrientZYX({z:.6}, {y:.6}, {x:.6});
 e := [EulerZYX(\\Z, o), EulerZYX(\\Y, o), EulerZYX(\\X, o)];
 product := PoseMult({pa}, {pb});
 inverse := PoseInv({pa});
 v := PoseVect({pa}, [{px:.4},{py:.4},{pz:.4}]);
 n := NOrient([2 * o.q1, 2 * o.q2, 2 * o.q3, 2 * o.q4]);
 oo := o * {qb};
 t.trans := [{px:.4},{py:.4},{pz:.4}]; t.rot := o;
 u := RelTool(t, 10, 20, 30 \\Rx:={rx:.6} \\Ry:={ry:.6} \\Rz:={rz:.6});
 d := Distance([{px:.4},{py:.4},{pz:.4}], [1,2,3]);
 dot := DotProd([{px:.4},{py:.4},{pz:.4}], [1,2,3]);
 length := VectMagn([{px:.4},{py:.4},{pz:.4}]);
 a1 := [{px:.4},{py:.4},{pz:.4}]; a2 := [1,2,3];
 sum := a1 + a2 * 2;
 cross := a1 * a2;
ENDPROC
ENDMODULE", pa = pose(&pa), pb = pose(&pb), qb = rapid(&pb.rotation));
        let mut machine = machine(&text);
        prop_assert_eq!(run(&mut machine, &mut FakeSystem::default()), Step::Finished);
        let get = |name: &str| numbers(&global(&machine, name));
        let near_rotation = |q: &[f64], wanted: &UnitQuaternion<f64>| rotation(q).angle_to(wanted) < 2e-3;
        let near = |v: &[f64], wanted: &Vector3<f64>| (Vector3::from_column_slice(&v[..3]) - wanted).norm() < 2e-2;
        prop_assert!(near_rotation(&get("o"), &pa.rotation));
        for (angle, wanted) in get("e").iter().zip(a.1) {
            let difference = (angle - wanted + 540.0).rem_euclid(360.0) - 180.0;
            prop_assert!(difference.abs() < 0.05, "{angle} {wanted}");
        }
        let product = pa * pb;
        let found = get("product");
        prop_assert!(near(&found, &product.translation.vector), "{found:?} {product}");
        prop_assert!(near_rotation(&found[3..], &product.rotation));
        let inverse = pa.inverse();
        let found = get("inverse");
        prop_assert!(near(&found, &inverse.translation.vector));
        prop_assert!(near_rotation(&found[3..], &inverse.rotation));
        let p = Vector3::from(point);
        prop_assert!(near(&get("v"), &(pa * depal_frames::nalgebra::Point3::from(p)).coords));
        prop_assert!(near_rotation(&get("n"), &pa.rotation));
        let length: f64 = get("n").iter().map(|v| v * v).sum();
        prop_assert!((length - 1.0).abs() < 1e-5);
        prop_assert!(near_rotation(&get("oo"), &(pa.rotation * pb.rotation)));
        let moved = p + pa.rotation * Vector3::new(10.0, 20.0, 30.0);
        let found = get("u");
        prop_assert!(near(&found, &moved));
        // RelTool turns about x, then the new y, then the new z.
        let turn = |axis: Vector3<f64>, angle: f64| UnitQuaternion::from_scaled_axis(axis * angle.to_radians());
        let tool = turn(Vector3::x(), rx) * turn(Vector3::y(), ry) * turn(Vector3::z(), rz);
        prop_assert!(near_rotation(&found[3..7], &(pa.rotation * tool)), "{found:?}");
        let q = Vector3::new(1.0, 2.0, 3.0);
        prop_assert!((get("d")[0] - (p - q).norm()).abs() < 1e-2);
        prop_assert!((get("dot")[0] - p.dot(&q)).abs() < 1e-1);
        prop_assert!((get("length")[0] - p.norm()).abs() < 1e-2);
        prop_assert!(near(&get("sum"), &(p + q * 2.0)));
        prop_assert!((Vector3::from_column_slice(&get("cross")) - p.cross(&q)).norm() < 1e-2);
    }
}
