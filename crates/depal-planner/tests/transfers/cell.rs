//! A made-up arm of the 2.65 m class made of boxes, carrying a carton beside a pallet, and its 44 transfers.

// The arm's figures are rounded on purpose.
#![allow(clippy::approx_constant)]

use std::fmt::Write;

use depal_arm::Arm;
use depal_frames::{JointPositions, PlacedShape, Pose, Vector};

use depal_planner::TransferScene;

/// Joint origins, axes and limits: xyz, axis, lower, upper, speed; rad and rad/s.
type Row = ([f64; 3], [u8; 3], f64, f64, f64);
const JOINTS: [Row; 6] = [
    ([0.0, 0.0, 0.288], [0, 0, 1], -2.96706, 2.96706, 1.745329),
    ([0.32, 0.0, 0.492], [0, 1, 0], -1.134464, 1.48353, 1.570796),
    ([0.0, 0.0, 1.135], [0, 1, 0], -3.141593, 1.22173, 1.570796),
    ([0.0, 0.0, 0.2], [1, 0, 0], -5.235988, 5.235988, 2.96706),
    ([1.1825, 0.0, 0.0], [0, 1, 0], -2.268928, 2.268928, 2.094395),
    ([0.165, 0.0, 0.0], [1, 0, 0], -6.283185, 6.283185, 3.316126),
];
const ACCELERATIONS: [f64; 6] = [3.141593, 3.141593, 3.141593, 6.981317, 6.981317, 8.726646];
/// Link, centre and size of its box, m.
const BOXES: [(&str, [f64; 3], [f64; 3]); 8] = [
    ("base", [-0.05, 0.0, 0.14], [0.90, 0.70, 0.28]),
    ("link1", [0.05, 0.0, 0.30], [0.75, 0.55, 0.55]),
    ("link2", [0.0, 0.0, 0.5675], [0.34, 0.30, 1.45]),
    ("link3", [-0.05, 0.0, 0.12], [0.55, 0.40, 0.50]),
    ("link4", [0.62, 0.0, 0.0], [0.95, 0.24, 0.24]),
    ("link5", [0.02, 0.0, 0.0], [0.26, 0.20, 0.20]),
    ("link6", [0.10, 0.0, 0.0], [0.16, 0.16, 0.16]),
    ("tool0", [0.0, 0.0, 0.25], [0.60, 0.40, 0.10]),
];
const CHECKED: [(&str, &[&str]); 5] = [
    ("tcp", &["base", "link1", "link2", "link3"]),
    ("tool0", &["base", "link1", "link2", "link3"]),
    ("link5", &["base", "link1", "link2"]),
    ("link4", &["base", "link1"]),
    ("link6", &["link2"]),
];

pub fn urdf() -> String {
    let list = |v: &[f64]| v.iter().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let mut text = "<robot name=\"boxes\"><link name=\"tcp\"/>".to_owned();
    for (name, centre, size) in BOXES {
        write!(
            text,
            "<link name=\"{name}\"><collision><origin xyz=\"{}\"/><geometry><box size=\"{}\"/></geometry></collision></link>",
            list(&centre), list(&size)
        )
        .unwrap();
    }
    for (i, (xyz, axis, lower, upper, speed)) in JOINTS.iter().enumerate() {
        let axis = axis.map(f64::from);
        write!(
            text,
            "<joint name=\"j{}\" type=\"revolute\"><parent link=\"{}\"/><child link=\"{}\"/><origin xyz=\"{}\"/><axis xyz=\"{}\"/><limit lower=\"{lower}\" upper=\"{upper}\" velocity=\"{speed}\" effort=\"0\"/></joint>",
            i + 1, BOXES[i].0, BOXES[i + 1].0, list(xyz), list(&axis)
        )
        .unwrap();
    }
    text + "<joint name=\"flange\" type=\"fixed\"><parent link=\"link6\"/><child link=\"tool0\"/><origin xyz=\"0.035 0 0\" rpy=\"0 1.5707963267948966 0\"/></joint>\
        <joint name=\"tool\" type=\"fixed\"><parent link=\"tool0\"/><child link=\"tcp\"/><origin xyz=\"0 0 0.3\"/></joint></robot>"
}

pub fn cuboid(centre: [f64; 3], size: [f64; 3]) -> PlacedShape {
    let [x, y, z] = centre;
    PlacedShape::cuboid(Pose::translation(x, y, z), Vector::from(size))
}

fn allowed_pairs() -> Vec<(String, String)> {
    let names: Vec<&str> = BOXES.iter().map(|b| b.0).chain(["tcp"]).collect();
    let checked = |a: &str, b: &str| CHECKED.iter().any(|(x, y)| *x == a && y.contains(&b));
    let mut pairs = Vec::new();
    for (i, a) in names.iter().enumerate() {
        for b in &names[i + 1..] {
            if !checked(a, b) && !checked(b, a) {
                pairs.push(((*a).to_owned(), (*b).to_owned()));
            }
        }
    }
    pairs
}

/// Arm with the carried carton among these obstacles.
pub fn scene(obstacles: Vec<PlacedShape>) -> TransferScene {
    let arm = Arm::from_urdf(&urdf(), "boxes.urdf", &ACCELERATIONS).unwrap();
    let tcp = arm.links().iter().position(|l| l.name == "tcp").unwrap();
    TransferScene {
        arm,
        attached: vec![(tcp, cuboid([0.0, 0.0, 0.127], [0.295, 0.245, 0.25]))],
        load: depal_arm::Load::NONE,
        obstacles,
        allowed_pairs: allowed_pairs(),
        tcp_link: Some(tcp),
    }
}

/// Floor, pallet, conveyor, fence and camera gantry.
pub fn furniture() -> Vec<PlacedShape> {
    vec![
        cuboid([0.0, 0.0, -0.055], [8.0, 8.0, 0.1]),
        cuboid([1.75, 0.0, 0.072], [1.2, 1.0, 0.144]),
        cuboid([0.2, 1.85, 0.375], [2.4, 0.7, 0.75]),
        cuboid([1.75, 0.95, 0.8], [1.5, 0.06, 1.6]),
        cuboid([2.75, -0.9, 1.6], [0.15, 0.15, 3.2]),
        cuboid([2.25, -0.9, 3.2], [1.0, 0.15, 0.15]),
    ]
}

/// The cell with so many layers on the pallet, without the carton of one slot of the top layer.
pub fn obstacles(layers: usize, slot: usize) -> Vec<PlacedShape> {
    let mut all = furniture();
    for layer in 0..layers {
        for s in 0..16 {
            if layer + 1 == layers && s == slot {
                continue;
            }
            let (i, j) = ((s / 4) as f64, (s % 4) as f64);
            let centre = [
                1.75 + (i - 1.5) * 0.3,
                (j - 1.5) * 0.25,
                0.269 + 0.25 * layer as f64,
            ];
            all.push(cuboid(centre, [0.295, 0.245, 0.25]));
        }
    }
    for layer in 0..5 {
        for i in 0..4 {
            let centre = [
                1.1 + f64::from(i % 2) * 0.4,
                -1.55 + f64::from(i / 2) * 0.3,
                0.269 + 0.25 * f64::from(layer),
            ];
            all.push(cuboid(centre, [0.39, 0.29, 0.25]));
        }
    }
    all
}

/// Above the conveyor.
pub fn goal() -> JointPositions {
    JointPositions::from_slice(&[1.4100, 0.3388, 0.0221, 0.0, 1.2099, -1.7316])
}

/// Layers, first slot and, per slot, joints 1, 2, 3 and 5 above it; joint 4 is zero, joint 6 equals joint 1.
const STARTS: [(usize, &[[f64; 4]]); 3] = [
    (
        5,
        &[
            [-0.2808, -0.1161, 0.0423, 1.6446],
            [-0.0959, -0.1566, 0.0774, 1.6500],
            [0.0959, -0.1566, 0.0774, 1.6500],
            [0.2808, -0.1161, 0.0423, 1.6446],
            [-0.2302, 0.1412, -0.2181, 1.6477],
            [-0.0780, 0.1059, -0.1786, 1.6435],
            [0.0780, 0.1059, -0.1786, 1.6435],
            [0.2302, 0.1412, -0.2181, 1.6477],
            [-0.1949, 0.4378, -0.5980, 1.7310],
            [-0.0657, 0.4010, -0.5462, 1.7160],
            [0.0657, 0.4010, -0.5462, 1.7160],
            [0.1949, 0.4378, -0.5980, 1.7310],
        ],
    ),
    (
        4,
        &[
            [-0.2808, -0.1464, 0.2796, 1.4376],
            [-0.0959, -0.1882, 0.3148, 1.4441],
            [0.0959, -0.1882, 0.3148, 1.4441],
            [0.2808, -0.1464, 0.2796, 1.4376],
            [-0.2302, 0.1100, 0.0276, 1.4332],
            [-0.0780, 0.0759, 0.0648, 1.4302],
            [0.0780, 0.0759, 0.0648, 1.4302],
            [0.2302, 0.1100, 0.0276, 1.4332],
            [-0.1949, 0.3814, -0.3062, 1.4956],
            [-0.0657, 0.3496, -0.2636, 1.4848],
            [0.0657, 0.3496, -0.2636, 1.4848],
            [0.1949, 0.3814, -0.3062, 1.4956],
            [-0.1688, 0.7277, -0.8272, 1.6703],
            [-0.0568, 0.6858, -0.7586, 1.6437],
            [0.0568, 0.6858, -0.7586, 1.6437],
            [0.1688, 0.7277, -0.8272, 1.6703],
        ],
    ),
    (
        3,
        &[
            [-0.2808, -0.1303, 0.4751, 1.2261],
            [-0.0959, -0.1734, 0.5119, 1.2323],
            [0.0959, -0.1734, 0.5119, 1.2323],
            [0.2808, -0.1303, 0.4751, 1.2261],
            [-0.2302, 0.1263, 0.2189, 1.2256],
            [-0.0780, 0.0928, 0.2559, 1.2221],
            [0.0780, 0.0928, 0.2559, 1.2221],
            [0.2302, 0.1263, 0.2189, 1.2256],
            [-0.1949, 0.3841, -0.1010, 1.2877],
            [-0.0657, 0.3548, -0.0616, 1.2776],
            [0.0657, 0.3548, -0.0616, 1.2776],
            [0.1949, 0.3841, -0.1010, 1.2877],
            [-0.1688, 0.6790, -0.5372, 1.4289],
            [-0.0568, 0.6471, -0.4866, 1.4103],
            [0.0568, 0.6471, -0.4866, 1.4103],
            [0.1688, 0.6790, -0.5372, 1.4289],
        ],
    ),
];

/// All 44: name, layers, slot, start.
pub fn transfers() -> Vec<(String, usize, usize, JointPositions)> {
    let mut all = Vec::new();
    for (layers, starts) in STARTS {
        for (slot, &[j1, j2, j3, j5]) in starts.iter().enumerate() {
            let start = JointPositions::from_slice(&[j1, j2, j3, 0.0, j5, j1]);
            all.push((format!("L{layers}s{slot:02}"), layers, slot, start));
        }
    }
    all
}
